//! The task with the workpiece at a placement: what travels through planning.

use super::point_evaluator::PointEvaluator;
use super::reference::State;
use crate::problem::{PlacedPoint, Placement, Problem};
use stead_model::robot::{Pose, Posture, Unreachable};
use stead_numerics::scalar::Scalar;

/// The task of a problem with the workpiece at a placement: [`Problem::at`].
#[derive(Debug, Clone, Copy)]
pub struct PlacedTask<'a, T: Scalar = f64> {
    /// The problem.
    pub problem: &'a Problem,
    /// Where the workpiece stands.
    pub placement: &'a Placement<T>,
}

impl Problem {
    /// The task with the workpiece at a placement.
    pub fn at<'a, T: Scalar>(&'a self, placement: &'a Placement<T>) -> PlacedTask<'a, T> {
        PlacedTask { problem: self, placement }
    }
}

impl<'a, T: Scalar> PlacedTask<'a, T> {
    /// Path point `point` (from 0) and its wrench in the robot base frame.
    pub fn point(self, point: usize) -> PlacedPoint<T> {
        self.problem.placed(point, self.placement)
    }

    /// The frame that is placed, in the base frame, while path point `point` is machined:
    /// [`Problem::base_from_workpiece`].
    pub fn base_from_workpiece(self, point: usize) -> Pose<T> {
        self.problem.base_from_workpiece(point, self.placement)
    }

    /// The flange frame in the base frame at path point `point` and a free angle (rad), Caro 2013, eq. 7 with eq. 8
    /// to 10.
    pub fn base_from_flange(self, point: usize, beta: T) -> Pose<T> {
        self.problem.flange_at(&self.problem.base_from_point(point, self.placement), beta)
    }

    /// Path point `point` to be evaluated at several free angles.
    pub fn evaluator(self, point: usize) -> PointEvaluator<'a, T> {
        PointEvaluator::of(self.problem, self.placement, point)
    }

    /// The state of the arm at path point `point`, a free angle (rad) and in a posture. Joint limits are not checked.
    ///
    /// # Errors
    /// [`Unreachable`] when the posture cannot reach the point.
    pub fn state(self, point: usize, beta: T, posture: Posture) -> Result<State<T>, Unreachable> {
        self.evaluator(point).state(beta, posture)
    }
}
