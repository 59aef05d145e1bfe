//! From the rows of a plan to the stations of a compensation: where the workpiece stands, and whether plan and run belong
//! together.
//!
//! A plan file does not state its placement, but every row has it: joint angles and beta tell how the workpiece is turned, and
//! then the position tells where it is. All rows must agree, and that makes a plan of another robot, spindle, task or cell
//! known at its first row that does not.

use super::rows::{FORCE, JOINTS, POSITION, PlanRow};
use crate::compensation::Station;
use crate::input::InputError;
use crate::placement::problem::{Placement, Problem};
use crate::robot::{Frames, Pose, angles::wrap, point_from_tool};
use crate::stiffness::displacement;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;
use std::path::Path;

/// A plan that fits its run.
#[derive(Debug)]
pub(super) struct PlacedPlan {
    pub placement: Placement,
    pub stations: Vec<Station>,
    /// What the user should know.
    pub note: Option<String>,
}

/// A position of a plan may miss where it should be by this much: its joint angles are printed to 1e-4 deg. m
const POSITION_TOLERANCE: f64 = 1e-5;
/// Likewise the directions of the workpiece. rad
const DIRECTION_TOLERANCE: f64 = 1e-4;
/// A joint angle of a plan may miss the one of its pose by this much. rad
const JOINT_TOLERANCE: f64 = 2e-4;
/// A force may be off by this much in N, and by this share.
const FORCE_TOLERANCE: (f64, f64) = (1e-3, 1e-5);
/// A deflection that is off by more than this in m, and by more than this share, is that of other compliances.
const DEFLECTION_TOLERANCE: (f64, f64) = (1e-7, 1e-3);

const ALLOWED: &str = "a row of the plan that stead place wrote for this run";

/// Puts the rows of a plan on the task of its run.
///
/// # Errors
/// [`InputError`] at the line of the first row that does not fit the run or the other rows.
pub(super) fn placed(file: &Path, rows: &[PlanRow], problem: &Problem) -> Result<PlacedPlan, InputError> {
    let fail = |row: &PlanRow, field: &str, problem: String| {
        InputError::new(file, problem).at_line(row.line).in_field(field).allowed(ALLOWED)
    };
    let position_field = POSITION.join(",");
    let joints_field = format!("{} to {}", JOINTS[0], JOINTS[5]);
    let mut turned = Vec::with_capacity(rows.len());
    for (point, row) in rows.iter().enumerate() {
        let tool = problem.robot.forward(&row.joints).then(&problem.spindle.flange_from_tool);
        let off = (tool.translation - row.position).norm();
        if off > POSITION_TOLERANCE {
            let problem = format!("these angles bring the tool {:.4} mm away from the position of the row", off * 1e3);
            return Err(fail(row, &joints_field, problem));
        }
        let base_from_workpiece = turned_workpiece(problem, point, row, &tool.rotation);
        let tilt = (base_from_workpiece.column(2) - Vector3::z()).norm();
        if tilt > DIRECTION_TOLERANCE {
            let problem = format!(
                "with these angles the tool is {:.4} deg off the axis that the task has here",
                tilt.to_degrees()
            );
            return Err(fail(row, &joints_field, problem));
        }
        turned.push(libm::atan2(base_from_workpiece.m21, base_from_workpiece.m11));
    }
    let yaw = agreed(&turned.iter().map(|yaw| wrap(yaw - turned[0])).collect::<Vec<_>>()) + turned[0];
    for (row, own) in rows.iter().zip(&turned) {
        let off = wrap(own - yaw).abs();
        if off > DIRECTION_TOLERANCE {
            let problem = format!(
                "with the joint angles it puts the workpiece at a yaw of {:.4} deg, and other rows at {:.4} deg",
                own.to_degrees(),
                wrap(yaw).to_degrees()
            );
            return Err(fail(row, "beta_deg", problem).found(format!("{:.4}", row.beta.to_degrees())));
        }
    }
    let yaw = wrap(turned.iter().map(|own| wrap(own - yaw)).sum::<f64>() / turned.len() as f64 + yaw);
    let origin = Placement { x: 0.0, y: 0.0, z: 0.0, yaw }.base_from_workpiece();
    let origins: Vec<Vector3<f64>> = rows
        .iter()
        .zip(problem.task.points())
        .map(|(row, point)| row.position - origin.point(&point.position))
        .collect();
    let middle = Vector3::from_fn(|axis, _| agreed(&origins.iter().map(|own| own[axis]).collect::<Vec<_>>()));
    for (row, own) in rows.iter().zip(&origins) {
        let off = (own - middle).norm();
        if off > POSITION_TOLERANCE {
            let problem =
                format!("{:.4} mm away from where the point is with the workpiece as in the other rows", off * 1e3);
            return Err(fail(row, &position_field, problem));
        }
    }
    let mean = origins.iter().sum::<Vector3<f64>>() / origins.len() as f64;
    let placement = Placement { x: mean.x, y: mean.y, z: mean.z, yaw };
    let mut stations = Vec::with_capacity(rows.len());
    let mut note = None;
    for (point, row) in rows.iter().enumerate() {
        let station = station(problem, &placement, point, row);
        let off = (station.force - row.force).norm();
        if off > FORCE_TOLERANCE.0 + FORCE_TOLERANCE.1 * station.force.norm() {
            let problem = format!("{off:.4} N away from the force that the task has here");
            return Err(fail(row, &FORCE.join(","), problem));
        }
        check_posture(problem, &station, row).map_err(|(field, problem)| fail(row, field, problem))?;
        note = note.or_else(|| deflection_note(problem, &station, row));
        stations.push(station);
    }
    Ok(PlacedPlan { placement, stations, note })
}

