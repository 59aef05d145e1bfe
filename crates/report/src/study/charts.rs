//! Charts of a study, on its page and as pictures: the front, what each axis does, and a column over two axes.

use super::words::{cases, heading, number, percent, value, words};
use crate::page::cards::{Axis, Chart, HeatMap, Series, Style};
use crate::picture;
use crate::units::figures;
use std::collections::BTreeMap;
use stead_problem::sense::Sense;
use stead_study::analysis::{AxisEffect, Effects, Front, FrontMember, Layout, Layouts, Map, Measure, Method};

/// The pages of the cases that are kept, by the numbers of the cases: paths from the folder of the study.
pub type CasePages = BTreeMap<i64, String>;

pub(super) fn with_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// What a layout is, in words: `robot a.toml, height 200 mm`.
pub(super) fn layout_words(layouts: &Layouts, layout: &Layout) -> String {
    let word = |axis: usize| {
        let (name, unit) = words(&layouts.columns[axis].name);
        format!("{name} {}{}", value(&layout.row[axis].written()), with_unit(unit))
    };
    layouts.varied().into_iter().map(word).collect::<Vec<_>>().join(", ")
}

/// The page of a layout: that of the first of its cases that has one.
pub(super) fn path<'a>(layout: &Layout, pages: &'a CasePages) -> Option<&'a String> {
    layout.cases.iter().find_map(|case| pages.get(case))
}

/// The first column of a front against another; the layouts lead to their pages.
pub(super) fn front_chart(front: &Front, layouts: &Layouts, other: usize, pages: &CasePages) -> Chart {
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
            written: if wanted == Some(false) {
                found.iter().map(|(layout, _)| cases(&layouts.all[*layout])).collect()
            } else {
                Vec::new()
            },
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
    Chart::new(
        format!("Front of {} and {}", words(&front.measures[0].name).0, words(&front.measures[other].name).0),
        axis_of(&front.measures[0]),
        axis_of(&front.measures[other]),
        series.into_iter().filter(|series| !series.x.is_empty()),
    )
}

/// The charts of `study-front.svg`: those of the page, with the numbers of the cases on the front. Two columns are
/// joined by the line beyond which nothing is.
pub(super) fn fronts_drawn(front: &Front, layouts: &Layouts) -> Vec<Chart> {
    let drawn = |other: usize| {
        let mut chart = front_chart(front, layouts, other, &CasePages::new());
        for series in &mut chart.series {
            series.name = format!("{}: {}", series.name, series.x.len());
        }
        if front.measures.len() == 2 {
            chart.series.insert(0, Series::curve("", 1, stairs(&front.members)));
        }
        chart
    };
    (1..front.measures.len()).map(drawn).collect()
}

/// The edge of what can be had: from each layout on at its height to where the next one takes over.
fn stairs(members: &[FrontMember]) -> Vec<[f64; 2]> {
    let mut edge: Vec<[f64; 2]> = Vec::new();
    for member in members.iter().filter(|member| !member.is_tie) {
        let [x, y] = [member.values[0], member.values[1]];
        edge.extend(edge.last().map(|before| [x, before[1]]));
        edge.push([x, y]);
    }
    edge
}

fn axis_of(measure: &Measure) -> Axis {
    let better = if measure.sense == Sense::Min { "smaller" } else { "larger" };
    Axis::new(format!("{}, {better} is better", heading(&measure.name)))
}

/// The mean of a column over two axes.
pub(super) fn map_chart(map: &Map) -> HeatMap {
    let values: Vec<f64> = map.cells.iter().map(|cell| cell.map_or(f64::NAN, number)).collect();
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let range = [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)];
    let [first, second] = &map.labels;
    let (name, unit) = words(&map.measure.name);
    let [across, up] = [&map.names[0], &map.names[1]].map(|name| heading(name));
    let short = |labels: &[String]| labels.iter().map(|label| value(label)).collect();
    let places = |labels: &[String]| (0..labels.len()).map(|k| k as f64).collect();
    HeatMap {
        title: format!("Mean of {name}"),
        detail: "over the other axes".to_owned(),
        x: Axis::named(across, short(first)),
        y: Axis::named(up, short(second)),
        columns: places(first),
        rows: places(second),
        values,
        range: if range[0] <= range[1] { range } else { [0.0, 1.0] },
        unit: unit.to_owned(),
        measure: heading(&map.measure.name),
        blank: "no layout with a value".to_owned(),
        is_written: true,
        ..HeatMap::default()
    }
}

/// `study-map.svg`: the map of the page, files by their names.
pub(super) fn map_drawn(map: &Map) -> String {
    let mut chart = map_chart(map);
    for (axis, labels) in [&mut chart.x, &mut chart.y].into_iter().zip(&map.labels) {
        axis.names = labels.iter().map(|label| short(label)).collect();
    }
    let title = format!("{} over two axes", words(&map.measure.name).0);
    picture::heat_maps(&title, "dark where it is small", &[chart], &[])
}

