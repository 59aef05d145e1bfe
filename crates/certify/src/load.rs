//! What acts on a path point and what of its deflection is scored; and the one lower bound that serves every criterion.
//!
//! With C the compliance at the tool centre point, W the scored directions (a row each, as long as the root of its
//! weight), f the force and r the size of its errors, the score is
//!
//! ```text
//! s(C) = max over |u| <= 1, |e| <= r of  u . W C (f + e)
//! ```
//!
//! (with a moment m the displacement `D m` beside that of the force, [`super::moment`]), a maximum of functions linear
//! in C and D, so convex. Any u and e of these lengths give a lower bound for every state,
//! `s(C) >= <C, S>` with S the symmetric part of `W^T u (f + e)^T`: a [`Tangent`]. It is sharp at a compliance where u
//! and e are the maximisers there, and need not be for the bound to hold. With one scored direction and no errors of
//! the force, u is +1 or -1 and S the same at every state.

use stead_problem::criterion::{Aggregate, Weights};
use stead_problem::problem::Problem;

/// What acts on a path point and what of its deflection is scored, in the frame of the load: axis 1 is its third axis,
/// and the first lies along the feed, or along the force where the score is the same in every direction of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Load {
    /// Scored directions, each as long as the root of its weight; zero beyond their number.
    pub directions: [[f64; 3]; 3],
    /// Force, times what a metre of the score counts. N
    pub force: [f64; 3],
    /// Moment, times the same. N m
    pub moment: [f64; 3],
    /// Largest error of the force, times the same. N
    pub error: f64,
    /// How the part yields, where it does: what it is moved by adds to every score.
    pub part: Option<Yielding>,
    /// The frame of the load against that of the feed, about axis 1. rad
    pub turn: f64,
}

/// What a point costs of its score: how bounds of points are put together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Objective {
    pub aggregate: Aggregate,
    /// Sum of the weights of the points.
    pub weight: f64,
}

impl Objective {
    pub fn of(problem: &Problem) -> Self {
        Self { aggregate: problem.criterion.aggregate, weight: problem.total_weight() }
    }

    /// What the costs of the points come to together where the figure that is minimised has a value (m).
    pub fn sum(&self, value: f64) -> f64 {
        match self.aggregate {
            Aggregate::Mean => value * self.weight,
            Aggregate::Rms => value * value * self.weight,
            Aggregate::Max => value,
        }
    }

    /// The figure that is minimised, where the costs of the points come to a sum. m
    pub fn value(&self, sum: f64) -> f64 {
        match self.aggregate {
            Aggregate::Mean => sum / self.weight,
            Aggregate::Rms => libm::sqrt(sum.max(0.0) / self.weight),
            Aggregate::Max => sum,
        }
    }

    /// What a force is multiplied by so that the score, or its square, counts as much as the weight of its point says.
    fn factor(&self, weight: f64) -> f64 {
        if self.aggregate == Aggregate::Rms { libm::sqrt(weight) } else { weight }
    }
}

/// Scored directions of the whole deflection.
const WHOLE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Rounds of the ascent to the worst error of the force.
const ROUNDS: usize = 3;
/// What keeps a unit vector from being longer than that by rounding.
const NO_LONGER: f64 = 1.0 - 1e-12;

impl Load {
    /// Of a path point, in the frame of its feed as seen along axis 1: that frame is given by the direction of the feed
    /// (rad) and by `side`, which is -1 where the arm hangs.
    pub fn new(problem: &Problem, point: usize, feed: f64, side: f64) -> Self {
        let mut load = Self::seen(problem, point, feed, side);
        let weights = &problem.criterion.weights;
        if weights.surface == 0.0 && weights.feed == weights.wall {
            load.turn_to_force();
        }
        load
    }

