//! Reports of `stead study report`: what it prints, and `study-ranking.csv`, `study-front.csv`, `study-effects.csv`,
//! `study-report.json`, pictures, and `report.html`.

mod charts;
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

pub use charts::CasePages;
pub use json::{StudyFigures, study_json};
pub use status::{StatusFigures, status_json};
pub use tables::{effects_table, front_table, ranking_table};
pub use text::study_text;

use crate::document::bytes;
use crate::output::ReportError;
use crate::page::PAGE;
use crate::picture;
use crate::{Files, named};
use stead_disk::input::InputFile;
use stead_study::analysis::Analysis;

/// The files of a report; the page leads to the pages of kept cases. A front of nothing, a map of a
/// single axis and effects of no axis have no files.
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
        files.push(("study-front.svg", picture::charts(&charts::fronts_drawn(front, layouts)).into_bytes()));
    }
    if !analysis.effects.axes.is_empty() {
        files.push(("study-effects.csv", effects_table(&analysis.effects)?));
        files.push((
            "study-effects.svg",
            picture::charts(&charts::effects_drawn(&analysis.effects, layouts)).into_bytes(),
        ));
    }
    if let Some(map) = &analysis.map {
        files.push(("study-map.svg", charts::map_drawn(map).into_bytes()));
    }
    files.push(("study-report.json", bytes(&study_json(name, analysis, inputs))));
    files.push((PAGE, page::page(name, analysis, inputs, pages).html()));
    Ok(named(files))
}
