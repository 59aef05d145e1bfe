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

use super::output::{Folder, ReportError};
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use crate::units::Unit;
use std::path::PathBuf;
use stead_runs::SimulationRun;
use stead_simulation::stability_analysis::StabilityAnalysis;

/// Spindle speeds, from rad/s to turns a minute.
pub(super) const RPM: Unit = Unit { factor: 30.0 / std::f64::consts::PI, decimals: 2 };

/// Writes `modes.csv`, `frequency-response.csv`, `lobes.csv`, `summary.json`, `frequency-response.svg`, `lobes.svg` and
/// `report.html`. Returns their paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_stability(
    folder: &Folder,
    run: &SimulationRun,
    analysis: &StabilityAnalysis,
) -> Result<Vec<PathBuf>, ReportError> {
    let files = stability_files(run, analysis)?;
    folder.results("stability", &run.inputs).write(&files)
}

/// The files that [`write_stability`] writes.
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
