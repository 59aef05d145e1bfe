//! How the arm yields all over the cell: nodes over radius, height and heading, made when they are first requested.
//!
//! A node speaks for everything within one step of it in radius and height, so that one of them answers for any region
//! of up to half a step around any state, and within half a step in heading: headings are cut into cells once and for
//! all. It says that none of its states is allowed, or gives an affine model of the compliances with what that leaves
//! out.

use super::arm::{Arm, ArmCompliance, LimitSpan};
use super::enclosure::Enclosure;
use super::interval::Interval;
use super::interval_simd::{Lanes, WIDTH};
use super::moment::{MOMENTS, MomentModel};
use super::number::{PAIR, PAIRS};
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use stead_model::robot::PostureClass;

/// What is known of the states around a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Node {
    /// None of them is allowed.
    Empty,
    /// Nothing is known of them.
    Unknown,
    /// How they yield.
    Known(AffineModel),
}

/// An affine model of the states around a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AffineModel {
    /// Value and gradient of m, d1, d2, c_rz, c_tz and c_zz at the node.
    pub values: [[f32; 4]; FUNCTIONS],
    /// What these leave out: of m, of the length of (d1, d2), of that of (c_rz, c_tz), and of c_zz.
    pub remainder: [f32; REMAINDERS],
    /// Whether all the states are sure to be allowed.
    pub sure: bool,
}

/// The extent of a table: what placements of the cell can ask for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    /// Radius, from and to. m
    pub radius: (f64, f64),
    /// Height, from and to. m
    pub height: (f64, f64),
}

/// Steps of the coarsest level; each level has half the steps of the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steps {
    /// Radius and height. m
    pub length: f64,
    /// Number of cells of heading, a power of two, 64 or more.
    pub headings: usize,
}

/// Functions modelled: see [`AffineModel::values`].
pub(super) const FUNCTIONS: usize = 6;
/// Remainders of them: see [`AffineModel::remainder`].
pub(super) const REMAINDERS: usize = 4;

/// Neighbouring headings made at once.
const CHUNK: usize = 16;

#[derive(Debug)]
pub(super) struct ComplianceTable {
    extent: Extent,
    steps: Steps,
    levels: Vec<Level>,
    /// What the chunks made so far take. bytes
    made: AtomicU64,
}

/// Nodes that are made when the first of them is needed.
type Chunk = OnceLock<Box<Nodes>>;

/// Neighbouring nodes, and how they yield to moments, where some act.
#[derive(Debug)]
struct Nodes {
    nodes: [Node; CHUNK],
    moments: Option<Box<[Option<MomentModel>; CHUNK]>>,
}

#[derive(Debug)]
struct Level {
    counts: [usize; 3],
    /// The chunks of each radius and height, allocated when one of them is needed: all of them together may be
    /// gigabytes, which take seconds to set up.
    places: Vec<OnceLock<Box<[Chunk]>>>,
}

impl ComplianceTable {
    pub fn new(extent: Extent, steps: Steps, levels: usize) -> Self {
        let levels = (0..levels)
            .map(|level| {
                let length = steps.length / (1u64 << level) as f64;
                let along = |(from, to): (f64, f64)| ((to - from) / length).ceil() as usize + 1;
                let counts = [along(extent.radius), along(extent.height), steps.headings << level];
                Level { counts, places: std::iter::repeat_with(OnceLock::new).take(counts[0] * counts[1]).collect() }
            })
            .collect();
        Self { levels, extent, steps, made: AtomicU64::new(0) }
    }

    /// What it takes at most with the nodes made so far. bytes
    pub fn used(&self) -> u64 {
        let empty = Self::bytes(self.extent, self.steps, self.levels.len());
        empty + self.made.load(Ordering::Relaxed)
    }

