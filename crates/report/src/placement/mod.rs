//! Reports of `stead place`, and in [`evaluation`] those of single evaluations, `stead score` and `stead explain`.

mod case;
pub(crate) mod context;
pub mod evaluation;
mod json;
mod origins;
pub(crate) mod plan_row;
mod settings;
pub(crate) mod setup;
mod sheet;
mod summary;
pub mod tables;
#[cfg(test)]
mod tests;
mod text;

pub use context::{CaseOfStudy, Context};
pub use json::{PlaceFigures, SummaryFigures, place_json, summary_json};
pub use summary::{Summary, SummaryLine, placement_summary, score_summary, summary_line, summary_text};
pub use text::placement_text;

use crate::document::bytes;
use crate::output::{Folder, ReportError};
use crate::page;
use crate::page::content::{LEAN_MAP, SETUP_SHEET};
use crate::page::data::{MapOf, Placed, page_data};
use crate::{Files, named, picture};
use std::path::PathBuf;
use stead_placement::outcome::{Case, Cases, Outcome};
use stead_placement::place::Score;
use stead_placement::setup_sheet::SetupSheet;
use stead_planning::feasibility::DeflectionMap;
use stead_problem::problem::Problem;
use stead_problem::sense::BySense;

impl Context {
    /// The files with a page of them, where one is wanted.
    fn with_page(
        &self,
        mut files: Files,
        command: &str,
        problem: &Problem,
        plans: &[&Case],
        maps: &[MapOf<'_>],
    ) -> Result<Files, ReportError> {
        if self.page {
            let data = page_data(self, command, problem, plans, maps);
            files.push((page::DATA.to_owned(), bytes(&data)));
            page::put_page(&mut files)?;
        }
        Ok(files)
    }
}

/// Where a case has the workpiece.
fn placed(case: &Case) -> Placed<'_> {
    (&case.placement, &case.setup)
}

/// The command under which the manifest lists the files of a placement job and of its certificate.
pub(crate) const PLACE: &str = "place";
/// The command under which it lists those of a given placement.
const SCORE: &str = "score";
/// The file by which a certificate knows the run that it is about.
pub(crate) const SUMMARY: &str = "summary.json";

/// The files of the maps at the best and at the worst placement.
const MAPS: [[&str; 2]; 2] =
    [["deflection-map-best.csv", "deflection-map-best.svg"], ["deflection-map-worst.csv", "deflection-map-worst.svg"]];

/// What these placements are called.
const PLACES: [&str; 2] = ["the best placement", "the worst placement"];

/// The files of the map at a given placement.
const SCORE_MAP: [&str; 2] = ["deflection-map.csv", "deflection-map.svg"];

/// The files that are there where the worst placement was looked for.
const OF_WORST: [&str; 3] = ["worst.csv", "worst-worst-plan.csv", "stability-worst.csv"];

/// The setup sheet of a case, where it was made.
fn setup_sheet(
    problem: &Problem,
    case: &Case,
    sheet: Option<&SetupSheet>,
    context: &Context,
) -> Option<(&'static str, Vec<u8>)> {
    let said = summary::rest(context);
    let title = picture::SheetTitle { inputs: &context.inputs, seed: context.search.seed, said: &said };
    Some((SETUP_SHEET, picture::setup_sheet(problem, case, sheet?, &title).into_bytes()))
}

/// Tables, warnings and notes of a result.
pub const NOTES: &str = "notes.txt";

/// The picture of the shapes of the cell.
const SURROUNDINGS: &str = "surroundings.svg";

/// That picture, where the run has shapes.
fn surroundings(problem: &Problem, cases: &[(&Case, &str)]) -> Option<(&'static str, Vec<u8>)> {
    Some((SURROUNDINGS, picture::surroundings(problem, cases)?.into_bytes()))
}

