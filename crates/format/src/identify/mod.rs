//! Identification files: the config of `stead identify fit` and `stead identify plan`, so that one file serves both.

mod locate;
mod plan;

pub use locate::LocatedError;
pub use plan::{PlanRun, read_plan};

use super::reader::{Field, Table};
use super::robot::robot_from;
use super::sheet::sheet_from;
use super::source::{Document, Source, input_file};
use crate::input::{InputError, InputFile};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use stead_calibration::identification::Problem;
use stead_calibration::identification::law::Law;
use stead_calibration::identification::spring::Geometry;
use stead_model::robot::{Compliance, Robot, Spindle};

/// An identification file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyRun {
    /// What is to be identified.
    pub problem: Problem,
    /// Text of the robot file to start from.
    pub robot_text: String,
    /// The measurement sheet, to name it in messages.
    pub sheet_file: PathBuf,
    /// The files that were read: config, robot, sheet.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<String>,
}

/// Reads an identification file with the robot file and the measurement sheet that it names.
///
/// Keys: `robot`, `sheet` (paths relative to the folder of the file), `load_point_mm` (where the wrench acts, flange frame);
/// optionally `noise_mm` and `noise_deg` (standard deviation of one coordinate of one reading; both are needed for sheets with
/// orientations), `[compensator]` (`joint`, `a_mm`, `l_mm`, `alpha_deg`; else that of the robot file, if it has one), `[base]`
/// (`rotation` from the robot base to the tracker's frame, to start from), `[fit]` (`reduce`, `hold`,
/// `distinct_q2`, `angle_tolerance_deg`) and `[plan]`, which is for [`read_plan`] alone. The shipped file explains each.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of the
/// wrong kind or out of range, or a sheet that is not in order.
pub fn read_identification(file: &Path) -> Result<IdentifyRun, InputError> {
    let source = Source::read(file)?;
    let document = source.parse()?;
    let Shared {
        robot, robot_input, robot_text, sheet, load_point, noise, noise_deg, fit, varying, note, start, ..
    } = Shared::new(&document)?;
    let sheet_file = sheet.named_file()?;
    let readings = sheet_from(&sheet_file.file, &sheet_file.bytes, &robot)?;
    if readings.is_full_pose() {
        for field in [&noise, &noise_deg] {
            if !field.is_given() {
                let allowed = "a number above 0: positions and orientations are weighted by their noise";
                return Err(field.error("is missing, but the sheet has orientations", allowed));
            }
        }
    }
    let inputs = vec![source.as_config(), robot_input, input_file("sheet", &sheet_file.name, &sheet_file.bytes)];
    let problem = Problem {
        robot,
        sheet: readings,
        load_point,
        noise: noise.optional(Field::positive)?.map(|mm| mm / 1e3),
        orientation_noise: noise_deg.optional(Field::positive)?.map(f64::to_radians),
        varying,
        angle_tolerance: fit.angle_tolerance,
        start,
        reduce: fit.reduce,
        hold: fit.hold,
    };
    let notes = note.into_iter().collect();
    Ok(IdentifyRun { problem, robot_text, sheet_file: sheet_file.file, inputs, notes })
}

/// What the file says to both commands, and the fields that one of them alone reads.
struct Shared<'a> {
    robot: Robot,
    robot_input: InputFile,
    robot_text: String,
    sheet: Field<'a>,
    load_point: Vector3<f64>,
    noise: Field<'a>,
    noise_deg: Field<'a>,
    fit: Fit,
    varying: Option<(usize, Law)>,
    note: Option<String>,
    start: Option<Matrix3<f64>>,
    plan: Field<'a>,
}

impl<'a> Shared<'a> {
    fn new(document: &'a Document<'a>) -> Result<Self, InputError> {
        let [robot, sheet, load_point, noise, noise_deg, compensator, base, fit, plan] =
            Table::root(document).fields([
                "robot",
                "sheet",
                "load_point_mm",
                "noise_mm",
                "noise_deg",
                "compensator",
                "base",
                "fit",
                "plan",
            ])?;
        let robot_file = robot.named_file()?;
        let robot_source = Source::new(&robot_file.file, robot_file.bytes)?;
        let robot = robot_from(&robot_source)?;
        let fit = fit.optional(|field| fit_from(&field.table()?))?.unwrap_or(PLAIN);
        let given = compensator.optional(|field| compensator_from(&field.table()?, &robot))?;
        let (varying, note) = varying_from(&robot, given, fit.is_distinct);
        Ok(Self {
            robot,
            robot_input: input_file("robot", &robot_file.name, robot_source.bytes()),
            robot_text: String::from_utf8_lossy(robot_source.bytes()).into_owned(),
            sheet,
            load_point: load_point.vector3()? / 1e3,
            noise,
            noise_deg,
            fit,
            varying,
            note,
            start: base.optional(|field| base_from(&field.table()?))?,
            plan,
        })
    }
}

