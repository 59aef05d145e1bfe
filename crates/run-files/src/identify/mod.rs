//! Identification files: the config of `stead identify fit` and `stead identify plan`, so that one file serves both.

mod directions;
mod file;
mod held;
mod plan;

pub use directions::{Directions, NamedDirections};
pub use file::*;
pub use held::HeldSprings;
pub use plan::read_plan;

use super::sheet::sheet_from;
use held::{Held, held_from};
use nalgebra::{Matrix3, Vector3};
use std::path::Path;
pub use stead_calibration::identification::FitModel;
use stead_calibration::identification::Problem;
use stead_calibration::identification::law::Law;
use stead_calibration::identification::spring::Geometry;
use stead_disk::input::{InputError, InputFile, input_file};
use stead_format::orientation::orientation_keys;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::robot::robot_from;
use stead_format::scalars::words;
use stead_format::toml_file::TomlFile;
use stead_model::plausibility;
use stead_model::robot::{Compliance, MeasuredFrom, Robot, SpringModel};
use stead_numerics::message::Note;
use stead_runs::IdentifyRun;

words!(FitModel, MeasuredFrom);

/// Reads an identification file with the robot file and the measurement sheet that it names.
///
/// Its keys are those of [`IdentificationFile`].
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range, or a sheet that is not in order.
pub fn read_identification(file: &Path) -> Result<IdentifyRun, InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    let at = document.root();
    let file: IdentificationFile = document.read()?;
    let Shared { robot, model, robot_input, robot_text, load_point, angle_tolerance, hold, varying, mut notes, start } =
        Shared::new(&file, &at)?;
    let fit = file.fit.unwrap_or_default();
    let measured_from = fit.stiffness_measured_from.map(|word| word.0);
    if model == FitModel::Full && measured_from.is_none() {
        let allowed = "\"base\" or \"floor\": what the measuring instrument stood on";
        let problem = "is missing, but fit.model is \"full\": what yields under the base is in the springs or is not";
        return Err(at.key("fit").key("stiffness_measured_from").error(problem, allowed));
    }
    let robot = match &file.base_compliance {
        Some(_) if measured_from != Some(MeasuredFrom::Floor) => {
            let problem = "is given, but fit.stiffness_measured_from is not \"floor\": readings taken from the base have none of it";
            let allowed = "fit.stiffness_measured_from = \"floor\", or no table [base_compliance]";
            return Err(at.key("base_compliance").error(problem, allowed));
        }
        Some(table) => robot.with_base_compliance(Some(table.base_compliance(&at.key("base_compliance"))?)),
        None => robot,
    };
    // What yields under the base is not in the springs where it is taken as stated.
    let measured_from = if file.base_compliance.is_some() { Some(MeasuredFrom::Base) } else { measured_from };
    let robot = stated(robot, model, fit.model.is_some(), measured_from);
    notes.extend(told_apart(&robot, model, measured_from).into_iter().map(Note::from));
    let sheet_file = at.key("sheet").named_file()?;
    let readings = sheet_from(&sheet_file.file, &sheet_file.bytes, &robot)?;
    if readings.is_full_pose() {
        for field in ["noise_mm", "noise_deg"].map(|key| at.key(key)) {
            if !field.is_given() {
                let allowed = "a number above 0: positions and orientations are weighted by their noise";
                return Err(field.error("is missing, but the sheet has orientations", allowed));
            }
        }
    }
    let inputs = vec![source.as_config(), robot_input, input_file("sheet", &sheet_file.name, &sheet_file.bytes)];
    let problem = Problem {
        robot,
        model,
        measured_from,
        sheet: readings,
        load_point,
        noise: file.noise_mm.map(Quantity::si),
        orientation_noise: file.noise_deg.map(Quantity::si),
        varying,
        angle_tolerance,
        start,
        reduce: fit.reduce.unwrap_or_default(),
        hold: hold.0,
        hold_normal: hold.1,
    };
    let largest =
        problem.sheet.configurations.iter().map(|configuration| configuration.force.norm()).fold(0.0, f64::max);
    let odd = plausibility::arm(&problem.robot).into_iter();
    let odd = odd.chain(plausibility::force(largest).map(Note::may_be_wrong));
    notes.extend(odd);
    Ok(IdentifyRun { problem, robot_text, sheet_file: sheet_file.file, inputs, notes })
}

/// What the file says to both commands.
struct Shared {
    robot: Robot,
    model: FitModel,
    robot_input: InputFile,
    robot_text: String,
    load_point: Vector3<f64>,
    angle_tolerance: f64,
    hold: Held,
    varying: Option<(usize, Law)>,
    notes: Vec<Note>,
    start: Option<Matrix3<f64>>,
}

