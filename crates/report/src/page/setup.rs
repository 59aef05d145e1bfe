//! How the cell is set up along each plan, for the view: the external axes, and how the part is turned.

use super::pose::{mm, rows};
use crate::placement::setup::{column, unit, word};
use nalgebra::Matrix3;
use stead_model::external_axis::{Carried, ExternalAxis};
use stead_placement::outcome::Case;
use stead_problem::problem::Problem;
use stead_problem::setup::Setup;

records! {
    /// An external axis; its positions along the plans are a column of the plans.
    pub struct AxisData of (number: usize, axis: &ExternalAxis) {
        /// Its name.
        name: String = axis.name.clone(),
        /// `rail` or `turntable`.
        kind: &'static str = word(axis.kind),
        /// The column: `e1_mm` or `e1_deg` and so on.
        column: String = column(number, axis.kind),
        /// What it carries: the `robot` or the `workpiece`.
        carries: &'static str = match axis.carries {
            Carried::Robot => "robot",
            Carried::Workpiece => "workpiece",
        },
        /// Its direction.
        direction: [f64; 3] = [axis.direction.x, axis.direction.y, axis.direction.z],
        /// A point on it. mm
        point_mm: [f64; 3] = mm(&axis.point),
        /// Least and largest position, in its unit.
        range: [f64; 2] = [axis.min, axis.max].map(|end| unit(axis.kind).number(end)),
    }
}

/// The external axes in their order.
pub(super) fn external_axes(problem: &Problem) -> Vec<AxisData> {
    let entry = |(number, axis): (usize, &ExternalAxis)| AxisData::of(number, axis);
    problem.external_axes.iter().enumerate().map(entry).collect()
}

/// For each plan the rotation from the workpiece frame that the page has the task in to the frame that is placed;
/// nothing where there is one orientation.
pub(super) fn part_turns(problem: &Problem, plans: &[&Case]) -> Option<Vec<[[f64; 3]; 3]>> {
    let turns = plans.iter().map(|case| part_turn(problem, &case.setup));
    (!problem.orientations.is_empty()).then(|| turns.collect())
}

/// That rotation in a setup.
pub(super) fn part_turn(problem: &Problem, setup: &Setup) -> [[f64; 3]; 3] {
    let rotation = |problem: &Problem| problem.orientation().map_or(Matrix3::identity(), |found| found.rotation);
    rows(&(rotation(&problem.in_setup(setup)) * rotation(problem).transpose()))
}
