//! Compensation files: the config of `stead compensate`.

mod file;
#[cfg(test)]
mod tests;

pub use file::*;

use super::run::read_run_with;
use std::path::Path;
use stead_calibration::compensation::{CompensationProblem, Settings, other_geometry};
use stead_disk::input::{InputError, InputFile, input_file};
use stead_format::field::FieldOverrides;
use stead_format::quantity::Quantity;
use stead_format::robot::{checked_to_score, robot_from};
use stead_format::toml_file::TomlFile;
use stead_model::plausibility;
use stead_model::robot::{MeasuredFrom, Robot, Spindle};
use stead_numerics::digits::figures;
use stead_numerics::message::Note;
use stead_numerics::monitor::Monitor;
use stead_runs::CompensateRun;
use stead_runs::ReadError;
use stead_runs::plan::plan_from;

/// Reads a compensation file, the keys of [`CompensationFile`], and the files that it names. Where `reality` is given
/// here too, as a path of its own, it takes the place of the file's.
///
/// The plan must fit the run: as many points, joint angles that bring the tool to the positions, one placement for all
/// rows, the forces of the task.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key or column,
/// a value of the wrong kind or out of range, a plan that does not fit the run or that its manifest does not vouch for,
/// a reality of another geometry than the run's robot, a weight that is to be corrected and not known.
/// [`ReadError::Stopped`] when the monitor asked to stop before the forces of a run with a table `[stock]` were
/// computed.
pub fn read_compensation(file: &Path, reality: Option<&Path>, monitor: &Monitor) -> Result<CompensateRun, ReadError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    let at = document.root();
    let file: CompensationFile = document.read()?;
    let run_file = at.key("run").named_file()?;
    let run = read_run_with(&run_file.file, &FieldOverrides::none(), monitor)?;
    let length = run.problem.constraints.characteristic_length;
    let settings = Settings { characteristic_length: length, ..file.compensation.unwrap_or_default().settings() };
    if settings.gravity && run.problem.spindle.carried_mass().is_none() {
        let problem = "asks for the weight, but the run does not state what the flange carries";
        let allowed = "mass_kg and centre_of_mass_mm in [spindle] of the run file, or false";
        return Err(at.key("compensation").key("gravity").error(problem, allowed).into());
    }

    let mut inputs = vec![source.as_config()];
    for read in run.inputs {
        let is_run = read.role == "config";
        inputs.push(if is_run { InputFile { role: "run", name: run_file.name.clone(), ..read } } else { read });
    }
    let plan_file = at.key("plan").named_file()?;
    let plan = plan_from(&plan_file.file, &plan_file.bytes, &run.problem)?;
    inputs.push(input_file("plan", &plan_file.name, &plan_file.bytes));

    let real = match (reality, file.reality) {
        (Some(path), _) => {
            let (name, source) = (path.to_string_lossy().replace('\\', "/"), TomlFile::read(path)?);
            let input = input_file("reality", name, source.bytes());
            Some((source, input))
        }
        (None, Some(_)) => Some(at.key("reality").named_toml("reality")?),
        (None, None) => None,
    };
    let has_reality = real.is_some();
    let mut notes: Vec<Note> = run.problem.notes();
    notes.extend(plan.notes.into_iter().map(Note::from));
    // The margin is one of the plan: a correction may use it up.
    let robot = run.problem.robot_to_its_limits();
    let reality = match real {
        None => robot.clone(),
        Some((source, input)) => {
            inputs.push(input);
            let reality = reality_from(&source, &robot)?;
            notes.extend(plausibility::springs_left_out(&reality).map(Note::from));
            notes.extend(base_of_reality(&reality, &robot).map(Note::from));
            reality
        }
    };
    notes.extend(weight_note(&settings, &run.problem.spindle, [&robot, &reality]).map(Note::from));
    let job = CompensationProblem { robot, reality, spindle: run.problem.spindle, points: plan.points, settings };
    Ok(CompensateRun { job, placement: plan.placement, has_reality, inputs, notes, warnings: run.warnings })
}

impl CompensationTable {
    fn settings(&self) -> Settings {
        let default = Settings::default();
        Settings {
            alpha: self.alpha.map_or(default.alpha, Quantity::si),
            tolerance: self.tolerance_mm.map_or(default.tolerance, Quantity::si),
            max_iterations: self.max_iterations.map_or(default.max_iterations, |max| max.count()),
            gravity: self.gravity.unwrap_or(default.gravity),
            model: self.model.map_or(default.model, |word| word.0),
            ..default
        }
    }
}

/// What is corrected of the weight, or that it is not, where the mass of what the flange carries is known.
fn weight_note(settings: &Settings, spindle: &Spindle, arms: [&Robot; 2]) -> Option<String> {
    let mass = figures(spindle.carried_mass()?.mass);
    if !settings.gravity {
        return Some(format!(
            "the weight of the {mass} kg on the flange is not corrected: compensation.gravity = true does, for a program that is not \
             touched up at the machine"
        ));
    }
    let links = match arms.map(|arm| arm.dynamics().is_some()) {
        [true, true] => " and of the links",
        [false, false] => " (not of the links, whose masses are not known)",
        [true, false] => " and of the links of the model (not of reality, whose masses are not known)",
        [false, true] => " and of the links of reality (not of the model, whose masses are not known)",
    };
    Some(format!(
        "the weight of the {mass} kg on the flange{links} is corrected: do not touch the program up at the machine as well, and leave it \
         out where the controller corrects the weight itself (absolute accuracy)"
    ))
}

/// What carries the arm that stands for reality, where that yields under the robot of the run.
fn base_of_reality(reality: &Robot, robot: &Robot) -> Option<String> {
    robot.base_compliance()?;
    Some(match reality.base_compliance() {
        Some(_) => format!("{} stands on the base of the run ([base_compliance])", reality.name()),
        None => format!(
            "{} stands on a base that does not yield: its stiffness was measured from the floor, and has the base in it",
            reality.name()
        ),
    })
}

/// The robot that stands for reality, which must have the geometry of the run's; it stands where that stands.
fn reality_from(source: &TomlFile, robot: &Robot) -> Result<Robot, InputError> {
    let reality = robot_from(source)?.mounted(&robot.cell_from_base());
    checked_to_score(&reality, source)?;
    let base = robot.base_compliance().filter(|_| reality.stiffness_measured_from() != Some(MeasuredFrom::Floor));
    let reality = reality.with_base_compliance(base.cloned());
    let Some(other) = other_geometry(robot, &reality) else { return Ok(reality) };
    let key = match other.field {
        "alpha" => "alpha_deg",
        "a" => "a_mm",
        _ => "d_mm",
    };
    let unit = |value: f64| if other.field == "alpha" { value.to_degrees() } else { value * 1e3 };
    let document = source.parse()?;
    let problem = format!("'{}' has another geometry than '{}', the robot of the run", reality.name(), robot.name());
    let allowed =
        format!("{}, as in the robot of the run: a reality differs in its compliances alone", unit(other.expected));
    let row = document.root().key("joints").element(other.joint);
    Err(row.key(key).error(problem, allowed))
}