    /// What a table takes at most beside its nodes. bytes
    pub fn bytes(extent: Extent, steps: Steps, levels: usize) -> u64 {
        let along = |(from, to): (f64, f64), length: f64| ((to - from) / length).ceil() + 1.0;
        let one = |level: usize| {
            let length = steps.length / (1u64 << level) as f64;
            let chunks = ((steps.headings << level) / CHUNK * 4) as f64;
            along(extent.radius, length) * along(extent.height, length) * chunks
        };
        ((0..levels).map(one).sum::<f64>() * size_of::<Chunk>() as f64) as u64
    }

    /// Radii and heights, and steps.
    pub fn grid(&self) -> (Extent, Steps) {
        (self.extent, self.steps)
    }

    /// Number of levels.
    pub fn depth(&self) -> usize {
        self.levels.len()
    }

    /// Number of cells of heading at a level.
    pub fn headings(&self, level: usize) -> usize {
        self.steps.headings << level
    }

    /// Steps in radius and height at a level. m
    pub fn length(&self, level: usize) -> f64 {
        self.steps.length / (1u64 << level) as f64
    }

    /// The finest level whose nodes answer for regions of that half size in radius and height; `None` for larger ones.
    pub fn level(&self, half: f64) -> Option<usize> {
        (0..self.levels.len()).rev().find(|level| self.answers(*level, [half, half]))
    }

    /// Whether the nodes of a level answer for everything within those distances of a radius and height.
    pub fn answers(&self, level: usize, reach: [f64; 2]) -> bool {
        reach[0].max(reach[1]) <= 0.5 * self.length(level) * (1.0 + 1e-9)
    }

    /// The node nearest to a radius and height, and how far they are from it; `None` outside the table.
    #[inline]
    pub fn nearest(&self, level: usize, r: f64, z: f64) -> Option<([usize; 2], [f64; 2])> {
        let length = self.length(level);
        let place = |value: f64, from: f64, count: usize| {
            let k = (value - from) / length + 0.5;
            if k < 0.0 { None } else { Some(k as usize).filter(|k| *k < count) }
        };
        let counts = &self.levels[level].counts;
        let (i, j) = (place(r, self.extent.radius.0, counts[0])?, place(z, self.extent.height.0, counts[1])?);
        let [at_r, at_z] = self.place(level, [i, j]);
        Some(([i, j], [r - at_r, z - at_z]))
    }

    /// Radius and height of a node. m
    pub fn place(&self, level: usize, [i, j]: [usize; 2]) -> [f64; 2] {
        let length = self.length(level);
        [self.extent.radius.0 + length * i as f64, self.extent.height.0 + length * j as f64]
    }

    /// Whether there is such a node.
    pub fn holds(&self, level: usize, [i, j]: [usize; 2]) -> bool {
        self.levels.get(level).is_some_and(|l| i < l.counts[0] && j < l.counts[1])
    }

    /// Middle of a cell of heading. rad
    pub fn heading(&self, level: usize, cell: usize) -> f64 {
        TAU / self.headings(level) as f64 * (cell as f64 + 0.5)
    }

    /// The node of a cell of heading, without what it tells of moments.
    #[cfg(test)]
    pub fn node(&self, arm: &Arm, level: usize, at: [usize; 2], cell: usize, class: PostureClass) -> &Node {
        self.known(arm, level, at, cell, class).0
    }

    /// The node of a cell of heading, and how it yields to moments, where some act.
    #[inline]
    pub fn known(
        &self,
        arm: &Arm,
        level: usize,
        at: [usize; 2],
        cell: usize,
        class: PostureClass,
    ) -> (&Node, Option<&MomentModel>) {
        let stored = &self.levels[level];
        let chunks = stored.places[at[0] * stored.counts[1] + at[1]]
            .get_or_init(|| std::iter::repeat_with(OnceLock::new).take(stored.counts[2] / CHUNK * 4).collect());
        let nodes = chunks[cell / CHUNK * 4 + class.index()].get_or_init(|| {
            let moments = arm.has_moments.then(|| Box::new([None; CHUNK]));
            let mut nodes = Box::new(Nodes { nodes: [Node::Empty; CHUNK], moments });
            let bytes = size_of::<Nodes>() + nodes.moments.as_deref().map_or(0, size_of_val);
            self.made.fetch_add(bytes as u64, Ordering::Relaxed);
            let first = cell / CHUNK * CHUNK;
            for start in (0..CHUNK).step_by(WIDTH) {
                let some = self.made(arm, level, self.place(level, at), first + start, class);
                for (k, (node, moment)) in some.into_iter().enumerate() {
                    nodes.nodes[start + k] = node;
                    if let Some(moments) = &mut nodes.moments {
                        moments[start + k] = moment;
                    }
                }
            }
            nodes
        });
        let moments = nodes.moments.as_ref().and_then(|moments| moments[cell % CHUNK].as_ref());
        (&nodes.nodes[cell % CHUNK], moments)
    }

