//! `report.html` of a study.

use super::words::{heading, value, words};
use super::{cases, number, percent};
use crate::page::cards::{Axis, Card, Cell, Chart, Column, HeatMap, Page, Series, Style, Table, Text, Tile, Tiles};
use crate::units::figures;
use std::collections::BTreeMap;
use stead_disk::input::InputFile;
use stead_problem::criterion::SMALL_PART;
use stead_problem::sense::Sense;
use stead_study::analysis::{Analysis, AxisEffect, Front, Layout, Layouts, Map, Measure, Ranked};
use stead_study::cases::TableCell;

/// The column of the whole deflection.
const WHOLE: &str = "best_mean_total_mm";

/// The pages of the cases that are kept, by the numbers of the cases: paths from the folder of the study.
pub type CasePages = BTreeMap<i64, String>;

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
    let mut page = Page::new(name, subtitle, lead, inputs)
        .messages(&none, &notes)
        .with(tiles(analysis))
        .with(ranking(analysis, pages));
    if let Some(front) = &analysis.front {
        for other in 1..front.measures.len() {
            page = page.with(front_card(front, &analysis.layouts, other, pages));
        }
    }
    if let Some(map) = &analysis.map {
        page = page.with(map_card(map));
    }
    for axis in analysis.effects.axes.iter().filter(|axis| !axis.levels.is_empty()) {
        page = page.with(effect(axis, &analysis.effects.measure));
    }
    let reasons =
        failures.reasons.iter().map(|(reason, count, first)| format!("{count} cases, the first {first}: {reason}"));
    let sentences: Vec<String> = reasons.collect();
    if !sentences.is_empty() {
        page =
            page.with(Card::Text(Text { title: "Cases without a placement".to_owned(), sentences, is_warning: true }));
    }
    page
}

fn with_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// What a layout is, in words: `robot a.toml, height 200 mm`.
fn layout_words(layouts: &Layouts, layout: &Layout) -> String {
    let word = |axis: usize| {
        let (name, unit) = words(&layouts.columns[axis].name);
        format!("{name} {}{}", value(&layout.row[axis].written()), with_unit(unit))
    };
    layouts.varied().into_iter().map(word).collect::<Vec<_>>().join(", ")
}

/// The mean of the whole deflection of a layout.
fn whole(layouts: &Layouts, layout: usize) -> Option<f64> {
    let column = layouts.columns.iter().position(|column| column.name == WHOLE)?;
    if let TableCell::Number(whole) = layouts.all[layout].row[column] { Some(whole) } else { None }
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

fn tiles(analysis: &Analysis) -> Card {
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
    tiles.push(Tile::new(
        "layouts",
        analysis.layouts.all.len().to_string(),
        "",
        format!("{} with a value", ranking.ranked.len()),
    ));
    tiles.push(Tile::new(
        "ties with the best",
        ties.to_string(),
        "",
        format!("within {} %", figures(percent(analysis.noise))),
    ));
    let detail = format!("{} infeasible, {} failed", failures.infeasible, failures.failed);
    tiles.push(Tile::new("without a placement", failures.count().to_string(), "cases", detail));
    Card::Tiles(Tiles { tiles })
}

/// The page of a layout: that of the first of its cases that has one.
fn path<'a>(layout: &Layout, pages: &'a CasePages) -> Option<&'a String> {
    layout.cases.iter().find_map(|case| pages.get(case))
}

/// The numbers of the cases of a layout, leading to their page.
fn cases_cell(layout: &Layout, pages: &CasePages) -> Cell {
    let text = cases(layout);
    match path(layout, pages) {
        Some(path) => Cell::Link { text, path: path.clone() },
        None => Cell::Number(text),
    }
}

fn ranking(analysis: &Analysis, pages: &CasePages) -> Card {
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
    Card::Table(Table {
        title: "Ranking".to_owned(),
        detail: if pages.is_empty() { String::new() } else { "a case leads to its own page".to_owned() },
        columns,
        rows: ranked.chain(without).collect(),
        can_filter: true,
    })
}