    /// The same in a frame whose first axis has this direction about axis 1 (rad), whatever is scored.
    pub fn seen(problem: &Problem, point: usize, feed: f64, side: f64) -> Self {
        let objective = Objective::of(problem);
        let (sine, cosine) = libm::sincos(feed);
        let seen = |v: &nalgebra::Vector3<f64>| {
            let (x, y) = (v.x, v.y * side);
            [x * cosine + y * sine, y * cosine - x * sine, v.z * side]
        };
        let axes = problem.task.points()[point].workpiece_from_point();
        let scored = problem.scored_directions(point, &axes);
        let mut directions = [[0.0; 3]; 3];
        for (direction, vector) in directions.iter_mut().zip(scored.vectors()) {
            *direction = seen(vector);
        }
        // Of the whole deflection the length counts, in whatever frame.
        if problem.criterion.weights == Weights::TOTAL {
            directions = WHOLE;
        }
        let factor = objective.factor(problem.point_weight(point));
        let force = &problem.task.loads()[point].wrench.force;
        let error = problem.criterion.force_uncertainty * force.norm() * factor;
        let moment = seen(&problem.task.loads()[point].wrench.moment).map(|m| m * factor);
        let part = problem.task.part_compliance(point).map(|matrix| {
            let column = |k: usize| {
                // Columns of the frame in the workpiece frame, seen back.
                let axis = [[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]][k];
                seen(&(matrix * nalgebra::Vector3::new(axis[0], axis[1] * side, axis[2] * side)))
            };
            Yielding::of([column(0), column(1), column(2)])
        });
        let force_seen = seen(force).map(|f| f * factor);
        Self { directions, force: force_seen, moment, error, part, turn: 0.0 }
    }

    /// The same score with force and scored directions the other way, where these point down their first coordinate: so
    /// that passes there and back are alike. Without a moment the sign of neither counts.
    pub fn signed(mut self) -> Self {
        let is_down = |v: &[f64; 3]| v.iter().find(|x| x.abs() > 1e-12).is_some_and(|x| *x < 0.0);
        let scale = norm(self.force).max(f64::MIN_POSITIVE);
        if !self.has_moment() && is_down(&self.force.map(|x| x / scale)) {
            self.force = self.force.map(|x| -x);
        }
        if !self.has_moment() {
            self.directions.iter_mut().filter(|v| is_down(v)).for_each(|v| *v = v.map(|x| -x));
        }
        self
    }

    /// Turns the frame so that no force acts along its second axis: where the parts of a deflection in the plane count
    /// alike, loads that differ by such a turn are one.
    fn turn_to_force(&mut self) {
        let [x, y, _] = self.force;
        self.turn = libm::atan2(y, x);
        (self.force[0], self.force[1]) = (libm::hypot(x, y), 0.0);
        let ((sine, cosine), [mx, my, _]) = (libm::sincos(self.turn), self.moment);
        (self.moment[0], self.moment[1]) = (mx * cosine + my * sine, my * cosine - mx * sine);
        self.part = self.part.map(|part| part.turned(self.turn));
        // A turn of deflections that count alike leaves their norm as it is.
    }

    /// Whether the point counts for nothing.
    pub fn is_zero(&self) -> bool {
        self.force == [0.0; 3] && !self.has_moment()
    }

    /// A compliance with that of the part.
    #[inline(always)]
    pub fn with_part(&self, at: Yielding) -> Yielding {
        self.part.map_or(at, |part| at.plus(&part))
    }

    /// What the part adds to a tangent.
    #[inline(always)]
    pub fn of_part(&self, tangent: &Tangent) -> f64 {
        self.part.map_or(0.0, |part| tangent.of(&part))
    }

    /// Whether a moment acts.
    pub fn has_moment(&self) -> bool {
        self.moment != [0.0; 3]
    }

    /// Whether one direction is scored, without errors of the force: the score is the absolute value of a linear
    /// function of the compliance.
    pub fn is_linear(&self) -> bool {
        self.error == 0.0 && self.is_single()
    }

    /// Whether one direction is scored.
    pub fn is_single(&self) -> bool {
        self.directions[1..].iter().all(|direction| *direction == [0.0; 3])
    }

    /// Whether entries of the compliance between the vertical and the plan count, and that along the vertical.
    pub fn vertical_parts(&self) -> [bool; 2] {
        let scored = self.directions.iter().any(|direction| direction[2] != 0.0);
        let forced = self.force[2] != 0.0 || self.error > 0.0;
        [scored || forced, scored && forced]
    }

    /// The tangent of one scored direction without errors of the force, with u = 1.
    pub fn of_first(&self) -> Tangent {
        Tangent::new(self.directions[0], self.force)
    }

