//! The job as a whole.

use super::distribution::{half_width, tail};
use super::law::{ArmFit, Law, LawError, Quantity, fit};
use super::model::{Layout, Noise, Observation, Parameter, Response, observations};
use super::normal::{Free, Normal, Unseen};
use super::outcome::{Estimate, Identified, RowResult};
use super::outliers::{Judgement, Task};
use super::setup::{Setup, SetupError, estimate};
use super::sheet::Sheet;
use super::validate::{compliances, leave_one_out};
use crate::robot::{Compensator, Compliance, Pose, Robot, RobotError};
use nalgebra::{Vector3, Vector6};

/// What is to be identified, from what.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The arm to start from: geometry, limits, and compliances of about the right size.
    pub robot: Robot,
    /// The measurements.
    pub sheet: Sheet,
    /// Where the wrench acts, in the flange frame. m
    pub load_point: Vector3<f64>,
    /// Standard deviation of a coordinate of one reading, if known; always known in sheets with orientations. m
    pub noise: Option<f64>,
    /// Standard deviation of a component of one orientation; used in sheets with orientations. rad
    pub orientation_noise: Option<f64>,
    /// The joint (from 0) with one compliance for each distinct angle, and the law of those.
    pub varying: Option<(usize, Law)>,
    /// Angles of that joint that differ by no more than this count as one. rad
    pub angle_tolerance: f64,
    /// Where to start looking for the robot base in the tracker's frame; without it, all round.
    pub start: Option<Pose<f64>>,
    /// Whether parameters that cannot be seen are held at the values of `robot`; else they are refused.
    pub reduce: bool,
}

/// Why nothing can be identified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Base transform and reference points cannot be told.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// A deflection is far larger than the load could cause on the starting arm.
    #[error("a deflection of {deflection_mm:.3} mm, where the load could cause some {expected_mm:.3} mm")]
    TooFar {
        /// Line of the reading in the sheet, from 1.
        line: usize,
        /// The deflection. mm
        deflection_mm: f64,
        /// Upper bound by the compliances of the starting arm. mm
        expected_mm: f64,
    },
    /// Fewer equations than unknowns.
    #[error("{equations} deflection components do not tell {unknowns} compliances")]
    TooFew {
        /// Components read.
        equations: usize,
        /// Compliances sought.
        unknowns: usize,
    },
    /// As many equations as unknowns, and the noise is not stated.
    #[error("{equations} deflection components for {equations} compliances leave nothing to estimate the noise from")]
    NoiseUnknown {
        /// Components read, and compliances sought.
        equations: usize,
    },
    /// Compliances, or combinations of them, that change no reading.
    #[error("the readings do not see every compliance")]
    Unseen {
        /// What they do not see.
        unseen: Vec<Unseen>,
        /// The parameters, to name them by.
        layout: Layout,
    },
    /// The compensator cannot be told.
    #[error("{0}")]
    Law(#[from] LawError),
    /// A compliance comes out at zero or below.
    #[error(
        "the compliance of joint {joint} comes out as {value_urad:.4} with a standard deviation of {deviation_urad:.4} \
         urad/(N m): it is not told by these readings"
    )]
    NotPositive {
        /// Number of the joint, from 1.
        joint: usize,
        /// The estimate. urad/(N m)
        value_urad: f64,
        /// Its standard deviation. urad/(N m)
        deviation_urad: f64,
    },
    /// The identified arm is refused, as where the compensator makes a joint give way inside its limits.
    #[error("the identified arm is none: {0}")]
    Robot(#[from] RobotError),
}

/// Deflections may be this many times what the starting arm lets expect.
const FAR: f64 = 50.0;
/// Residuals below this are rounding, whatever the tracker. m
const ROUNDING: f64 = 1e-10;
/// Setup and outliers hardly depend on each other: two rounds settle them.
const ROUNDS: usize = 4;

