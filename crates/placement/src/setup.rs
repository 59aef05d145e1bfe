//! How the cell is set up for a placement: which way up the part lies, and where the external axes stand along the path.
//!
//! A [`Problem`] is always in one setup; [`Problem::in_setup`] is the same problem in another. Everything that knows where the workpiece
//! is goes through [`Problem::base_from_workpiece`], so that no computation has to know of orientations and axes.

use super::problem::{Placement, Problem};
use nalgebra::Matrix3;
use std::borrow::Cow;
use std::sync::Arc;
use stead_model::external_axis::{AxisKind, Carried, ExternalAxis, carried, robot_from_workpiece};
use stead_model::robot::Pose;
use stead_model::task::Task;
use stead_numerics::scalar::Scalar;

/// A way in which the part may lie: turned before it is placed.
#[derive(Debug, Clone, PartialEq)]
pub struct Orientation {
    /// Its name, unique among those of a problem.
    pub name: String,
    /// Rotation from the workpiece frame of the task file to the frame that is placed.
    pub rotation: Matrix3<f64>,
    /// The task of the file, turned by it.
    pub task: Arc<Task>,
}

/// Positions of the external axes along the path, in their order. m or rad
#[derive(Debug, Clone, PartialEq)]
pub enum AxisPositions {
    /// The same at every point.
    Same(Vec<f64>),
    /// For each segment.
    PerSegment(Vec<Vec<f64>>),
    /// For each path point.
    PerPoint(Vec<Vec<f64>>),
}

impl Default for AxisPositions {
    /// Of no axis.
    fn default() -> Self {
        Self::Same(Vec::new())
    }
}

/// How the cell is set up.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Setup {
    /// Which orientation of the part, from 0, where there are several.
    pub orientation: usize,
    /// Where the external axes stand.
    pub positions: AxisPositions,
}

/// The positions of an external axis along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisPath {
    /// The name of the axis.
    pub name: String,
    /// How it moves.
    pub kind: AxisKind,
    /// Its position at each path point. m or rad
    pub positions: Vec<f64>,
}

/// A setup that was searched.
#[derive(Debug, Clone, PartialEq)]
pub struct TriedSetup {
    /// The setup.
    pub setup: Setup,
    /// The objectives of the best and of the worst placement in it ([`Problem::objective`]); `None` where none is feasible. m
    pub objectives: Option<[f64; 2]>,
}

impl Setup {
    /// The first orientation, and all axes as near to zero as their ranges allow.
    pub fn at_rest(axes: &[ExternalAxis]) -> Self {
        let positions = axes.iter().map(ExternalAxis::nearest_to_zero).collect();
        Self { orientation: 0, positions: AxisPositions::Same(positions) }
    }
}

impl Problem {
    /// The same problem with the part and the axes set up otherwise.
    pub fn in_setup(&self, setup: &Setup) -> Cow<'_, Self> {
        if *setup == self.setup {
            return Cow::Borrowed(self);
        }
        let mut problem = self.clone();
        if setup.orientation != self.setup.orientation
            && let Some(orientation) = self.orientations.get(setup.orientation)
        {
            problem.task = (*orientation.task).clone();
        }
        problem.setup = setup.clone();
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

    /// The external axes with their positions along the path.
    pub fn axis_paths(&self) -> Vec<AxisPath> {
        let path = |(number, axis): (usize, &ExternalAxis)| AxisPath {
            name: axis.name.clone(),
            kind: axis.kind,
            positions: (0..self.task.points().len()).map(|point| self.axis_positions(point)[number]).collect(),
        };
        self.external_axes.iter().enumerate().map(path).collect()
    }

    /// The frame that is placed, in the base frame, while path point `point` is machined: the workpiece frame of [`Problem::task`]. Axes
    /// that carry the robot move it the other way. With a mounted robot the base frame is the cell frame
    /// ([`Robot::mounted`](stead_model::robot::Robot::mounted)).
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

    /// The part itself, as the task file and its meshes have it, in the base frame while path point `point` is machined.
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

    /// Where the external axes have brought the robot at a path point: the frame that rides with it, in which everything is stated, in the cell.
    /// The identity where no axis carries the robot.
    pub fn cell_from_carriage(&self, point: usize) -> Pose<f64> {
        carried(&self.external_axes, self.axis_positions(point), Carried::Robot)
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

    /// Where the axes stand at the same place all along the path, and only shift the workpiece: the same problem without axes, in a cell that is
    /// shifted as far, and the shift. m
    pub(crate) fn without_shifting_axes(&self) -> Option<(Self, [f64; 3])> {
        let AxisPositions::Same(positions) = &self.setup.positions else { return None };
        if self.external_axes.is_empty() || self.external_axes.iter().any(|axis| axis.kind != AxisKind::Rail) {
            return None;
        }
        let shift: [f64; 3] = robot_from_workpiece(&self.external_axes, positions).translation.into();
        let mut problem = self.clone();
        problem.external_axes.clear();
        problem.setup.positions = AxisPositions::default();
        for (bounds, by) in problem.cell.position.iter_mut().zip(shift) {
            bounds.min += by;
            bounds.max += by;
        }
        Some((problem, shift))
    }
}

impl AxisPositions {
    /// Those of some points of a path, ascending.
    pub(crate) fn of_points(&self, points: &[usize]) -> Self {
        match self {
            Self::PerPoint(all) => {
                Self::PerPoint(points.iter().map(|point| all.get(*point).cloned().unwrap_or_default()).collect())
            }
            other => other.clone(),
        }
    }

    /// The shortest way to state the positions at every point of a task.
    pub(crate) fn shortest(rows: Vec<Vec<f64>>, task: &Task) -> Self {
        let is_one = |rows: &[Vec<f64>]| rows.windows(2).all(|pair| pair[0] == pair[1]);
        if is_one(&rows) {
            return Self::Same(rows.into_iter().next().unwrap_or_default());
        }
        if task.segments().iter().all(|span| is_one(&rows[span.clone()])) {
            return Self::PerSegment(task.segments().iter().map(|span| rows[span.start].clone()).collect());
        }
        Self::PerPoint(rows)
    }

    /// At every point of a task.
    pub(crate) fn spread(&self, task: &Task) -> Vec<Vec<f64>> {
        let count = task.points().len();
        match self {
            Self::Same(positions) => vec![positions.clone(); count],
            Self::PerSegment(all) => {
                let of = |point| all.get(task.path().segment_of(point)).cloned().unwrap_or_default();
                (0..count).map(of).collect()
            }
            Self::PerPoint(all) => all.clone(),
        }
    }
}

#[cfg(test)]
mod tests;
