//! How far beta may change between neighbouring path points: by its own rate, and by how fast the spindle may turn in
//! space.
//!
//! The tool frames at neighbouring points are `R_1 Rz(beta_1) D` and `R_2 Rz(beta_2) D`, R being the axes of the points
//! and D half a turn about the feed. With `P = R_1^T R_2` the angle theta between them depends on `d = beta_2 - beta_1`
//! alone:
//!
//! ```text
//! 1 + 2 cos(theta) = P_33 + (P_11 + P_22) cos(d) + (P_12 - P_21) sin(d)
//! cos(theta / 2) = cos(tau / 2) cos((d - m) / 2)      m = atan2(P_12 - P_21, P_11 + P_22)
//! ```
//!
//! Where a turntable turns the part along the path, R_2 is turned with it: the frames are those in the cell.
//!
//! Here tau is the angle between the two tool axes. So a limit on theta is an interval of d about m, the change with
//! which the spindle turns no more than its axis has to: for a tool with a constant axis, the turn of the feed in the
//! opposite sense.

use crate::constraints::STEP_ROUNDING;
use crate::limit::Limit;
use crate::problem::{BetaPlan, Problem, Redundancy};
use crate::setup::AxisPositions;
use nalgebra::Matrix3;
use std::f64::consts::PI;
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis, carried};
use stead_model::robot::angles::wrap;

/// The largest turn of the spindle between neighbouring points of the whole path, where its axis turns by less: with a
/// larger one a controller, which turns the tool the short way, can lead a joint of the wrist to an angle a turn away
/// from that of the plan. rad
const MAX_TURN: f64 = PI / 2.0;
/// How far the spindle may turn beyond what its axis has to. rad
const BEYOND_AXIS: f64 = PI / 6.0;

/// A direction may be this far from vertical (its sine) to be taken as vertical: printed digits.
const VERTICAL: f64 = 1e-9;

/// The changes of beta that are allowed from one path point to the next, modulo a turn: those within `half` of
/// `middle`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetaStep {
    /// The middle, zero where the rate of beta alone decides. rad
    pub middle: f64,
    /// Half the width; infinite where every change is allowed, below zero where none is. rad
    pub half: f64,
}

impl BetaStep {
    /// Every change.
    pub const ANY: Self = Self { middle: 0.0, half: f64::INFINITY };

    /// By how much a change is off the middle, within half a turn. rad
    pub fn off_middle(&self, change: f64) -> f64 {
        wrap(change - self.middle)
    }

    /// Whether a change (rad) is allowed, up to rounding.
    #[inline]
    pub fn allows(&self, change: f64) -> bool {
        let half = self.half + STEP_ROUNDING;
        (change - self.middle).abs() <= half || self.off_middle(change).abs() <= half
    }
}

/// How the point's axes and beta turn the tool from one path point to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    /// Angle tau between the tool axes. rad
    tilt: f64,
    /// The change of beta with which the tool turns by tau only. rad
    middle: f64,
}

impl Turn {
    /// Between points with these axes (feed, left of the feed, tool axis) as columns.
    fn between(from: &Matrix3<f64>, to: &Matrix3<f64>) -> Self {
        let p = from.tr_mul(to);
        let (a, b) = (from.column(2), to.column(2));
        Self {
            tilt: libm::atan2(a.cross(&b).norm(), a.dot(&b)),
            middle: libm::atan2(p[(0, 1)] - p[(1, 0)], p[(0, 0)] + p[(1, 1)]),
        }
    }

    /// Half the width of the changes of beta for which the tool turns by at most `limit` (rad): below zero where there
    /// are none.
    fn half(&self, limit: f64) -> f64 {
        if limit >= PI {
            return f64::INFINITY;
        }
        let (sine, cosine) = libm::sincos(self.tilt / 2.0);
        let room = libm::sin(limit / 2.0);
        if self.tilt > limit + STEP_ROUNDING {
            return -1.0;
        }
        let square = ((room - sine) * (room + sine)).max(0.0);
        2.0 * libm::asin((square.sqrt() / cosine).min(1.0))
    }
}

