//! The result of an identification from its estimates: intervals, arm, residuals, prediction error.

use super::cross_validation::{compliances, leave_one_out};
use super::distribution::{half_width, tail};
use super::error::IdentifyError;
use super::gauge::Gauge;
use super::law::{ArmFit, ArmParameter, Law, Quantity, fit};
use super::made::{NEGATIVE, about_axes, made};
use super::model::{Layout, Noise, Observation, Parameter};
use super::normal_equations::FreeParameters;
use super::outcome::{Estimate, Held, HeldReason, Identified, RowResult};
use super::outliers::{ROUNDING, RobustEstimate};
use super::problem::Problem;
use super::setup::{Setup, SetupFit};
use super::sheet::Reading;
use super::springs::{FitModel, stated_normal};
use nalgebra::Vector6;
use stead_model::robot::{Compliance, Robot};

/// What to try where springs about the axes alone do not fit.
pub(super) const FULL_HINT: &str = "; springs normal to the axes may explain the readings: fit.model = \"full\"";

/// The estimates that the result is assembled from.
pub(super) struct Assembly<'a, const N: usize> {
    /// The problem.
    pub problem: &'a Problem,
    /// The parameters.
    pub layout: &'a Layout,
    /// Base transform and reference points.
    pub setup: Setup,
    /// Their fit to the unloaded readings.
    pub fit: SetupFit,
    /// The equations of all readings.
    pub equations: &'a [Observation<N>],
    /// Which parameters are free.
    pub free: &'a FreeParameters<N>,
    /// The estimate without outliers.
    pub robust: RobustEstimate<N>,
    /// Standard deviations by which the equations were divided.
    pub noise: Noise,
    /// Springs that are held as asked.
    pub asked: [bool; N],
    /// Which springs cannot be told apart.
    pub gauge: Gauge,
    /// Configurations (from 0) whose equations do not describe the arm at rest.
    pub not_at_rest: Vec<usize>,
}

/// The arm by a law of its varying joint.
struct FittedArm<const N: usize> {
    law: Law,
    arm: ArmFit<N>,
    estimates: Vec<Estimate<ArmParameter>>,
    robot: Robot,
    at_lowest: Vec<Parameter>,
}

