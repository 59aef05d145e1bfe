//! `report.html` of an assessment.

use super::AssessmentContext;
use crate::page::cards::{Axis, Card, Cell, Chart, Column, HeatMap, Outline, Page, Series, Table, Tile, Tiles};
use crate::picture::{ColourRange, PlaneView};
use crate::units::{figures, fixed};
use stead_assessment::comparison::{Assessment, Comparison, Configuration, Load, RobotResult, Zones};
use stead_assessment::map::{Elbow, Map};
use stead_assessment::zone::Zone;

/// Values of all maps of a page at most: finer maps are thinned out evenly.
const MAX_VALUES: usize = 30_000;

/// Ranking, accuracy over force, and the maps of all robots with their zones.
pub(super) fn page(comparison: &Comparison, assessment: &Assessment, context: &AssessmentContext) -> Page {
    let force = figures(comparison.benchmark.in_plane_force());
    let radius = figures(comparison.benchmark.radius * 1e3);
    let best = assessment.order.first().and_then(|name| assessment.robots.iter().find(|robot| robot.name == *name));
    let least = best.and_then(|robot| robot.competitor().min.map(|min| (robot, min)));
    let lead = match least {
        Some((robot, min)) => format!(
            "Most accurate is {}: at its best place a circle of radius {radius} mm under {force} N is out of round by {} mm.",
            robot.name,
            figures(min * 1e3)
        ),
        None => format!("No robot has room for a circle of radius {radius} mm."),
    };
    let title = match &assessment.robots[..] {
        [one] => one.name.clone(),
        robots => format!("{} robots", robots.len()),
    };
    let mut page = Page::new(&title, "circularity over the working plane", lead, &context.inputs)
        .messages(&assessment.warnings, &context.notes)
        .with(tiles(assessment))
        .with(ranking(assessment))
        .with(accuracies(assessment))
        .with(configurations(assessment));
    if !assessment.capable.is_empty() {
        page = page.with(selection(assessment));
    }
    let maps =
        || assessment.robots.iter().flat_map(|robot| robot.maps.iter().map(move |(elbow, map)| (robot, *elbow, map)));
    let total: usize = maps().filter(|(.., map)| map.count() > 0).map(|(.., map)| map.grid.len()).sum();
    let mut stride = 1;
    while total / (stride * stride) > MAX_VALUES {
        stride += 1;
    }
    let view = PlaneView::new(&comparison.benchmark.plane);
    let drawn = maps().filter(|(.., map)| map.count() > 0);
    let mut cards: Vec<HeatMap> = drawn.map(|(robot, elbow, map)| map_card(&view, robot, elbow, map, stride)).collect();
    compared(&mut cards);
    cards.into_iter().fold(page, |page, card| page.with(Card::HeatMap(card)))
}

fn millimetres(length: Option<f64>) -> Option<String> {
    length.map(|length| figures(length * 1e3))
}

/// The figures of the first robots, the most accurate first.
fn tiles(assessment: &Assessment) -> Card {
    let robot = |name: &String| assessment.robots.iter().find(|robot| robot.name == *name);
    let tile = |robot: &RobotResult| {
        let payload =
            robot.data_sheet.payload.map_or_else(String::new, |payload| format!(", payload {} kg", figures(payload)));
        let detail = format!("reach {} mm{payload}", fixed(robot.working_radius * 1e3, 0));
        Tile::new(&robot.name, millimetres(robot.competitor().min).unwrap_or_else(|| "–".to_owned()), "mm", detail)
    };
    Card::Tiles(Tiles { tiles: assessment.order.iter().take(6).filter_map(robot).map(tile).collect() })
}

