//! The external axes that carry the workpiece, as the controller moves them: what a program couples its base to, or, on
//! a Fanuc, where the workpiece stands still.

use super::motion::{External, Move};
use super::{ExportOptions, ProgramError, ProgramFormat};
use nalgebra::{Matrix3, Vector3};
use std::ops::RangeInclusive;
use stead_model::external_axis::{AxisKind, Carried, ExternalAxis, carried};
use stead_model::robot::Pose;
use stead_problem::problem::{Placement, Problem};

/// What moves the base of a program, by its name at the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Carrier<'a> {
    /// KUKA: the n of `MACHINE_DEF[n]`.
    Mechanism(usize),
    /// ABB: the mechanical unit.
    Unit(&'a str),
}

/// The numbers of mechanisms at a KUKA; 1 is the robot.
const MECHANISMS: RangeInclusive<usize> = 2..=16;
/// The longest name of a mechanical unit.
const LONGEST_UNIT: usize = 32;

/// The last axis that carries the workpiece: what it carries is the table.
fn last(problem: &Problem) -> Option<&ExternalAxis> {
    problem.external_axes.iter().rfind(|axis| axis.carries == Carried::Workpiece)
}

/// What the base of a program is coupled to; nothing where the workpiece stands on no external axis, and in forms
/// without a coupling.
///
/// # Errors
/// [`ProgramError::Argument`] for an option that is missing, wrong or not for the run, and for a Fanuc where the
/// workpiece moves in the cut.
pub(super) fn carrier<'a>(problem: &Problem, options: &ExportOptions<'a>) -> Result<Option<Carrier<'a>>, ProgramError> {
    let refused = |option, problem: String, allowed: &str| {
        Err(ProgramError::Argument { option, problem, allowed: allowed.to_owned() })
    };
    let axis = last(problem);
    let given = [
        ("--mechanism", options.mechanism.is_some(), ProgramFormat::Krl),
        ("--unit", options.unit.is_some(), ProgramFormat::Rapid),
    ];
    for (option, is_given, format) in given {
        if is_given && options.format != format {
            let problem = format!("is not for programs in {}", options.format.word());
            return refused(option, problem, "--mechanism with --format krl, --unit with --format rapid");
        }
        if is_given && axis.is_none() {
            let problem = "is given, and no external axis of the run carries the workpiece".to_owned();
            return refused(option, problem, "none");
        }
    }
    let Some(axis) = axis else { return Ok(None) };
    let missing = format!(
        "is missing, and the workpiece is carried by the external axis '{}', to which the program has to couple its base",
        axis.name
    );
    match (options.format, options.mechanism, options.unit) {
        (ProgramFormat::Csv, ..) => Ok(None),
        (ProgramFormat::Krl, None, _) => refused("--mechanism", missing, MECHANISM_ALLOWED),
        (ProgramFormat::Krl, Some(number), _) if MECHANISMS.contains(&number) => Ok(Some(Carrier::Mechanism(number))),
        (ProgramFormat::Krl, Some(number), _) => {
            refused("--mechanism", format!("is out of range, found {number}"), MECHANISM_ALLOWED)
        }
        (ProgramFormat::Rapid, _, None) => refused("--unit", missing, UNIT_ALLOWED),
        (ProgramFormat::Rapid, _, Some(unit)) if is_name(unit) => Ok(Some(Carrier::Unit(unit))),
        (ProgramFormat::Rapid, _, Some(_)) => {
            refused("--unit", "is no name of a mechanical unit".to_owned(), UNIT_ALLOWED)
        }
        (ProgramFormat::Fanuc, ..) => match moving_segment(problem) {
            None => Ok(None),
            Some(segment) => refused(
                "--format",
                format!(
                    "in segment {segment} the external axis '{}' moves the workpiece in the cut, and TP programs are not written for that",
                    axis.name
                ),
                "csv; or use = \"fixed\" or \"indexed\" for the axes that carry the workpiece",
            ),
        },
    }
}

