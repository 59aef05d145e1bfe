//! A problem in its setup, and in another.
//!
//! Everything that knows where the workpiece is goes through [`Problem::base_from_workpiece`], so that no computation
//! has to know of orientations and axes.

use super::{Placement, Problem};
use crate::setup::{AxisPath, AxisPositions, Orientation, Setup};
use nalgebra::Vector3;
use std::borrow::Cow;
use stead_model::external_axis::{AxisKind, Carried, ExternalAxis, carried, robot_from_workpiece};
use stead_model::robot::Pose;
use stead_model::robot::chain::GRAVITY;
use stead_numerics::scalar::Scalar;

impl Problem {
    /// The same problem with the part and the axes set up otherwise.
    pub fn in_setup(&self, setup: &Setup) -> Cow<'_, Self> {
        if *setup == self.setup {
            return Cow::Borrowed(self);
        }
        let mut problem = self.clone();
        let is_turned = setup.orientation != self.setup.orientation;
        if is_turned && let Some(orientation) = self.orientations.get(setup.orientation) {
            problem.parts.task = (*orientation.task).clone();
        }
        if is_turned || setup.leans != self.setup.leans {
            let task = problem.parts.task.upright();
            problem.parts.task = match &self.lean {
                Some(space) if !setup.leans.is_empty() => task.leaned(&space.rule, &setup.leans),
                _ => task.clone(),
            };
        }
        problem.parts.setup = setup.clone();
        Cow::Owned(problem)
    }

    /// Positions of the external axes at a path point. m or rad
    pub fn axis_positions(&self, point: usize) -> &[f64] {
        match &self.setup.positions {
            AxisPositions::Same(positions) => positions,
            AxisPositions::PerSegment(all) => all.get(self.task.path().segment_of(point)).map_or(&[], Vec::as_slice),
            AxisPositions::PerPoint(all) => all.get(point).map_or(&[], Vec::as_slice),
        }
    }

    /// Positions of the external axes a share of the way from one path point to another. m or rad
    pub fn positions_between(&self, points: [usize; 2], share: f64) -> Vec<f64> {
        let [start, end] = points.map(|point| self.axis_positions(point));
        start.iter().zip(end).map(|(start, end)| start + (end - start) * share).collect()
    }

    /// The external axes with their positions along the path.
    pub fn axis_paths(&self) -> Vec<AxisPath> {
        let path = |(number, axis): (usize, &ExternalAxis)| AxisPath {
            name: axis.name.clone(),
            kind: axis.kind,
            positions: (0..self.task.points().len()).map(|point| self.axis_positions(point)[number]).collect(),
        };
        self.external_axes.iter().enumerate().map(path).collect()
    }

    /// The frame that is placed, in the base frame, while path point `point` is machined: the workpiece frame of the
    /// [task](super::ProblemParts::task). Axes that carry the robot move it the other way. With a mounted robot the
    /// base frame is the cell frame ([`Robot::mounted`](stead_model::robot::Robot::mounted)).
    pub fn base_from_workpiece<T: Scalar>(&self, point: usize, placement: &Placement<T>) -> Pose<T> {
        if self.external_axes.is_empty() {
            return placement.base_from_workpiece();
        }
        self.base_from_workpiece_at(self.axis_positions(point), placement)
    }

    /// The same with the external axes at given positions. m or rad
    pub fn base_from_workpiece_at<T: Scalar>(&self, positions: &[f64], placement: &Placement<T>) -> Pose<T> {
        robot_from_workpiece(&self.external_axes, positions).cast().then(&placement.base_from_workpiece())
    }

    /// Acceleration of free fall in the base frame while path point `point` is machined: along -z of the cell, which
    /// turntables that carry the robot may have turned. m/s^2
    pub fn free_fall(&self, point: usize) -> Vector3<f64> {
        let down = Vector3::new(0.0, 0.0, -GRAVITY);
        if self.external_axes.iter().all(|axis| axis.carries == Carried::Workpiece) {
            return down;
        }
        carried(&self.external_axes, self.axis_positions(point), Carried::Robot).rotation.tr_mul(&down)
    }

    /// The part itself, as the task file and its meshes have it, in the base frame while path point `point` is
    /// machined.
    pub fn base_from_part(&self, point: usize, placement: &Placement) -> Pose<f64> {
        self.turned(self.base_from_workpiece(point, placement))
    }

    /// The part itself, where the frame that is placed is given: turned by its orientation.
    pub(crate) fn turned(&self, mut base_from_workpiece: Pose<f64>) -> Pose<f64> {
        if let Some(orientation) = self.orientation() {
            base_from_workpiece.rotation *= orientation.rotation;
        }
        base_from_workpiece
    }

    /// Which way up the part lies, where the run says several.
    pub fn orientation(&self) -> Option<&Orientation> {
        self.orientations.get(self.setup.orientation)
    }

    /// Whether any external axis moves between two neighbouring points of a segment.
    pub fn moves_axes_along_segments(&self) -> bool {
        match &self.setup.positions {
            AxisPositions::PerPoint(all) => self
                .task
                .segments()
                .iter()
                .any(|span| span.clone().skip(1).any(|point| all.get(point) != all.get(point - 1))),
            _ => false,
        }
    }

    /// Where the axes stand at the same place all along the path, and only shift the workpiece: the same problem
    /// without axes, in a cell that is shifted as far, and the shift; not where shapes would have to be shifted with
    /// it. m
    pub fn without_shifting_axes(&self) -> Option<(Self, [f64; 3])> {
        let AxisPositions::Same(positions) = &self.setup.positions else { return None };
        if self.external_axes.is_empty() || self.external_axes.iter().any(|axis| axis.kind != AxisKind::Rail) {
            return None;
        }
        let shift: [f64; 3] = robot_from_workpiece(&self.external_axes, positions).translation.into();
        if self.scene.is_some() && shift != [0.0; 3] {
            return None;
        }
        let mut problem = self.clone();
        problem.parts.external_axes.clear();
        problem.parts.setup.positions = AxisPositions::default();
        for (bounds, by) in problem.parts.cell.position.iter_mut().zip(shift) {
            bounds.min += by;
            bounds.max += by;
        }
        Some((problem, shift))
    }
}
