//! The least-squares circle (Klimchik 2017, eq. 29-32).

use super::algebraic::Moments;
use super::chart::{Centre, Chart, Far, Middle, Point};
use super::frame::{Frame, Spread};
use super::{CircleError, Fit, Radius};
use std::f64::consts::PI;

/// Steps at most; near a circle three or four are enough.
const STEPS: usize = 200;
/// Once a Newton step is this short, the next would be lost in rounding.
const LAST: f64 = 1e-9;
/// A smaller curvature, of points in the unit disc, is that of a line.
const FLAT: f64 = 1e-12;
/// Mean square residual from which on there may be several minima, of points in the unit disc.
const SCATTERED: f64 = 2.5e-3;
/// Points that are enough to compare starts with.
const ENOUGH: usize = 2048;

/// The least-squares circle: the circle with the smallest sum of squared distances of the points from it.
///
/// Newton's method from Taubin's algebraic circle, which unlike the centroid of eq. 30 is a good start for arcs too,
/// damped (Levenberg-Marquardt) where the plain step does not help. Centres beyond three times the extent of the points
/// are sought by direction and curvature, so that flat arcs are no harder than full circles. What is found is a minimum
/// to within rounding. For points near any circle or arc it is the global one. For scattered points (residuals beyond
/// some 5 % of their extent), which may have several minima, it is the best that 21 starts over the plane lead to.
///
/// Allocates nothing; some 72 points near a circle take a few microseconds. The radius is the mean distance from the
/// centre.
///
/// # Errors
/// [`CircleError`]; [`CircleError::Straight`] where the radius grows beyond all bounds.
pub fn least_squares(points: &[[f64; 2]]) -> Result<Fit, CircleError> {
    let mut moments = Moments::default();
    let spread = Spread::new(points, |p| moments.add(p))?;
    if !moments.is_wide() {
        spread.check(points)?;
    }
    let frame = Frame::of(&spread);
    let set = Set { points, frame: &frame, stride: 1 };
    let (centre, weight) = moments.centre(points.len() as f64, frame.unit);
    let mut best = set.minimum(Middle::from_homogeneous(centre, weight));
    if best.sum > SCATTERED * points.len() as f64 {
        let few = Set { stride: points.len().div_ceil(ENOUGH), ..set };
        let found = starts().map(|start| few.minimum(start));
        let promising = found.fold(few.minimum(best.middle), |a, b| if b.sum < a.sum { b } else { a });
        let polished = set.minimum(promising.middle);
        if polished.sum < best.sum {
            best = polished;
        }
    }
    match best.middle {
        Middle::Far([_, curvature]) if curvature.abs() < FLAT => Err(CircleError::Straight),
        middle => Ok(frame.fit(middle, points, Radius::Mean)),
    }
}

/// Centres over the plane: the middle, eight about it at two distances, and lines in four directions.
fn starts() -> impl Iterator<Item = Middle> {
    let around = |radius: f64, turn: u32| {
        let (sine, cosine) = libm::sincos(PI * f64::from(turn) / 4.0);
        Middle::Near([radius * cosine, radius * sine])
    };
    let rings = (0..8).flat_map(move |turn| [around(0.4, turn), around(1.0, turn)]);
    let lines = (0..4).map(|turn| Middle::Far([PI * f64::from(turn) / 4.0, 0.0]));
    std::iter::once(Middle::Near([0.0, 0.0])).chain(rings).chain(lines)
}

/// Points, or one in so many of them, and their local frame.
#[derive(Clone, Copy)]
struct Set<'a> {
    points: &'a [Point],
    frame: &'a Frame,
    stride: usize,
}

/// The sum of squared residuals at a centre, with half its derivatives by the chart coordinates. The radius is always
/// the best for the centre.
#[derive(Clone, Copy)]
struct State {
    middle: Middle,
    sum: f64,
    gradient: Point,
    /// Twice by the first coordinate, by both, twice by the second.
    hessian: [f64; 3],
    /// Mean reach.
    mean: f64,
}

