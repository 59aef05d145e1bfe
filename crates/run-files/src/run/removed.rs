//! The table `[stock]` of a run: forces from what its path removes.

use super::reading::Reading;
use crate::forces::{NamedPath, RemovalTables};
use std::sync::Arc;
use stead_disk::input::{InputError, InputFile, input_file};
use stead_format::document::NamedFile;
use stead_format::place::Place;
use stead_format::task::Imported;
use stead_model::task::lean::Lean;
use stead_model::task::{LeanForces, PointLeanForces, Task, TaskError, ToolPath};
use stead_numerics::message::Note;
use stead_problem::lean::LeanSpace;
use stead_removal::outcome::RemovalForces;
use stead_runs::ReadError;
use stead_runs::forces::ForcesRun;

/// Sections of a cut that are no farther apart are one. Relative
const SAME_SECTION: f64 = 0.2;

/// What a run gets of its stock.
pub(super) struct Removed {
    /// The task with the points that were added, and the force at each.
    pub task: Task,
    /// Files beside that of the task.
    pub inputs: Vec<InputFile>,
    pub notes: Vec<Note>,
    pub removal: Removal,
}

/// What was computed of a stock.
pub(super) struct Removal {
    /// All of it.
    pub forces: Arc<RemovalForces>,
    /// What it was computed of.
    run: ForcesRun,
    /// All that it depends on.
    key: String,
}

/// Values of lead and of tilt to either side of the middle for which forces are computed.
const LEANS: usize = 2;

impl Removal {
    /// The task with the forces of a tool that leans: at every point for five values of lead and of tilt, the stock as
    /// it is before the operation, the tool leaning so all along.
    ///
    /// # Errors
    /// [`ReadError`]: what the computation finds wrong, and a stop.
    pub fn leaning(&self, reading: &Reading<'_>, task: Task, space: &LeanSpace) -> Result<Task, ReadError> {
        let key = format!("{} {space:?}", self.key);
        let wrong = |error: TaskError| self.run.located(&error.into());
        let make = || {
            let half = space.half_counts().map(|half| half.min(LEANS));
            let leans: Vec<Vec<Lean>> = (0..task.points().len()).map(|point| space.grid(point, half)).collect();
            let count = leans.first().map_or(0, Vec::len);
            // Of equal ones the first is computed.
            let way = |number: usize| leans.iter().map(|of_point| of_point[number]).collect::<Vec<Lean>>();
            let mut ways: Vec<Vec<Lean>> = Vec::new();
            let mut places = Vec::with_capacity(count);
            for number in 0..count {
                let way = way(number);
                let known = ways.iter().position(|known| *known == way);
                places.push(known.unwrap_or(ways.len()));
                if known.is_none() {
                    ways.push(way);
                }
            }
            let upright = Task::new(self.forces.path.clone(), self.forces.wrenches()).map_err(wrong)?;
            let paths: Vec<ToolPath> = ways.iter().map(|way| upright.leaned(&space.rule, way).path().clone()).collect();
            let found = self.run.leaning(&self.forces, &paths, reading.monitor)?;
            let of_point = |point: usize| {
                let all = || places.iter().map(|place| &found[*place][point]);
                let tilts = 2 * half[1] + 1;
                PointLeanForces {
                    leads: leans[point].iter().step_by(tilts).map(|lean| lean.lead).collect(),
                    tilts: leans[point].iter().take(tilts).map(|lean| lean.tilt).collect(),
                    wrenches: all().map(|forces| forces.at_feed(1.0)).collect(),
                    edges: Some(all().map(|forces| forces.edge).collect()),
                }
            };
            LeanForces::new((0..task.points().len()).map(of_point).collect()).map_err(wrong)
        };
        let forces = reading.source.sources.made(key, make)?;
        task.with_lean_forces(forces).map_err(wrong)
    }
}

