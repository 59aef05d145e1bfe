//! Inputs of the choice of measurements.

use super::super::law::Law;
use super::super::sheet::LoadCase;
use super::super::springs::{FitModel, held};
use nalgebra::Vector3;
use stead_model::robot::Robot;

/// Inputs of the choice of measurements. SI units, radians.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The arm as far as it is known: geometry, limits, and compliances of about the right size.
    pub robot: Robot,
    /// Which springs the identification will seek.
    pub model: FitModel,
    /// Where the load acts, in the flange frame. m
    pub load_point: Vector3<f64>,
    /// About where the reference points are, in the flange frame. m
    pub points: Vec<Vector3<f64>>,
    /// Standard deviation of a coordinate of one reading. m
    pub noise: f64,
    /// The joint (from 0) with one compliance for each distinct angle, and the law of those.
    pub varying: Option<(usize, Law)>,
    /// Joints whose compliance about their axis the identification will hold at that of `robot`.
    pub hold: [bool; 6],
    /// Springs about x and y of each joint that it will hold likewise, where it seeks all.
    pub hold_normal: [[bool; 2]; 6],
    /// Angles of that joint that differ by no more than this count as one. rad
    pub angle_tolerance: f64,
    /// The joint (from 0) that is put to few angles only.
    pub level_joint: usize,
    /// Those angles, ascending; none where it may have any. rad
    pub levels: Vec<f64>,
    /// Lowest and highest angle of each joint in a measurement, within its limits. rad
    pub limits: [[f64; 2]; 6],
    /// Directions of the load.
    pub loads: LoadDirections,
    /// Size of the load. N
    pub load: f64,
    /// Where things may be.
    pub volume: Volume,
    /// No reference point may be deflected further, by the compliances of `robot`. m
    pub max_deflection: f64,
    /// The point whose deflection is to be known, in the flange frame. m
    pub tip: Vector3<f64>,
    /// Where it is to be known.
    pub tests: TestCases,
    /// How many configurations to choose.
    pub configurations: usize,
    /// From how many.
    pub candidates: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Starts of the exchange: a greedy one, the best random set, and others of those.
    pub starts: usize,
    /// Random sets to compare with.
    pub random_sets: usize,
    /// A compliance whose expected standard deviation is above this share of it is weakly observed.
    pub max_relative_deviation: f64,
}

impl Request {
    /// The springs that the identification will hold, by their columns.
    pub fn held<const N: usize>(&self) -> [bool; N] {
        held(&self.hold, &self.hold_normal)
    }
}

/// Directions of the load, in the base frame, whose z axis points up.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadDirections {
    /// Any, uniform over the sphere.
    Any,
    /// Any horizontal one, uniform over the circle.
    Horizontal,
    /// Down, as a hanging weight pulls.
    Vertical,
    /// One of these unit vectors.
    Listed(Vec<Vector3<f64>>),
}

/// Where wrist centre, flange, load point, tip and reference points must be, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// Lowest and highest x, y and z. m
    pub ranges: [[f64; 2]; 3],
    /// Least distance from the z axis. m
    pub min_radius: f64,
}

impl Volume {
    /// Everywhere.
    pub const OPEN: Self = Self { ranges: [[f64::NEG_INFINITY, f64::INFINITY]; 3], min_radius: 0.0 };

    /// Whether a place is in it.
    pub fn contains(&self, place: &Vector3<f64>) -> bool {
        let is_between = place.iter().zip(self.ranges).all(|(value, [low, high])| (low..=high).contains(value));
        is_between && libm::hypot(place.x, place.y) >= self.min_radius
    }
}

/// Where the deflection of the tip is to be known.
#[derive(Debug, Clone, PartialEq)]
pub enum TestCases {
    /// Here.
    Given(Vec<LoadCase>),
    /// At so many poses drawn as the candidates are, but at any angle of every joint and under loads in any direction.
    Drawn(usize),
}
