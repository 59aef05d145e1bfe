//! Reports of a simulated pass: `series.csv`, `wall.csv`, `summary.json`, `forces.svg`, `turns.svg`, `wall.svg`,
//! `report.html`, and a text for people.

mod json;
mod page;
pub(crate) mod tables;
mod text;

pub use json::{SimulationFigures, simulation_json, timed_json};
pub use tables::{series, wall};
pub use text::simulation_text;

use super::output::{Folder, ReportError};
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use std::path::PathBuf;
use stead_runs::SimulationRun;
use stead_simulation::coupled::End;
use stead_simulation::outcome::Simulation;

/// Writes `series.csv`, `wall.csv`, `summary.json`, `forces.svg`, `turns.svg`, `wall.svg` and `report.html`. Returns
/// their paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_simulation(folder: &Folder, run: &SimulationRun, found: &Simulation) -> Result<Vec<PathBuf>, ReportError> {
    let files = simulation_files(run, found)?;
    folder.results("simulate", &run.inputs).write(&files)
}

/// The files that [`write_simulation`] writes.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn simulation_files(run: &SimulationRun, found: &Simulation) -> Result<Files, ReportError> {
    Ok(named([
        ("series.csv", series(found)?),
        ("wall.csv", wall(found)?),
        ("summary.json", crate::document::bytes(&simulation_json(run, found))),
        ("forces.svg", picture::charts(&[page::forces(found)]).into_bytes()),
        ("turns.svg", picture::charts(&[page::turns(found, run.cut.spindle_speed)]).into_bytes()),
        ("wall.svg", picture::charts(&page::walls(found)).into_bytes()),
        (PAGE, page::page(run, found).html()),
    ]))
}

/// The word for how a run ended, and the reason if it ended early.
pub(super) fn end_words(end: &End) -> (&'static str, Option<String>) {
    match end {
        End::Complete => ("complete", None),
        End::Limit(limit) => ("limit", Some(limit.to_string())),
        End::Step(error) => ("step", Some(error.to_string())),
    }
}
