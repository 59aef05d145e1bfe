//! Run files.

use super::certificate::{certificate_from, check_size};
use super::cutting::cutting_from;
use super::path_stability::path_stability_from;
use super::reader::{Field, NamedFile, Table};
use super::robot::{moving_robot_from, robot_from};
use super::source::{Source, input_file};
use super::tables::{
    cell_from, check_confidence, check_tables, constraints_from, criterion_from, moving_spindle_from, redundancy_from,
    reference_from, search_from, spindle_from, transfer_from,
};
use crate::input::{InputError, InputFile};
use crate::task::{Imported, parse_csv};
use std::path::Path;
use stead_model::published::Published;
use stead_model::robot::Robot;
use stead_model::task::{Task, ToolPath};
use stead_placement::problem::Problem;
use stead_placement::settings::{CertificateSettings, SearchSettings, TransferSettings};
use stead_simulation::arm::Variant;
use stead_simulation::path_stability::PathStabilityAnalysis;

/// A run file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What is to be solved.
    pub problem: Problem,
    /// How hard to search.
    pub search: SearchSettings,
    /// Limits of the moves between segments.
    pub transfer: TransferSettings,
    /// The certificate, where one is asked for.
    pub certificate: Option<CertificateSettings>,
    /// The files that were read, in the order config, robot, task.
    pub inputs: Vec<InputFile>,
    /// Published mean deflections of the four cases (Caro 2013, Table III), to print beside the computed ones. mm
    pub reference: Option<Published<[f64; 4]>>,
    /// What is to be cut along the path, where its stability is asked for.
    pub path_stability: Option<PathStabilityAnalysis>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<String>,
}

/// Reads a run file and the robot and task files that it names. Top-level keys: `robot` and `task` (paths relative to
/// the folder of the run file), `[spindle]`, `[cell]`, `[constraints]` and `[redundancy]`; optionally `[criterion]`,
/// `[search]`, `[transfer]`, `[certificate]`, `[stability]` and `[reference]`; and `[cutting]` if, and only if, the task has no force
/// columns.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range, an arm or a task that breaks a rule, forces from two places or from none, a cell too
/// large for the certificate that is asked for.
pub fn read_run(file: &Path) -> Result<Run, InputError> {
    read_run_to_certify(file, None)
}

/// Reads a run file as [`read_run`] does, for a certificate with this gap (relative), whatever its own table says.
///
/// # Errors
/// Those of [`read_run`].
pub fn read_run_to_certify(file: &Path, gap: Option<f64>) -> Result<Run, InputError> {
    let source = Source::read(file)?;
    let document = source.parse()?;
    let [
        robot,
        task,
        spindle,
        cell_field,
        constraints,
        criterion,
        redundancy,
        search,
        transfer,
        certificate,
        cutting,
        stability,
        reference,
    ] = Table::root(&document).fields([
        "robot",
        "task",
        "spindle",
        "cell",
        "constraints",
        "criterion",
        "redundancy",
        "search",
        "transfer",
        "certificate",
        "cutting",
        "stability",
        "reference",
    ])?;
    let carried = spindle.table()?;
    let spindle = if stability.is_given() { moving_spindle_from(&carried)? } else { spindle_from(&carried)? };
    let cell = cell_from(&cell_field.table()?)?;
    let constraints = constraints_from(&constraints.table()?)?;
    let scoring = criterion.optional(Field::table)?;
    let criterion = scoring.as_ref().map(criterion_from).transpose()?.unwrap_or_default();
    let redundancy = redundancy_from(&redundancy.table()?)?;
    let searching = search.optional(Field::table)?;
    let search = searching.as_ref().map(search_from).transpose()?.unwrap_or_default();
    let transfer = transfer.optional(|field| transfer_from(&field.table()?))?.unwrap_or_default();
    let certificate = certificate.optional(|field| certificate_from(&field.table()?))?;
    let limit = certificate.and_then(|settings| settings.time_limit);
    let certificate = gap.map(|gap| CertificateSettings { gap, time_limit: limit }).or(certificate);
    let reference = reference.optional(|field| reference_from(&field.table()?))?;

    let robot_file = robot.named_file()?;
    let robot_source = Source::new(&robot_file.file, robot_file.bytes)?;
    let path_stability = stability.optional(|field| path_stability_from(&field.table()?))?;
    let robot = match &path_stability {
        Some(path_stability) => moving_robot_from(&robot_source, path_stability.variant >= Variant::Orthogonal)?,
        None => robot_from(&robot_source)?,
    };
    if let Some(table) = &scoring {
        check_confidence(table, &criterion, &robot)?;
    }
    let task_file = task.named_file()?;
    let imported = parse_csv(&task_file.file, &task_file.bytes)?;
    let mut notes: Vec<String> =
        [tilt_note(&imported.path, &imported.lines), speed_note(&robot)].into_iter().flatten().collect();
    let inputs = vec![
        source.as_config(),
        input_file("robot", robot_file.name, robot_source.bytes()),
        input_file("task", &task_file.name, &task_file.bytes),
    ];
    let task = task_from(imported, &task_file, &task, &cutting)?;
    let problem = Problem { robot, spindle, task, cell, constraints, criterion, redundancy };
    if let Some(table) = &searching {
        check_tables(table, &search, &problem)?;
    }
    if certificate.is_some() {
        check_size(&cell_field, &problem)?;
    }
    notes.extend(density_note(&problem));
    notes.extend(direction_note(&problem.task));
    Ok(Run { problem, search, transfer, certificate, inputs, reference, path_stability, notes })
}

