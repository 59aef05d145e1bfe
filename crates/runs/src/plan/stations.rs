//! From the rows of a plan to its points in the base frame: where the workpiece stands, and whether plan and run belong
//! together.
//!
//! A plan file does not state its placement, but every row has it: joint angles and beta tell how the workpiece is
//! turned, and then the position tells where it is. All rows must agree, and that makes a plan of another robot,
//! spindle, task or cell known at its first row that does not.

use super::rows::{FORCE, JOINTS, POSITION, PlanRow};
use nalgebra::{Matrix3, Vector3};
use std::path::Path;
use std::sync::Arc;
use stead_calibration::compensation::PathPoint;
use stead_disk::input::InputError;
use stead_model::robot::{Frames, Pose, angles::wrap, point_from_tool};
use stead_model::stiffness::whole::{WholeArm, of_part};
use stead_model::task::lean::Lean;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::{AxisPositions, Setup};

/// A plan that fits its run.
#[derive(Debug)]
pub struct PlacedPlan {
    /// Where the workpiece stands.
    pub placement: Placement,
    /// How part and external axes are set up.
    pub setup: Setup,
    /// The points with their targets in the base frame.
    pub points: Vec<PathPoint>,
    /// The free angle about the tool axis at every point. rad
    pub betas: Vec<f64>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// A position of a plan may miss where it should be by this much: its joint angles are printed to 1e-4 deg. m
const POSITION_TOLERANCE: f64 = 1e-5;
/// Likewise the directions of the workpiece. rad
const DIRECTION_TOLERANCE: f64 = 1e-4;
/// A joint angle of a plan may miss the one of its pose by this much. rad
const JOINT_TOLERANCE: f64 = 2e-4;
/// A joint angle may be beyond its limit by what it is rounded to. rad
const LIMIT_TOLERANCE: f64 = 2e-6;
/// A force may be off by this much in N, and by this share.
const FORCE_TOLERANCE: (f64, f64) = (1e-3, 1e-5);
/// A deflection that is off by more than this in m, and by more than this share, is that of other compliances.
const DEFLECTION_TOLERANCE: (f64, f64) = (1e-7, 1e-3);

/// What does not fit in a row: the columns, and a sentence on them with the values.
type Misfit = (String, String);

/// Puts the rows of a plan on the task of its run, the part in the first orientation in which they fit and the external
/// axes where the rows have them.
///
/// # Errors
/// [`InputError`] at the line of the first row that does not fit the run or the other rows, the part as it lies in the
/// run.
pub fn set_up(file: &Path, rows: &[PlanRow], problem: &Problem) -> Result<PlacedPlan, InputError> {
    let positions = match &problem.external_axes[..] {
        [] => problem.setup.positions.clone(),
        _ => AxisPositions::PerPoint(rows.iter().map(|row| row.axes.clone()).collect()),
    };
    // A run whose tool may not lean is that of another plan, which its positions will tell.
    let leans = rows.iter().map(|row| row.lean.filter(|_| problem.lean.is_some())).collect::<Option<Vec<_>>>();
    let leans: Arc<[Lean]> = leans.unwrap_or_default().into();
    let in_orientation = |orientation: usize| {
        let setup = Setup { orientation, positions: positions.clone(), leans: Arc::clone(&leans) };
        placed(file, rows, &problem.in_setup(&setup))
    };
    let own = problem.setup.orientation;
    in_orientation(own).or_else(|error| {
        let others = (0..problem.orientations.len()).filter(|other| *other != own);
        others.map(in_orientation).find_map(Result::ok).ok_or(error)
    })
}

/// Puts the rows of a plan on the task of a problem, in its setup.
///
/// # Errors
/// [`InputError`] at the line of the first row that does not fit the run or the other rows.
fn placed(file: &Path, rows: &[PlanRow], problem: &Problem) -> Result<PlacedPlan, InputError> {
    let located = |row: &PlanRow, (columns, problem): Misfit| {
        InputError::new(file, problem)
            .at_line(row.line)
            .in_field(columns)
            .allowed("a row of the plan that stead place wrote for this run")
    };
    let mut yaws = Vec::with_capacity(rows.len());
    for (point, row) in rows.iter().enumerate() {
        check_limits(problem, row).map_err(|misfit| located(row, misfit))?;
        yaws.push(own_yaw(problem, point, row).map_err(|misfit| located(row, misfit))?);
    }
    let yaw = common_yaw(&yaws, rows).map_err(|(row, misfit)| located(row, misfit))?;
    let origin = common_origin(problem, yaw, rows).map_err(|(row, misfit)| located(row, misfit))?;
    let placement = Placement { x: origin.x, y: origin.y, z: origin.z, yaw };
    let mut stations = Vec::with_capacity(rows.len());
    let mut note = None;
    for (point, row) in rows.iter().enumerate() {
        let station = station(problem, &placement, point, row);
        check_force(&station, row).map_err(|misfit| located(row, misfit))?;
        check_posture(problem, &station, row).map_err(|misfit| located(row, misfit))?;
        note = note.or_else(|| deflection_note(problem, &station, row));
        stations.push(station);
    }
    let setup = problem.setup.clone();
    Ok(PlacedPlan {
        placement,
        setup,
        points: stations,
        betas: rows.iter().map(|row| row.beta).collect(),
        notes: note.into_iter().collect(),
    })
}

fn check_limits(problem: &Problem, row: &PlanRow) -> Result<(), Misfit> {
    for ((column, angle), joint) in JOINTS.into_iter().zip(row.joints).zip(problem.robot.joints()) {
        if angle < joint.min - LIMIT_TOLERANCE || angle > joint.max + LIMIT_TOLERANCE {
            let [angle, min, max] = [angle, joint.min, joint.max].map(f64::to_degrees);
            let sentence = format!("is {angle:.4}, but the joint of the run's robot goes from {min:.4} to {max:.4}");
            return Err((column.to_owned(), sentence));
        }
    }
    if let Some(range) = problem.robot.sum_range().filter(|_| problem.robot.beyond_sum(&row.joints) > LIMIT_TOLERANCE) {
        let [sum, min, max] = [problem.robot.sum_of(&row.joints), range.min, range.max].map(f64::to_degrees);
        let sentence = format!(
            "makes a sum of joints 2 and 3 of {sum:.4}, but that of the run's robot goes from {min:.4} to {max:.4}"
        );
        return Err((JOINTS[2].to_owned(), sentence));
    }
    Ok(())
}

/// The yaw of the workpiece that one row alone tells. rad
fn own_yaw(problem: &Problem, point: usize, row: &PlanRow) -> Result<f64, Misfit> {
    let columns = || format!("{} to {}", JOINTS[0], JOINTS[5]);
    let tool = problem.robot.forward(&row.joints).then(&problem.spindle.flange_from_tool);
    let off = (tool.translation - row.position).norm();
    if off > POSITION_TOLERANCE {
        let sentence = format!("these angles bring the tool {:.4} mm away from the position of the row", off * 1e3);
        return Err((columns(), sentence));
    }
    let workpiece_from_point = problem.task.points()[point].workpiece_from_point();
    let base_from_point = tool.rotation * point_from_tool(row.beta).transpose();
    let moved = problem.base_from_workpiece_at(problem.axis_positions(point), &Placement::from([0.0; 4])).rotation;
    let base_from_workpiece = moved.transpose() * base_from_point * workpiece_from_point.transpose();
    let tilt = (base_from_workpiece.column(2) - Vector3::z()).norm();
    if tilt > DIRECTION_TOLERANCE {
        let tilt_deg = tilt.to_degrees();
        return Err((
            columns(),
            format!("these angles tilt the tool {tilt_deg:.4} deg off the axis of the task's point"),
        ));
    }
    Ok(libm::atan2(base_from_workpiece.m21, base_from_workpiece.m11))
}

/// The yaw of the workpiece that all rows agree on, or the first row that does not agree with most. rad
fn common_yaw<'a>(yaws: &[f64], rows: &'a [PlanRow]) -> Result<f64, (&'a PlanRow, Misfit)> {
    let middle = median(yaws.iter().map(|yaw| wrap(yaw - yaws[0]))) + yaws[0];
    for (row, yaw) in rows.iter().zip(yaws) {
        if wrap(yaw - middle).abs() > DIRECTION_TOLERANCE {
            let [beta, own, others] = [row.beta, *yaw, wrap(middle)].map(f64::to_degrees);
            let sentence = format!(
                "is {beta:.4}, which with the joint angles puts the workpiece at a yaw of {own:.4} deg, and other rows at {others:.4} deg"
            );
            return Err((row, ("beta_deg".to_owned(), sentence)));
        }
    }
    Ok(wrap(yaws.iter().map(|yaw| wrap(yaw - middle)).sum::<f64>() / yaws.len() as f64 + middle))
}

