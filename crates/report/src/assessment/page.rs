//! `report.html` of an assessment.

use super::AssessmentContext;
use super::map;
use crate::page::cards::{Axis, Cell, Chart, Column, HeatMap, Page, Series, Table, Tile};
use crate::picture::{ColourRange, PlaneView};
use crate::units::{figures, fixed};
use stead_assessment::comparison::{Assessment, Comparison, Configuration, RobotResult, Zones};
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
    let selection = (!assessment.capable.is_empty()).then(|| selection(assessment));
    let page = Page::new(&title, "circularity over the working plane", lead, &context.inputs)
        .messages(&assessment.warnings, &context.notes)
        .with(tiles(assessment))
        .with(ranking(assessment))
        .with(accuracies(assessment))
        .with(configurations(assessment))
        .with_all(selection);
    let maps =
        || assessment.robots.iter().flat_map(|robot| robot.maps.iter().map(move |(elbow, map)| (robot, *elbow, map)));
    let total: usize = maps().filter(|(.., map)| map.count() > 0).map(|(.., map)| map.grid.len()).sum();
    let mut stride = 1;
    while total / (stride * stride) > MAX_VALUES {
        stride += 1;
    }
    let view = PlaneView::new(&comparison.benchmark.plane);
    let drawn = maps().filter(|(.., map)| map.count() > 0);
    let mut cards: Vec<HeatMap> =
        drawn.map(|(robot, elbow, map)| map::chart(&view, robot, elbow, map, stride)).collect();
    map::compare(&mut cards, ColourRange::round);
    page.with_all(cards)
}

fn millimetres(length: Option<f64>) -> Option<String> {
    length.map(|length| figures(length * 1e3))
}

/// The figures of the first robots, the most accurate first.
fn tiles(assessment: &Assessment) -> Vec<Tile> {
    let robot = |name: &String| assessment.robots.iter().find(|robot| robot.name == *name);
    let tile = |robot: &RobotResult| {
        let payload =
            robot.data_sheet.payload.map_or_else(String::new, |payload| format!(", payload {} kg", figures(payload)));
        let detail = format!("reach {} mm{payload}", fixed(robot.working_radius * 1e3, 0));
        Tile::new(&robot.name, millimetres(robot.competitor().min).unwrap_or_else(|| "–".to_owned()), "mm", detail)
    };
    assessment.order.iter().take(6).filter_map(robot).map(tile).collect()
}

fn ranking(assessment: &Assessment) -> Table {
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
    let columns = [Column::number("rank"), Column::text("robot")].into_iter().chain(numbers);
    let rows = assessment.order.iter().enumerate().map(row);
    let table = Table::new("Ranking", columns.collect(), rows.collect()).detailed("most accurate first");
    Table { can_filter: assessment.order.len() > 8, ..table }
}

fn accuracies(assessment: &Assessment) -> Chart {
    let curve = |(color, robot): (usize, &RobotResult)| {
        let cells = assessment.accuracies.iter().filter(|cell| cell.robot == robot.name);
        let points = cells.map(|cell| [cell.force, cell.circularity.map_or(f64::NAN, |length| length * 1e3)]);
        Series::curve(&robot.name, color, points)
    };
    let curves = assessment.robots.iter().enumerate().map(curve);
    Chart::new("Accuracy at a force", "cutting force (N)", Axis::log("circularity (mm)"), curves)
        .detailed("at the best place, without compensation")
        .wide()
}

fn configurations(assessment: &Assessment) -> Table {
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
    Table::new("Configurations and zones", columns.collect(), rows.collect())
        .detailed("circularity in mm; of a zone, its largest")
        .filtered()
}

fn selection(assessment: &Assessment) -> Table {
    let row = |cell: &stead_assessment::ranking::Capable| {
        vec![
            Cell::Number(figures(cell.accuracy * 1e3)),
            Cell::Number(fixed(cell.force, 0)),
            Cell::Number(cell.robots.len().to_string()),
            Cell::Text(cell.robots.join(", ")),
        ]
    };
    let numbers = ["accuracy mm", "force N", "robots"].map(Column::number);
    let columns = numbers.into_iter().chain([Column::text("which")]).collect();
    Table::new("Which robots for which task", columns, assessment.capable.iter().map(row).collect())
        .detailed("with errors compensated")
        .filtered()
}
