//! Compensation files: the config of `stead compensate`.

mod rows;
mod stations;
#[cfg(test)]
mod tests;

use super::reader::{Field, Table};
use super::robot::robot_from;
use super::run::read_run;
use super::toml_file::TomlFile;
use crate::input::input_file;
use crate::input::{InputError, InputFile};
use rows::rows_from;
use stations::placed;
use std::path::Path;
use stead_calibration::compensation::{CompensationProblem, DeflectionModel, Settings, other_geometry};
use stead_model::robot::Robot;
use stead_placement::problem::Placement;

/// A compensation file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensateRun {
    /// What is to be compensated.
    pub job: CompensationProblem,
    /// Where the workpiece stands, as the plan has it.
    pub placement: Placement,
    /// Whether the commands are played on another robot file than the run's.
    pub has_reality: bool,
    /// The files that were read: config, run, robot, task, plan, reality.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<String>,
}

/// Reads a compensation file and the files that it names. Top-level keys: `run`, the run file of `stead place`, and `plan`, a
/// plan that it wrote (`best.csv` and the like), both relative to the folder of the file; optionally `reality`, the robot
/// file on which the corrected commands are played, and `[compensation]` with `alpha`, `tolerance_mm`, `max_iterations` and
/// `model`. Where `reality` is given here too, as a path of its own, it takes the place of the file's.
///
/// The plan must fit the run: as many points, joint angles that bring the tool to the positions, one placement for all rows,
/// the forces of the task.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key or column, a value
/// of the wrong kind or out of range, a plan that does not fit the run, a reality of another geometry than the run's robot.
pub fn read_compensation(file: &Path, reality: Option<&Path>) -> Result<CompensateRun, InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    let [run, plan, reality_field, settings] =
        Table::root(&document).fields(["run", "plan", "reality", "compensation"])?;
    let run_file = run.named_file()?;
    let run = read_run(&run_file.file)?;
    let length = run.problem.constraints.characteristic_length;
    let settings = settings.optional(|field| settings_from(&field.table()?))?.unwrap_or_default();
    let settings = Settings { characteristic_length: length, ..settings };

    let mut inputs = vec![source.as_config()];
    for read in run.inputs {
        let is_run = read.role == "config";
        inputs.push(if is_run { InputFile { role: "run", name: run_file.name.clone(), ..read } } else { read });
    }
    let plan_file = plan.named_file()?;
    let rows = rows_from(&plan_file.file, &plan_file.bytes, run.problem.task.path())?;
    let plan = placed(&plan_file.file, &rows, &run.problem)?;
    inputs.push(input_file("plan", &plan_file.name, &plan_file.bytes));

    let real = match reality {
        Some(path) => Some((path.to_string_lossy().replace('\\', "/"), TomlFile::read(path)?)),
        None => reality_field.optional(|field| {
            let named = field.named_file()?;
            Ok((named.name, TomlFile::new(&named.file, named.bytes)?))
        })?,
    };
    let has_reality = real.is_some();
    let robot = run.problem.robot;
    let reality = match real {
        None => robot.clone(),
        Some((name, source)) => {
            inputs.push(input_file("reality", name, source.bytes()));
            reality_from(&source, &robot)?
        }
    };
    let job = CompensationProblem { robot, reality, spindle: run.problem.spindle, points: plan.points, settings };
    Ok(CompensateRun { job, placement: plan.placement, has_reality, inputs, notes: plan.note.into_iter().collect() })
}

/// More iterations than this are not allowed.
const MOST_ITERATIONS: u64 = 100_000;

fn settings_from(table: &Table<'_>) -> Result<Settings, InputError> {
    let [alpha, tolerance, iterations, model] = table.fields(["alpha", "tolerance_mm", "max_iterations", "model"])?;
    let default = Settings::default();
    let share = |field: &Field<'_>| field.number_where("a number above 0 and not above 1", |v| v > 0.0 && v <= 1.0);
    // Below a nanometre the rounding of the kinematics is in the way.
    let small = |field: &Field<'_>| field.number_where("a number from 1e-9 to 1", |v| (1e-9..=1.0).contains(&v));
    let models = [("equilibrium", DeflectionModel::Equilibrium), ("linear", DeflectionModel::Linear)];
    Ok(Settings {
        alpha: alpha.optional(share)?.unwrap_or(default.alpha),
        tolerance: tolerance.optional(small)?.map_or(default.tolerance, |mm| mm / 1e3),
        max_iterations: iterations
            .optional(|field| field.integer(1..=MOST_ITERATIONS))?
            .map_or(default.max_iterations, |most| most as usize),
        model: model.optional(|field| field.one_of(&models))?.unwrap_or(default.model),
        ..default
    })
}

/// The robot that stands for reality, which must have the geometry of the run's.
fn reality_from(source: &TomlFile, robot: &Robot) -> Result<Robot, InputError> {
    let reality = robot_from(source)?;
    let Some(other) = other_geometry(robot, &reality) else { return Ok(reality) };
    let key = match other.field {
        "alpha" => "alpha_deg",
        "a" => "a_mm",
        _ => "d_mm",
    };
    let unit = |value: f64| if other.field == "alpha" { value.to_degrees() } else { value * 1e3 };
    let document = source.parse()?;
    let rows = Table::root(&document).field("joints").tables()?;
    let problem = format!("'{}' has another geometry than '{}', the robot of the run", reality.name(), robot.name());
    let allowed =
        format!("{}, as in the robot of the run: a reality differs in its compliances alone", unit(other.expected));
    Err(match rows.get(other.joint - 1) {
        Some(row) => row.field(key).error(problem, allowed),
        None => InputError::new(source.file(), problem).allowed(allowed),
    })
}
