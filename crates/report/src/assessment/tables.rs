//! The CSV files of an assessment. One function makes one file; every column carries its unit. Places are centres of
//! circles in the coordinates of the plane. Columns `printed_*` are published values: `-` for a dash, empty where
//! nothing is published.

use super::super::output::ReportError;
use crate::csv_file::rows_or;
use crate::figure::{DeflectionMm, ForceN, PlaceMm, some};
use stead_assessment::comparison::{Assessment, Configuration, MapPoint, RobotResult, Zones};
use stead_assessment::published::{PublishedTables, Quantity};
use stead_assessment::ranking::{Accuracy, Capable};
use stead_assessment::zone::Zone;

records! {
    /// A circle that can be milled.
    #[derive(Default)]
    pub struct MapRow of (robot: &RobotResult, elbow: &'static str, place: [f64; 2], circularities: [f64; 2]) {
        let finite = |value: Option<f64>| some(value.filter(|value| value.is_finite()));
    } with {
        /// Posture of the elbow.
        elbow: &'static str = elbow,
        /// x of its centre.
        x_mm: PlaceMm = place[0].into(),
        /// y of its centre.
        y_mm: PlaceMm = place[1].into(),
        /// Circularity under the test load; empty where the arm is too soft for it.
        test_mm: Option<DeflectionMm> = finite(Some(circularities[0])),
        /// Circularity under the rated load; empty also where the payload is not known.
        rated_mm: Option<DeflectionMm> = finite(robot.rated_load.map(|_| circularities[1])),
    }
}

/// `map-ROBOT.csv`: a [`MapRow`] for every circle that can be milled.
pub(super) fn map(robot: &RobotResult) -> Result<Vec<u8>, ReportError> {
    let circles = robot.maps.iter().flat_map(|(name, map)| {
        map.nodes
            .iter()
            .enumerate()
            .filter_map(move |(index, node)| Some(MapRow::of(robot, name.word(), map.grid.place(index), (*node).ok()?)))
    });
    rows_or("the table of a circularity map", &MapRow::default(), circles)
}

/// Each configuration of each robot, with its robot.
fn configurations(assessment: &Assessment) -> impl Iterator<Item = (&RobotResult, &Configuration)> {
    assessment.robots.iter().flat_map(|robot| robot.configurations.iter().map(move |c| (robot, c)))
}

records! {
    /// The columns that tell a configuration.
    #[derive(Default)]
    pub(crate) struct Key of (robot: &RobotResult, of: &Configuration) {
        /// Name of the robot.
        robot: String = robot.name.clone(),
        /// Posture of the elbow.
        elbow: &'static str = of.elbow.word(),
        /// The load: `test` or `rated`.
        load: &'static str = of.load.word(),
        /// Its force.
        force_n: ForceN = of.force.into(),
    }

    /// A place in the coordinates of the plane; empty where there is none.
    #[derive(Copy, Default)]
    struct Spot from place: Option<[f64; 2]> {
        /// x.
        x_mm: Option<PlaceMm> = some(place.map(|[x, _]| x)),
        /// y.
        y_mm: Option<PlaceMm> = some(place.map(|[_, y]| y)),
    }
}

/// A published value: `None` where nothing is published, `Some(None)` for a dash.
fn printed_text(value: Option<Option<f64>>) -> Option<String> {
    // As printed: two decimals of a millimetre are in the tables, more would be rounding.
    value.map(|value| value.map_or_else(|| "-".to_owned(), |value| format!("{}", (value * 1e9).round() / 1e6)))
}

fn printed_value(
    published: Option<&PublishedTables>,
    robot: &RobotResult,
    of: &Configuration,
    quantity: Quantity,
) -> Option<String> {
    printed_text(published.and_then(|published| published.value(&robot.name, of.elbow, of.load, quantity)))
}

records! {
    /// Circularities of a configuration (Klimchik 2017, Table 5).
    #[derive(Default)]
    pub struct CircularityRow of (robot: &RobotResult, of: &Configuration, published: Option<&PublishedTables>) {
        let value = |spot: Option<MapPoint>| some(spot.map(|spot| spot.circularity));
        let place = |spot: Option<MapPoint>| spot.map(|spot| spot.centre).into();
    } with {
        #[serde(flatten)] key: Key = Key::of(robot, of),
        /// Circles that can be milled.
        circles: usize = of.circles,
        /// Least circularity.
        min_mm: Option<DeflectionMm> = value(of.min),
        /// Where it is.
        min_at: Spot = place(of.min),
        /// Largest circularity.
        max_mm: Option<DeflectionMm> = value(of.max),
        /// Where it is.
        max_at: Spot = place(of.max),
        /// Circularity in the middle of the map.
        middle_mm: Option<DeflectionMm> = value(of.middle),
        /// Where that is.
        middle_at: Spot = place(of.middle),
        /// Published least circularity.
        printed_min_mm: Option<String> = printed_value(published, robot, of, Quantity::Minimum),
        /// Published largest circularity.
        printed_max_mm: Option<String> = printed_value(published, robot, of, Quantity::Maximum),
        /// Published circularity in the middle.
        printed_middle_mm: Option<String> = printed_value(published, robot, of, Quantity::Middle),
    }
}