/// Table and picture of a map with the best and the worst plan, under these names.
fn map_files(
    problem: &Problem,
    map: &DeflectionMap,
    plans: [&Case; 2],
    names: [&'static str; 2],
    place: &str,
) -> Result<[(&'static str, Vec<u8>); 2], ReportError> {
    let svg = picture::deflection_map(problem, map, plans, place);
    let at = (&*problem.in_setup(&plans[0].setup), &plans[0].placement);
    Ok([(names[0], tables::deflection_map(at, map)?), (names[1], svg.into_bytes())])
}

/// Writes everything that `stead score --out` reports into a folder: `best-plan.csv`, `worst-plan.csv`, `score.json`,
/// `notes.txt`, `placement.svg`, the setup sheet `setup.svg` where it was made, with shapes of the cell
/// `surroundings.svg`, with the map of the placement `deflection-map.csv` and `deflection-map.svg`, with that over lead
/// and tilt `lean-map.csv`, and where stability was requested `stability-best-plan.csv`, `stability-worst-plan.csv` and
/// `stability.svg`; unless the run does without, `page-data.json`, `report.html` and `cell.glb`. Returns the paths.
///
/// # Errors
/// As [`write_placement`].
pub fn write_score(
    folder: &Folder,
    problem: &Problem,
    score: &Score,
    map: Option<&DeflectionMap>,
    context: &Context,
) -> Result<Vec<PathBuf>, ReportError> {
    let files = score_files(problem, score, map, context)?;
    let beside = folder.beside_finished(SCORE, score.interrupted)?;
    let folder = beside.as_ref().unwrap_or(folder);
    let outdated = if map.is_none() { &SCORE_MAP[..] } else { &[] };
    let outdated = outdated.iter().copied().chain(score.lean_map.is_none().then_some(LEAN_MAP));
    let outdated = outdated.chain(problem.scene.is_none().then_some(SURROUNDINGS));
    let outdated = outdated.chain(score.sheet.is_none().then_some(SETUP_SHEET));
    folder.results(SCORE, &context.inputs).interrupted(score.interrupted).without(outdated).write(&files)
}

/// The files that [`write_score`] writes.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn score_files(
    problem: &Problem,
    score: &Score,
    map: Option<&DeflectionMap>,
    context: &Context,
) -> Result<Files, ReportError> {
    let BySense { best, worst } = score.cases();
    let scene = problem.scene.as_deref();
    let summary = score_summary(problem, score, context);
    let said = summary::notes_text(&summary, &evaluation::score_text(problem, score, context), context);
    let mut files = vec![
        ("best-plan.csv", tables::plan(&best.plan, scene)?),
        ("worst-plan.csv", tables::plan(&worst.plan, scene)?),
        ("score.json", bytes(&evaluation::score_json(problem, score, context))),
        (NOTES, said.into_bytes()),
        ("placement.svg", picture::cell_with(problem, &best).into_bytes()),
    ];
    files.extend(setup_sheet(problem, &best, score.sheet.as_ref(), context));
    files.extend(surroundings(problem, &[(&best, "this placement")]));
    if let Some(map) = map {
        files.extend(map_files(problem, map, [&best, &worst], SCORE_MAP, "this placement")?);
    }
    if let Some(map) = &score.lean_map {
        files.push((LEAN_MAP, tables::lean_map(problem, map)?));
    }
    if let Some(stability) = &context.stability {
        let (tables, names) = (["stability-best-plan.csv", "stability-worst-plan.csv"], ["best plan", "worst plan"]);
        files.extend(crate::stability::path::files(
            stability,
            &[&score.plans.best, &score.plans.worst],
            tables,
            names,
        )?);
    }
    let placed: Placed<'_> = (&score.placement, &score.setup);
    let maps: Vec<MapOf<'_>> = map.iter().map(|map| (placed, *map, SCORE_MAP[0])).collect();
    context.with_page(named(files), SCORE, problem, &[&best, &worst], &maps)
}

/// Writes everything that the placement job reports into a folder: `best.csv`, `best-worst-plan.csv`, `worst.csv`,
/// `worst-worst-plan.csv` (cases 1 to 4; without the worst placement those of it are left out), `placements.csv`,
/// `convergence.csv`, `deflection-map-best.csv`, `deflection-map-worst.csv`, `transfers.csv`, `refinements.csv`,
/// `summary.json`, `notes.txt`, `convergence.svg`, `deflection-map-best.svg`, `deflection-map-worst.svg` and
/// `cell.svg`, where the tool may lean `lean-map.csv`, the setup sheet `setup.svg` where it was made, with shapes of
/// the cell `surroundings.svg`; and where stability was requested, `stability-best.csv`, `stability-worst.csv` (cases 1
/// and 3) and `stability.svg`; unless the run does without, `page-data.json`, `report.html` and `cell.glb`. Where there
/// are no maps, those of an earlier run are removed. Returns the paths of the files written.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_placement(
    folder: &Folder,
    problem: &Problem,
    outcome: &Outcome,
    context: &Context,
) -> Result<Vec<PathBuf>, ReportError> {
    let files = placement_files(problem, outcome, context)?;
    let beside = folder.beside_finished(PLACE, outcome.interrupted)?;
    let folder = beside.as_ref().unwrap_or(folder);
    let made = outcome.maps.as_ref().map_or(0, Vec::len);
    let outdated = MAPS.into_iter().skip(made).flatten().chain(outcome.lean_map.is_none().then_some(LEAN_MAP));
    let outdated = outdated.chain(outcome.cases.worst.is_none().then_some(OF_WORST).into_iter().flatten());
    let outdated = outdated.chain(problem.scene.is_none().then_some(SURROUNDINGS));
    let outdated = outdated.chain(outcome.sheet.is_none().then_some(SETUP_SHEET));
    folder.results(PLACE, &context.inputs).interrupted(outcome.interrupted).without(outdated).write(&files)
}

