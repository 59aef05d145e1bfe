//! The table `[stock]` of a run: forces from what its path removes.

use crate::forces::{NamedPath, RemovalTables};
use stead_format::document::NamedFile;
use stead_format::input::{InputError, InputFile, input_file};
use stead_format::place::Place;
use stead_format::task::Imported;
use stead_format::toml_file::TomlFile;
use stead_model::task::{Task, ToolPath};
use stead_numerics::monitor::Monitor;
use stead_removal::forces::forces;

/// What a run gets of its stock.
pub(super) struct Removed {
    /// The task with the points that were added, and the force at each.
    pub task: Task,
    /// Files beside that of the task.
    pub inputs: Vec<InputFile>,
    pub notes: Vec<String>,
}

/// Computes the forces of a task, once for all runs of shared sources in which nothing that they depend on differs.
/// `feed` (m/s) is that of a path that states none.
///
/// # Errors
/// [`InputError`]: forces from two places, and those of [`RemovalTables::run`] and of the computation.
pub(super) fn removed(
    tables: &RemovalTables<'_>,
    imported: Imported,
    file: &NamedFile,
    feed: f64,
    source: &TomlFile,
    at: &Place<'_>,
) -> Result<Removed, InputError> {
    let alone = "force columns in the task, [forces], or [stock], [tool] and [cut]: one of them";
    if imported.wrenches.is_some() {
        let problem = format!("forces come from one place only, and the task {} has force columns", file.name);
        return Err(at.key("stock").error(problem, alone).found_if(None));
    }
    if at.key("forces").is_given() {
        let problem = "forces come from one place only, and there is a table [stock]";
        return Err(at.key("forces").error(problem, alone).found_if(None));
    }
    let path = NamedPath {
        file: file.file.clone(),
        path: fed(imported.path, feed, tables, at)?,
        rapids: Vec::new(),
        spindle_speed: None,
        tool: None,
        notes: Vec::new(),
        input: input_file("task", &file.name, &file.bytes),
    };
    let run = tables.run(path, source, at)?;
    // Of the cut nothing else counts, such as depths for the stability.
    let cut = tables.cut.map(|cut| (cut.spindle_rpm, cut.feed_per_tooth_mm));
    let others = RemovalTables { cut: None, is_for_stability: false, ..*tables };
    let key = format!("{others:?} {cut:?} {:?} {feed:?}", run.inputs);
    let made = source.sources.made(key, || forces(&run.problem, &Monitor::silent()));
    let outcome = made.map_err(|error| {
        let stopped = || at.key("stock").error(error.to_string(), "a run that is not stopped").found_if(None);
        run.located(&error).unwrap_or_else(stopped)
    })?;
    let task = Task::new(outcome.path.clone(), outcome.wrenches())
        .map_err(|e| at.key("stock").error(format!("gives no usable forces: {e}"), "values whose forces are finite"))?;
    let mut notes = run.notes;
    notes.push(
        "the forces are those of what the path removes of [stock], and the task has the points that they add"
            .to_owned(),
    );
    notes.extend(outcome.notes.iter().cloned());
    notes.extend(outcome.warnings.iter().map(|warning| format!("forces of the path: {warning}")));
    Ok(Removed { task, inputs: run.inputs.into_iter().skip(1).collect(), notes })
}

/// The path with the feed of the run, where it states none and no feed per tooth is given.
fn fed(path: ToolPath, feed: f64, tables: &RemovalTables<'_>, at: &Place<'_>) -> Result<ToolPath, InputError> {
    if path.feed(0).is_some() || tables.cut.is_some_and(|cut| cut.feed_per_tooth_mm.is_some()) {
        return Ok(path);
    }
    let count = path.points().len();
    let at = at.key("redundancy").key("feed_mm_per_s");
    path.with_feeds(vec![feed; count]).map_err(|error| at.error(error.to_string(), "a feed above 0"))
}