    /// The tangents at a compliance, that of the part included: one that is sharp there, and where one direction is
    /// scored another one, sharp where the deflection without an error vanishes, of what errors of the force alone can
    /// do.
    ///
    /// `by_moment` is the displacement there under the moment, in the frame of the load (m).
    pub fn tangents(&self, at: &Yielding, by_moment: [f64; 3]) -> (Tangent, Option<Tangent>) {
        let moved = added(at.times(self.force), by_moment);
        if self.is_single() {
            let direction = self.directions[0];
            let response = at.times(direction);
            let sign = if dot(direction, moved) < 0.0 { -1.0 } else { 1.0 };
            let sharp = self.error_along(response);
            // The mean of that with u and that with -u: a moment adds nothing to it.
            let of_error = Tangent { along: [0.0; 3], ..Tangent::new(direction, sharp) };
            return (Tangent::new(direction.map(|x| sign * x), self.force).plus(&of_error), Some(of_error));
        }
        if self.error == 0.0 {
            return (Tangent::new(self.along(moved), self.force), None);
        }
        // Where the force acts along an axis of the compliance an ascent would stay on it: the error along the softest
        // axis is what makes the score largest.
        let aside = at.softest();
        let response = at.times(self.parts_back(moved));
        let sign = if dot(response, aside) < 0.0 { -norm(response) } else { norm(response) };
        let under = |error: [f64; 3]| {
            let force = added(self.force, self.error_along(error));
            (force, added(at.times(force), by_moment))
        };
        let (mut force, mut moved) = under(std::array::from_fn(|k| response[k] + sign * aside[k]));
        for _ in 1..ROUNDS {
            (force, moved) = under(at.times(self.parts_back(moved)));
        }
        (Tangent::new(self.along(moved), force), None)
    }

    /// A tangent that is nearly sharp there, in a fraction of the time: u along the deflection without an error, and
    /// the error that adds most to that.
    #[inline(always)]
    pub fn near_tangent(&self, at: &Yielding, by_moment: [f64; 3]) -> Tangent {
        let along = self.along(added(at.times(self.force), by_moment));
        Tangent::new(along, added(self.force, self.error_along(at.times(along))))
    }

    /// The largest error of the force in a direction.
    #[inline(always)]
    fn error_along(&self, direction: [f64; 3]) -> [f64; 3] {
        scaled(direction, self.error * NO_LONGER / norm(direction).max(f64::MIN_POSITIVE))
    }

    /// W^T W times a deflection.
    #[inline(always)]
    fn parts_back(&self, moved: [f64; 3]) -> [f64; 3] {
        if self.directions == WHOLE {
            return moved;
        }
        let parts = self.directions.map(|direction| dot(direction, moved));
        std::array::from_fn(|k| (0..3).map(|row| self.directions[row][k] * parts[row]).sum::<f64>())
    }

    /// By how much a displacement counts in the score, at most.
    pub fn most_scored(&self) -> f64 {
        let row = |of: &[f64; 3]| self.directions.iter().map(|other| dot(*of, *other).abs()).sum::<f64>();
        libm::sqrt(self.directions.iter().map(row).fold(0.0, f64::max))
    }

    /// W^T u with u along the parts of a deflection.
    #[inline]
    fn along(&self, moved: [f64; 3]) -> [f64; 3] {
        let parts = if self.directions == WHOLE { moved } else { self.directions.map(|row| dot(row, moved)) };
        scaled(self.parts_back(moved), NO_LONGER / norm(parts).max(f64::MIN_POSITIVE))
    }

    /// The score under a compliance, that of the part included, by the ascent of [`Self::tangents`]: what the first
    /// tangent says there.
    #[cfg(test)]
    pub fn score(&self, at: &Yielding, by_moment: [f64; 3]) -> f64 {
        self.tangents(at, by_moment).0.with(at, by_moment)
    }
}

/// The compliance at a point, symmetric, in the frame of a load: [[m + d0, d1, v0], [d1, m - d0, v1], [v0, v1, zz]].
/// m/N
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Yielding {
    pub m: f64,
    pub d: [f64; 2],
    pub v: [f64; 2],
    pub zz: f64,
}

/// A symmetric matrix S in the frame of a load: the score of a state is at least `<C, S>`. N
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tangent {
    /// S11 + S22.
    pub plane: f64,
    /// S11 - S22 and 2 S12.
    pub turning: [f64; 2],
    /// 2 S13 and 2 S23.
    pub vertical: [f64; 2],
    /// S33.
    pub axial: f64,
    /// W^T u, by which the displacement under a moment counts.
    pub along: [f64; 3],
}

impl Yielding {
    /// Of a symmetric matrix.
    pub fn of(matrix: [[f64; 3]; 3]) -> Self {
        let [x, y, z] = matrix;
        let v = [0.5 * (x[2] + z[0]), 0.5 * (y[2] + z[1])];
        Self { m: 0.5 * (x[0] + y[1]), d: [0.5 * (x[0] - y[1]), 0.5 * (x[1] + y[0])], v, zz: z[2] }
    }

