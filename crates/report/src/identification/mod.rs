//! Reports of `stead identify fit`, and in [`plan`] those of `stead identify plan`: the robot file, the report for
//! programs, tables, the picture, the table for people.

mod json;
mod page;
pub mod plan;
mod robot_file;
pub(crate) mod tables;
#[cfg(test)]
mod tests;
mod text;

pub use json::{IdentificationFigures, identify_json};
pub use robot_file::robot_file;
pub use text::identify_text;

use super::document as documents;
use super::output::ReportError;
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use stead_calibration::identification::Identified;
use stead_runs::IdentifyRun;

/// `robot-identified.toml`, `report.json`, `compliances.csv`, `residuals.csv`, `deflections.svg` and `report.html`.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn identified_files(run: &IdentifyRun, found: &Identified) -> Result<Files, ReportError> {
    Ok(named([
        ("robot-identified.toml", robot_file(&run.robot_text, found)?.into_bytes()),
        ("report.json", documents::bytes(&identify_json(run, found))),
        ("compliances.csv", tables::compliances(found)?),
        ("residuals.csv", tables::residuals(run, found)?),
        (
            "deflections.svg",
            picture::charts(&[page::agreement(run, found), page::residuals_chart(run, found)]).into_bytes(),
        ),
        (PAGE, page::page(run, found).html()),
    ]))
}
