//! What earlier teeth have cleared along rays from the tool centre.

use super::rays::{LANES, Rays, starts};
use super::trail::{Extent, Extents, Node, Trail};
use stead_numerics::simd::{Lanes, Simd};

/// A tooth that passed before the present one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predecessor {
    /// How long before. steps
    pub delay: f64,
    /// How much longer before another tooth passed. steps
    pub spacing: f64,
    /// Radius of its edge. m
    pub radius: f64,
}

/// What is constant for all rays of one tooth at one time.
#[derive(Debug, Clone, Copy)]
pub struct ToothQuery<'a> {
    /// Where the centre was.
    pub trail: &'a Trail,
    /// The teeth of the last turn, the nearest first; those of the turns before follow them a turn apart.
    pub predecessors: &'a [Predecessor],
    /// Largest radius of all teeth. m
    pub largest: f64,
    /// Steps a turn.
    pub turn: f64,
    /// Now. steps
    pub time: f64,
    /// Where the centre is now. m
    pub centre: [f64; 2],
    /// Steps in which a tooth turns by 1 rad of psi; negative where psi falls.
    pub steps_per_radian: f64,
}

/// The earlier passes as one tooth meets them at one moment, looked up when requested.
#[derive(Debug, Clone, Default)]
pub struct Passes {
    met: Vec<Met>,
    ended: bool,
}

/// An earlier tooth at the moment when it had turned as far as the present one has now.
#[derive(Debug, Clone, Copy)]
struct Met {
    time: f64,
    radius: f64,
    centre: Node,
    /// What all passes before this one have in common; `None` if there was none.
    older: Option<Extents>,
}

/// So far (in steps) the cubic of a step is used beyond its ends, for rays that lie a little beside it. There the next
/// step's cubic has the same place and motion, and differs in the curvature of the way alone.
const BESIDE: f64 = 0.25;

impl Passes {
    /// Forgets what was looked up, for another tooth or another moment.
    pub fn reset(&mut self) {
        self.met.clear();
        self.ended = false;
    }

    fn get(&mut self, query: &ToothQuery<'_>, index: usize) -> Option<Met> {
        while self.met.len() <= index && !self.ended {
            let number = self.met.len();
            let turns = (number / query.predecessors.len()) as f64;
            let predecessor = query.predecessors[number % query.predecessors.len()];
            let time = query.time - predecessor.delay - turns * query.turn;
            // So that the centre is known for all rays that lie within a radian.
            match query.trail.at(time).filter(|_| time >= query.steps_per_radian.abs()) {
                Some(centre) => {
                    let older = query.trail.up_to(time - predecessor.spacing / 2.0);
                    self.met.push(Met { time, radius: predecessor.radius, centre, older });
                }
                None => self.ended = true,
            }
        }
        self.met.get(index).copied()
    }

    /// Moves the beginning of each ray to where earlier teeth have cleared it: as far as need be, to the end of the ray
    /// at most. m
    #[inline(always)]
    pub fn clear<S: Simd<Number = f64>>(&mut self, simd: S, query: &ToothQuery<'_>, rays: &mut Rays) {
        let mut index = 0;
        while let Some(met) = self.get(query, index) {
            let centres = centres(simd, query, &met, rays);
            advance(simd, query, &met, &centres, rays);
            let Some(Extents { recent, before }) = &met.older else { break };
            if !may_reach(simd, recent, query, rays)
                && !before.is_some_and(|older| may_reach(simd, &older, query, rays))
            {
                break;
            }
            index += 1;
        }
    }
}

/// Centres that in a radian of the tooth come farther than this part of the radius need four steps to be found,
const SWIFT: f64 = 0.01;
/// and so do those that stray from a straight way by more than this part of it.
const STRAY: f64 = 2e-5;

/// Where the centre was when an earlier tooth was on each ray: x and y. m
///
/// The tooth was there, turned by delta more than when it had turned as far as the present one has now, when
/// `(c(t') - c) x e + R' sin(delta) = 0`. One step of Newton's method finds that, since the centre moves much slower
/// than the edge, unless it is swift or just now on the turn.
#[inline(always)]
fn centres<S: Simd<Number = f64>>(simd: S, query: &ToothQuery<'_>, met: &Met, rays: &Rays) -> [[f64; LANES]; 2] {
    let [vx, vy] = met.centre.motion.map(|motion| motion * query.steps_per_radian / met.radius);
    let [x, y] = met.centre.place;
    let first = times(simd, query, met, rays, &[[x; LANES], [y; LANES]], [vx, vy]);
    let found = places(simd, query, met, &first);
    let stray = |lane: usize| {
        let [dx, dy] = [(0, x), (1, y)]
            .map(|(axis, place)| (found[axis][lane] - place - met.centre.motion[axis] * first[lane]).abs());
        dx + dy
    };
    if vx.abs() + vy.abs() < SWIFT && stray(0).max(stray(LANES - 1)) < STRAY * met.radius {
        return found;
    }
    let (mut known, mut found) = (first, found);
    for _ in 0..3 {
        let mut next = times(simd, query, met, rays, &found, [0.0; 2]);
        for lane in 0..LANES {
            // What is left of the error shrinks once more by the drift of the centre.
            let drift = vx * rays.cosine[lane] + vy * rays.sine[lane];
            next[lane] += drift * (known[lane] - next[lane]);
        }
        found = places(simd, query, met, &next);
        known = next;
    }
    found
}

