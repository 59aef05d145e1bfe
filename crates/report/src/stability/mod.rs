//! Reports of a stability analysis: `modes.csv`, `frequency-response.csv` and `.svg`, `lobes.csv` and `.svg`,
//! `summary.json`, `report.html`, and a text for people.

mod json;
pub(crate) mod page;
pub(crate) mod path;
pub(crate) mod tables;
#[cfg(test)]
mod tests;
mod text;

pub use json::{LobeFigures, StabilityFigures, stability_json};
pub use tables::{lobes, modes, responses};
pub use text::stability_text;

use super::output::ReportError;
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use crate::units::Unit;
use stead_runs::SimulationRun;
use stead_simulation::stability_analysis::StabilityAnalysis;

/// Spindle speeds, from rad/s to turns a minute.
pub(super) const RPM: Unit = Unit { factor: 30.0 / std::f64::consts::PI, decimals: 2 };

/// `modes.csv`, `frequency-response.csv`, `lobes.csv`, `summary.json`, `frequency-response.svg`, `lobes.svg` and
/// `report.html`.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn stability_files(run: &SimulationRun, analysis: &StabilityAnalysis) -> Result<Files, ReportError> {
    Ok(named([
        ("modes.csv", modes(analysis)?),
        ("frequency-response.csv", responses(analysis)?),
        ("lobes.csv", lobes(analysis)?),
        ("summary.json", crate::document::bytes(&stability_json(run, analysis))),
        ("frequency-response.svg", picture::charts(&[page::response(analysis)]).into_bytes()),
        ("lobes.svg", picture::charts(&[page::lobes(run, analysis)]).into_bytes()),
        (PAGE, page::page(run, analysis).html()),
    ]))
}
