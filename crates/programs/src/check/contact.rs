//! Where the end of a leaning tool touches, from tip and axis in the program alone.

use super::expected::{Expected, workpiece};
use super::geometry::{Frame, seen};
use super::written::Written;
use super::{Arm, Largest};
use nalgebra::Vector3;
use stead_disk::input::InputError;
use stead_model::task::PathPoint;
use stead_model::task::lean::{ContactRule, LeanRule};
use stead_problem::lean::LeanSpace;
use stead_problem::problem::{Placement, Problem};

/// How far the decimals of a program may move a contact. mm
const ROUNDING: f64 = 2e-3;

/// Axes nearer to the normal of the surface than this touch with a disc. rad
const DISC: f64 = 1e-6;

/// How far the contact may be off. mm
pub(super) fn allowed(space: &LeanSpace) -> f64 {
    (space.contact_tolerance * 1e3).max(ROUNDING)
}

/// The largest distance of a contact from that of the task, over all moves to path points.
pub(super) fn largest(
    arm: &Arm<'_>,
    problem: &Problem,
    rule: &LeanRule,
    placement: &Placement,
    written: &[Written],
    expected: &[Expected],
) -> Result<Option<Largest>, InputError> {
    let task = problem.task.upright();
    let normals = task.path().surface_normals();
    let mut largest = None;
    for (one, wanted) in written.iter().zip(expected).filter(|(_, wanted)| !wanted.is_retracted) {
        let part = seen(arm.axes, &wanted.external).of(&workpiece(placement)).inverted();
        let (point, normal) = (&task.points()[wanted.point], normals.map(|normals| &normals[wanted.point]));
        for tool in arm.tools(one)? {
            Largest::keep(&mut largest, off(rule, point, normal, &part.of(&tool)), one, wanted);
        }
    }
    Ok(largest)
}

/// By how much a tool, its frame seen from the workpiece, misses what it touches at a point of the path as the task
/// states it: the contact or, where a plane stays, that plane. mm
pub(super) fn off(rule: &LeanRule, point: &PathPoint, normal: Option<&Vector3<f64>>, tool: &Frame) -> f64 {
    let (radius, corner) = (rule.end.radius * 1e3, rule.end.corner * 1e3);
    // The tool's z axis points to the workpiece.
    let axis = -Vector3::from(tool.turn.map(|row| row[2]));
    let (tip, stated) = (Vector3::from(tool.origin), point.position * 1e3);
    if rule.contact == ContactRule::Centre {
        return (tip + axis * radius - stated - point.axis * radius).norm();
    }
    let normal = normal.unwrap_or(&point.axis);
    // From the tip to the lowest point of the torus about the axis.
    let lowest = |axis: &Vector3<f64>| {
        let aside = normal - axis * normal.dot(axis);
        let spoke = if aside.norm() > DISC { aside.normalize() } else { Vector3::zeros() };
        axis * corner - spoke * (radius - corner) - normal * corner
    };
    let miss = tip + lowest(&axis) - stated - lowest(&point.axis);
    if rule.contact == ContactRule::Plane { miss.dot(normal).abs() } else { miss.norm() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_model::task::lean::{CutterEnd, Lean, LeanForce};

    #[test]
    fn a_leaning_tool_touches_where_the_upright_one_does() {
        let point = PathPoint {
            position: Vector3::new(0.1, -0.2, 0.05),
            feed: Vector3::x(),
            axis: Vector3::new(0.0, 0.6, 0.8),
        };
        let normal = Vector3::new(0.0, 0.0, 1.0);
        for (corner, contact) in
            [(0.008, ContactRule::Centre), (0.002, ContactRule::Contact), (0.002, ContactRule::Plane)]
        {
            let rule = LeanRule { end: CutterEnd { radius: 0.008, corner }, contact, force: LeanForce::Feed };
            let leaned = rule.leaned(&point, Some(&normal), &Lean { lead: 0.2, tilt: -0.1 });
            let frame = |height: f64| {
                let axes = leaned.workpiece_from_point();
                let turn = std::array::from_fn(|row| [axes[(row, 0)], -axes[(row, 1)], -axes[(row, 2)]]);
                let origin = leaned.position * 1e3 + normal * height;
                Frame { turn, origin: [origin.x, origin.y, origin.z] }
            };
            assert!(off(&rule, &point, Some(&normal), &frame(0.0)) < 1e-9, "{contact:?}");
            assert!((off(&rule, &point, Some(&normal), &frame(0.02)) - 0.02).abs() < 1e-9, "{contact:?}");
        }
    }
}