/// When an earlier tooth was on each ray, in steps, if the centre was at a place and moved on from there by a share of
/// the radius for each radian that the tooth turned: `1 / (1 + v)` as `1 - v + v^2`, and the series of the arcsine,
/// since the centre comes less far than a radius between passes.
#[inline(always)]
fn times<S: Simd<Number = f64>>(
    simd: S,
    query: &ToothQuery<'_>,
    met: &Met,
    rays: &Rays,
    centres: &[[f64; LANES]; 2],
    shares: [f64; 2],
) -> [f64; LANES] {
    let ([xs, ys], [vx, vy]) = (centres, shares);
    let inverse = 1.0 / met.radius;
    let mut times = [0.0; LANES];
    for start in starts::<S>() {
        let (sine, cosine) = (Lanes::load(simd, &rays.sine, start), Lanes::load(simd, &rays.cosine, start));
        let (dx, dy) = (Lanes::load(simd, xs, start) - query.centre[0], Lanes::load(simd, ys, start) - query.centre[1]);
        let drift = cosine * vx + sine * vy;
        let ratio = (cosine * dx + sine * dy) * -inverse * ((drift * drift - drift) + 1.0);
        let square = ratio * ratio;
        let series = (((square * (5.0 / 112.0) + 3.0 / 40.0) * square + 1.0 / 6.0) * square + 1.0) * ratio;
        let turned = series.min(ratio.all(1.0)).max(ratio.all(-1.0));
        (turned * query.steps_per_radian).store(&mut times, start);
    }
    times
}

/// Where the centre was at times after that of an earlier tooth: x and y. m
#[inline(always)]
fn places<S: Simd<Number = f64>>(
    simd: S,
    query: &ToothQuery<'_>,
    met: &Met,
    times: &[f64; LANES],
) -> [[f64; LANES]; 2] {
    let [mut xs, mut ys] = [[0.0; LANES]; 2];
    let [first, last] = [times[0], times[LANES - 1]];
    let middle = (first + last) / 2.0;
    let beside = (last - first).abs() / 2.0 + (times[LANES / 2] - middle).abs();
    match query.trail.leg(met.time + middle) {
        Some((leg, within)) if within > beside - BESIDE && within + beside < 1.0 + BESIDE => {
            let offset = within - middle;
            for start in starts::<S>() {
                let s = Lanes::load(simd, times, start) + offset;
                let [place, motion, second, third] = leg.parts(0);
                (((s * third + second) * s + motion) * s + place).store(&mut xs, start);
                let [place, motion, second, third] = leg.parts(1);
                (((s * third + second) * s + motion) * s + place).store(&mut ys, start);
            }
        }
        _ => {
            for lane in 0..LANES {
                // Before the first step: as far away as never to matter.
                [xs[lane], ys[lane]] = query.trail.place(met.time + times[lane]).unwrap_or([-1e3, 0.0]);
            }
        }
    }
    [xs, ys]
}

/// Moves the beginning of each ray to the arc of an earlier tooth, where that is farther.
#[inline(always)]
fn advance<S: Simd<Number = f64>>(
    simd: S,
    query: &ToothQuery<'_>,
    met: &Met,
    centres: &[[f64; LANES]; 2],
    rays: &mut Rays,
) {
    let ([xs, ys], square) = (centres, met.radius * met.radius);
    for start in starts::<S>() {
        let (sine, cosine) = (Lanes::load(simd, &rays.sine, start), Lanes::load(simd, &rays.cosine, start));
        let (dx, dy) = (Lanes::load(simd, xs, start) - query.centre[0], Lanes::load(simd, ys, start) - query.centre[1]);
        let across = dx * cosine + dy * sine;
        let left = across.all(square) - across * across;
        let reach = dx * sine - dy * cosine + left.sqrt();
        // Not a number where the ray misses the arc: then nothing is less than it.
        let from = Lanes::load(simd, &rays.from, start);
        from.max(reach).store(&mut rays.from, start);
    }
}

/// Whether a pass older than all that an extent tells of could clear more of a ray that is not cleared yet.
///
/// Its centre is at least `behind` back along the feed, and so much higher or lower. A ray ahead (sin(psi) >= 0) is
/// cleared up to `d . e + R - (d x e)^2 / 2R` at most, with the nearest centre. A ray a little astern is cleared most
/// by a centre farther back, unless that is as near as they come. A ray far astern is only known to be no further
/// cleared than any edge came down.
#[inline(always)]
fn may_reach<S: Simd<Number = f64>>(simd: S, older: &Extent, query: &ToothQuery<'_>, rays: &Rays) -> bool {
    let ([x, y], radius) = (query.centre, query.largest);
    let behind = x - older.front;
    if behind > 2.0 * radius {
        return false;
    }
    let (low, high) = (older.bottom - y, older.top - y);
    let widest = low.abs().max(high.abs());
    let half = 0.5 / radius;
    let mut may = false;
    for start in starts::<S>() {
        let (sine, cosine) = (Lanes::load(simd, &rays.sine, start), Lanes::load(simd, &rays.cosine, start));
        let (from, to) = (Lanes::load(simd, &rays.from, start), Lanes::load(simd, &rays.to, start));
        let zero = sine.all(0.0);
        let lift = (cosine * -low).max(cosine * -high);
        let across = (cosine.abs() * behind - sine.abs() * widest).max(zero);
        let nearest = lift - sine * behind + radius - across * across * half;
        // Where cos(psi) > 0.9: the farthest that any centre clears, and how far back that one is at most.
        let farthest = lift + radius + sine * sine * (0.62 * radius + 1.12 * widest);
        let back = sine * (-1.24 * radius) + 1.12 * widest;
        let beside = zero.all(behind).less(back).select(farthest, nearest);
        let depth = cosine.less(zero).select(zero.all(radius + high), zero.all(radius - low));
        let astern = zero.all(0.9).less(cosine).select(beside - from, depth - from * cosine.abs());
        let excess = sine.less(zero).select(astern, nearest - from);
        may |= (from.less(to) & zero.less(excess)).any();
    }
    may
}
