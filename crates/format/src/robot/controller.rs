//! The tables `[controller]` and `[root]` of a robot file.

use super::file::{ControllerTable, RobotFile, RootTable};
use crate::orientation::orientation_keys;
use crate::place::Place;
use crate::scalars::words;
use stead_disk::input::InputError;
use stead_model::robot::{Controller, ControllerKind, Pose, Robot};

words!(ControllerKind);

/// The robot with the controller that its file states.
///
/// # Errors
/// [`InputError`] for a sign that is neither 1 nor -1, an orientation that is none, or a root without a controller.
pub(super) fn with_controller(robot: Robot, file: &RobotFile, at: &Place<'_>) -> Result<Robot, InputError> {
    let root = |root: &RootTable| {
        let rotation = orientation_keys!(root).rotation(&at.key("root"))?;
        Ok(Pose { rotation, translation: root.xyz_mm.vector() })
    };
    let root = file.root.as_ref().map(root).transpose()?;
    match (&file.controller, root) {
        (Some(table), root) => Ok(robot.with_controller(controller_from(table, root, &at.key("controller"))?)),
        (None, Some(_)) => {
            let allowed = "[controller] beside it, with kind, sign and offset_deg";
            Err(at.key("root").error("says where the root of a controller is, of which nothing is said", allowed))
        }
        (None, None) => Ok(robot),
    }
}

fn controller_from(
    table: &ControllerTable,
    root_from_base: Option<Pose<f64>>,
    at: &Place<'_>,
) -> Result<Controller, InputError> {
    let sign = table.sign.si();
    if let Some(joint) = sign.iter().position(|sign| sign.abs() != 1.0) {
        return Err(at.key("sign").element(joint + 1).error("is no sign", "1 or -1"));
    }
    let kind = table.kind.0;
    let is_j3_level = table.is_j3_level;
    Ok(Controller { kind, sign, offset: table.offset_deg.si(), is_j3_level, root_from_base })
}
