//! The result of an identification. SI units and radians, in its serialised form too.

use super::cross_validation::Prediction;
use super::gauge::Gauge;
use super::law::ArmParameter;
use super::model::Parameter;
use super::setup::{Setup, SetupFit};
use super::springs::FitModel;
use nalgebra::{DMatrix, Vector3};
use serde::{Serialize, Serializer};
use stead_model::robot::{Robot, Spring};
use stead_numerics::message::Warning;

/// An estimate with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate<P> {
    /// The parameter.
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

/// One reading and its prediction by the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
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

/// A parameter that keeps its value in the starting robot. Intervals and covariances take that for exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Held {
    /// Which.
    pub parameter: Parameter,
    /// Why.
    pub reason: HeldReason,
}

/// Why a parameter was held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum HeldReason {
    /// By [`Problem::hold`](super::Problem::hold).
    Asked,
    /// It is not identifiable, and [`Problem::reduce`](super::Problem::reduce) allows to hold it.
    Unidentifiable,
}

/// The result of an identification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identified {
    /// Base transform and reference points.
    pub setup: Setup,
    /// How well those fit the unloaded readings.
    pub setup_fit: SetupFit,
    /// Which springs were sought.
    pub model: FitModel,
    /// Which of them cannot be told apart, and how they are told together.
    pub gauge: Gauge,
    /// One compliance for each spring, and for each distinct angle of the joint beside a compensator; of springs that
    /// cannot be told apart their sum, under the name of one of them. rad/(N m)
    pub compliances: Vec<Estimate<Parameter>>,
    /// The joint (from 0) to which [`Parameter::Group`] refers.
    pub varying: Option<usize>,
    /// The parameters of the arm, in the units of [`Quantity`](super::law::Quantity), as `robot` has them; of a spring
    /// that is told only together with others its deviation is that of the sum, as if those were exact.
    pub arm: Vec<Estimate<ArmParameter>>,
    /// Covariance of those, in their order; serialised row by row.
    #[serde(serialize_with = "rows_of")]
    pub covariance: DMatrix<f64>,
    /// The arm with its new compliances, those that cannot be told apart split such that none is below zero and the sum
    /// of their squares is least; serialised as its name.
    #[serde(serialize_with = "name_of")]
    pub robot: Robot,
    /// Parameters that were not estimated but held at the values of the starting robot.
    pub held: Vec<Held>,
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
    /// Whether there were enough equations to look for outliers.
    pub are_outliers_searched: bool,
    /// Probability that a right law of the varying joint increases the residuals as much as this one does.
    pub law_probability: Option<f64>,
    /// Error of predicted deflections, for a configuration that was left out. Component; m
    pub prediction: Prediction,
    /// Why the spring beside the varying joint is not in the arm, where it was requested and is not identifiable: then
    /// the joint has one compliance for all its angles.
    pub spring_fault: Option<String>,
    /// Configurations (from 0) in which the arm found would give way under its load, or whose equations did not settle.
    pub not_at_rest: Vec<usize>,
    /// Compliances that came out below zero by chance, and are at their lowest value in `robot`.
    pub at_lowest: Vec<Parameter>,
    /// What may be wrong with the result though the identification has not failed.
    pub warnings: Vec<Warning>,
}

fn rows_of<S: Serializer>(matrix: &DMatrix<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(matrix.row_iter().map(|row| row.iter().copied().collect::<Vec<f64>>()))
}

fn name_of<S: Serializer>(robot: &Robot, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(robot.name())
}

impl Identified {
    /// The joint (from 0) of a parameter.
    pub fn joint(&self, parameter: Parameter) -> usize {
        self.spring(parameter).joint
    }

    /// The spring of a parameter.
    pub fn spring(&self, parameter: Parameter) -> Spring {
        parameter.spring(self.varying)
    }

    /// The name of a parameter in messages, with the springs that are told only together with it.
    pub fn name(&self, parameter: Parameter, angle: Option<f64>) -> String {
        let spring = self.spring(parameter);
        self.gauge.sum_name(spring, self.model.name(spring, angle))
    }

    /// The readings that were left out.
    pub fn outliers(&self) -> impl Iterator<Item = &RowResult> {
        self.rows.iter().filter(|row| row.is_outlier)
    }
}