/// The files that [`write_placement`] writes.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn placement_files(problem: &Problem, outcome: &Outcome, context: &Context) -> Result<Files, ReportError> {
    let Cases { best, best_worst_plan, worst } = &outcome.cases;
    let document = summary_json(problem, outcome, context);
    let scene = problem.scene.as_deref();
    let mut files = vec![
        ("best.csv", tables::plan(&best.plan, scene)?),
        ("best-worst-plan.csv", tables::plan(&best_worst_plan.plan, scene)?),
        ("placements.csv", tables::placements(&outcome.cases, context.reference.as_ref())?),
        ("convergence.csv", tables::convergence(&outcome.convergence)?),
        ("transfers.csv", tables::transfers(&outcome.cases, scene)?),
        ("refinements.csv", tables::refinements(&outcome.refinements)?),
        (SUMMARY, bytes(&document)),
        (NOTES, summary::placement_notes(problem, outcome, context).into_bytes()),
        ("convergence.svg", picture::convergence(outcome).into_bytes()),
        ("cell.svg", picture::cell(problem, outcome).into_bytes()),
    ];
    if let Some(BySense { best: worst, worst: worst_worst_plan }) = worst {
        files.push(("worst.csv", tables::plan(&worst.plan, scene)?));
        files.push(("worst-worst-plan.csv", tables::plan(&worst_worst_plan.plan, scene)?));
    }
    files.extend(setup_sheet(problem, best, outcome.sheet.as_ref(), context));
    let optima = outcome.cases.optima();
    let shown: Vec<_> = optima.iter().copied().zip(PLACES).collect();
    files.extend(surroundings(problem, &shown));
    if let Some(stability) = &context.stability {
        let (tables, names) = (["stability-best.csv", "stability-worst.csv"], ["best placement", "worst placement"]);
        let plans: Vec<_> = optima.iter().map(|case| &case.plan).collect();
        files.extend(crate::stability::path::files(stability, &plans, tables, names)?);
    }
    let plans = [[best, best_worst_plan]].into_iter().chain(worst.iter().map(BySense::values));
    let mut maps = Vec::new();
    for ((map, plans), (names, place)) in outcome.maps.iter().flatten().zip(plans).zip(MAPS.into_iter().zip(PLACES)) {
        files.extend(map_files(problem, map, plans, names, place)?);
        maps.push((placed(plans[0]), map, names[0]));
    }
    if let Some(map) = &outcome.lean_map {
        files.push((LEAN_MAP, tables::lean_map(problem, map)?));
    }
    context.with_page(named(files), PLACE, problem, &outcome.cases.all(), &maps)
}