/// The workpiece origin that all rows agree on, or the first row that does not agree with most. m
fn common_origin<'a>(problem: &Problem, yaw: f64, rows: &'a [PlanRow]) -> Result<Vector3<f64>, (&'a PlanRow, Misfit)> {
    let turned = Placement { x: 0.0, y: 0.0, z: 0.0, yaw }.base_from_workpiece();
    let at_zero = |(point, row): (usize, &PlanRow)| {
        let moved = problem.base_from_workpiece_at(problem.axis_positions(point), &Placement::from([0.0; 4]));
        moved.inverse().point(&row.position) - turned.point(&problem.task.points()[point].position)
    };
    let origins: Vec<Vector3<f64>> = rows.iter().enumerate().map(at_zero).collect();
    let middle = Vector3::from_fn(|axis, _| median(origins.iter().map(|origin| origin[axis])));
    for (row, origin) in rows.iter().zip(&origins) {
        let off = (origin - middle).norm();
        if off > POSITION_TOLERANCE {
            let sentence = format!("{:.4} mm away from where the other rows place this point of the task", off * 1e3);
            return Err((row, (POSITION.join(","), sentence)));
        }
    }
    Ok(origins.iter().sum::<Vector3<f64>>() / origins.len() as f64)
}

/// The value in the middle, which a few wrong rows do not move.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn station(problem: &Problem, placement: &Placement, point: usize, row: &PlanRow) -> PathPoint {
    let base_from_workpiece = problem.base_from_workpiece(point, placement);
    let (path_point, wrench) = (&problem.task.points()[point], &problem.task.loads()[point].wrench);
    let base_from_flange = problem.at(placement).base_from_flange(point, row.beta);
    let tool = base_from_flange.then(&problem.spindle.flange_from_tool);
    let force = base_from_workpiece.rotation * wrench.force;
    PathPoint {
        segment: problem.task.path().segment_of(point) + 1,
        base_from_tool: Pose { translation: base_from_workpiece.point(&path_point.position), ..tool },
        posture: row.posture,
        joints: row.joints,
        force,
        moment: base_from_workpiece.rotation * wrench.moment,
        of_part: displacement_of_part(problem, point, &base_from_workpiece.rotation, &force),
        free_fall: problem.free_fall(point),
        normal: base_from_workpiece.rotation * problem.task.path().scored_axes(point).column(1),
    }
}