impl Problem {
    /// How the tool turns from axes (feed, left of the feed, tool axis; as columns) to others while the part turns in
    /// the cell by a rotation, in the frame that is placed.
    fn turn_between(axes: [&Matrix3<f64>; 2], part: Option<&Matrix3<f64>>) -> Turn {
        match part {
            Some(part) => Turn::between(axes[0], &(part * axes[1])),
            None => Turn::between(axes[0], axes[1]),
        }
    }

    fn turn(&self, point: usize) -> Turn {
        self.turn_with(point, self.part_turn(point).as_ref())
    }

    /// The same where the part itself turns in the cell by a rotation, in the frame that is placed.
    fn turn_with(&self, point: usize, part: Option<&Matrix3<f64>>) -> Turn {
        let [from, to] = [point - 1, point].map(|point| self.task.points()[point].workpiece_from_point());
        Self::turn_between([&from, &to], part)
    }

    /// How external axes turn the part in the cell on the way to a path point from the one before, in the frame that is
    /// placed; none where they do not. They turn it about the vertical, as the placement does
    /// ([`Self::turns_part_otherwise`]).
    fn part_turn(&self, point: usize) -> Option<Matrix3<f64>> {
        let AxisPositions::PerPoint(all) = &self.setup.positions else { return None };
        self.part_turn_between(all.get(point - 1)?, all.get(point)?)
    }

    /// The same from some positions of the axes to others (m or rad).
    pub fn part_turn_between(&self, from: &[f64], to: &[f64]) -> Option<Matrix3<f64>> {
        let turns = |axis: &ExternalAxis| axis.kind == AxisKind::Turntable && axis.carries == Carried::Workpiece;
        if from == to || !self.external_axes.iter().any(turns) {
            return None;
        }
        let [from, to] = [from, to].map(|at| carried(&self.external_axes, at, Carried::Workpiece).rotation);
        Some(from.tr_mul(&to))
    }

    /// Whether an external axis that moves along the path can turn the part about another direction than the vertical,
    /// so that how the spindle turns in the cell would depend on the yaw of the placement.
    pub fn turns_part_otherwise(&self) -> bool {
        let of_part = self.external_axes.iter().filter(|axis| axis.carries == Carried::Workpiece);
        let turntables = of_part.filter(|axis| axis.kind == AxisKind::Turntable);
        let moving = turntables.skip_while(|axis| axis.axis_use != AxisUse::Continuous);
        moving.into_iter().any(|axis| libm::hypot(axis.direction.x, axis.direction.y) > VERTICAL)
    }

    /// The largest angle between the tool frames at path points `point - 1` and `point`, where one is set; not more
    /// than a quarter turn, or somewhat more than the tool axis turns, which is all that bounds a turn in place: that
    /// has neither length nor feed. rad
    pub fn spindle_turn_limit(&self, point: usize) -> Option<f64> {
        self.turn_limit(point, &self.redundancy)
    }

    fn turn_limit(&self, point: usize, limits: &Redundancy) -> Option<f64> {
        self.turn_limit_of(point, limits, || self.turn(point))
    }

    fn turn_limit_of(&self, point: usize, limits: &Redundancy, turn: impl Fn() -> Turn) -> Option<f64> {
        let is_set = limits.max_spindle_turn.is_some() || limits.max_spindle_speed.is_some();
        let most = || MAX_TURN.max(turn().tilt + BEYOND_AXIS);
        if self.task.path().turns_in_place(point) {
            return is_set.then(most);
        }
        let by_length = limits.max_spindle_turn.map(|limit| limit * self.step_length(point));
        let by_time = limits.max_spindle_speed.map(|limit| limit * self.step_time(point));
        let limit = by_length.into_iter().chain(by_time).reduce(f64::min)?;
        Some(if self.task.path().is_thinned() || limit <= MAX_TURN { limit } else { limit.min(most()) })
    }

    /// The angle between the tool frames at path points `point - 1` and `point` when beta changes by `change` (rad).
    /// rad
    pub fn spindle_turn(&self, point: usize, change: f64) -> f64 {
        let turn = self.turn(point);
        let (sine, cosine) = libm::sincos((change - turn.middle) / 2.0);
        let (tilt_sine, tilt_cosine) = libm::sincos(turn.tilt / 2.0);
        2.0 * libm::atan2(libm::hypot(tilt_sine, tilt_cosine * sine), (tilt_cosine * cosine).abs())
    }