/// `circularity.csv`: a [`CircularityRow`] for each configuration.
pub(super) fn circularity(
    assessment: &Assessment,
    published: Option<&PublishedTables>,
) -> Result<Vec<u8>, ReportError> {
    let row = |(robot, of): (&RobotResult, &Configuration)| CircularityRow::of(robot, of, published);
    rows_or("the table of circularities", &CircularityRow::default(), configurations(assessment).map(row))
}

records! {
    /// A square zone of a configuration.
    #[derive(Default)]
    pub struct ZoneRow of (key: Key, side: f64, zone: Option<Zone>, printed: Option<String>) {
        #[serde(flatten)] key: Key = key,
        /// Its side.
        size_mm: PlaceMm = side.into(),
        /// Largest circularity in it.
        largest_mm: Option<DeflectionMm> = some(zone.map(|zone| zone.largest)),
        /// Its centre.
        centre: Spot = zone.map(|zone| zone.centre).into(),
        /// Published value.
        printed_mm: Option<String> = printed,
    }
}

/// `optimal-zones.csv` (Klimchik 2017, Table 6): a [`ZoneRow`] for each size.
pub(super) fn optimal_zones(
    assessment: &Assessment,
    published: Option<&PublishedTables>,
) -> Result<Vec<u8>, ReportError> {
    zones("the table of optimal zones", assessment, published, |zones| {
        (zones.optimal, Quantity::OptimalZone(zones.side))
    })
}

/// `middle-zones.csv` (Klimchik 2017, Table 7): a [`ZoneRow`] for each size.
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
    of: impl Fn(&Zones) -> (Option<Zone>, Quantity),
) -> Result<Vec<u8>, ReportError> {
    let zones = configurations(assessment).flat_map(|(robot, configuration)| {
        let of = &of;
        configuration.zones.iter().map(move |zones| {
            let (zone, quantity) = of(zones);
            let printed = printed_value(published, robot, configuration, quantity);
            ZoneRow::of(Key::of(robot, configuration), zones.side, zone, printed)
        })
    });
    rows_or(what, &ZoneRow::default(), zones)
}

records! {
    /// A circularity at the best place, in proportion to the force (Klimchik 2017, Table 8).
    #[derive(Default)]
    pub struct AccuracyRow of (cell: &Accuracy, published: Option<&PublishedTables>) {
        /// Name of the robot.
        robot: String = cell.robot.clone(),
        /// The force.
        force_n: ForceN = cell.force.into(),
        /// The circularity; empty where the force is above the payload.
        circularity_mm: Option<DeflectionMm> = some(cell.circularity),
        /// Published value.
        printed_mm: Option<String> =
            printed_text(published.and_then(|published| published.accuracy(&cell.robot, cell.force))),
    }
}

/// `accuracy.csv`: an [`AccuracyRow`] for each robot and force.
pub(super) fn accuracy(assessment: &Assessment, published: Option<&PublishedTables>) -> Result<Vec<u8>, ReportError> {
    let cells = assessment.accuracies.iter().map(|cell| AccuracyRow::of(cell, published));
    rows_or("the table of accuracies", &AccuracyRow::default(), cells)
}

records! {
    /// The robots that suit an accuracy and a force (Klimchik 2017, Table 9): names with semicolons between.
    #[derive(Default)]
    pub struct SelectionRow of (cell: &Capable, published: Option<&PublishedTables>) {
        /// The accuracy.
        accuracy_mm: DeflectionMm = cell.accuracy.into(),
        /// The force.
        force_n: ForceN = cell.force.into(),
        /// The robots.
        robots: String = cell.robots.join("; "),
        /// Published robots.
        printed_robots: Option<String> =
            published.map(|published| published.robots(cell.accuracy, cell.force).join("; ")),
    }
}

/// `selection.csv`: a [`SelectionRow`] for each accuracy and force.
pub(super) fn selection(assessment: &Assessment, published: Option<&PublishedTables>) -> Result<Vec<u8>, ReportError> {
    let cells = assessment.capable.iter().map(|cell| SelectionRow::of(cell, published));
    rows_or("the table of the selection", &SelectionRow::default(), cells)
}
