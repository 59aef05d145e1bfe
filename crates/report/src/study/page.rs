//! `report.html` of a study.

use super::charts::{CasePages, effect_chart, front_chart, layout_words, map_chart, path, with_unit};
use super::words::{cases, heading, percent, value, words};
use crate::page::cards::{Cell, Column, Page, Table, Text, Tile};
use crate::units::figures;
use stead_disk::input::InputFile;
use stead_problem::criterion::SMALL_PART;
use stead_study::analysis::{Analysis, Layout, Layouts, Ranked};

/// The column of the whole deflection.
const WHOLE: &str = "best_mean_total_mm";

/// The ranking of all layouts, the front, the effects of the axes, the map, and what failed.
pub(super) fn page(name: &str, analysis: &Analysis, inputs: &[InputFile], pages: &CasePages) -> Page {
    let failures = &analysis.failures;
    let (placed, none): (_, [&str; 0]) = (failures.cases - failures.count(), []);
    let subtitle = format!("study · {} cases, {placed} placed", failures.cases);
    let measure = &analysis.ranking.measure;
    let lead = match analysis.ranking.ranked.first() {
        Some(best) => {
            let layout = &analysis.layouts.all[best.layout];
            let (what, unit) = words(&measure.name);
            let (unit, axes) = (with_unit(unit), layout_words(&analysis.layouts, layout));
            format!("Best by {what}: {}{unit}{}{axes}.", figures(best.value), if axes.is_empty() { "" } else { ", " })
        }
        None => format!("No case has a value of {}.", words(&measure.name).0),
    };
    let lead = if analysis.notes.is_empty() { lead } else { format!("{lead} {}.", analysis.notes.join(". ")) };
    let notes: Vec<String> = analysis.notes.iter().map(ToString::to_string).chain(cancelling(analysis)).collect();
    let fronts = analysis.front.iter().flat_map(|front| {
        (1..front.measures.len()).map(move |other| front_chart(front, &analysis.layouts, other, pages))
    });
    let effects = analysis.effects.axes.iter().filter(|axis| !axis.levels.is_empty());
    let reasons =
        failures.reasons.iter().map(|(reason, count, first)| format!("{count} cases, the first {first}: {reason}"));
    Page::new(name, subtitle, lead, inputs)
        .messages(&none, &notes)
        .with(tiles(analysis))
        .with(ranking(analysis, pages))
        .with_all(fronts)
        .with_all(analysis.map.as_ref().map(map_chart))
        .with_all(effects.map(|axis| effect_chart(axis, &analysis.effects.measure)))
        .with_all(Text::of("Cases without a placement", reasons.collect(), true))
}

/// The mean of the whole deflection of a layout.
fn whole(layouts: &Layouts, layout: usize) -> Option<f64> {
    let column = layouts.columns.iter().position(|column| column.name == WHOLE)?;
    layouts.all[layout].row[column].as_number()
}

/// A note on scores that are small beside the whole deflection.
fn cancelling(analysis: &Analysis) -> Option<String> {
    let ranking = &analysis.ranking;
    let share = |layout: usize| Some(SMALL_PART * whole(&analysis.layouts, layout)?);
    let is_small = |ranked: &&Ranked| share(ranked.layout).is_some_and(|share| ranked.value < share);
    let small = ranking.ranked.iter().filter(is_small).count();
    (ranking.measure.name == "objective_mm" && small > 0).then(|| {
        format!(
            "the score of {small} of {} layouts is below a fifth of their whole deflection: parts of different sign \
             cancel in it, and small errors of the force undo that; the whole deflection is beside the score, and \
             --by {WHOLE} ranks by it",
            ranking.ranked.len()
        )
    })
}

fn tiles(analysis: &Analysis) -> Vec<Tile> {
    let (ranking, failures) = (&analysis.ranking, &analysis.failures);
    let (name, unit) = words(&ranking.measure.name);
    let mut tiles = Vec::new();
    if let [first, .., last] = &ranking.ranked[..] {
        let behind =
            last.behind.map_or_else(String::new, |behind| format!("{} % behind the best", figures(percent(behind))));
        tiles.push(Tile::new("best", figures(first.value), unit, name));
        tiles.push(Tile::new("worst", figures(last.value), unit, behind));
    }
    let ties = ranking.best().len().saturating_sub(1);
    let valued = format!("{} with a value", ranking.ranked.len());
    let noise = format!("within {} %", figures(percent(analysis.noise)));
    let lost = format!("{} infeasible, {} failed", failures.infeasible, failures.failed);
    tiles.extend([
        Tile::new("layouts", analysis.layouts.all.len().to_string(), "", valued),
        Tile::new("ties with the best", ties.to_string(), "", noise),
        Tile::new("without a placement", failures.count().to_string(), "cases", lost),
    ]);
    tiles
}

/// The numbers of the cases of a layout, leading to their page.
fn cases_cell(layout: &Layout, pages: &CasePages) -> Cell {
    let text = cases(layout);
    match path(layout, pages) {
        Some(path) => Cell::Link { text, path: path.clone() },
        None => Cell::Number(text),
    }
}

fn ranking(analysis: &Analysis, pages: &CasePages) -> Table {
    let (layouts, ranking) = (&analysis.layouts, &analysis.ranking);
    let axes = layouts.varied();
    let is_number = |axis: usize| {
        let mut written = layouts.all.iter().map(|layout| layout.row[axis].written());
        written.all(|text| text.is_empty() || text.parse::<f64>().is_ok())
    };
    let is_single = layouts.all.iter().all(|layout| layout.cases.len() == 1);
    let mut columns = vec![Column::number("rank"), Column { name: "case".to_owned(), is_number: is_single }];
    columns.extend(
        axes.iter().map(|axis| Column { name: heading(&layouts.columns[*axis].name), is_number: is_number(*axis) }),
    );
    let is_known = |layout| whole(layouts, layout).is_some();
    let has_whole = ranking.measure.name != WHOLE && (0..layouts.all.len()).any(is_known);
    columns.push(Column::number(heading(&ranking.measure.name)));
    columns.extend(has_whole.then(|| Column::number(heading(WHOLE))));
    columns.push(Column::number("behind the best (%)"));
    columns.extend(["status", "reason"].map(Column::text));
    let row = |index: usize, rank: Cell, [score, behind]: [Cell; 2]| {
        let layout = &layouts.all[index];
        let values = axes.iter().map(|axis| Cell::Text(value(&layout.row[*axis].written())));
        let whole = has_whole.then(|| Cell::optional(whole(layouts, index).map(figures)));
        let found = std::iter::once(score).chain(whole).chain([behind]);
        let status = layouts.status(layout).map(Cell::Text);
        [rank, cases_cell(layout, pages)].into_iter().chain(values).chain(found).chain(status).collect()
    };
    let ranked = ranking.ranked.iter().map(|ranked| {
        let behind = Cell::optional(ranked.behind.map(|behind| figures(percent(behind))));
        row(ranked.layout, Cell::Number(ranked.rank.to_string()), [Cell::Number(figures(ranked.value)), behind])
    });
    let without = ranking.without.iter().map(|layout| row(*layout, Cell::Empty, [Cell::Empty, Cell::Empty]));
    Table::new("Ranking", columns, ranked.chain(without).collect())
        .detailed(if pages.is_empty() { "" } else { "a case leads to its own page" })
        .filtered()
}