    /// The change of beta from path point `point - 1` to `point` with which the spindle turns least in space. rad
    pub fn still_change(&self, point: usize) -> f64 {
        self.turn(point).middle
    }

    /// The angle between the tool axes at path points `point - 1` and `point`: no beta turns the spindle by less. rad
    pub fn axis_turn(&self, point: usize) -> f64 {
        self.turn(point).tilt
    }

    /// The allowed changes of beta from path point `point - 1` to `point`: within the rate of beta and the turn of the
    /// spindle.
    ///
    /// Where both together leave two intervals, as they can where the feed all but reverses, the wider one is taken.
    pub fn beta_step(&self, point: usize) -> BetaStep {
        self.beta_step_within(point, &self.redundancy)
    }

    /// The same with the limits of another planning. Where beta stays, it may change by nothing, if that is within its
    /// limits.
    pub fn beta_step_within(&self, point: usize, limits: &Redundancy) -> BetaStep {
        self.beta_step_with(point, limits, self.part_turn(point).as_ref())
    }

    /// The same where the part itself turns in the cell by a rotation, in the frame that is placed.
    pub fn beta_step_with(&self, point: usize, limits: &Redundancy, part: Option<&Matrix3<f64>>) -> BetaStep {
        self.beta_step_of(point, limits, || self.turn_with(point, part))
    }

    /// The same where the tool leans otherwise at both points, too: with axes (feed, left of the feed, tool axis) as
    /// columns in place of those of the points.
    pub fn beta_step_between(
        &self,
        point: usize,
        limits: &Redundancy,
        axes: [&Matrix3<f64>; 2],
        part: Option<&Matrix3<f64>>,
    ) -> BetaStep {
        self.beta_step_of(point, limits, || Self::turn_between(axes, part))
    }

    fn beta_step_of(&self, point: usize, limits: &Redundancy, turn: impl Fn() -> Turn) -> BetaStep {
        let free = self.free_beta_step(point, limits, turn);
        match limits.beta {
            BetaPlan::Free => free,
            BetaPlan::ConstantPerSegment | BetaPlan::Constant => {
                BetaStep { middle: 0.0, half: if free.half >= 0.0 && free.allows(0.0) { 0.0 } else { -1.0 } }
            }
        }
    }

    /// The same where beta may change.
    fn free_beta_step(&self, point: usize, limits: &Redundancy, turn: impl Fn() -> Turn) -> BetaStep {
        let rate = limits.max_beta_rate.map_or(f64::INFINITY, |rate| rate * self.step_length(point));
        let by_rate = BetaStep { middle: 0.0, half: rate };
        let Some(limit) = self.turn_limit_of(point, limits, &turn) else { return by_rate };
        let turn = turn();
        let half = turn.half(limit);
        if half >= PI {
            return by_rate;
        }
        if rate >= PI || half < 0.0 {
            return BetaStep { middle: turn.middle, half };
        }
        let common = |middle: f64| {
            let (min, max) = (f64::max(-rate, middle - half), f64::min(rate, middle + half));
            BetaStep { middle: (min + max) / 2.0, half: (max - min) / 2.0 }
        };
        let wider = |a: BetaStep, b: BetaStep| if b.half > a.half { b } else { a };
        [-2.0 * PI, 2.0 * PI].map(|turned| common(turn.middle + turned)).into_iter().fold(common(turn.middle), wider)
    }

    /// Which limit is behind the lower and the upper end of the allowed changes at a path point.
    pub fn beta_step_ends(&self, point: usize, step: &BetaStep) -> [Limit; 2] {
        let rate = self.redundancy.max_beta_rate.map(|rate| rate * self.step_length(point));
        let is_by_rate = |end: f64| rate.is_some_and(|rate| (end.abs() - rate).abs() <= STEP_ROUNDING);
        [step.middle - step.half, step.middle + step.half].map(|end| match self.spindle_turn_limit(point) {
            Some(_) if !is_by_rate(end) => Limit::SpindleTurn,
            _ => Limit::BetaRate,
        })
    }
}

#[cfg(test)]
mod tests;
