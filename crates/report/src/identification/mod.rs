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
use super::output::{Folder, ReportError};
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use std::path::PathBuf;
use stead_calibration::identification::Identified;
use stead_calibration::identification::law::{ArmParameter, Quantity};
use stead_runs::IdentifyRun;

/// Writes `robot-identified.toml`, `report.json`, `compliances.csv`, `residuals.csv`, `deflections.svg` and
/// `report.html` into a folder and returns their paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_identified(folder: &Folder, run: &IdentifyRun, found: &Identified) -> Result<Vec<PathBuf>, ReportError> {
    let files = identified_files(run, found)?;
    folder.results("identify fit", &run.inputs).write(&files)
}

/// The files that [`write_identified`] writes.
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

/// The key of a robot file for a number of the arm, and what a number in SI is multiplied by to stand there.
fn key(parameter: &ArmParameter) -> (String, f64) {
    let number = parameter.joint + 1;
    match parameter.quantity {
        Quantity::Compliance => (format!("joints[{number}].compliance_urad_per_nm"), 1e6),
        Quantity::SpringStiffness => (format!("joints[{number}].compensator.spring_stiffness_n_per_mm"), 1e-3),
        Quantity::FreeLength => (format!("joints[{number}].compensator.free_length_mm"), 1e3),
        Quantity::AboutX => (format!("joints[{number}].orthogonal_compliance_urad_per_nm[1]"), 1e6),
        Quantity::AboutY => (format!("joints[{number}].orthogonal_compliance_urad_per_nm[2]"), 1e6),
    }
}

/// Its unit there.
fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Compliance | Quantity::AboutX | Quantity::AboutY => "urad/(N m)",
        Quantity::SpringStiffness => "N/mm",
        Quantity::FreeLength => "mm",
    }
}

/// Compliances, from rad/(N m) to urad/(N m).
const URAD: f64 = 1e6;

/// A number with so many significant digits, as a number.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}
