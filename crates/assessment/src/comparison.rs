//! Comparison of robots: every robot, both elbows, both loads, zones, and the selection.

use super::benchmark::{Benchmark, DeflectedCircle, MAX_DEFLECTION, Obstacle};
use super::map::{Elbow, Grid, Map};
use super::ranking::{Accuracy, Capable, Competitor, Selection, order};
use super::zone::{self, Zone};
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_model::robot::{DataSheet, Robot};
use stead_numerics::message::Warning;
use stead_numerics::monitor::{Monitor, Progress};

/// What is to be assessed, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The robots, in the order of the results. No two have the same name.
    pub robots: Vec<Robot>,
    /// The circle and its load.
    pub benchmark: Benchmark,
    /// Where the centre of the circle is put.
    pub grid: Grid,
    /// Sides of the square zones, in steps of the grid.
    pub zones: Vec<usize>,
    /// Which elbow goes by which name.
    pub elbow_names: ElbowNames,
    /// Share of the weight of a robot's payload that makes its rated load: 0.8 in Klimchik 2017, Table 5.
    pub rated_share: f64,
    /// Which robot for which task.
    pub selection: Selection,
}

stead_numerics::worded! {
    /// Which elbow goes by which name.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    pub enum ElbowNames {
        /// Up is above the line from the shoulder to the wrist centre.
        Geometric = "geometric",
        /// Up is below that line: the readings of Klimchik 2017 fit its tables only so.
        Swapped = "swapped",
    }
}

stead_numerics::worded! {
    /// Under which load a circle is milled.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    pub enum Load {
        /// The wrench of the benchmark.
        Test = "test",
        /// The same wrench scaled so that the force in the plane is a share of the weight of the robot's payload.
        Rated = "rated",
    }
}

/// A value of a map and where it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MapPoint {
    /// Centre of the circle, in the coordinates of the plane. m
    pub centre: [f64; 2],
    /// Circularity there. m
    pub circularity: f64,
}

/// The zones of one size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Zones {
    /// Side of the square. m
    pub side: f64,
    /// Where the largest circularity inside is smallest.
    pub optimal: Option<Zone>,
    /// About the middle of the map.
    pub middle: Option<Zone>,
}

/// One robot with one elbow under one load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Configuration {
    /// The elbow, by the names of the comparison.
    pub elbow: Elbow,
    /// The load.
    pub load: Load,
    /// Force in the plane of the circle. N
    pub force: f64,
    /// Number of circles that can be milled.
    pub circles: usize,
    /// Number of circles for which the arm is too soft under this load alone; they are not among the former.
    pub too_soft: usize,
    /// The most accurate place.
    pub min: Option<MapPoint>,
    /// The least accurate place.
    pub max: Option<MapPoint>,
    /// The middle of the map: the centre of the largest square of places that can all be milled.
    pub middle: Option<MapPoint>,
    /// Zones of the sizes of the comparison, in their order.
    pub zones: Vec<Zones>,
}

/// One robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotResult {
    /// Its name.
    pub name: String,
    /// Its data sheet.
    pub data_sheet: DataSheet,
    /// Working radius: that of the data sheet, or else the geometric reach of the wrist centre. m
    pub working_radius: f64,
    /// Load of [`Load::Rated`] in multiples of the benchmark's wrench, where the payload is known.
    pub rated_load: Option<f64>,
    /// Elbow up, then elbow down, by the names of the comparison: circularity under the test load and, where there is
    /// one, under the rated load (else that of the test load again).
    pub maps: [(Elbow, Map<2>); 2],
    /// Both elbows under the test load, then both under the rated load where there is one.
    pub configurations: Vec<Configuration>,
}

/// What an assessment finds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Assessment {
    /// The robots in the order of the comparison.
    pub robots: Vec<RobotResult>,
    /// Every robot at every force of the selection.
    pub accuracies: Vec<Accuracy>,
    /// The robots that reach every accuracy under every force.
    pub capable: Vec<Capable>,
    /// Names of the robots, the most accurate at its best place under the test load first.
    pub order: Vec<String>,
    /// Where a robot can mill no circle (`fits-nowhere`), or some not under one load alone (`too-soft`).
    pub warnings: Vec<Warning>,
}