/// Identifies the compliances of an arm.
///
/// Outliers are left out of the deflections and then of the setup too, until both agree. Where the noise is not stated it is
/// estimated from the residuals, with twice its variance in the difference of two readings.
///
/// # Errors
/// [`IdentifyError`] when the sheet does not tell them.
pub fn identify(problem: &Problem) -> Result<Identified, IdentifyError> {
    let sheet = &problem.sheet;
    let layout = Layout::new(sheet, problem.varying.map(|(joint, _)| joint), problem.angle_tolerance);
    let flanges: Vec<Pose<f64>> = sheet.configurations.iter().map(|c| problem.robot.forward(&c.theta)).collect();
    let mut kept = vec![true; sheet.readings.len()];
    let mut setup = estimate(sheet, &flanges, &kept, problem.start.as_ref())?;
    check_lengths(problem, &setup)?;
    let (start_joints, start_groups) = starting_values(problem, &layout);
    let held = (&start_joints, &start_groups[..]);
    let noise = Noise { position: problem.noise.unwrap_or(1.0), orientation: problem.orientation_noise.unwrap_or(1.0) };
    let least_scale = if problem.noise.is_some() { 1.0 } else { ROUNDING };
    let equations = |setup: &Setup| observations(&problem.robot, sheet, setup, &problem.load_point, &noise);
    let mut observations = equations(&setup);
    let (free, dropped) = free_parameters(problem, &layout, &observations)?;
    let judge = |observations: &[Observation]| {
        let task = Task { sheet, layout: &layout, observations, free: &free, held, least_scale };
        task.judge().ok_or_else(|| IdentifyError::Unseen { unseen: vec![], layout: layout.clone() })
    };
    let mut judgement = judge(&observations)?;
    for _ in 0..ROUNDS {
        if judgement.kept == kept {
            break;
        }
        kept.clone_from(&judgement.kept);
        setup = estimate(sheet, &flanges, &kept, Some(&setup.tracker_from_base))?;
        observations = equations(&setup);
        judgement = judge(&observations)?;
    }
    let found = Found { problem, layout: &layout, setup, equations: &observations, free: &free, judgement, noise };
    found.outcome(dropped)
}

/// Refuses a deflection that is far larger than the starting arm lets expect.
fn check_lengths(problem: &Problem, setup: &Setup) -> Result<(), IdentifyError> {
    for configuration in &problem.sheet.configurations {
        let compliances = problem.robot.compliances_at(&configuration.theta);
        for reading in &problem.sheet.readings[configuration.readings.clone()] {
            let response =
                Response::of(&problem.robot, configuration, &problem.load_point, &setup.points[reading.point]);
            let columns = response.linear.column_iter().zip(compliances);
            let expected: f64 = columns.map(|(column, compliance)| column.norm() * compliance).sum();
            let deflection = (reading.loaded - reading.unloaded).norm();
            if deflection > FAR * expected.max(1e-4) {
                return Err(IdentifyError::TooFar {
                    line: reading.line,
                    deflection_mm: deflection * 1e3,
                    expected_mm: expected * 1e3,
                });
            }
        }
    }
    Ok(())
}

/// The compliances of the starting arm: of the joints, and at the distinct angles.
fn starting_values(problem: &Problem, layout: &Layout) -> (Vector6<f64>, Vec<f64>) {
    let middle = problem.sheet.configurations.first().map_or([0.0; 6], |configuration| configuration.theta);
    let joints = Vector6::from(problem.robot.compliances_at(&middle));
    let at = |angle: &f64| layout.varying.map_or(0.0, |joint| problem.robot.joints()[joint].compliance_at(*angle));
    (joints, layout.angles.iter().map(at).collect())
}

