//! Reports of a stability analysis: `modes.csv`, `frequency-response.csv` and `.svg`, `lobes.csv` and `.svg`, `summary.json`,
//! `report.html`, and a text for people.

mod json;
pub(crate) mod page;
pub(crate) mod path;
mod tables;
#[cfg(test)]
mod tests;
mod text;

pub use json::stability_json;
pub use tables::{lobes, modes, responses};
pub use text::stability_text;

use super::output::{Folder, ReportError};
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use crate::units::Unit;
use std::path::PathBuf;
use stead_format::SimulationRun;
use stead_simulation::stability_analysis::StabilityAnalysis;

/// Frequencies in Hz.
pub(super) const HERTZ: Unit = Unit { factor: 1.0, decimals: 4 };
/// Shares of the critical damping.
pub(super) const SHARE: Unit = Unit { factor: 1.0, decimals: 6 };
/// Spindle speeds, from rad/s to turns a minute.
pub(super) const RPM: Unit = Unit { factor: 30.0 / std::f64::consts::PI, decimals: 2 };
/// Depths of cut, from m to mm.
pub(super) const DEPTH_MM: Unit = Unit { factor: 1e3, decimals: 5 };
/// Answers to a force, from m/N to um/N.
pub(super) const RESPONSE: Unit = Unit { factor: 1e6, decimals: 6 };
/// Rates of growth in 1/s.
pub(super) const RATE: Unit = Unit { factor: 1.0, decimals: 4 };

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
        ("frequency-response.svg", picture::frequency_response(analysis).into_bytes()),
        ("lobes.svg", picture::lobes(analysis, &run.cut, run.analysis.max_depth).into_bytes()),
        (PAGE, page::page(run, analysis).html()),
    ]))
}