    fn made(&self, arm: &Arm, level: usize, [r, z]: [f64; 2], cell: usize, class: PostureClass) -> [Made; WIDTH] {
        let half = [self.length(level), self.length(level), PI / self.headings(level) as f64];
        let place: [[f64; 3]; WIDTH] = std::array::from_fn(|k| [r, z, self.heading(level, cell + k)]);
        known_over(arm, &place, half, class)
    }
}

/// The same without what is known of moments.
#[cfg(test)]
pub(super) fn nodes_over(arm: &Arm, place: &[[f64; 3]; WIDTH], half: [f64; 3], class: PostureClass) -> [Node; WIDTH] {
    known_over(arm, place, half, class).map(|made| made.0)
}

/// A node, and how it yields to moments, where some act.
type Made = (Node, Option<MomentModel>);

/// What is known of four regions (radius, height, heading) of those half widths.
pub(super) fn known_over(arm: &Arm, place: &[[f64; 3]; WIDTH], half: [f64; 3], class: PostureClass) -> [Made; WIDTH] {
    match enclosed(arm, place, half, class) {
        None => [(Node::Empty, None); WIDTH],
        Some(y) => std::array::from_fn(|k| judged(arm, &y, k, half)),
    }
}

/// The closed form over four regions (radius, height, heading).
pub(super) fn enclosed(
    arm: &Arm,
    place: &[[f64; 3]; WIDTH],
    half: [f64; 3],
    class: PostureClass,
) -> Option<ArmCompliance<Enclosure>> {
    let ends = place.map(|p| sine_cosine_over(p[2] - half[2], p[2] + half[2]));
    let middle = place.map(|p| libm::sincos(p[2]));
    let (sine, cosine) = Enclosure::heading(
        [Lanes(middle.map(|m| m.0)), Lanes(middle.map(|m| m.1))],
        [
            Interval::between(Lanes(ends.map(|e| e.0.0)), Lanes(ends.map(|e| e.0.1))),
            Interval::between(Lanes(ends.map(|e| e.1.0)), Lanes(ends.map(|e| e.1.1))),
        ],
        half,
    );
    let radius = Enclosure::variable(Lanes(place.map(|p| p[0])), 0, half);
    let height = Enclosure::variable(Lanes(place.map(|p| p[1])), 1, half);
    arm.evaluate(radius, height, sine, cosine, class)
}