/// The table `[fit]`.
struct Fit {
    reduce: bool,
    hold: [bool; 6],
    is_distinct: bool,
    angle_tolerance: f64,
}

/// Angles of the joint beside a compensator that differ by no more than this count as one, where the file does not say.
const TOLERANCE_DEG: f64 = 0.05;
/// What holds without a table `[fit]`.
const PLAIN: Fit =
    Fit { reduce: false, hold: [false; 6], is_distinct: false, angle_tolerance: TOLERANCE_DEG * PI / 180.0 };

fn fit_from(table: &Table<'_>) -> Result<Fit, InputError> {
    let [reduce, hold, distinct, tolerance] = table.fields(["reduce", "hold", "distinct_q2", "angle_tolerance_deg"])?;
    let rule = "a number from 0 to 5";
    let tolerance = tolerance.optional(|field| field.number_where(rule, |deg| (0.0..=5.0).contains(&deg)))?;
    Ok(Fit {
        reduce: reduce.optional(Field::boolean)?.unwrap_or_default(),
        hold: hold.optional(held_from)?.unwrap_or_default(),
        is_distinct: distinct.optional(Field::boolean)?.unwrap_or_default(),
        angle_tolerance: tolerance.unwrap_or(TOLERANCE_DEG).to_radians(),
    })
}

/// The joints that are to keep the compliance of the robot file.
fn held_from(field: &Field<'_>) -> Result<[bool; 6], InputError> {
    let mut hold = [false; 6];
    for entry in field.list(HOLD)? {
        let joint = entry.integer(1..=6)? as usize - 1;
        if std::mem::replace(&mut hold[joint], true) {
            return Err(entry.error("is there twice", HOLD));
        }
    }
    if hold == [true; 6] {
        return Err(field.error("holds every joint, so that nothing is left to identify", HOLD));
    }
    Ok(hold)
}

const HOLD: &str = "numbers of one to five joints, from 1 to 6, each once";

fn compensator_from(table: &Table<'_>, robot: &Robot) -> Result<(usize, Law), InputError> {
    let [joint, a, l, alpha] = table.fields(["joint", "a_mm", "l_mm", "alpha_deg"])?;
    let geometry = Geometry { a: a.positive()? / 1e3, l: l.positive()? / 1e3, alpha: alpha.number()?.to_radians() };
    if geometry.a == geometry.l {
        return Err(l.error("lets the two ends of the spring meet", "another length than a_mm"));
    }
    let index = joint.integer(1..=6)? as usize - 1;
    if let Some(other) = compensated(robot).filter(|other| *other != index) {
        let problem = format!("is another joint than the robot file's compensator is beside, {}", other + 1);
        return Err(joint.error(problem, "one joint with a compensator"));
    }
    Ok((index, Law::Spring(geometry)))
}

/// The joint (from 0) beside which the robot file has a compensator.
fn compensated(robot: &Robot) -> Option<usize> {
    robot.joints().iter().position(|joint| matches!(joint.compliance, Compliance::Compensated { .. }))
}

/// The joint whose compliance changes with its angle, by the config or else by the robot file.
fn varying_from(
    robot: &Robot,
    given: Option<(usize, Law)>,
    is_distinct: bool,
) -> (Option<(usize, Law)>, Option<String>) {
    let known = compensated(robot).and_then(|index| match robot.joints()[index].compliance {
        Compliance::Compensated { compensator, .. } => {
            let (a, l, alpha) = (compensator.a, compensator.l, compensator.alpha);
            Some((index, Law::Spring(Geometry { a, l, alpha })))
        }
        _ => None,
    });
    let varying = given.or(known).or_else(|| is_distinct.then_some((1, Law::Constant)));
    let ranged = |index: usize| matches!(robot.joints()[index].compliance, Compliance::Range { .. });
    let is_spring = |index: usize| matches!(varying, Some((joint, Law::Spring(_))) if joint == index);
    let note = (0..6).find(|index| ranged(*index) && !is_spring(*index)).map(|index| {
        let number = index + 1;
        format!(
            "joint {number} has a range of compliances in the robot file; one compliance is identified in its place"
        )
    });
    (varying, note)
}

fn base_from(table: &Table<'_>) -> Result<Matrix3<f64>, InputError> {
    let [rotation] = table.fields(["rotation"])?;
    let placed = Spindle::new(rotation.matrix3()?, Vector3::zeros()).map_err(|problem| {
        let tolerance = Spindle::ROTATION_TOLERANCE;
        rotation.error(problem, format!("a right-handed rotation matrix [row, row, row] within {tolerance}"))
    })?;
    Ok(placed.flange_from_tool.rotation)
}
