//! `report.html` of a compensation.

use crate::page::cards::{Axis, Card, Cell, Chart, Column, Mark, Page, Series, Style, Table, Tile, Tiles};
use crate::units::{figures, fixed};
use stead_calibration::compensation::{CompensatedPath, CompensatedPoint, Deflection, MeanAndMax, reduction};
use stead_format::CompensateRun;

/// Figures before and after, both along the path, and which points keep their target.
pub(super) fn page(run: &CompensateRun, outcome: &CompensatedPath) -> Page {
    let count = outcome.points.len();
    let kept = outcome.not_corrected().map_or_else(Vec::new, |not| not.failed);
    let subtitle = format!("compensation · {count} path points");
    let [before, after] = outcome.deflections();
    let mut lead = format!(
        "The commands bring the mean deflection of the tool from {} mm to {} mm",
        figures(before.mean * 1e3),
        figures(after.mean * 1e3)
    );
    if run.has_reality {
        lead.push_str(&format!(", carried out by {}", run.job.reality.name()));
    }
    if !kept.is_empty() {
        lead.push_str(&format!("; {} of {count} points keep their target", kept.len()));
    }
    lead.push('.');
    let page = Page::new(run.job.robot.name(), subtitle, lead, &run.inputs)
        .messages(&outcome.warnings, &[run.notes.as_slice(), &outcome.notes].concat())
        .with(tiles(outcome))
        .with(along("Deflection before and after", outcome, |deflection| deflection.linear.norm()))
        .with(along("Normal to the feed before and after", outcome, |deflection| deflection.normal.abs()))
        .with(correction(outcome));
    if kept.is_empty() {
        return page;
    }
    let row = |(point, reason): &(usize, _)| vec![Cell::Number(point.to_string()), Cell::Text(format!("{reason}"))];
    page.with(Card::Table(Table {
        title: "Points that keep their target".to_owned(),
        columns: vec![Column::number("point"), Column::text("reason")],
        rows: kept.iter().map(row).collect(),
        ..Table::default()
    }))
}

fn tiles(outcome: &CompensatedPath) -> Card {
    let of = |what: &str, pair: [MeanAndMax; 2]| {
        let [before, after] = pair;
        let less = reduction(pair).map_or_else(String::new, |share| format!("{} % less", fixed(share * 100.0, 3)));
        let largest = |figures_: &MeanAndMax| format!("largest {} mm", figures(figures_.max * 1e3));
        [
            Tile::new(&format!("mean {what} before"), figures(before.mean * 1e3), "mm", largest(&before)),
            Tile::new(
                &format!("mean {what} after"),
                figures(after.mean * 1e3),
                "mm",
                format!("{}; {less}", largest(&after)),
            ),
        ]
    };
    let moved = outcome.figures(|point| Some(point.correction.linear.norm())).max * 1e3;
    let turned = outcome.figures(|point| Some(point.correction.angular.norm())).max.to_degrees();
    let detail = format!("and {}°, in at most {} iterations", figures(turned), outcome.iterations());
    let mut tiles = of("deflection", outcome.deflections()).to_vec();
    tiles.extend(of("normal to the feed", outcome.normal_parts()));
    tiles.push(Tile::new("largest correction", figures(moved), "mm", detail));
    Card::Tiles(Tiles { tiles })
}

/// A part of the deflection over the points, without and with the commands.
fn along(title: &str, outcome: &CompensatedPath, part: fn(&Deflection) -> f64) -> Card {
    let curve = |name: &str, color: usize, of: fn(&CompensatedPoint) -> &Option<Deflection>| {
        let value = |point: &CompensatedPoint| of(point).as_ref().map(part).filter(|part| *part > 0.0);
        Series::curve(name, color, by_segment(outcome, |point| value(point).map_or(f64::NAN, |part| part * 1e3)))
    };
    Card::Chart(Chart {
        title: title.to_owned(),
        x: Axis::new("path point"),
        y: Axis::log("mm"),
        series: vec![
            curve("target commanded", 1, |point| &point.before),
            curve("corrected command", 0, |point| &point.after),
        ],
        marks: starts(outcome),
        is_wide: true,
        ..Chart::default()
    })
}

/// By how much the command differs from the target.
fn correction(outcome: &CompensatedPath) -> Card {
    let shift = by_segment(outcome, |point| point.correction.linear.norm() * 1e3);
    let turn = by_segment(outcome, |point| point.correction.angular.norm().to_degrees());
    Card::Chart(Chart {
        title: "Corrections".to_owned(),
        detail: "of the place in mm, of the orientation in deg".to_owned(),
        x: Axis::new("path point"),
        y: Axis::new("mm and deg"),
        series: vec![
            Series::curve("place (mm)", 0, shift),
            Series::curve("orientation (deg)", 2, turn).styled(Style::Dashed),
        ],
        marks: starts(outcome),
        is_wide: true,
        ..Chart::default()
    })
}

/// A value over the path points, without a line from segment to segment.
fn by_segment(outcome: &CompensatedPath, value: impl Fn(&CompensatedPoint) -> f64) -> Vec<[f64; 2]> {
    let mut points = Vec::with_capacity(outcome.points.len());
    let mut segment = None;
    for (k, point) in outcome.points.iter().enumerate() {
        if segment.is_some_and(|last| last != point.segment) {
            points.push([k as f64 - 0.5, f64::NAN]);
        }
        segment = Some(point.segment);
        points.push([k as f64, value(point)]);
    }
    points
}

/// Where segments begin, but for the first.
fn starts(outcome: &CompensatedPath) -> Vec<Mark> {
    let pairs = outcome.points.windows(2).enumerate().filter(|(_, pair)| pair[0].segment != pair[1].segment);
    pairs
        .map(|(k, pair)| Mark { is_level: false, at: k as f64 + 0.5, label: format!("segment {}", pair[1].segment) })
        .collect()
}