/// Puts the forces to the path: those of the file, or those of the `[cutting]` table.
fn task_from(imported: Imported, file: &NamedFile, field: &Field<'_>, cutting: &Field<'_>) -> Result<Task, InputError> {
    let rule = "force columns in the task or a table [cutting], one and not both";
    let wrenches = match (imported.wrenches, cutting.is_given()) {
        (Some(wrenches), false) => wrenches,
        (None, true) => cutting_from(&cutting.table()?)?.wrenches(&imported.path),
        (Some(_), true) => {
            let problem = format!("forces come from one place only, and the task {} has force columns", file.name);
            return Err(cutting.error(problem, rule));
        }
        (None, false) => {
            return Err(field.error("has no force columns, and there is no table [cutting] to compute them", rule));
        }
    };
    Task::new(imported.path, wrenches)
        .map_err(|e| cutting.error(format!("gives no usable forces: {e}"), "values whose forces are finite"))
}

/// A feed that misses the plane normal to the tool axis by no more than this is normal to it. deg
const NORMAL_FEED_DEG: f64 = 0.1;

/// The largest tilt of the feed, where there is one.
fn tilt_note(path: &ToolPath, lines: &[usize]) -> Option<String> {
    let tilts = path.points().iter().zip(lines).map(|(point, line)| (point.feed_tilt().abs().to_degrees(), line));
    let steepest = tilts.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(tilt, _)| *tilt > NORMAL_FEED_DEG);
    steepest.map(|(tilt, line)| {
        format!(
            "feed is up to {tilt:.2} deg off the normal of the tool axis (task line {line}): \
             the wall normal is axis x feed"
        )
    })
}

/// Points so near to each other that beta cannot change by a step of its grid between them.
fn density_note(problem: &Problem) -> Option<String> {
    let step = problem.redundancy.beta_step();
    let inner = || problem.task.segments().iter().flat_map(|span| span.clone().skip(1));
    let stuck = inner().filter(|point| problem.beta_step_limit(*point) < step * (1.0 - 1e-9)).count();
    (stuck > 0).then(|| {
        format!(
            "between {stuck} of {} neighbouring points the rate of beta allows less than beta_step_deg: steps of the grid are \
             spread over several points there, or beta is held where that breaks a limit; a finer grid or a thinner path is \
             planned more exactly",
            inner().count()
        )
    })
}

/// A feed that points away from the next point by more than this is suspicious. deg
const FEED_TO_PATH_DEG: f64 = 60.0;

/// The first point whose feed does not point along the path.
fn direction_note(task: &Task) -> Option<String> {
    let points = task.points();
    let off = |point: &usize| {
        let (feed, chord) = (points[point - 1].feed, points[*point].position - points[point - 1].position);
        libm::acos((feed.dot(&chord) / chord.norm()).clamp(-1.0, 1.0)).to_degrees()
    };
    let mut inner = task.segments().iter().flat_map(|span| span.clone().skip(1));
    let first = inner.find(|point| off(point) > FEED_TO_PATH_DEG)?;
    let (from, angle) = (first - 1, off(&first));
    Some(format!("at point {from} the feed is {angle:.0} deg off the way to the next point: check the signs of feed_*"))
}

/// The joints whose speed is not known, where there are some.
fn speed_note(robot: &Robot) -> Option<String> {
    let unknown = robot.joints().iter().zip(1..).filter(|(joint, _)| joint.max_speed.is_none());
    let numbers: Vec<String> = unknown.map(|(_, number): (_, usize)| number.to_string()).collect();
    (!numbers.is_empty()).then(|| {
        format!(
            "the robot file gives no max_speed_deg_per_s for joints {}: their steps along the path are not bounded, \
             and the times of moves between segments are not known",
            numbers.join(", ")
        )
    })
}

#[cfg(test)]
mod tests;