fn ranking(assessment: &Assessment) -> Card {
    let row = |(rank, name): (usize, &String)| {
        let robot = assessment.robots.iter().find(|robot| robot.name == *name);
        let number = |of: fn(&RobotResult) -> Option<String>| Cell::optional(robot.and_then(of));
        vec![
            Cell::Number((rank + 1).to_string()),
            Cell::Text(name.clone()),
            number(|robot| millimetres(robot.competitor().min)),
            number(|robot| Some(fixed(robot.working_radius * 1e3, 0))),
            number(|robot| robot.data_sheet.payload.map(figures)),
            number(|robot| robot.data_sheet.price.map(figures)),
        ]
    };
    let numbers = ["smallest circularity mm", "working radius mm", "payload kg", "price EUR"].map(Column::number);
    Card::Table(Table {
        title: "Ranking".to_owned(),
        detail: "most accurate first".to_owned(),
        columns: [Column::number("rank"), Column::text("robot")].into_iter().chain(numbers).collect(),
        rows: assessment.order.iter().enumerate().map(row).collect(),
        can_filter: assessment.order.len() > 8,
    })
}

fn accuracies(assessment: &Assessment) -> Card {
    let curve = |(color, robot): (usize, &RobotResult)| {
        let cells = assessment.accuracies.iter().filter(|cell| cell.robot == robot.name);
        let points = cells.map(|cell| [cell.force, cell.circularity.map_or(f64::NAN, |length| length * 1e3)]);
        Series::curve(&robot.name, color, points)
    };
    Card::Chart(Chart {
        title: "Accuracy at a force".to_owned(),
        detail: "at the best place, without compensation".to_owned(),
        x: Axis::new("cutting force (N)"),
        y: Axis::log("circularity (mm)"),
        series: assessment.robots.iter().enumerate().map(curve).collect(),
        is_wide: true,
        ..Chart::default()
    })
}

fn configurations(assessment: &Assessment) -> Card {
    let first = assessment.robots.first().and_then(|robot| robot.configurations.first());
    let sides: Vec<f64> =
        first.map_or(vec![], |configuration| configuration.zones.iter().map(|zones| zones.side).collect());
    let zones = |kind: &str, side: &f64| Column::number(format!("{kind} zone {} mm", figures(side * 1e3)));
    let numbers = ["force N", "smallest mm", "largest mm", "middle mm", "circles"].map(Column::number);
    let columns = ["robot", "elbow", "load"].map(Column::text).into_iter().chain(numbers);
    let columns = columns.chain(sides.iter().flat_map(|side| [zones("optimal", side), zones("middle", side)]));
    let row = |robot: &RobotResult, of: &Configuration| {
        let words = [robot.name.as_str(), of.elbow.word(), of.load.word()].map(|word| Cell::Text(word.to_owned()));
        let spots =
            [of.min, of.max, of.middle].map(|spot| Cell::optional(millimetres(spot.map(|spot| spot.circularity))));
        let zone = |zone: Option<Zone>| Cell::optional(millimetres(zone.map(|zone| zone.largest)));
        let zones = of.zones.iter().flat_map(|zones: &Zones| [zone(zones.optimal), zone(zones.middle)]);
        let force = [Cell::Number(fixed(of.force, 0))];
        words.into_iter().chain(force).chain(spots).chain([Cell::Number(of.circles.to_string())]).chain(zones).collect()
    };
    let rows = assessment.robots.iter().flat_map(|robot| robot.configurations.iter().map(move |of| row(robot, of)));
    Card::Table(Table {
        title: "Configurations and zones".to_owned(),
        detail: "circularity in mm; of a zone, its largest".to_owned(),
        columns: columns.collect(),
        rows: rows.collect(),
        can_filter: true,
    })
}

fn selection(assessment: &Assessment) -> Card {
    let row = |cell: &stead_assessment::ranking::Capable| {
        vec![
            Cell::Number(figures(cell.accuracy * 1e3)),
            Cell::Number(fixed(cell.force, 0)),
            Cell::Number(cell.robots.len().to_string()),
            Cell::Text(cell.robots.join(", ")),
        ]
    };
    let numbers = ["accuracy mm", "force N", "robots"].map(Column::number);
    Card::Table(Table {
        title: "Which robots for which task".to_owned(),
        detail: "with errors compensated".to_owned(),
        columns: numbers.into_iter().chain([Column::text("which")]).collect(),
        rows: assessment.capable.iter().map(row).collect(),
        can_filter: true,
    })
}

