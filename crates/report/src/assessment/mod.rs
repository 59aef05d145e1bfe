//! What `stead assess` reports.

mod json;
pub(crate) mod map;
mod page;
pub(crate) mod tables;
mod text;

pub use json::{AssessmentFigures, assess_json, summary_json};
pub use text::assessment_text;

use super::output::ReportError;
use super::page::PAGE;
use super::{Files, cutting, document as documents, picture};
use stead_assessment::comparison::{Assessment, Comparison};
use stead_assessment::published::{Agreement, PublishedTables};
use stead_disk::input::InputFile;
use stead_model::cutting::ForceHistory;
use stead_model::published::Published;
use stead_numerics::message::Note;

/// What the reports of an assessment state besides the comparison and its result.
#[derive(Debug, Clone, PartialEq)]
pub struct AssessmentContext {
    /// The files the result depends on.
    pub inputs: Vec<InputFile>,
    /// What the result rests on: assumptions made and values left at their defaults.
    pub notes: Vec<Note>,
    /// Where a range of compliance was replaced by one value of it: how far from its smaller to its larger end.
    pub range_share: Option<f64>,
    /// Published tables to set beside ours, and how far both agree.
    pub published: Option<(Published<PublishedTables>, Agreement)>,
    /// The cutting forces behind the load, where they were computed.
    pub force_history: Option<ForceHistory>,
}

/// Everything that an assessment reports: for each robot `map-ROBOT.csv` and `map-ROBOT.svg`; then
/// `circularity.csv`, `optimal-zones.csv`, `middle-zones.csv`, `accuracy.csv`, `selection.csv` (Klimchik 2017, Tables 5
/// to 9), `indicators.svg` and `summary.json`; and, where forces were computed, `cutting.svg`, `cutting-engagement.csv`
/// and `cutting-turn.csv`; last the page, `report.html`.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn assessment_files(
    comparison: &Comparison,
    assessment: &Assessment,
    context: &AssessmentContext,
) -> Result<Files, ReportError> {
    let mut files = Files::new();
    for (index, robot) in assessment.robots.iter().enumerate() {
        let name = format!("map-{}", file_name(assessment, index));
        files.push((format!("{name}.csv"), tables::map(robot)?));
        files.push((format!("{name}.svg"), map::picture(comparison, robot).into_bytes()));
    }
    let published = context.published.as_ref().map(|(published, _)| &published.figures);
    let mut add = |name: &str, bytes: Vec<u8>| files.push((name.to_owned(), bytes));
    add("circularity.csv", tables::circularity(assessment, published)?);
    add("optimal-zones.csv", tables::optimal_zones(assessment, published)?);
    add("middle-zones.csv", tables::middle_zones(assessment, published)?);
    add("accuracy.csv", tables::accuracy(assessment, published)?);
    add("selection.csv", tables::selection(assessment, published)?);
    add("indicators.svg", picture::indicators(assessment).into_bytes());
    add("summary.json", documents::bytes(&summary_json(comparison, assessment, context)));
    if let Some(force_history) = &context.force_history {
        add("cutting.svg", picture::charts(&cutting::charts(force_history)).into_bytes());
        add("cutting-engagement.csv", cutting::entering(force_history)?);
        add("cutting-turn.csv", cutting::turn(force_history)?);
    }
    add(PAGE, page::page(comparison, assessment, context).html());
    Ok(files)
}

/// Longest piece of a robot's name in a file name.
const MAX_NAME_LENGTH: usize = 80;

/// The name of a robot as part of a file name: small letters, digits and hyphens, and its number where an earlier robot
/// has the same.
fn file_name(assessment: &Assessment, index: usize) -> String {
    let plain = |index: usize| {
        let name = assessment.robots[index].name.to_lowercase();
        let words = name.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join("-").chars().take(MAX_NAME_LENGTH).collect::<String>()
    };
    let name = plain(index);
    let taken = name.is_empty() || (0..index).any(|earlier| plain(earlier) == name);
    if taken { format!("{name}-{}", index + 1).trim_start_matches('-').to_owned() } else { name }
}

#[cfg(test)]
mod tests;
