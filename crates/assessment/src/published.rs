//! Published results of an assessment, and their agreement with computed ones.

use super::comparison::{Assessment, Configuration, Load};
use super::map::Elbow;
use super::ranking::{Capable, Competitor, order};
use serde::Serialize;

/// Published tables of an assessment.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PublishedTables {
    /// Readings of single configurations.
    pub readings: Vec<Reading>,
    /// Robot, force (N) and circularity (m, `None` for a dash).
    pub accuracies: Vec<(String, f64, Option<f64>)>,
    /// Accuracy (m), force (N) and a robot that reaches it.
    pub capable: Vec<(f64, f64, String)>,
}

/// What a reading is of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Quantity {
    /// Smallest circularity of the map.
    Minimum,
    /// Largest circularity of the map.
    Maximum,
    /// Circularity in the middle of the map.
    Middle,
    /// Largest circularity in the best zone of a side (m).
    OptimalZone(f64),
    /// Largest circularity in the middle zone of a side (m).
    MiddleZone(f64),
}

/// One number of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reading {
    /// Name of the robot.
    pub robot: String,
    /// Elbow, by the table's names.
    pub elbow: Elbow,
    /// Load.
    pub load: Load,
    /// What it is.
    pub quantity: Quantity,
    /// Its value, `None` for a dash. m
    pub value: Option<f64>,
}

/// How far our results and the published ones agree.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// Root mean square of computed / published - 1 over the smallest and largest circularities and the optimal zones
    /// under the test load.
    pub rms: f64,
    /// Number of readings behind it.
    pub readings: usize,
    /// Readings of that kind where only one of the two has a value.
    pub one_sided: usize,
    /// The published order of the robots, the most accurate at its best place first.
    pub order: Vec<String>,
    /// Whether the most accurate of the robots in both is the same.
    pub same_best: bool,
    /// Whether the least accurate of them is the same.
    pub same_worst: bool,
    /// Whether their whole order is the same.
    pub same_order: bool,
    /// Cells of the published table of accuracies, and how many of the computed ones round to the same.
    pub accuracies: (usize, usize),
    /// Cells of the published table of capable robots, and in how many of them the computed one names the same robots,
    /// those apart that are not printed.
    pub capable: (usize, usize),
}

/// Sides closer than this are the same zone. m
const SAME_SIDE: f64 = 1e-6;
/// Accuracies closer than this are the same. m
const SAME_ACCURACY: f64 = 1e-9;
/// Forces closer than this are the same. N
const SAME_FORCE: f64 = 1e-6;

impl Quantity {
    /// The same quantity of a computed configuration. m
    pub fn of(self, configuration: &Configuration) -> Option<f64> {
        let zones = |side: f64| configuration.zones.iter().find(move |zones| (zones.side - side).abs() < SAME_SIDE);
        match self {
            Self::Minimum => configuration.min.map(|spot| spot.circularity),
            Self::Maximum => configuration.max.map(|spot| spot.circularity),
            Self::Middle => configuration.middle.map(|spot| spot.circularity),
            Self::OptimalZone(side) => zones(side).and_then(|zones| zones.optimal).map(|zone| zone.largest),
            Self::MiddleZone(side) => zones(side).and_then(|zones| zones.middle).map(|zone| zone.largest),
        }
    }

    fn is_compared(self) -> bool {
        matches!(self, Self::Minimum | Self::Maximum | Self::OptimalZone(_))
    }

    fn is_same(self, other: Self) -> bool {
        match (self, other) {
            (Self::OptimalZone(a), Self::OptimalZone(b)) | (Self::MiddleZone(a), Self::MiddleZone(b)) => {
                (a - b).abs() < SAME_SIDE
            }
            _ => self == other,
        }
    }
}

impl PublishedTables {
    /// The printed value of a quantity: `None` where it is not printed, `Some(None)` for a dash. m
    pub fn value(&self, robot: &str, elbow: Elbow, load: Load, quantity: Quantity) -> Option<Option<f64>> {
        let is_it = |reading: &&Reading| {
            reading.robot == robot
                && reading.elbow == elbow
                && reading.load == load
                && reading.quantity.is_same(quantity)
        };
        self.readings.iter().find(is_it).map(|reading| reading.value)
    }

