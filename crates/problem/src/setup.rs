//! How the cell is set up for a placement: which way up the part lies, and where the external axes stand along the
//! path, and how the tool leans.
//!
//! A [`Problem`](crate::problem::Problem) is always in one setup, and
//! [`Problem::base_from_workpiece`](crate::problem::Problem::base_from_workpiece) is the one way to where the workpiece
//! is in it.

use nalgebra::Matrix3;
use std::sync::Arc;
use stead_model::external_axis::{AxisKind, ExternalAxis};
use stead_model::task::Task;
use stead_model::task::lean::Lean;

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
    /// How the tool leans at every path point; empty where its axis is that of the path.
    pub leans: Arc<[Lean]>,
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
    /// The objectives of the best and, where it was looked for, of the worst placement in it
    /// ([`Problem::objective`](crate::problem::Problem::objective)); `None` where none is feasible. m
    pub objectives: Option<(f64, Option<f64>)>,
}

impl Setup {
    /// The first orientation, and all axes as near to zero as their ranges allow.
    pub fn at_rest(axes: &[ExternalAxis]) -> Self {
        let positions = axes.iter().map(ExternalAxis::nearest_to_zero).collect();
        Self { positions: AxisPositions::Same(positions), ..Self::default() }
    }
}

impl AxisPositions {
    /// Those of some points of a path, ascending.
    pub fn of_points(&self, points: &[usize]) -> Self {
        match self {
            Self::PerPoint(all) => {
                Self::PerPoint(points.iter().map(|point| all.get(*point).cloned().unwrap_or_default()).collect())
            }
            other => other.clone(),
        }
    }

    /// The shortest way to state the positions at every point of a task.
    pub fn shortest(rows: Vec<Vec<f64>>, task: &Task) -> Self {
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
    pub fn spread(&self, task: &Task) -> Vec<Vec<f64>> {
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
