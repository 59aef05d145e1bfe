//! Reports of `stead identify plan`: the sheet to be filled in, what it will tell, the picture, the table for people.

mod json;
pub(crate) mod tables;
mod text;

pub use json::{PlanFigures, plan_json};
pub use text::plan_text;

use super::super::document as documents;
use super::super::output::{Folder, ReportError};
use super::super::{Files, named, picture};
use std::path::{Path, PathBuf};
use stead_calibration::identification::design::Design;
use stead_calibration::identification::sheet::COLUMNS;
use stead_disk::files;
use stead_disk::input::InputError;
use stead_runs::PlanRun;

/// The name of the sheet among the files of a plan.
pub const SHEET: &str = "sheet.csv";

/// Writes `sheet.csv`, `plan.json`, `expected.csv` and `plan.svg` into a folder and returns their paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_plan(folder: &Folder, run: &PlanRun, plan: &Design) -> Result<Vec<PathBuf>, ReportError> {
    let files = plan_files(run, plan)?;
    folder.results("identify plan", &run.inputs).with_form(SHEET).write(&files)
}

/// The files that [`write_plan`] writes.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn plan_files(run: &PlanRun, plan: &Design) -> Result<Files, ReportError> {
    Ok(named([
        (SHEET, plan.sheet.form().into_bytes()),
        ("plan.json", documents::bytes(&plan_json(run, plan))),
        ("expected.csv", tables::expected(run.request.model, plan)?),
        ("plan.svg", picture::measurement_plan(&run.request, plan).into_bytes()),
    ]))
}

/// Whether a file is a sheet into which no reading has been filled yet, so that nothing is lost with it.
fn is_form(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let mut lines = text.lines();
    // The places that are read are the last six columns.
    let is_open = |line: &str| line.trim().is_empty() || line.rsplit(',').take(6).all(|field| field.trim().is_empty());
    lines.next() == Some(COLUMNS) && lines.all(is_open)
}

/// Refuses to overwrite a sheet into which readings have been filled.
///
/// # Errors
/// [`InputError`] that names the sheet.
pub fn keep_readings(folder: &Path) -> Result<(), InputError> {
    let sheet = folder.join(SHEET);
    match files::read(&sheet) {
        Ok(bytes) if !is_form(&bytes) => {
            Err(InputError::new(&sheet, "is a sheet with readings in it, which a new plan would overwrite")
                .allowed("another folder (--out), or no sheet.csv but an empty one there"))
        }
        _ => Ok(()),
    }
}