    /// The printed circularity of a robot at a force, as [`Self::value`].
    pub fn accuracy(&self, robot: &str, force: f64) -> Option<Option<f64>> {
        let found = self.accuracies.iter().find(|(name, at, _)| name == robot && (at - force).abs() < SAME_FORCE);
        found.map(|(_, _, value)| *value)
    }

    /// The printed robots that reach an accuracy under a force.
    pub fn robots(&self, accuracy: f64, force: f64) -> Vec<&str> {
        let is_it =
            |(a, f, _): &&(f64, f64, String)| (a - accuracy).abs() < SAME_ACCURACY && (f - force).abs() < SAME_FORCE;
        self.capable.iter().filter(is_it).map(|(_, _, robot)| robot.as_str()).collect()
    }

    /// Compares the readings with computed ones.
    pub fn agreement(&self, ours: &Assessment) -> Agreement {
        let (mut squares, mut readings, mut one_sided) = (0.0, 0, 0);
        for reading in self.readings.iter().filter(|r| r.load == Load::Test && r.quantity.is_compared()) {
            let configuration = ours.configuration(&reading.robot, reading.elbow, reading.load);
            match (configuration.and_then(|c| reading.quantity.of(c)), reading.value) {
                (Some(found), Some(published)) => {
                    let error = found / published - 1.0;
                    squares += error * error;
                    readings += 1;
                }
                (None, None) => {}
                _ => one_sided += 1,
            }
        }
        let published_order = self.order(ours);
        let shared: Vec<String> = ours.order.iter().filter(|name| published_order.contains(name)).cloned().collect();
        let rounded = |value: Option<f64>| value.map(|value| (value * 1e5).round());
        let cells = ours.accuracies.iter().filter_map(|cell| {
            self.accuracy(&cell.robot, cell.force).map(|published| rounded(published) == rounded(cell.circularity))
        });
        let cells: Vec<bool> = cells.collect();
        let heads = |accuracy: f64, force: f64| {
            self.capable.iter().any(|(a, _, _)| (a - accuracy).abs() < SAME_ACCURACY)
                && self.accuracies.iter().any(|(_, f, _)| (f - force).abs() < SAME_FORCE)
        };
        let named = ours.capable.iter().filter(|cell| heads(cell.accuracy, cell.force));
        let same = |cell: &Capable| {
            let published = self.robots(cell.accuracy, cell.force);
            let found: Vec<&String> = cell.robots.iter().filter(|name| published_order.contains(name)).collect();
            found.len() == published.len() && found.iter().all(|name| published.contains(&name.as_str()))
        };
        let named: Vec<bool> = named.map(same).collect();
        Agreement {
            rms: if readings > 0 { libm::sqrt(squares / f64::from(readings)) } else { 0.0 },
            readings: readings as usize,
            one_sided,
            same_best: !shared.is_empty() && shared.first() == published_order.first(),
            same_worst: !shared.is_empty() && shared.last() == published_order.last(),
            same_order: !shared.is_empty() && shared == published_order,
            order: published_order,
            accuracies: (cells.len(), cells.iter().filter(|same| **same).count()),
            capable: (named.len(), named.iter().filter(|same| **same).count()),
        }
    }

    /// The order of the robots by their printed smallest circularity under the test load over both elbows.
    fn order(&self, ours: &Assessment) -> Vec<String> {
        let min = |name: &str| {
            let both = Elbow::BOTH.map(|elbow| self.value(name, elbow, Load::Test, Quantity::Minimum).flatten());
            both.into_iter().flatten().reduce(f64::min)
        };
        let names = ours.robots.iter().map(|robot| robot.name.clone());
        let robots: Vec<_> = names.map(|name| Competitor { min: min(&name), name, payload: None }).collect();
        order(&robots)
    }
}

impl Assessment {
    /// One robot with one elbow under one load.
    pub fn configuration(&self, robot: &str, elbow: Elbow, load: Load) -> Option<&Configuration> {
        let robot = self.robots.iter().find(|result| result.name == robot)?;
        robot.configurations.iter().find(|configuration| configuration.elbow == elbow && configuration.load == load)
    }
}