impl<const N: usize> Assembly<'_, N> {
    /// All of it, with the law of the varying joint fitted; warnings are left to be added. `dropped` are the
    /// unidentifiable parameters that are not free. A spring that is not identifiable is left out, and the rest kept:
    /// its joint then has one compliance for all angles.
    pub fn assemble(self, dropped: Vec<Parameter>) -> Result<Identified, IdentifyError> {
        let (sheet, layout, robust) = (&self.problem.sheet, self.layout, &self.robust);
        let law = self.problem.varying.map_or(Law::Constant, |(_, law)| law);
        let is_noise_estimated = self.problem.noise.is_none();
        // Equations have unit variance where the noise is known; else the residuals tell their variance.
        let variance = if is_noise_estimated { robust.variance } else { 1.0 };
        let width = half_width(is_noise_estimated.then_some(robust.degrees));
        let compliances = self.compliances(variance, width);
        self.refuse_negative(&compliances)?;
        let (FittedArm { law, arm, estimates, robot, at_lowest }, spring_fault) =
            match self.fitted(law, variance, width) {
                Err(error) if error.is_of_the_spring() => {
                    (self.fitted(Law::Constant, variance, width)?, Some(error.to_string()))
                }
                fitted => (fitted?, None),
            };
        let rows = self.rows(&arm);
        let mut prediction = leave_one_out(sheet, layout, self.equations, &robust.kept, &arm);
        let difference = libm::sqrt(2.0) * self.noise.position;
        prediction.rms *= difference;
        prediction.worst = prediction.worst.map(|(index, rms)| (index, rms * difference));
        let inside = || rows.iter().filter(|row| !row.is_outlier);
        let squares: f64 = inside().map(|row| (row.measured - row.predicted).norm_squared()).sum();
        Ok(Identified {
            model: self.problem.model,
            gauge: self.gauge.clone(),
            compliances,
            varying: layout.varying,
            arm: estimates,
            covariance: &arm.covariance * variance,
            robot,
            held: self.held(dropped),
            residual_rms: libm::sqrt(squares / (3 * inside().count()).max(1) as f64),
            noise: self.noise.position * libm::sqrt(variance),
            is_noise_estimated,
            variance_ratio: robust.variance / variance,
            degrees_of_freedom: robust.degrees,
            are_outliers_searched: robust.is_searched,
            law_probability: self.law_probability(law, &arm),
            prediction,
            setup: self.setup.clone(),
            setup_fit: self.fit.clone(),
            rows,
            spring_fault,
            not_at_rest: self.not_at_rest,
            at_lowest,
            warnings: vec![],
        })
    }

    /// The parameters of the arm by a law of the varying joint.
    fn fitted(&self, law: Law, variance: f64, width: f64) -> Result<FittedArm<N>, IdentifyError> {
        let RobustEstimate { normal, solution, .. } = &self.robust;
        let arm = fit(normal, self.free.joints, solution, &self.layout.angles, law)?;
        let estimates = self.arm(&arm, variance, width)?;
        let (robot, at_lowest) = match self.problem.model {
            FitModel::Axes => (about_axes(self.problem, &arm, &arm.values, |_, alone| alone)?, vec![]),
            FitModel::Full => made(self.problem, &self.gauge, &arm, variance)?,
        };
        let estimates = match self.problem.model {
            FitModel::Axes => estimates,
            FitModel::Full => estimates.into_iter().map(|estimate| as_in(&robot, estimate)).collect(),
        };
        Ok(FittedArm { law, arm, estimates, robot, at_lowest })
    }

    fn held(&self, dropped: Vec<Parameter>) -> Vec<Held> {
        let requested = (0..N).filter(|number| self.asked[*number]).map(Parameter::of_column);
        let requested = requested.map(|parameter| Held { parameter, reason: HeldReason::Asked });
        let dropped = dropped.into_iter();
        requested.chain(dropped.map(|parameter| Held { parameter, reason: HeldReason::Unidentifiable })).collect()
    }

    fn compliances(&self, variance: f64, width: f64) -> Vec<Estimate<Parameter>> {
        let solution = &self.robust.solution;
        let covariance = |group: Option<usize>| solution.covariance(self.layout.varying, group);
        let whole = covariance(None);
        let estimate = |parameter: Parameter| {
            let column = self.layout.column(parameter);
            let (value, square) = match parameter {
                Parameter::Joint(_) | Parameter::Normal(_) => (solution.joints[column], whole[(column, column)]),
                Parameter::Group(group) => (solution.groups[group], covariance(Some(group))[(column, column)]),
            };
            interval(parameter, self.layout.angle(parameter), value, libm::sqrt(square * variance), width)
        };
        self.layout.parameters().into_iter().filter(|parameter| self.free.contains(*parameter)).map(estimate).collect()
    }

    /// Refuses a compliance that noise cannot explain: the joint turns against its load.
    fn refuse_negative(&self, compliances: &[Estimate<Parameter>]) -> Result<(), IdentifyError> {
        if self.problem.model == FitModel::Full {
            // A sum may well be negative, and what is not is told by the split among the springs.
            return Ok(());
        }
        let worst = compliances.iter().filter(|e| e.value < -NEGATIVE * e.deviation).min_by(|a, b| {
            let [a, b] = [a, b].map(|e| e.value / e.deviation.max(f64::MIN_POSITIVE));
            a.total_cmp(&b)
        });
        worst.map_or(Ok(()), |estimate| {
            Err(IdentifyError::Negative {
                name: format!("joint {}", self.layout.spring(estimate.parameter).joint + 1),
                hint: FULL_HINT,
                value_urad: estimate.value * 1e6,
                deviation_urad: estimate.deviation * 1e6,
            })
        })
    }

    fn arm(&self, arm: &ArmFit<N>, variance: f64, width: f64) -> Result<Vec<Estimate<ArmParameter>>, IdentifyError> {
        let deviation = |index: usize| libm::sqrt(arm.covariance[(index, index)] * variance);
        for (index, parameter) in arm.parameters.iter().enumerate() {
            let is_bounded = self.problem.model == FitModel::Axes || self.layout.varying == Some(parameter.column());
            if is_bounded && parameter.quantity == Quantity::Compliance && arm.values[index] <= 0.0 {
                return Err(IdentifyError::NotPositive {
                    joint: parameter.joint + 1,
                    hint: if self.problem.model == FitModel::Axes { FULL_HINT } else { "" },
                    value_urad: arm.values[index] * 1e6,
                    deviation_urad: deviation(index) * 1e6,
                });
            }
        }
        let estimates = arm.parameters.iter().enumerate();
        Ok(estimates.map(|(index, p)| interval(*p, None, arm.values[index], deviation(index), width)).collect())
    }

    fn rows(&self, arm: &ArmFit<N>) -> Vec<RowResult> {
        let difference = libm::sqrt(2.0) * self.noise.position;
        let row = |(index, reading): (usize, &Reading)| {
            let equation = &self.equations[index];
            let compliances = compliances(self.layout, arm, reading.configuration);
            let linear = |vector: Vector6<f64>| vector.fixed_rows::<3>(0).into_owned() * difference;
            RowResult {
                line: reading.line,
                configuration: reading.configuration,
                point: reading.point,
                measured: linear(equation.deflection + equation.known),
                predicted: linear(equation.design * compliances + equation.known),
                studentised: self.robust.studentised[index],
                is_outlier: !self.robust.kept[index],
            }
        };
        self.problem.sheet.readings.iter().enumerate().map(row).collect()
    }

    /// F test of the law of the varying joint against one compliance for each angle: the probability of so large an
    /// increase of the residuals under a right law.
    fn law_probability(&self, law: Law, arm: &ArmFit<N>) -> Option<f64> {
        self.problem.varying?;
        let unknowns = match law {
            Law::Constant => 1,
            Law::Spring(_) => 3,
        };
        let free = self.free.groups.iter().filter(|free| **free).count();
        let (more, degrees) = (free.checked_sub(unknowns).filter(|more| *more > 0)?, self.robust.degrees);
        // The increase is a quadratic form in the difference of the two solutions.
        let normal = &self.robust.normal;
        let joints = arm.joints - self.robust.solution.joints;
        let mut cost = (normal.shared * joints).dot(&joints);
        for (index, group) in normal.groups.iter().enumerate() {
            let difference = arm.groups[index].0 - self.robust.solution.groups[index];
            cost += (2.0 * group.coupling.dot(&joints) + group.diagonal * difference) * difference;
        }
        let floor = if self.problem.noise.is_some() { 1.0 } else { ROUNDING * ROUNDING };
        Some(tail(cost / more as f64 / self.robust.variance.max(floor), more, degrees.max(1)))
    }
}

/// The estimate of a parameter where an arm has it: a sum less what others have of it, as if those were exact.
fn as_in(robot: &Robot, estimate: Estimate<ArmParameter>) -> Estimate<ArmParameter> {
    let joint = estimate.parameter.joint;
    let value = match (estimate.parameter.quantity, robot.joints()[joint].compliance) {
        (Quantity::Compliance, Compliance::Constant(value)) => value,
        (Quantity::AboutX | Quantity::AboutY, _) => stated_normal(robot, estimate.parameter.spring()),
        _ => return estimate,
    };
    let moved = value - estimate.value;
    Estimate { value, interval: estimate.interval.map(|end| end + moved), ..estimate }
}

fn interval<P>(parameter: P, angle: Option<f64>, value: f64, deviation: f64, width: f64) -> Estimate<P> {
    Estimate { parameter, angle, value, deviation, interval: [value - width * deviation, value + width * deviation] }
}