    /// In a frame turned by an angle about axis 1. rad
    pub fn turned(&self, angle: f64) -> Self {
        let ((s, c), (s2, c2)) = (libm::sincos(angle), libm::sincos(2.0 * angle));
        let ([d0, d1], [v0, v1]) = (self.d, self.v);
        Self { d: [d0 * c2 + d1 * s2, d1 * c2 - d0 * s2], v: [v0 * c + v1 * s, v1 * c - v0 * s], ..*self }
    }

    /// A unit vector near to the direction in which it yields most.
    pub fn softest(&self) -> [f64; 3] {
        let Self { m, d, v, zz } = self;
        let columns = [[m + d[0], d[1], v[0]], [d[1], m - d[0], v[1]], [v[0], v[1], *zz]];
        let longest = columns.into_iter().fold(columns[0], |a, b| if dot(b, b) > dot(a, a) { b } else { a });
        let size = 1.0 / norm(longest).max(f64::MIN_POSITIVE);
        let next = self.times(self.times(scaled(longest, size)));
        scaled(next, 1.0 / norm(next).max(f64::MIN_POSITIVE))
    }

    /// The root of the sum of the squares of its entries, which its norm does not exceed. m/N
    pub fn size(&self) -> f64 {
        let Self { m, d, v, zz } = self;
        let square = 2.0 * (m * m + d[0] * d[0] + d[1] * d[1] + v[0] * v[0] + v[1] * v[1]) + zz * zz;
        libm::sqrt(square)
    }

    /// How far another one is from it. m/N
    pub fn apart(&self, o: &Self) -> f64 {
        let off = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
        Self { m: self.m - o.m, d: off(self.d, o.d), v: off(self.v, o.v), zz: self.zz - o.zz }.size()
    }

    /// The sum of two.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self { m: self.m + other.m, d: sum(self.d, other.d), v: sum(self.v, other.v), zz: self.zz + other.zz }
    }

    /// The displacement under a force.
    #[inline(always)]
    pub fn times(&self, force: [f64; 3]) -> [f64; 3] {
        let (Self { m, d, v, zz }, [x, y, z]) = (self, force);
        [(m + d[0]) * x + d[1] * y + v[0] * z, d[1] * x + (m - d[0]) * y + v[1] * z, v[0] * x + v[1] * y + zz * z]
    }
}

impl Tangent {
    /// Of `W^T u` and `f + e`.
    #[inline(always)]
    pub fn new(a: [f64; 3], g: [f64; 3]) -> Self {
        Self {
            plane: a[0] * g[0] + a[1] * g[1],
            turning: [a[0] * g[0] - a[1] * g[1], a[0] * g[1] + a[1] * g[0]],
            vertical: [a[0] * g[2] + a[2] * g[0], a[1] * g[2] + a[2] * g[1]],
            axial: a[2] * g[2],
            along: a,
        }
    }

    pub fn plus(&self, other: &Self) -> Self {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self {
            plane: self.plane + other.plane,
            turning: sum(self.turning, other.turning),
            vertical: sum(self.vertical, other.vertical),
            axial: self.axial + other.axial,
            along: added(self.along, other.along),
        }
    }

    /// The same by a factor.
    #[inline(always)]
    pub fn times(&self, factor: f64) -> Self {
        let by = |pair: [f64; 2]| pair.map(|x| x * factor);
        Self {
            plane: self.plane * factor,
            turning: by(self.turning),
            vertical: by(self.vertical),
            axial: self.axial * factor,
            along: self.along.map(|x| x * factor),
        }
    }

    /// `<C, S>`, and what the displacement under a moment adds.
    #[inline(always)]
    pub fn with(&self, c: &Yielding, by_moment: [f64; 3]) -> f64 {
        self.of(c) + dot(self.along, by_moment)
    }

    /// `<C, S>`.
    #[inline(always)]
    pub fn of(&self, c: &Yielding) -> f64 {
        c.m * self.plane
            + c.d[0] * self.turning[0]
            + c.d[1] * self.turning[1]
            + c.v[0] * self.vertical[0]
            + c.v[1] * self.vertical[1]
            + c.zz * self.axial
    }
}

#[inline(always)]
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[inline(always)]
pub(super) fn added(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn scaled(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| x * factor)
}
