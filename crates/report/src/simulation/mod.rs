//! Reports of a simulated pass: `series.csv`, `wall.csv`, `summary.json`, `forces.svg`, `turns.svg`, `wall.svg`,
//! `report.html`, and a text for people.

mod json;
mod page;
pub(crate) mod tables;
mod text;

pub use json::{SimulationFigures, simulation_json, timed_json};
pub use tables::{series, wall};
pub use text::simulation_text;

use super::output::ReportError;
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use stead_runs::SimulationRun;
use stead_simulation::outcome::Simulation;

/// `series.csv`, `wall.csv`, `summary.json`, `forces.svg`, `turns.svg`, `wall.svg` and `report.html`.
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