/// Gives all maps one scale of colours and the same axes, so that they are compared by eye.
fn compared(maps: &mut [HeatMap]) {
    let mut ascending: Vec<f64> = maps.iter().flat_map(|map| &map.values).copied().filter(|v| v.is_finite()).collect();
    ascending.sort_by(f64::total_cmp);
    let colours = ColourRange::round(&ascending);
    let ends = |places: fn(&HeatMap) -> &[f64]| {
        let halves = maps.iter().flat_map(|map| match places(map) {
            [] => vec![],
            of @ [first, .., last] => {
                let half = (last - first) / (of.len() - 1) as f64 / 2.0;
                vec![first - half, last + half]
            }
            [only] => vec![*only - 0.5, only + 0.5],
        });
        halves.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], end| [low.min(end), high.max(end)])
    };
    let (x, y) = (ends(|map| &map.columns), ends(|map| &map.rows));
    for map in maps {
        map.range = [colours.from, colours.to];
        (map.x.range, map.y.range) = (Some(x), Some(y));
    }
}

/// The map of an elbow under the test load, every so-manieth node of the part that has values.
fn map_card(view: &PlaneView, robot: &RobotResult, elbow: Elbow, map: &Map<2>, stride: usize) -> HeatMap {
    let [across, up] = map.grid.counts;
    let values = map.values(0);
    let at = |column: usize, row: usize| values[row * across + column];
    let has_value = |line: &dyn Fn(usize) -> bool, count: usize| {
        let found: Vec<usize> = (0..count).filter(|k| line(*k)).collect();
        let (first, last) = (found.first().copied().unwrap_or(0), found.last().copied().unwrap_or(0));
        (first..=last).step_by(stride).collect::<Vec<usize>>()
    };
    let columns = has_value(&|column| (0..up).any(|row| at(column, row).is_finite()), across);
    let rows = has_value(&|row| (0..across).any(|column| at(column, row).is_finite()), up);
    let shown: Vec<f64> = rows.iter().flat_map(|row| columns.iter().map(|column| at(*column, *row) * 1e3)).collect();
    let place = |column: usize, row: usize| view.shown(map.grid.at([column as f64, row as f64]));
    let found = robot.configurations.iter().find(|found| found.elbow == elbow && found.load == Load::Test);
    let outline = |kind: &str, color: usize, zone: Option<Zone>| {
        zone.map(|zone| {
            let ([x, y], half) = (view.shown(zone.centre), zone.side / 2.0 * 1e3);
            Outline {
                label: format!("{kind} zone, {} mm", figures(zone.side * 1e3)),
                color,
                low: [x - half, y - half],
                high: [x + half, y + half],
            }
        })
    };
    let zones = found.iter().flat_map(|found| &found.zones);
    let outlines = zones.flat_map(|zones| [outline("optimal", 2, zones.optimal), outline("middle", 3, zones.middle)]);
    let detail = found.and_then(|found| Some((found.min?, found.max?))).map_or_else(String::new, |(min, max)| {
        format!("{} to {} mm", figures(min.circularity * 1e3), figures(max.circularity * 1e3))
    });
    HeatMap {
        title: format!("{}, elbow {}", robot.name, elbow.word()),
        detail: format!("{detail}; {}", view.words()),
        x: Axis::new(view.labels[0]),
        y: Axis::new(view.labels[1]),
        columns: columns.iter().map(|column| place(*column, 0)[0]).collect(),
        rows: rows.iter().map(|row| place(0, *row)[1]).collect(),
        values: shown,
        unit: "mm".to_owned(),
        blank: "no circle fits".to_owned(),
        outlines: outlines.flatten().collect(),
        is_even: true,
        ..HeatMap::default()
    }
}