/// How the workpiece is turned in the base frame, by one row alone.
fn turned_workpiece(problem: &Problem, point: usize, row: &PlanRow, base_from_tool: &Matrix3<f64>) -> Matrix3<f64> {
    let workpiece_from_point = problem.task.points()[point].workpiece_from_point();
    base_from_tool * point_from_tool(row.beta).transpose() * workpiece_from_point.transpose()
}

/// The value that most rows agree on: the median, which a few wrong rows do not move.
fn agreed(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn station(problem: &Problem, placement: &Placement, point: usize, row: &PlanRow) -> Station {
    let pose = [placement.x, placement.y, placement.z, placement.yaw];
    let base_from_workpiece = placement.base_from_workpiece();
    let (path_point, wrench) = (&problem.task.points()[point], &problem.task.wrenches()[point]);
    let base_from_flange = problem.base_from_flange(point, &pose, row.beta);
    let tool = base_from_flange.then(&problem.spindle.flange_from_tool);
    Station {
        segment: problem.task.path().segment_of(point) + 1,
        base_from_tool: Pose { translation: base_from_workpiece.point(&path_point.position), ..tool },
        posture: row.posture,
        joints: row.joints,
        force: base_from_workpiece.rotation * wrench.force,
        moment: base_from_workpiece.rotation * wrench.moment,
        normal: base_from_workpiece.rotation * path_point.normal(),
    }
}

/// Whether the joint angles are those of the posture.
fn check_posture(problem: &Problem, station: &Station, row: &PlanRow) -> Result<(), (&'static str, String)> {
    let base_from_flange = station.base_from_tool.then(&problem.spindle.flange_from_tool.inverse());
    let posture = row.posture;
    let angles = problem
        .robot
        .inverse(&base_from_flange, posture)
        .map_err(|e| ("posture", format!("posture {posture} does not reach this point: {e}")))?;
    for ((name, own), angle) in JOINTS.into_iter().zip(row.joints).zip(angles) {
        if wrap(own - angle).abs() > JOINT_TOLERANCE {
            let turns = ((own - angle) / TAU).round();
            let expected = (angle + TAU * turns).to_degrees();
            return Err((
                name,
                format!("is {:.4}, but in posture {posture} the joint stands at {expected:.4}", own.to_degrees()),
            ));
        }
    }
    Ok(())
}

/// Whether the deflection of a row is that of the run's robot.
fn deflection_note(problem: &Problem, station: &Station, row: &PlanRow) -> Option<String> {
    let frames = Frames::new(&problem.robot, &row.joints);
    let compliances = problem.robot.compliances_at(&row.joints);
    let tip = &station.base_from_tool.translation;
    let ours = displacement(&frames, tip, &compliances, &station.force, &station.moment).linear;
    let off = (ours - row.deflection?).norm();
    let tolerance = DEFLECTION_TOLERANCE.0.max(DEFLECTION_TOLERANCE.1 * ours.norm());
    (off > tolerance).then(|| {
        format!(
            "the plan was made for other compliances than the robot of the run has (line {}: its deflection is {:.4} mm off)",
            row.line,
            off * 1e3
        )
    })
}
