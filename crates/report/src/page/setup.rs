//! How the cell is set up along each plan, for the view: the external axes, and how the part is turned.

use super::data::{mm, rows};
use crate::placement::setup::{column, unit, word};
use nalgebra::Matrix3;
use serde_json::{Value, json};
use stead_model::external_axis::{Carried, ExternalAxis};
use stead_placement::outcome::Case;
use stead_placement::problem::Problem;

/// The external axes in their order; their positions along the plans are columns of the plans, `e1_mm` or `e1_deg`.
pub(super) fn external_axes(problem: &Problem) -> Value {
    let entry = |(number, axis): (usize, &ExternalAxis)| {
        let range = [axis.min, axis.max].map(|end| unit(axis.kind).number(end));
        json!({
            "name": axis.name,
            "kind": word(axis.kind),
            "column": column(number, axis.kind),
            "carries": match axis.carries { Carried::Robot => "robot", Carried::Workpiece => "workpiece" },
            "direction": [axis.direction.x, axis.direction.y, axis.direction.z],
            "point_mm": mm(&axis.point),
            "range": range,
        })
    };
    problem.external_axes.iter().enumerate().map(entry).collect()
}

/// For each plan the rotation from the workpiece frame that the page has the task in to the frame that is placed; null where there is one
/// orientation.
pub(super) fn part_turns(problem: &Problem, plans: &[&Case]) -> Value {
    if problem.orientations.is_empty() {
        return Value::Null;
    }
    let rotation = |problem: &Problem| problem.orientation().map_or(Matrix3::identity(), |found| found.rotation);
    plans.iter().map(|case| rows(&(rotation(&problem.in_setup(&case.setup)) * rotation(problem).transpose()))).collect()
}