fn judged(arm: &Arm, y: &ArmCompliance<Enclosure>, lane: usize, half: [f64; 3]) -> Made {
    if y.violated.lane(lane) {
        return (Node::Empty, None);
    }
    if !y.regular.lane(lane) {
        return (Node::Unknown, None);
    }
    let holds = |margin: &Enclosure| margin.value.low().0[lane] >= 0.0;
    let margins = &y.margins;
    let within = |joint: usize| match (arm.limit_span(joint), &margins.joints[joint]) {
        (LimitSpan::Full, _) => true,
        (LimitSpan::Wide, [min, max]) => holds(min) || holds(max),
        (LimitSpan::Narrow, [min, max]) => holds(min) && holds(max),
    };
    let others = [&margins.elbow, &margins.joint5, &margins.wrist, &margins.conditioning];
    let sure = y.conditioned.lane(lane) && others.into_iter().all(holds) && within(0) && within(1);
    let functions = [&y.m, &y.d1, &y.d2, &y.vertical[0], &y.vertical[1], &y.axial];
    let of = |f: &Enclosure| {
        let f = f.middle();
        [f.value.0[lane], f.gradient[0].0[lane], f.gradient[1].0[lane], f.gradient[2].0[lane]]
    };
    let values = functions.map(of);
    let max_second = |f: usize, p: usize| functions[f].second[p].magnitude().0[lane];
    let mut remainder = [0.0; REMAINDERS];
    let factors: [f64; PAIRS] = std::array::from_fn(|p| {
        let (i, j) = PAIR[p];
        half[i] * half[j] * if i == j { 0.5 } else { 1.0 }
    });
    for (p, factor) in factors.into_iter().enumerate() {
        remainder[0] += max_second(0, p) * factor;
        remainder[1] += libm::hypot(max_second(1, p), max_second(2, p)) * factor;
        remainder[2] += libm::hypot(max_second(3, p), max_second(4, p)) * factor;
        remainder[3] += max_second(5, p) * factor;
    }
    // And what is lost by writing the values with fewer digits.
    let size = |f: usize| values[f][0].abs() + (0..3).map(|k| values[f][k + 1].abs() * half[k]).sum::<f64>();
    let lost = [size(0), size(1) + size(2), size(3) + size(4), size(5)];
    let remainder = [0, 1, 2, 3].map(|f| remainder[f] + 1e-7 * lost[f]).map(|r| (r * (1.0 + 1e-6)) as f32);
    if !remainder.iter().all(|r| *r < 1e30) {
        return (Node::Unknown, None);
    }
    let known = Node::Known(AffineModel { values: values.map(|v| v.map(|x| x as f32)), remainder, sure });
    let Some(moments) = &y.moments else { return (known, None) };
    let values: [[f64; 4]; MOMENTS] = std::array::from_fn(|f| of(&moments[f]));
    let max_second = |f: usize, p: usize| moments[f].second[p].magnitude().0[lane];
    match MomentModel::new(values, half, max_second, factors) {
        Some(moments) => (known, Some(moments)),
        None => (Node::Unknown, None),
    }
}

/// Least and largest sine and cosine between two angles less than a turn apart. rad
fn sine_cosine_over(from: f64, to: f64) -> ((f64, f64), (f64, f64)) {
    let (s0, c0) = libm::sincos(from);
    let (s1, c1) = libm::sincos(to);
    // Whether an angle of that kind (plus whole turns) is between.
    let holds = |angle: f64| ((to - angle) / TAU).floor() > ((from - angle) / TAU).floor();
    let range = |a: f64, b: f64, top: f64| {
        let high = if holds(top) { 1.0 } else { a.max(b) };
        let low = if holds(top + PI) { -1.0 } else { a.min(b) };
        (low, high)
    };
    (range(s0, s1, PI / 2.0), range(c0, c1, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_planning::testing::five_segments;

    /// A cell 4 m wide and 2 m high has gigabytes of chunks. Setting them up takes seconds, without a look at the time
    /// limit.
    #[test]
    fn a_table_takes_memory_only_where_it_is_used() {
        let problem = five_segments();
        let extent = Extent { radius: (0.3, 4.3), height: (-1.0, 1.0) };
        let steps = Steps { length: 0.025, headings: 128 };
        assert!(ComplianceTable::bytes(extent, steps, 4) > 3_000_000_000);
        let table = ComplianceTable::new(extent, steps, 4);
        let set_up =
            || table.levels.iter().flat_map(|level| &level.places).filter(|place| place.get().is_some()).count();
        assert_eq!(set_up(), 0);
        let arm = Arm::new(&problem, &problem.robot, extent.radius.0);
        for cell in [0, 1023] {
            table.known(&arm, 3, [700, 300], cell, PostureClass::ALL[0]);
        }
        assert_eq!((set_up(), table.made.load(Ordering::Relaxed)), (1, 2 * size_of::<Nodes>() as u64));
    }
}
