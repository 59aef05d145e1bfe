//! The cell in the JSON documents: where the workpiece may stand, and where the robot does.

use crate::units::Unit;
use serde_json::{Value, json};
use stead_numerics::rotation::zyx_from_rotation;
use stead_placement::problem::{Interval, Problem};

/// Both ends of an interval.
fn interval(unit: Unit, bounds: &Interval) -> [Value; 2] {
    [bounds.min, bounds.max].map(|end| json!(unit.number(end)))
}

/// Where the workpiece may stand.
pub(super) fn cell(problem: &Problem) -> Value {
    let [x, y, z] = problem.cell.position.map(|bounds| interval(Unit::PLACE_MM, &bounds));
    json!({ "x_mm": x, "y_mm": y, "z_mm": z, "yaw_deg": interval(Unit::ANGLE_DEG, &problem.cell.yaw) })
}

/// Where the robot stands in the cell, where that is not its origin.
pub(super) fn mount(problem: &Problem) -> Option<Value> {
    let mount = problem.robot.is_mounted().then(|| problem.robot.cell_from_base::<f64>())?;
    let xyz = <[f64; 3]>::from(mount.translation).map(|value| Unit::PLACE_MM.number(value));
    let [yaw, pitch, roll] = zyx_from_rotation(&mount.rotation).map(|angle| Unit::ANGLE_DEG.number(angle));
    Some(json!({ "xyz_mm": xyz, "rpy_deg": [roll, pitch, yaw] }))
}