/// Which parameters are sought, and those that are not because nothing is seen of them.
fn free_parameters(
    problem: &Problem,
    layout: &Layout,
    equations: &[Observation],
) -> Result<(Free, Vec<Parameter>), IdentifyError> {
    let sheet = &problem.sheet;
    let normal = Normal::new(sheet, layout, equations, &vec![1.0; equations.len()]);
    let mut free = normal.all_free();
    let rows = sheet.readings.len() * sheet.rows_per_reading();
    let mut dropped = Vec::new();
    loop {
        let unseen = normal.unseen(&free);
        if unseen.is_empty() {
            break;
        }
        if !problem.reduce {
            let unknowns = layout.parameters().len();
            return Err(if rows < unknowns {
                IdentifyError::TooFew { equations: rows, unknowns }
            } else {
                IdentifyError::Unseen { unseen, layout: layout.clone() }
            });
        }
        for parameter in unseen.iter().filter_map(|unseen| unseen.parameters.first()) {
            match parameter {
                Parameter::Joint(joint) => free.joints[*joint] = false,
                Parameter::Group(group) => free.groups[*group] = false,
            }
            if !dropped.contains(parameter) {
                dropped.push(*parameter);
            }
        }
    }
    let unknowns = layout.parameters().len() - dropped.len();
    if rows < unknowns || unknowns == 0 {
        return Err(IdentifyError::TooFew { equations: rows, unknowns });
    }
    if rows == unknowns && problem.noise.is_none() {
        return Err(IdentifyError::NoiseUnknown { equations: rows });
    }
    Ok((free, dropped))
}

/// Everything that has been estimated, to be put together.
struct Found<'a> {
    problem: &'a Problem,
    layout: &'a Layout,
    setup: Setup,
    equations: &'a [Observation],
    free: &'a Free,
    judgement: Judgement,
    noise: Noise,
}

