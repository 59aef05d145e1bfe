//! A path point with the workpiece placed: what all states of the arm there have in common.

use crate::criterion::ScoredDirections;
use crate::problem::{PlacedPoint, Placement, Problem};
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::Pose;
use stead_numerics::scalar::Scalar;

/// A path point with the workpiece at a placement. Its states are those of the [reference evaluator](super::reference).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointEvaluator<'a, T: Scalar = f64> {
    pub(super) problem: &'a Problem,
    pub(super) point: usize,
    pub(super) placed: PlacedPoint<T>,
    pub(super) directions: ScoredDirections<T>,
    /// In the base frame.
    pub(super) surface_normal: Option<Vector3<T>>,
    /// How the part yields, where it does, in the base frame. m/N
    pub(super) part: Option<Matrix3<T>>,
}

impl<'a, T: Scalar> PointEvaluator<'a, T> {
    pub(super) fn of(problem: &'a Problem, placement: &Placement<T>, point: usize) -> Self {
        let placed = problem.placed(point, placement);
        let directions = problem.scored_directions(point, &placed.scored_axes);
        let part = problem.task.part_compliance(point).map(|matrix| {
            let rotation = problem.base_from_workpiece(point, placement).rotation;
            rotation * matrix.map(T::constant) * rotation.transpose()
        });
        let surface_normal = problem.surface_normal(point, placement);
        Self { problem, point, placed, directions, surface_normal, part }
    }

    /// The problem of the point.
    pub fn problem(&self) -> &'a Problem {
        self.problem
    }

    /// The flange frame in the base frame at a free angle (rad):
    /// [`PlacedTask::base_from_flange`](super::placed_task::PlacedTask::base_from_flange).
    pub fn base_from_flange(&self, beta: T) -> Pose<T> {
        let PlacedPoint { tip, axes, .. } = self.placed;
        self.problem.flange_at(&Pose { rotation: axes, translation: tip }, beta)
    }
}