/// Angles of the joint beside a compensator that differ by no more than this count as one, where the file does not say.
const TOLERANCE_DEG: f64 = 0.05;

impl Shared {
    fn new(file: &IdentificationFile, at: &Place<'_>) -> Result<Self, InputError> {
        let (robot_source, robot_input) = at.key("robot").named_toml("robot")?;
        let robot = robot_from(&robot_source)?;
        let fit = file.fit.clone().unwrap_or_default();
        let model = fit.model.map_or(FitModel::Axes, |word| word.0);
        if model == FitModel::Axes && robot.spring_model() == Some(SpringModel::Full) {
            let problem = "states springs normal to the axes (stiffness_model = \"full\"), and readings are fitted by those about the axes alone";
            let allowed = "fit.model = \"full\", or a robot file without stiffness_model = \"full\" and without springs normal to \
                           the axes";
            return Err(at.key("robot").error(problem, allowed));
        }
        let given =
            file.compensator.map(|table| compensator_from(&table, &at.key("compensator"), &robot)).transpose()?;
        let start = file.base.map(|table| orientation_keys!(table).rotation(&at.key("base"))).transpose()?;
        let hold = fit.hold.map(|springs| held_from(&springs, model, &at.key("fit").key("hold"))).transpose()?;
        let (varying, note) = varying_from(&robot, given, fit.distinct_q2.unwrap_or_default());
        if let Some((joint, _)) = varying.filter(|(joint, _)| model == FitModel::Full && *joint > 2) {
            let problem = format!(
                "lets joint {} have another compliance at each angle, where springs normal to the axes of the wrist are \
                 sought too: the two cannot be told apart",
                joint + 1
            );
            return Err(at.key("fit").key("model").error(problem, "\"axes\", or a compensator beside joint 1, 2 or 3"));
        }
        Ok(Self {
            robot,
            model,
            robot_input,
            robot_text: robot_source.without_schema().to_owned(),
            load_point: file.load_point_mm.vector(),
            angle_tolerance: fit.angle_tolerance_deg.map_or(TOLERANCE_DEG.to_radians(), Quantity::si),
            hold: hold.unwrap_or_default(),
            varying,
            notes: note.map(Note::from).into_iter().collect(),
            start,
        })
    }
}

/// The arm to start from, with what the compliances to be found stand for where that is stated.
fn stated(robot: Robot, model: FitModel, is_stated: bool, measured_from: Option<MeasuredFrom>) -> Robot {
    let robot = match measured_from {
        None => robot,
        from => robot.with_stiffness_measured_from(from),
    };
    // What an earlier file says of its compliances does not hold for these.
    if model == FitModel::Axes && (is_stated || robot.spring_model().is_some()) {
        return robot.with_spring_model(Some(SpringModel::Axes));
    }
    robot
}

/// What a fit takes as given, and what it cannot tell apart on any sheet.
fn told_apart(robot: &Robot, model: FitModel, measured_from: Option<MeasuredFrom>) -> Vec<String> {
    let is_stated = robot.base_compliance().is_some();
    let of_base = "what yields under the base is taken as [base_compliance] states it and is not in the springs";
    if model == FitModel::Axes {
        return is_stated.then(|| of_base.to_owned()).into_iter().collect();
    }
    let stated_base = if is_stated { format!("; {of_base}") } else { String::new() };
    let bearings = match robot.stated_normal_springs() {
        Some(_) => "where the springs normal to the axes sit (bearing_mm) is taken from the robot file",
        None => {
            "the robot file does not say where the springs normal to the axes sit (bearing_mm): they are taken to sit at the \
             origins of the frames of its rows"
        }
    };
    let base = match measured_from {
        Some(MeasuredFrom::Floor) => {
            "; what yields under the base is in the springs of joint 1: its turn about axis 1 in that about z, its tilt in those \
             about x and y as far as it is alike in both directions, its shift in none"
        }
        _ => "",
    };
    vec![format!(
        "{bearings}; how the body with the reference points is fixed to the flange is in the springs of joint 6, from which it \
         cannot be told apart{base}{stated_base}"
    )]
}

fn compensator_from(
    table: &CompensatorGeometryTable,
    at: &Place<'_>,
    robot: &Robot,
) -> Result<(usize, Law), InputError> {
    let geometry = Geometry { a: table.a_mm.si(), l: table.l_mm.si(), alpha: table.alpha_deg.si() };
    if geometry.a == geometry.l {
        return Err(at.key("l_mm").error("lets the two ends of the spring meet", "another length than a_mm"));
    }
    let index = table.joint.count() - 1;
    if let Some(other) = compensated(robot).filter(|other| *other != index) {
        let problem = format!("is another joint than the robot file's compensator is beside, {}", other + 1);
        return Err(at.key("joint").error(problem, "one joint with a compensator"));
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
