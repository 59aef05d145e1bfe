//! Reports of `stead study report`: what it prints, and `study-ranking.csv`, `study-front.csv`, `study-effects.csv`,
//! `study-report.json`, pictures, and `report.html`.

mod json;
mod page;
mod status;
pub(crate) mod tables;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
mod text;
mod words;

pub use json::{StudyFigures, study_json};
pub use page::CasePages;
pub use status::{StatusFigures, status_json};
pub use tables::{effects_table, front_table, ranking_table};
pub use text::study_text;

use crate::document::bytes;
use crate::output::{Folder, ReportError};
use crate::page::PAGE;
use crate::picture;
use crate::{Files, named};
use std::path::PathBuf;
use stead_disk::input::InputFile;
use stead_study::analysis::{Analysis, Layout};

/// Writes the files of a report into the folder of its study and returns their paths; the page leads to the pages of
/// kept cases. A front of nothing, a map of a single axis and effects of no axis have no files.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_study(
    folder: &Folder,
    name: &str,
    analysis: &Analysis,
    inputs: &[InputFile],
    pages: &CasePages,
) -> Result<Vec<PathBuf>, ReportError> {
    folder.results("study report", inputs).write(&study_files(name, analysis, inputs, pages)?)
}

/// The files that [`write_study`] writes.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn study_files(
    name: &str,
    analysis: &Analysis,
    inputs: &[InputFile],
    pages: &CasePages,
) -> Result<Files, ReportError> {
    let layouts = &analysis.layouts;
    let mut files = vec![("study-ranking.csv", ranking_table(analysis)?)];
    if let Some(front) = analysis.front.as_ref().filter(|front| !front.members.is_empty()) {
        files.push(("study-front.csv", front_table(front, layouts)?));
        files.push(("study-front.svg", picture::study_front(front, layouts).into_bytes()));
    }
    if !analysis.effects.axes.is_empty() {
        files.push(("study-effects.csv", effects_table(&analysis.effects)?));
        files.push(("study-effects.svg", picture::study_effects(&analysis.effects, layouts).into_bytes()));
    }
    if let Some(map) = &analysis.map {
        files.push(("study-map.svg", picture::study_map(map).into_bytes()));
    }
    files.push(("study-report.json", bytes(&study_json(name, analysis, inputs))));
    files.push((PAGE, page::page(name, analysis, inputs, pages).html()));
    Ok(named(files))
}

/// The numbers of the cases of a layout.
fn cases(layout: &Layout) -> String {
    layout.cases.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// A number with the nine digits that are more than rounding.
fn number(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(f64::NAN)
}

/// A share in per cent.
fn percent(share: f64) -> f64 {
    number(100.0 * share)
}