/// What a part that yields adds to the displacement of the tool against it under a force (N), all in the base frame. m
fn displacement_of_part(
    problem: &Problem,
    point: usize,
    rotation: &Matrix3<f64>,
    force: &Vector3<f64>,
) -> Vector3<f64> {
    problem.task.part_compliance(point).map_or_else(Vector3::zeros, |part| of_part(part, rotation, force))
}

fn check_force(station: &PathPoint, row: &PlanRow) -> Result<(), Misfit> {
    let off = (station.force - row.force).norm();
    if off > FORCE_TOLERANCE.0 + FORCE_TOLERANCE.1 * station.force.norm() {
        return Err((FORCE.join(","), format!("{off:.4} N away from the force that the task has here")));
    }
    Ok(())
}

/// Whether the joint angles are those of the posture.
fn check_posture(problem: &Problem, station: &PathPoint, row: &PlanRow) -> Result<(), Misfit> {
    let base_from_flange = station.base_from_tool.then(&problem.spindle.flange_from_tool.inverse());
    let posture = row.posture;
    let angles = problem
        .robot
        .inverse(&base_from_flange, posture)
        .map_err(|e| ("posture".to_owned(), format!("posture {posture} does not reach this point: {e}")))?;
    for ((column, own), angle) in JOINTS.into_iter().zip(row.joints).zip(angles) {
        if wrap(own - angle).abs() > JOINT_TOLERANCE {
            let [own, expected] = [own, own - wrap(own - angle)].map(f64::to_degrees);
            let sentence = format!("is {own:.4}, but in posture {posture} the joint stands at {expected:.4}");
            return Err((column.to_owned(), sentence));
        }
    }
    Ok(())
}

/// Whether the deflection of a row is that of the run's robot.
fn deflection_note(problem: &Problem, station: &PathPoint, row: &PlanRow) -> Option<String> {
    let frames = Frames::new(&problem.robot, &row.joints);
    let compliances = problem.robot.compliances_at(&row.joints);
    let tip = &station.base_from_tool.translation;
    let whole = WholeArm::new(&problem.robot, &problem.spindle, &frames, compliances, *tip);
    let ours = whole.displacement(&station.force, &station.moment).linear + station.of_part;
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