fn front_card(front: &Front, layouts: &Layouts, other: usize, pages: &CasePages) -> Card {
    let is_member =
        |layout: usize| front.members.iter().find(|member| member.layout == layout).map(|member| member.is_tie);
    let series = |name: &str, color: usize, style: Style, wanted: Option<bool>| {
        let found: Vec<_> = front.compared.iter().filter(|(layout, _)| is_member(*layout) == wanted).collect();
        let label = |layout: usize| {
            let layout = &layouts.all[layout];
            format!("case {} {}", cases(layout), layout_words(layouts, layout)).trim_end().to_owned()
        };
        let link = |layout: usize| path(&layouts.all[layout], pages).cloned().unwrap_or_default();
        Series {
            links: if pages.is_empty() { Vec::new() } else { found.iter().map(|(layout, _)| link(*layout)).collect() },
            ..Series::dots(name, color, found.iter().map(|(_, values)| [values[0], values[other]]))
                .styled(style)
                .labelled(found.iter().map(|(layout, _)| label(*layout)).collect())
        }
    };
    let series = [
        series("other layouts", 0, Style::Dots, None),
        series("behind it within the noise of the search", 2, Style::Dots, Some(true)),
        series("on the front", 1, Style::Rings, Some(false)),
    ];
    Card::Chart(Chart {
        title: format!("Front of {} and {}", words(&front.measures[0].name).0, words(&front.measures[other].name).0),
        x: axis_of(&front.measures[0]),
        y: axis_of(&front.measures[other]),
        series: series.into_iter().filter(|series| !series.x.is_empty()).collect(),
        ..Chart::default()
    })
}

fn axis_of(measure: &Measure) -> Axis {
    let better = if measure.sense == Sense::Min { "smaller" } else { "larger" };
    Axis::new(format!("{}, {better} is better", heading(&measure.name)))
}

fn map_card(map: &Map) -> Card {
    let values: Vec<f64> = map.cells.iter().map(|cell| cell.map_or(f64::NAN, number)).collect();
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let range = [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)];
    let [first, second] = &map.labels;
    let (name, unit) = words(&map.measure.name);
    let [across, up] = [&map.names[0], &map.names[1]].map(|name| heading(name));
    let short = |labels: &[String]| labels.iter().map(|label| value(label)).collect();
    let places = |labels: &[String]| (0..labels.len()).map(|k| k as f64).collect();
    Card::HeatMap(HeatMap {
        title: format!("Mean of {name}"),
        detail: "over the other axes".to_owned(),
        x: Axis::named(across, short(first)),
        y: Axis::named(up, short(second)),
        columns: places(first),
        rows: places(second),
        values,
        range: if range[0] <= range[1] { range } else { [0.0, 1.0] },
        unit: unit.to_owned(),
        blank: "no layout with a value".to_owned(),
        is_written: true,
        ..HeatMap::default()
    })
}

fn effect(axis: &AxisEffect, measure: &Measure) -> Card {
    let share = axis.share.map(|share| format!("{} % of the variation", figures(percent(share))));
    let slope = axis.slope.map(|slope| format!("{} per unit along a straight line", figures(slope)));
    let detail = [share, slope].into_iter().flatten().collect::<Vec<_>>().join("; ");
    let numbers: Option<Vec<f64>> = axis.levels.iter().map(|level| level.number).collect();
    let labels = axis.levels.iter().map(|level| format!("{}: {} layouts", value(&level.label), level.count)).collect();
    let names: Vec<String> = axis.levels.iter().map(|level| value(&level.label)).collect();
    let (x, places) = match numbers {
        Some(numbers) => (Axis::new(heading(&axis.name)), numbers),
        None => (Axis::named(heading(&axis.name), names), (0..axis.levels.len()).map(|k| k as f64).collect()),
    };
    let points: Vec<[f64; 2]> = places.iter().zip(&axis.levels).map(|(place, level)| [*place, level.value]).collect();
    Card::Chart(Chart {
        title: format!("Effect of {}", words(&axis.name).0),
        detail,
        x,
        y: Axis::new(format!("mean of {}", heading(&measure.name))),
        series: vec![Series::dots("", 1, points).labelled(labels)],
        ..Chart::default()
    })
}
