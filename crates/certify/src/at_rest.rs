//! External axes that stand still along the path, as a larger cell.

use nalgebra::Vector3;
use std::borrow::Cow;
use stead_model::external_axis::{AxisKind, AxisUse, Carried};
use stead_planning::problem::{Interval, Problem};
use stead_planning::setup::Setup;
use stead_planning::symmetry::Unsupported;

/// The same problem without external axes: rails that stand at one place for the whole path shift the workpiece against
/// the robot, so that each place is another cell. The cell holds all of these.
///
/// # Errors
/// [`Unsupported::ExternalAxes`] for other axes.
pub(super) fn without_rails(problem: &Problem) -> Result<Cow<'_, Problem>, Unsupported> {
    if problem.external_axes.is_empty() {
        return Ok(Cow::Borrowed(problem));
    }
    let mut cell = problem.cell;
    for axis in &problem.external_axes {
        if axis.kind != AxisKind::Rail || axis.axis_use != AxisUse::Fixed {
            return Err(Unsupported::ExternalAxes);
        }
        // A robot that moves one way is a workpiece that moves the other way.
        let sign = if axis.carries == Carried::Robot { -1.0 } else { 1.0 };
        let ends: [Vector3<f64>; 2] = [axis.min, axis.max].map(|at| axis.direction * (sign * at));
        for (k, range) in cell.position.iter_mut().enumerate() {
            let (a, b) = (ends[0][k], ends[1][k]);
            *range = Interval { min: range.min + a.min(b), max: range.max + a.max(b) };
        }
    }
    let alone = problem.changed(|parts| {
        (parts.external_axes, parts.scene, parts.cell) = (Vec::new(), None, cell);
        parts.setup = Setup { positions: Default::default(), ..parts.setup.clone() };
    });
    alone.map(Cow::Owned).map_err(|_| Unsupported::ExternalAxes)
}
