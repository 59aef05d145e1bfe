//! The arm of a full fit: what was found, split among the springs that cannot be told apart.

use super::bounded::non_negative;
use super::error::IdentifyError;
use super::gauge::Gauge;
use super::law::{ArmFit, ArmParameter, Law, Quantity};
use super::model::Parameter;
use super::problem::Problem;
use super::springs::{AXES, FULL, bearings, column, compliances_of, spring};
use nalgebra::{DMatrix, DVector};
use stead_model::robot::{Compensator, Compliance, NormalSprings, Robot, RobotError, SpringModel};

/// A compliance so many standard deviations below zero is not negative by chance.
pub(super) const NEGATIVE: f64 = 6.0;

/// The least compliance about an axis, as a share of the largest one: a robot file has none that is zero there.
const STIFFEST: f64 = 1e-6;
/// An estimate that moves by less than this share of its standard deviation has not moved.
const SAME: f64 = 1e-9;

/// The starting arm with the springs found, and which of them are at their lowest value since they came out below it.
///
/// # Errors
/// [`IdentifyError::Negative`] where chance does not explain that, and [`IdentifyError::Robot`] where the springs make
/// no arm.
pub(super) fn made<const N: usize>(
    problem: &Problem,
    gauge: &Gauge,
    arm: &ArmFit<N>,
    variance: f64,
) -> Result<(Robot, Vec<Parameter>), IdentifyError> {
    let start = &problem.robot;
    let has_spring = |joint: usize| {
        arm.parameters.iter().any(|other| other.joint == joint && other.quantity == Quantity::SpringStiffness)
    };
    let is_law = |parameter: &ArmParameter| parameter.column() == parameter.joint && has_spring(parameter.joint);
    // Bounded are the compliances of springs without a law.
    let bounded: Vec<usize> = (0..arm.parameters.len()).filter(|index| !is_law(&arm.parameters[*index])).collect();
    let largest = bounded.iter().map(|index| arm.values[*index]).fold(0.0, f64::max);
    let lowest: [f64; FULL] = std::array::from_fn(|number| if number < AXES { STIFFEST * largest } else { 0.0 });
    let mut fixed: [f64; FULL] = compliances_of::<FULL>(start, &start.mid_range()).into();
    gauge.replaced.iter().for_each(|replaced| fixed[column(replaced.spring)] = 0.0);
    let mut values = arm.values.clone();
    let mut at_lowest = Vec::new();
    let place = |values: &DVector<f64>, fixed: &mut [f64; FULL]| {
        bounded.iter().for_each(|index| fixed[arm.parameters[*index].column()] = values[*index]);
    };
    place(&values, &mut fixed);
    let is_low = bounded.iter().any(|index| {
        let number = arm.parameters[*index].column();
        gauge.others(spring(number)).is_empty() && fixed[number] < lowest[number]
    });
    let mut split = if is_low { None } else { gauge.split(&fixed, &lowest) };
    if split.is_none() {
        values = nearest(gauge, arm, &bounded, &lowest).unwrap_or(values);
        place(&values, &mut fixed);
        let moved = &values - &arm.values;
        let deviation = |index: usize| libm::sqrt(arm.covariance[(index, index)] * variance);
        let share = |index: usize| -moved[index].abs() / deviation(index).max(f64::MIN_POSITIVE);
        let far: Vec<usize> = bounded.iter().copied().filter(|index| -share(*index) > SAME).collect();
        let is_at = |index: &usize| {
            let number = arm.parameters[*index].column();
            gauge.others(spring(number)).iter().all(|(_, share)| *share > 0.0)
                && fixed[number] <= lowest[number] + SAME * largest
        };
        at_lowest = far.iter().copied().filter(is_at).collect();
        if at_lowest.is_empty() {
            at_lowest = far.clone();
        }
        let worst = at_lowest.iter().copied().min_by(|a, b| share(*a).total_cmp(&share(*b)));
        if let Some(worst) = worst.filter(|worst| share(*worst) < -NEGATIVE) {
            let own = arm.parameters[worst].spring();
            return Err(IdentifyError::Negative {
                name: gauge.sum_name(own, own.to_string()),
                hint: "",
                value_urad: arm.values[worst] * 1e6,
                deviation_urad: deviation(worst) * 1e6,
            });
        }
        split = gauge.split(&fixed, &lowest.map(|lowest| lowest * (1.0 - SAME)));
    }
    let compliances = split.unwrap_or(fixed);
    let compliances: [f64; FULL] = std::array::from_fn(|number| compliances[number].max(lowest[number]));
    let at_lowest = at_lowest.into_iter().map(|index| Parameter::of_column(arm.parameters[index].column())).collect();
    Ok((robot(problem, arm, &values, &compliances)?, at_lowest))
}