impl Found<'_> {
    fn outcome(self, held: Vec<Parameter>) -> Result<Identified, IdentifyError> {
        let (sheet, layout, judgement) = (&self.problem.sheet, self.layout, &self.judgement);
        let law = self.problem.varying.map_or(Law::Constant, |(_, law)| law);
        let arm = fit(&judgement.normal, self.free.joints, &judgement.solution, &layout.angles, law)?;
        let is_noise_estimated = self.problem.noise.is_none();
        // Equations have unit variance where the noise is known; else the residuals tell their variance.
        let variance = if is_noise_estimated { judgement.variance } else { 1.0 };
        let width = half_width(is_noise_estimated.then_some(judgement.degrees));
        let seen = self.seen(variance, width);
        let estimates = self.arm(&arm, variance, width)?;
        let robot = self.robot(&arm)?;
        let rows = self.rows(&arm);
        let mut prediction = leave_one_out(sheet, layout, self.equations, &judgement.kept, &arm);
        let difference = libm::sqrt(2.0) * self.noise.position;
        prediction.rms *= difference;
        prediction.worst = prediction.worst.map(|(index, rms)| (index, rms * difference));
        let inside = || rows.iter().filter(|row| !row.is_outlier);
        let squares: f64 = inside().map(|row| (row.measured - row.predicted).norm_squared()).sum();
        Ok(Identified {
            seen,
            varying: layout.varying,
            arm: estimates,
            covariance: &arm.covariance * variance,
            robot,
            held,
            residual_rms: libm::sqrt(squares / (3 * inside().count()).max(1) as f64),
            noise: self.noise.position * libm::sqrt(variance),
            is_noise_estimated,
            variance_ratio: judgement.variance / variance,
            degrees: judgement.degrees,
            are_outliers_searched: judgement.is_searched,
            law_probability: self.law_probability(&arm),
            prediction,
            setup: self.setup.clone(),
            rows,
        })
    }

    fn seen(&self, variance: f64, width: f64) -> Vec<Estimate<Parameter>> {
        let solution = &self.judgement.solution;
        let covariance = |group: Option<usize>| solution.covariance(self.layout.varying, group);
        let whole = covariance(None);
        let estimate = |parameter: Parameter| {
            let joint = self.layout.joint(parameter);
            let (value, square) = match parameter {
                Parameter::Joint(_) => (solution.joints[joint], whole[(joint, joint)]),
                Parameter::Group(group) => (solution.groups[group], covariance(Some(group))[(joint, joint)]),
            };
            interval(parameter, self.layout.angle(parameter), value, libm::sqrt(square * variance), width)
        };
        let is_free = |parameter: &Parameter| match parameter {
            Parameter::Joint(joint) => self.free.joints[*joint],
            Parameter::Group(group) => self.free.groups[*group],
        };
        self.layout.parameters().into_iter().filter(is_free).map(estimate).collect()
    }

    fn arm(
        &self,
        arm: &ArmFit,
        variance: f64,
        width: f64,
    ) -> Result<Vec<Estimate<super::law::ArmParameter>>, IdentifyError> {
        let deviation = |index: usize| libm::sqrt(arm.covariance[(index, index)] * variance);
        for (index, parameter) in arm.parameters.iter().enumerate() {
            if parameter.quantity == Quantity::Compliance && arm.values[index] <= 0.0 {
                return Err(IdentifyError::NotPositive {
                    joint: parameter.joint + 1,
                    value_urad: arm.values[index] * 1e6,
                    deviation_urad: deviation(index) * 1e6,
                });
            }
        }
        let estimates = arm.parameters.iter().enumerate();
        Ok(estimates.map(|(index, p)| interval(*p, None, arm.values[index], deviation(index), width)).collect())
    }

    /// The starting arm with the numbers that have been estimated.
    fn robot(&self, arm: &ArmFit) -> Result<Robot, RobotError> {
        let value = |joint: usize, quantity: Quantity| {
            let place = arm.parameters.iter().position(|p| p.joint == joint && p.quantity == quantity);
            place.map(|place| arm.values[place])
        };
        let start = &self.problem.robot;
        start.with_compliances(std::array::from_fn(|joint| {
            let Some(alone) = value(joint, Quantity::Compliance) else { return start.joints()[joint].compliance };
            match (self.problem.varying, value(joint, Quantity::SpringStiffness), value(joint, Quantity::FreeLength)) {
                (Some((_, Law::Spring(geometry))), Some(spring_stiffness), Some(free_length)) => {
                    let (a, l, alpha) = (geometry.a, geometry.l, geometry.alpha);
                    let compensator = Compensator { spring_stiffness, a, l, alpha, free_length };
                    Compliance::Compensated { alone, compensator }
                }
                _ => Compliance::Constant(alone),
            }
        }))
    }

    fn rows(&self, arm: &ArmFit) -> Vec<RowResult> {
        let difference = libm::sqrt(2.0) * self.noise.position;
        let row = |(index, reading): (usize, &super::sheet::Reading)| {
            let equation = &self.equations[index];
            let compliances = compliances(self.layout, arm, reading.configuration);
            let linear = |vector: Vector6<f64>| vector.fixed_rows::<3>(0).into_owned() * difference;
            RowResult {
                line: reading.line,
                configuration: reading.configuration,
                point: reading.point,
                measured: linear(equation.deflection),
                predicted: linear(equation.design * compliances),
                studentised: self.judgement.studentised[index],
                is_outlier: !self.judgement.kept[index],
            }
        };
        self.problem.sheet.readings.iter().enumerate().map(row).collect()
    }

    /// How likely it is that the law of the varying joint costs as much as it does beside one compliance for each angle.
    fn law_probability(&self, arm: &ArmFit) -> Option<f64> {
        let unknowns = match self.problem.varying?.1 {
            Law::Constant => 1,
            Law::Spring(_) => 3,
        };
        let free = self.free.groups.iter().filter(|free| **free).count();
        let (more, degrees) = (free.checked_sub(unknowns).filter(|more| *more > 0)?, self.judgement.degrees);
        // The increase is a quadratic form in the difference of the two solutions.
        let normal = &self.judgement.normal;
        let joints = arm.joints - self.judgement.solution.joints;
        let mut cost = (normal.shared * joints).dot(&joints);
        for (index, group) in normal.groups.iter().enumerate() {
            let difference = arm.groups[index].0 - self.judgement.solution.groups[index];
            cost += (2.0 * group.coupling.dot(&joints) + group.diagonal * difference) * difference;
        }
        let floor = if self.problem.noise.is_some() { 1.0 } else { ROUNDING * ROUNDING };
        Some(tail(cost / more as f64 / self.judgement.variance.max(floor), more, degrees.max(1)))
    }
}

fn interval<P>(parameter: P, angle: Option<f64>, value: f64, deviation: f64, width: f64) -> Estimate<P> {
    Estimate { parameter, angle, value, deviation, interval: [value - width * deviation, value + width * deviation] }
}
