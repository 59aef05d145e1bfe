//! The CSV files of an assessment. One function makes one file; every column carries its unit. Places are centres of
//! circles in the coordinates of the plane. Columns `printed_*` are published values: `-` for a dash, empty where nothing
//! is published.

use super::super::output::ReportError;
use crate::csv_file::table;
use crate::units::Unit;
use stead_assessment::comparison::{Assessment, Configuration, MapPoint, RobotResult, Zones};
use stead_assessment::published::{PublishedTables, Quantity};

/// `map-ROBOT.csv`: every circle that can be milled; a column is empty where the arm is too soft for that load, and the rated one where the
/// payload is not known.
pub(super) fn map(robot: &RobotResult) -> Result<Vec<u8>, ReportError> {
    let header = "elbow,x_mm,y_mm,test_mm,rated_mm";
    let rows = robot.maps.iter().flat_map(|(name, map)| {
        map.nodes.iter().enumerate().filter_map(move |(index, node)| {
            let [test, rated] = (*node).ok()?;
            let mut row = vec![name.word().to_owned()];
            row.extend(map.grid.place(index).map(|place| Unit::PLACE_MM.text(place)));
            let cells = [Some(test), robot.rated_load.map(|_| rated)];
            row.extend(cells.map(|cell| Unit::DEFLECTION_MM.text_or_empty(cell.filter(|value| value.is_finite()))));
            Some(row)
        })
    });
    table("the table of a circularity map", header.split(','), rows)
}

/// Each configuration of each robot, with its robot.
fn configurations(assessment: &Assessment) -> impl Iterator<Item = (&RobotResult, &Configuration)> {
    assessment.robots.iter().flat_map(|robot| robot.configurations.iter().map(move |c| (robot, c)))
}

/// The fields that tell a configuration.
fn key(robot: &RobotResult, configuration: &Configuration) -> Vec<String> {
    let (elbow, load) = (configuration.elbow.word(), configuration.load.word());
    vec![robot.name.clone(), elbow.to_owned(), load.to_owned(), Unit::FORCE_N.text(configuration.force)]
}

/// A value and its place, empty where there is none.
fn spot(spot: Option<MapPoint>) -> [String; 3] {
    let Some(spot) = spot else { return Default::default() };
    let [x, y] = spot.centre.map(|place| Unit::PLACE_MM.text(place));
    [Unit::DEFLECTION_MM.text(spot.circularity), x, y]
}

/// A published value: `None` where nothing is published, `Some(None)` for a dash.
fn printed_text(value: Option<Option<f64>>) -> String {
    match value {
        None => String::new(),
        Some(None) => "-".to_owned(),
        // As printed: two decimals of a millimetre are in the tables, more would be rounding.
        Some(Some(value)) => format!("{}", (value * 1e9).round() / 1e6),
    }
}

fn printed_value(
    published: Option<&PublishedTables>,
    robot: &RobotResult,
    of: &Configuration,
    quantity: Quantity,
) -> String {
    printed_text(published.and_then(|published| published.value(&robot.name, of.elbow, of.load, quantity)))
}

/// `circularity.csv` (Klimchik 2017, Table 5).
pub(super) fn circularity(
    assessment: &Assessment,
    published: Option<&PublishedTables>,
) -> Result<Vec<u8>, ReportError> {
    let header = "\
        robot,elbow,load,force_n,circles,min_mm,min_at_x_mm,min_at_y_mm,max_mm,max_at_x_mm,max_at_y_mm,middle_mm,\
         middle_at_x_mm,middle_at_y_mm,printed_min_mm,printed_max_mm,printed_middle_mm";
    let rows = configurations(assessment).map(|(robot, configuration)| {
        let mut row = key(robot, configuration);
        row.push(configuration.circles.to_string());
        row.extend([configuration.min, configuration.max, configuration.middle].into_iter().flat_map(spot));
        let quantities = [Quantity::Minimum, Quantity::Maximum, Quantity::Middle];
        row.extend(quantities.map(|quantity| printed_value(published, robot, configuration, quantity)));
        row
    });
    table("the table of circularities", header.split(','), rows)
}

const ZONE: &str = "robot,elbow,load,force_n,size_mm,largest_mm,centre_x_mm,centre_y_mm,printed_mm";

/// `optimal-zones.csv` (Klimchik 2017, Table 6).
pub(super) fn optimal_zones(
    assessment: &Assessment,
    published: Option<&PublishedTables>,
) -> Result<Vec<u8>, ReportError> {
    zones("the table of optimal zones", assessment, published, |zones| {
        (zones.optimal, Quantity::OptimalZone(zones.side))
    })
}

/// `middle-zones.csv` (Klimchik 2017, Table 7).
pub(super) fn middle_zones(
    assessment: &Assessment,
    published: Option<&PublishedTables>,
) -> Result<Vec<u8>, ReportError> {
    zones("the table of middle zones", assessment, published, |zones| (zones.middle, Quantity::MiddleZone(zones.side)))
}

fn zones(
    what: &'static str,
    assessment: &Assessment,
    published: Option<&PublishedTables>,
    of: impl Fn(&Zones) -> (Option<stead_assessment::zone::Zone>, Quantity),
) -> Result<Vec<u8>, ReportError> {
    let rows = configurations(assessment).flat_map(|(robot, configuration)| {
        let of = &of;
        configuration.zones.iter().map(move |zones| {
            let (zone, quantity) = of(zones);
            let mut row = key(robot, configuration);
            row.push(Unit::PLACE_MM.text(zones.side));
            row.extend(spot(zone.map(|zone| MapPoint { centre: zone.centre, circularity: zone.largest })));
            row.push(printed_value(published, robot, configuration, quantity));
            row
        })
    });
    table(what, ZONE.split(','), rows)
}

/// `accuracy.csv` (Klimchik 2017, Table 8): circularity at the best place, in proportion to the force; empty where the force
/// is above the payload.
pub(super) fn accuracy(assessment: &Assessment, published: Option<&PublishedTables>) -> Result<Vec<u8>, ReportError> {
    let header = "robot,force_n,circularity_mm,printed_mm";
    let rows = assessment.accuracies.iter().map(|cell| {
        let value = published.and_then(|published| published.accuracy(&cell.robot, cell.force));
        vec![
            cell.robot.clone(),
            Unit::FORCE_N.text(cell.force),
            Unit::DEFLECTION_MM.text_or_empty(cell.circularity),
            printed_text(value),
        ]
    });
    table("the table of accuracies", header.split(','), rows)
}

/// `selection.csv` (Klimchik 2017, Table 9): names with semicolons between.
pub(super) fn selection(assessment: &Assessment, published: Option<&PublishedTables>) -> Result<Vec<u8>, ReportError> {
    let header = "accuracy_mm,force_n,robots,printed_robots";
    let rows = assessment.capable.iter().map(|cell| {
        let published = published.map(|published| published.robots(cell.accuracy, cell.force).join("; "));
        vec![
            Unit::DEFLECTION_MM.text(cell.accuracy),
            Unit::FORCE_N.text(cell.force),
            cell.robots.join("; "),
            published.unwrap_or_default(),
        ]
    });
    table("the table of the selection", header.split(','), rows)
}