/// Computes the forces of a task, once for all runs of shared sources in which nothing that they depend on differs.
/// The feed of `[redundancy]` is that of a path that states none.
///
/// # Errors
/// [`ReadError`]: forces from two places, what [`RemovalTables::run`] and the computation find wrong, and a stop.
pub(super) fn removed(
    reading: &Reading<'_>,
    tables: &RemovalTables<'_>,
    imported: Imported,
    file: &NamedFile,
) -> Result<Removed, ReadError> {
    let (at, feed) = (&reading.at, reading.redundancy.feed);
    let alone = "force columns in the task, [forces], or [stock], [tool] and [cut]: one of them";
    if imported.wrenches.is_some() {
        let problem = format!("the task {} has force columns already: forces come from one place only", file.name);
        return Err(at.key("stock").error(problem, alone).found_if(None).into());
    }
    if at.key("forces").is_given() {
        let problem = "there is a table [stock] already: forces come from one place only";
        return Err(at.key("forces").error(problem, alone).found_if(None).into());
    }
    // With the feed of the run its task still states none.
    let is_fed = imported.path.feed(0).is_none() && tables.cut.is_none_or(|cut| cut.feed_per_tooth_mm.is_none());
    let path = if is_fed { fed(imported.path, feed, at)? } else { imported.path };
    let named = NamedPath::plain(&file.file, path, input_file("task", &file.name, &file.bytes));
    let run = tables.run(named, reading.source, at)?;
    // Of the cut nothing else counts, such as depths for the stability.
    let cut = tables.cut.map(|cut| (cut.spindle_rpm, cut.feed_per_tooth_mm));
    let others = RemovalTables { reading: tables.reading.clone(), cut: None, is_for_stability: false, ..*tables };
    let key = format!("{others:?} {cut:?} {:?} {feed:?}", run.inputs);
    let outcome = reading.source.sources.made(key.clone(), || run.forces(reading.monitor))?;
    let edges = outcome.points.iter().map(|point| point.edge).collect();
    let cut = outcome.path.clone();
    let task = Task::new(if is_fed { cut.without_feeds() } else { cut }, outcome.wrenches())
        .and_then(|task| task.with_edge_parts(edges))
        .map_err(|e| at.key("stock").error(format!("gives no usable forces: {e}"), "values whose forces are finite"))?;
    let mut notes = run.notes.clone();
    notes.push(
        "the forces are those of what the path removes of [stock], and the task has the points that they add"
            .to_owned()
            .into(),
    );
    notes.extend(section_note(tables, &outcome).map(Note::may_be_wrong));
    notes.extend(outcome.notes.iter().cloned());
    let inputs = run.inputs.iter().skip(1).cloned().collect();
    Ok(Removed { task, inputs, notes, removal: Removal { forces: outcome, run, key } })
}

/// The path with the feed of the run (m/s).
fn fed(path: ToolPath, feed: f64, at: &Place<'_>) -> Result<ToolPath, InputError> {
    let count = path.points().len();
    let at = at.key("redundancy").key("feed_mm_per_s");
    path.with_feeds(vec![feed; count]).map_err(|error| at.error(error.to_string(), "a feed above 0"))
}

/// That the cut which `[cut]` describes for the stability is another than that of the stock, where its section is off
/// by more than a fifth.
fn section_note(tables: &RemovalTables<'_>, outcome: &RemovalForces) -> Option<String> {
    let cut = tables.cut.filter(|_| tables.is_for_stability)?;
    let stated = cut.radial_depth_mm?.si() * cut.axial_depth_mm?.si();
    let largest = outcome.points.iter().map(|point| point.removed).fold(0.0, f64::max);
    let is_like = (largest / stated - 1.0).abs() <= SAME_SECTION;
    (!is_like).then(|| {
        format!(
            "[cut] describes a cut of {:.2} mm2 for [stability], and the path removes up to {:.2} mm2 of [stock]: critical depths are \
             those of the first, deflections those of the second",
            stated * 1e6,
            largest * 1e6
        )
    })
}