/// The mean of a column at each value of an axis.
pub(super) fn effect_chart(axis: &AxisEffect, measure: &Measure) -> Chart {
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
    let (title, y) = (format!("Effect of {}", words(&axis.name).0), format!("mean of {}", heading(&measure.name)));
    Chart::new(title, x, y, [Series::dots("", 1, points).labelled(labels)]).detailed(detail)
}

/// The charts of `study-effects.svg`, the largest share of the variance first: every layout, the mean at each value of
/// the axis, joined where the values are numbers, and the best of them. What a line explains has no means of its own.
pub(super) fn effects_drawn(effects: &Effects, layouts: &Layouts) -> Vec<Chart> {
    let mean = if effects.axes.len() == 1 { "mean of the layouts" } else { "mean over the other axes" };
    let drawn = |axis: &AxisEffect| {
        let chart = effect_chart(axis, &effects.measure);
        let is_line = axis.method == Method::Line;
        let place = |written: &str| -> Option<f64> {
            let at = || axis.levels.iter().position(|level| level.label == written);
            if is_line { written.parse().ok() } else { at().map(|k| k as f64) }
        };
        let of = layouts.valued(&effects.measure);
        let of = of.filter_map(|(layout, value)| Some([place(&layouts.all[layout].row[axis.axis].written())?, value]));
        let means: Vec<[f64; 2]> =
            axis.levels.iter().filter_map(|level| Some([place(&level.label)?, level.value])).collect();
        let best = axis.best(effects.measure.sense).and_then(|level| Some([place(&level.label)?, level.value]));
        let mut series = vec![Series::dots("a layout", 0, of)];
        if axis.levels.iter().all(|level| level.number.is_some()) {
            series.push(Series::curve(if is_line { mean } else { "" }, 2, means.iter().copied()));
        }
        if !is_line {
            series.push(Series::dots(mean, 2, means));
            series.push(Series::dots("the best of them", 1, best).styled(Style::Rings));
        }
        let names = || axis.levels.iter().map(|level| short(&level.label)).collect();
        Chart {
            detail: [chart.detail, format!("by {}", axis.method.word())].join("; "),
            x: if is_line { chart.x } else { Axis::named(chart.x.label, names()) },
            y: Axis::new(heading(&effects.measure.name)),
            series,
            ..chart
        }
    };
    effects.axes.iter().map(drawn).collect()
}

/// A value without folders and endings of files, a number with few digits.
fn short(label: &str) -> String {
    match label.parse::<f64>() {
        Ok(number) if label.len() > 7 => figures(number),
        Ok(_) => label.to_owned(),
        Err(_) => {
            let is_file = [".toml", ".csv"].iter().any(|ending| label.ends_with(ending));
            let name = if is_file { label.rsplit(['/', '\\']).next().unwrap_or(label) } else { label };
            name.trim_end_matches(".toml").trim_end_matches(".csv").to_owned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::testing::analysis;

    #[test]
    fn labels_are_short() {
        let labels = ["robots/kuka-kr500.toml", "high and dry", "0.2", "0.123456789"].map(short);
        assert_eq!(labels, ["kuka-kr500", "high and dry", "0.2", "0.123"]);
    }

    #[test]
    fn what_is_on_the_front_is_marked_with_the_number_of_its_case() {
        let analysis = analysis();
        let svg = picture::charts(&fronts_drawn(analysis.front.as_ref().unwrap(), &analysis.layouts));
        let green = svg.lines().filter(|line| line.starts_with("<circle") && line.contains("#1F8F8A"));
        // The legend, and cases 1 and 2.
        assert_eq!(green.count(), 3);
        assert!(svg.contains("on the front: 2") && svg.contains("\n1\n") && svg.contains("\n2\n"));
        assert!(svg.contains("cycle time (s), smaller is better"));
    }

    #[test]
    fn each_axis_has_a_chart_with_its_share() {
        let analysis = analysis();
        let svg = picture::charts(&effects_drawn(&analysis.effects, &analysis.layouts));
        assert!(svg.contains("of the variation; by") && svg.contains("height") && svg.contains("robot"));
        assert!(svg.contains("a layout") && svg.contains("the best of them"));
    }

    #[test]
    fn the_map_has_a_figure_in_each_cell() {
        let analysis = analysis();
        let svg = map_drawn(analysis.map.as_ref().unwrap());
        for part in ["\n1.00\n", "\n2.00\n", "\n–\n", "score over two axes"] {
            assert!(svg.contains(part), "{part}");
        }
    }
}