const MECHANISM_ALLOWED: &str = "the number n of the mechanism at the controller, MACHINE_DEF[n], from 2 to 16; or --format csv, for poses in the workpiece frame";
const UNIT_ALLOWED: &str = "the name of the mechanical unit at the controller, up to 32 letters, digits and _, the first a letter; or \
                            --format csv, for poses in the workpiece frame";

fn is_name(unit: &str) -> bool {
    unit.starts_with(|c: char| c.is_ascii_alphabetic())
        && unit.len() <= LONGEST_UNIT
        && unit.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The first segment, from 1, in which an axis moves the workpiece.
fn moving_segment(problem: &Problem) -> Option<usize> {
    let place = |point: usize| {
        let positions = problem.axis_positions(point).iter().copied().zip(&problem.external_axes);
        positions.filter(|(_, axis)| axis.carries == Carried::Workpiece).map(|(at, _)| at).collect::<Vec<f64>>()
    };
    let moves = |range: &std::ops::Range<usize>| {
        let first = place(range.start);
        range.clone().skip(1).any(|point| place(point) != first)
    };
    problem.task.segments().iter().position(moves).map(|segment| segment + 1)
}

/// The table with all axes at zero in the controller's root: its origin on the last axis that carries the workpiece, z
/// along it, x along that of the root as far as z allows, or along its y where z is within 25 deg of x.
pub(super) fn root_from_table(problem: &Problem) -> Option<Pose<f64>> {
    let (axis, root_from_cell) = last(problem).zip(problem.robot.controller_root_from_cell())?;
    let z = root_from_cell.rotation * axis.direction;
    let along = if z.x.abs() > 0.9 { Vector3::y() } else { Vector3::x() };
    let x = (along - z * z.dot(&along)).normalize();
    Some(Pose { rotation: Matrix3::from_columns(&[x, z.cross(&x), z]), translation: root_from_cell.point(&axis.point) })
}

/// What the axes at these positions do to the workpiece.
fn motion(problem: &Problem, external: &External) -> Pose<f64> {
    let positions = problem.external_axes.iter().zip(external).map(|(axis, position)| match axis.kind {
        AxisKind::Rail => position.unwrap_or(0.0) / 1e3,
        AxisKind::Turntable => position.unwrap_or(0.0).to_radians(),
    });
    carried(&problem.external_axes, &positions.collect::<Vec<f64>>(), Carried::Workpiece)
}

/// The workpiece in the cell as the axes have it at the first of the moves, and the moves with their poses in that
/// frame, which stands still.
pub(super) fn standing_still(problem: &Problem, placement: &Placement, moves: &mut [Move]) -> Pose<f64> {
    let at_zero = super::motion::at_zero(problem, placement);
    let Some(first) = moves.first().filter(|_| last(problem).is_some()) else { return at_zero };
    let external = first.external;
    let fixed = motion(problem, &external).then(&at_zero);
    for step in moves.iter_mut().filter(|step| step.external != external) {
        let here = motion(problem, &step.external).then(&at_zero);
        step.workpiece_from_tool = fixed.inverse().then(&here).then(&step.workpiece_from_tool);
    }
    fixed
}

/// What the operator has to compare, for a note.
pub(super) fn note(problem: &Problem, carrier: Option<Carrier<'_>>) -> Option<String> {
    let axis = last(problem)?;
    let what = match carrier? {
        Carrier::Mechanism(number) => format!("mechanism {number} (MACHINE_DEF[{number}])"),
        Carrier::Unit(unit) => format!("the mechanical unit {unit}"),
    };
    Some(format!(
        "the program couples its base to {what}, and takes the frame of its table with all axes at zero to have z along the external axis \
         '{}' and its origin at xyz_mm of that axis: compare it with the calibration of the mechanism before the first run",
        axis.name
    ))
}