/// The estimates nearest to those of the arm, in the metric of their covariance, that can be split.
fn nearest<const N: usize>(
    gauge: &Gauge,
    arm: &ArmFit<N>,
    bounded: &[usize],
    lowest: &[f64; FULL],
) -> Option<DVector<f64>> {
    let count = bounded.len();
    let size = |index: usize| libm::sqrt(arm.covariance[(index, index)]);
    // In units of the standard deviations.
    let among = DMatrix::from_fn(count, count, |a, b| {
        arm.covariance[(bounded[a], bounded[b])] / (size(bounded[a]) * size(bounded[b]))
    });
    let root = among.clone().cholesky()?.l().try_inverse()?;
    let floor = DVector::from_iterator(
        count,
        bounded.iter().map(|index| {
            let number = arm.parameters[*index].column();
            // What replaced springs add at their lowest, which is zero, is nothing.
            lowest[number] / size(*index)
        }),
    );
    let found = DVector::from_iterator(count, bounded.iter().map(|index| arm.values[*index] / size(*index)));
    // Sums are those of the springs that are kept and the shares of those that are replaced, all of them above zero.
    let mut of_springs = DMatrix::zeros(count, count + gauge.replaced.len());
    for (row, index) in bounded.iter().enumerate() {
        of_springs[(row, row)] = 1.0;
        let own = arm.parameters[*index].spring();
        for (unknown, replaced) in gauge.replaced.iter().enumerate() {
            let share = replaced.by.iter().find(|(spring, _)| *spring == own).map_or(0.0, |(_, share)| *share);
            of_springs[(row, count + unknown)] = share * largest_size(arm, bounded) / size(*index);
        }
    }
    let solved = non_negative(&(&root * &of_springs), &(&root * (&found - &floor)))?;
    let nearest = of_springs * solved + floor;
    // What is not bounded follows.
    let change = &nearest - &found;
    let pull = among.cholesky()?.solve(&change);
    let mut values = arm.values.clone();
    for index in 0..values.len() {
        values[index] += bounded
            .iter()
            .enumerate()
            .map(|(b, other)| arm.covariance[(index, *other)] / size(*other) * pull[b])
            .sum::<f64>();
    }
    bounded.iter().enumerate().for_each(|(row, index)| values[*index] = nearest[row] * size(*index));
    Some(values)
}

/// The largest standard deviation of them, for equations of unit variance.
fn largest_size<const N: usize>(arm: &ArmFit<N>, bounded: &[usize]) -> f64 {
    libm::sqrt(bounded.iter().map(|index| arm.covariance[(*index, *index)]).fold(0.0, f64::max))
}

/// The starting arm with these compliances; with a law where one was found.
fn robot<const N: usize>(
    problem: &Problem,
    arm: &ArmFit<N>,
    values: &DVector<f64>,
    compliances: &[f64; FULL],
) -> Result<Robot, IdentifyError> {
    let start = &problem.robot;
    let bearings = bearings(start);
    let normal = std::array::from_fn(|joint| NormalSprings {
        compliance: [0, 1].map(|about| compliances[AXES + 2 * joint + about]),
        bearing: bearings[joint],
    });
    let robot = about_axes(problem, arm, values, |joint, _| compliances[joint])?.with_normal_springs(Some(normal))?;
    Ok(robot.with_spring_model(Some(SpringModel::Full)).with_stiffness_measured_from(problem.measured_from))
}

/// The starting arm with other springs about its axes: with a law where one was found, else with the compliance of a
/// joint (from 0) for its estimate. Joints that the readings do not tell of keep what they are given.
pub(super) fn about_axes<const N: usize>(
    problem: &Problem,
    arm: &ArmFit<N>,
    values: &DVector<f64>,
    compliance: impl Fn(usize, f64) -> f64,
) -> Result<Robot, RobotError> {
    let start = &problem.robot;
    let value = |joint: usize, quantity: Quantity| {
        let place = arm.parameters.iter().position(|p| p.joint == joint && p.quantity == quantity);
        place.map(|place| values[place])
    };
    let found = start.with_compliances(std::array::from_fn(|joint| {
        let Some(alone) = value(joint, Quantity::Compliance) else { return start.joints()[joint].compliance };
        match (problem.varying, value(joint, Quantity::SpringStiffness), value(joint, Quantity::FreeLength)) {
            (Some((_, Law::Spring(geometry))), Some(spring_stiffness), Some(free_length)) => {
                let (a, l, alpha) = (geometry.a, geometry.l, geometry.alpha);
                let compensator = Compensator { spring_stiffness, a, l, alpha, free_length };
                Compliance::Compensated { alone, compensator }
            }
            _ => Compliance::Constant(compliance(joint, alone)),
        }
    }))?;
    let is_whole = (0..6).all(|joint| value(joint, Quantity::Compliance).is_some());
    Ok(match start.stiffness_like() {
        Some(other) if !is_whole => found.with_stiffness_like(other),
        _ => found,
    })
}
