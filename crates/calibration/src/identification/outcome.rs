//! What an identification finds. SI units and radians.

use super::cross_validation::Prediction;
use super::law::ArmParameter;
use super::model::Parameter;
use super::setup::{Setup, SetupFit};
use nalgebra::{DMatrix, Vector3};
use stead_model::robot::Robot;

/// An estimate with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate<P> {
    /// What is estimated.
    pub parameter: P,
    /// The joint angle to which it belongs, where that matters. rad
    pub angle: Option<f64>,
    /// The estimate.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
    /// Its 95 % interval: Student's where the noise is estimated, normal where it is known.
    pub interval: [f64; 2],
}

/// One reading beside the model.
#[derive(Debug, Clone, PartialEq)]
pub struct RowResult {
    /// Line in the sheet, from 1.
    pub line: usize,
    /// Which configuration, from 0.
    pub configuration: usize,
    /// Which reference point, from 0.
    pub point: usize,
    /// Deflection read, in the base frame. m
    pub measured: Vector3<f64>,
    /// Deflection by the identified arm. m
    pub predicted: Vector3<f64>,
    /// Root of the mean square of the studentised residual's components: about 1.
    pub studentised: f64,
    /// Whether it was left out.
    pub is_outlier: bool,
}

/// What an identification finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Base transform and reference points.
    pub setup: Setup,
    /// How well those fit the unloaded readings.
    pub setup_fit: SetupFit,
    /// One compliance for each joint, and for each distinct angle of the joint beside a compensator. rad/(N m)
    pub compliances: Vec<Estimate<Parameter>>,
    /// The joint (from 0) to which [`Parameter::Group`] refers.
    pub varying: Option<usize>,
    /// The numbers of the arm, in the units of [`ArmParameter`].
    pub arm: Vec<Estimate<ArmParameter>>,
    /// Covariance of those, in their order.
    pub covariance: DMatrix<f64>,
    /// The arm with its new compliances.
    pub robot: Robot,
    /// Parameters that the sheet does not see, held at the values of the starting robot.
    pub held: Vec<Parameter>,
    /// Every reading, in the order of the sheet.
    pub rows: Vec<RowResult>,
    /// Root of the mean square residual of a deflection's component, outliers left out. m
    pub residual_rms: f64,
    /// Standard deviation of a coordinate of one reading: as stated, or estimated. m
    pub noise: f64,
    /// Whether that was estimated from the residuals.
    pub is_noise_estimated: bool,
    /// Mean square of the residuals over that of the noise: near 1 where the noise was stated rightly.
    pub variance_ratio: f64,
    /// Equations less parameters.
    pub degrees_of_freedom: usize,
    /// Whether there were equations enough to look for outliers.
    pub are_outliers_searched: bool,
    /// Probability of residuals that grow so much by the law of the varying joint, were the law right.
    pub law_probability: Option<f64>,
    /// Error of predicted deflections, for a configuration that was left out. Component; m
    pub prediction: Prediction,
}

impl Identified {
    /// The readings that were left out.
    pub fn outliers(&self) -> impl Iterator<Item = &RowResult> {
        self.rows.iter().filter(|row| row.is_outlier)
    }
}