/// No robot can mill the circle anywhere on the grid.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize)]
#[error("the circle of radius {} mm fits nowhere on the map: {}", radius * 1e3, words(limits))]
pub struct FitsNowhere {
    /// Radius of the circle. m
    pub radius: f64,
    /// What limits each robot.
    pub limits: Vec<Limits>,
}

/// Why an assessment has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AssessError {
    /// No robot can mill the circle.
    #[error("{0}")]
    FitsNowhere(FitsNowhere),
    /// It was stopped before its end.
    #[error("interrupted: there are no results")]
    Interrupted,
}

/// What keeps a robot from milling circles.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Limits {
    /// Name of the robot.
    pub robot: String,
    /// Number of circles that each obstacle prevents, the most frequent first.
    pub obstacles: Vec<(Obstacle, usize)>,
    /// Number of circles tried.
    pub tried: usize,
}

fn words(limits: &[Limits]) -> String {
    let each = limits.iter().map(|of| format!("{}: {}", of.robot, obstacle_words(&of.obstacles, of.tried)));
    each.collect::<Vec<_>>().join("; ")
}

/// How often each obstacle stands in the way, for people.
pub fn obstacle_words(obstacles: &[(Obstacle, usize)], tried: usize) -> String {
    let each = obstacles.iter().map(|(obstacle, count)| {
        let what = match obstacle {
            Obstacle::Reach => "out of reach".to_owned(),
            Obstacle::JointLimit(joint) => format!("limit of joint {joint}"),
            Obstacle::AxesSum => "limit of the sum of joints 2 and 3".to_owned(),
            Obstacle::Singularity(joint) => format!("singularity, joint {joint} would jump"),
            Obstacle::Buckling => "arm buckles under the load".to_owned(),
            Obstacle::TooSoft => format!("deflected by more than {MAX_DEFLECTION} of the radius"),
        };
        format!("{what} at {count} of {tried} places")
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Assesses every robot of the comparison, row by row of its maps.
///
/// # Errors
/// [`AssessError`] when no robot can mill the circle anywhere on the grid, or when `monitor` asked to stop.
pub fn assess(comparison: &Comparison, monitor: &Monitor) -> Result<Assessment, AssessError> {
    let total = comparison.robots.len() * 2 * comparison.grid.counts[1];
    let done = AtomicUsize::new(0);
    let row_done = || {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        monitor.report(Progress::Steps { stage: "circularity maps", done, total });
    };
    let mut robots: Vec<RobotResult> = Vec::with_capacity(comparison.robots.len());
    for robot in &comparison.robots {
        robots.push(comparison.robot(robot, monitor, &row_done));
        if monitor.should_stop() {
            return Err(AssessError::Interrupted);
        }
    }
    if robots.iter().all(|robot| robot.maps.iter().all(|(_, map)| map.count() == 0)) {
        let limits = robots.iter().map(RobotResult::limits).collect();
        return Err(AssessError::FitsNowhere(FitsNowhere { radius: comparison.benchmark.radius, limits }));
    }
    let competitors: Vec<Competitor> = robots.iter().map(RobotResult::competitor).collect();
    let reference = comparison.benchmark.in_plane_force();
    Ok(Assessment {
        accuracies: comparison.selection.accuracies(&competitors, reference),
        capable: comparison.selection.capable(&competitors, reference),
        order: order(&competitors),
        warnings: robots.iter().flat_map(RobotResult::warnings).collect(),
        robots,
    })
}

impl RobotResult {
    /// What limits the robot, both elbows together.
    pub fn limits(&self) -> Limits {
        let mut counted: Vec<(Obstacle, usize)> = Vec::new();
        for (obstacle, count) in self.maps.iter().flat_map(|(_, map)| map.obstacles()) {
            match counted.iter_mut().find(|(known, _)| *known == obstacle) {
                Some((_, sum)) => *sum += count,
                None => counted.push((obstacle, count)),
            }
        }
        counted.sort_by_key(|(obstacle, count)| (std::cmp::Reverse(*count), *obstacle));
        let tried = self.maps.iter().map(|(_, map)| map.nodes.len()).sum();
        Limits { robot: self.name.clone(), obstacles: counted, tried }
    }

    fn warnings(&self) -> Vec<Warning> {
        let name = &self.name;
        let blocked = self.maps.iter().filter(|(_, map)| map.count() == 0).map(|(elbow, map)| {
            let why = obstacle_words(&map.obstacles(), map.nodes.len());
            Warning::new("fits-nowhere", format!("{name}, elbow {}: the circle fits nowhere ({why})", elbow.word()))
        });
        let soft = self.configurations.iter().filter(|configuration| configuration.too_soft > 0).map(|configuration| {
            let (elbow, load) = (configuration.elbow.word(), configuration.load.word());
            let message = format!(
                "{name}, elbow {elbow}, {load} load: {} circles left out, deflected by more than {MAX_DEFLECTION} of the radius",
                configuration.too_soft
            );
            Warning::new("too-soft", message)
        });
        blocked.chain(soft).collect()
    }

    /// What the selection needs of the robot.
    pub fn competitor(&self) -> Competitor {
        let test = self.configurations.iter().filter(|configuration| configuration.load == Load::Test);
        let min = test.filter_map(|configuration| configuration.min.map(|spot| spot.circularity));
        Competitor { name: self.name.clone(), min: min.reduce(f64::min), payload: self.data_sheet.payload }
    }
}

impl Comparison {
    fn robot(&self, robot: &Robot, monitor: &Monitor, row_done: &(dyn Fn() + Sync)) -> RobotResult {
        let sheet = *robot.data_sheet();
        let force = self.benchmark.in_plane_force();
        let rated_load = sheet.payload.map(|payload| self.rated_share * payload * self.selection.gravity / force);
        let deflected = DeflectedCircle::new(&self.benchmark, robot);
        let maps = Elbow::BOTH.map(|name| {
            let elbow = match self.elbow_names {
                ElbowNames::Geometric => name,
                ElbowNames::Swapped => name.other(),
            };
            let class = elbow.forward_class(robot);
            let loads = [1.0, rated_load.unwrap_or(1.0)];
            (name, Map::new(&deflected, class, self.grid, loads, monitor, row_done))
        });
        let mut configurations = Vec::with_capacity(4);
        let loads = [(Load::Test, Some(1.0)), (Load::Rated, rated_load)];
        for (index, (load, scale)) in loads.into_iter().enumerate() {
            let Some(scale) = scale else { continue };
            for (elbow, map) in &maps {
                configurations.push(self.configuration(*elbow, load, force * scale, map, index));
            }
        }
        let working_radius = sheet.working_radius.unwrap_or_else(|| robot.geometry().reach());
        let name = robot.name().to_owned();
        RobotResult { name, data_sheet: sheet, working_radius, rated_load, maps, configurations }
    }

    fn configuration(&self, elbow: Elbow, load: Load, force: f64, map: &Map<2>, index: usize) -> Configuration {
        let values = map.values(index);
        let grid = &self.grid;
        let spot = |node: usize| MapPoint { centre: grid.place(node), circularity: values[node] };
        let feasible = || (0..values.len()).filter(|node| values[*node].is_finite());
        let middle = zone::middle(grid, &values);
        let zones = self.zones.iter().map(|intervals| Zones {
            side: grid.step * *intervals as f64,
            optimal: zone::optimal(grid, &values, *intervals),
            middle: middle.and_then(|node| zone::about(grid, &values, node, *intervals)),
        });
        Configuration {
            elbow,
            load,
            force,
            circles: feasible().count(),
            too_soft: map.count() - feasible().count(),
            min: feasible().min_by(|a, b| values[*a].total_cmp(&values[*b])).map(spot),
            // The first of several equal ones, as for the least.
            max: feasible().rev().max_by(|a, b| values[*a].total_cmp(&values[*b])).map(spot),
            middle: middle.map(|[column, row]| spot(row * grid.counts[0] + column)),
            zones: zones.collect(),
        }
    }
}