impl Set<'_> {
    /// The minimum that a start leads to.
    fn minimum(&self, start: Middle) -> State {
        let mut state = self.state(start, 0.0);
        // Residuals are computed about the mean reach, which is known only now.
        state = self.state(start, state.mean);
        let mut damping = 0.0;
        for _ in 0..STEPS {
            let (step, is_newton) = state.step(damping);
            let length = libm::hypot(step[0], step[1]);
            let next = self.state(state.middle.moved(step), state.mean);
            let is_better = next.sum < state.sum * (1.0 - 1e-12);
            // The change that so short a step makes may be less than the rounding of the sums.
            let is_last = is_newton && length < LAST;
            let is_as_good = is_last || next.sum <= state.sum * (1.0 + 1e-12) + f64::MIN_POSITIVE;
            if is_better || (is_as_good && next.steepness() < state.steepness()) {
                let rechart = next.middle.recharted();
                state = if rechart == next.middle { next } else { self.state(rechart, 0.0) };
                damping = if damping > 1e-6 * state.stiffness() { 0.1 * damping } else { 0.0 };
                if is_last {
                    break;
                }
            } else if length < LAST {
                break;
            } else {
                damping = (10.0 * damping).max(1e-3 * state.stiffness());
            }
        }
        state
    }

    fn state(&self, middle: Middle, reference: f64) -> State {
        match middle {
            Middle::Near(coordinates) => self.sums::<Centre>(middle, coordinates, reference),
            Middle::Far(coordinates) => self.sums::<Far>(middle, coordinates, reference),
        }
    }

    fn sums<C: Chart>(&self, middle: Middle, coordinates: Point, reference: f64) -> State {
        let at = C::at(coordinates);
        let (mut count, mut e, mut ee) = (0.0, 0.0, 0.0);
        let ([mut g, mut eg], [mut gg, mut eh, mut h]) = ([[0.0; 2]; 2], [[0.0; 3]; 3]);
        for p in self.points.iter().step_by(self.stride) {
            let (reach, [gx, gy], second) = C::derivatives(&at, &self.frame.localised(*p));
            let residual = reach - reference;
            count += 1.0;
            e += residual;
            ee += residual * residual;
            g = [g[0] + gx, g[1] + gy];
            eg = [eg[0] + residual * gx, eg[1] + residual * gy];
            gg = [gg[0] + gx * gx, gg[1] + gx * gy, gg[2] + gy * gy];
            for k in 0..3 {
                eh[k] += residual * second[k];
                h[k] += second[k];
            }
        }
        let mean = e / count;
        let cross = [g[0] * g[0], g[0] * g[1], g[1] * g[1]].map(|product| product / count);
        State {
            middle,
            sum: (ee - mean * e).max(0.0),
            gradient: [eg[0] - mean * g[0], eg[1] - mean * g[1]],
            hessian: [0, 1, 2].map(|k| gg[k] - cross[k] + eh[k] - mean * h[k]),
            mean: reference + mean,
        }
    }
}

impl State {
    fn steepness(&self) -> f64 {
        libm::hypot(self.gradient[0], self.gradient[1])
    }

    fn stiffness(&self) -> f64 {
        self.hessian[0].abs() + self.hessian[2].abs() + 2.0 * self.hessian[1].abs() + f64::MIN_POSITIVE
    }

    /// The damped Newton step, at most one unit long, and whether it is an undamped one. Where the curvature is
    /// negative it is damped enough to go downhill.
    fn step(&self, damping: f64) -> (Point, bool) {
        let [xx, xy, yy] = self.hessian;
        let min = 0.5 * (xx + yy) - libm::hypot(0.5 * (xx - yy), xy);
        let floor = 1e-14 * self.stiffness();
        let damping = if min > floor { damping } else { damping.max(1e-3 * self.stiffness()) + floor - min };
        let (xx, yy) = (xx + damping, yy + damping);
        let determinant = xx * yy - xy * xy;
        let [gx, gy] = self.gradient;
        let step = [(xy * gy - yy * gx) / determinant, (xy * gx - xx * gy) / determinant];
        let length = libm::hypot(step[0], step[1]);
        if length > 1.0 { ([step[0] / length, step[1] / length], false) } else { (step, damping == 0.0) }
    }
}
