//! Standard deviations of the normal part: against drawn compliances, the matrix product and differences.

use super::*;
use crate::criterion::Criterion;
use crate::problem::Placement;
use crate::testing::{five_segments, five_segments_compensated, with_uncertainty};
use nalgebra::Vector6;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use stead_model::robot::angles::yaw_from_q4;
use stead_model::stiffness::displacement;
use stead_numerics::scalar::Dual;

fn published_optimum() -> Placement {
    [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)].into()
}

/// The problem with other values of its six constant compliances, each moved by its share of some directions.
fn moved(problem: &Problem, steps: &[f64]) -> Problem {
    let mut compliances = problem.robot.constant_compliances().unwrap();
    for (step, direction) in steps.iter().zip(problem.robot.uncertainty().unwrap().directions()) {
        for (compliance, share) in compliances.iter_mut().zip(direction) {
            *compliance += step * share;
        }
    }
    let robot = problem.robot.with_compliances(compliances).unwrap();
    problem.clone().with(|parts| parts.robot = robot)
}

#[test]
fn drawn_compliances_scatter_the_normal_part_as_much_as_its_deviation_says() {
    const DRAWS: usize = 4000;
    let problem = with_uncertainty(five_segments(), 0.1);
    let (placement, beta, posture) = (published_optimum(), 0.3, Posture::ALL[2]);
    let points = [3, 30, 60, 77, 104];
    let at = |problem: &Problem| points.map(|point| problem.at(&placement).state(point, beta, posture).unwrap());
    let nominal = at(&problem);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut normal = || {
        let [u, v]: [f64; 2] = [random.random(), random.random()];
        libm::sqrt(-2.0 * libm::log(1.0 - u)) * libm::cos(TAU * v)
    };
    let mut squares = [0.0; 5];
    for _ in 0..DRAWS {
        let steps: Vec<f64> = (0..6).map(|_| normal()).collect();
        let drawn = at(&moved(&problem, &steps));
        for (k, square) in squares.iter_mut().enumerate() {
            let change = drawn[k].normal_part - nominal[k].normal_part;
            *square += change * change;
            // Nothing is lost by linearising: the normal part is linear in the compliances.
            let gradient = scored_part_by_parameters(&problem, points[k], &placement, &nominal[k].joints);
            let directions = problem.robot.uncertainty().unwrap().directions();
            let shift =
                |k: usize| steps.iter().zip(directions).map(|(step, direction)| step * direction[k]).sum::<f64>();
            let expected: f64 = gradient.iter().enumerate().map(|(k, slope)| slope * shift(k)).sum();
            assert!((change - expected).abs() < 1e-15, "{change} {expected}");
        }
    }
    for (square, nominal) in squares.iter().zip(nominal) {
        let ratio = libm::sqrt(square / DRAWS as f64) / nominal.own.deviation.unwrap();
        // The standard deviation of a sample's standard deviation is 1 / sqrt(2 n) of it: 3 of them.
        assert!((ratio - 1.0).abs() < 3.0 / libm::sqrt(2.0 * DRAWS as f64), "{ratio}");
    }
}

#[test]
fn a_score_adds_deviations_as_often_as_asked() {
    let mut problem = with_uncertainty(five_segments(), 0.1);
    let at = |problem: &Problem| problem.at(&published_optimum()).state(41, 0.4, Posture::ALL[3]).unwrap();
    let sure = at(&problem);
    assert_eq!((sure.own.margin, sure.score()), (0.0, at(&five_segments()).score()));
    assert_eq!(at(&five_segments()).own.deviation, None);
    problem.criterion = Criterion { force_uncertainty: 0.1, confidence: 2.0, ..Criterion::default() };
    let found = at(&problem);
    assert_eq!(found.own.deviation, sure.own.deviation);
    assert!(found.own.uncertainty > 0.0 && found.own.margin == 2.0 * sure.own.deviation.unwrap());
    assert!((found.score() - sure.score() - found.own.uncertainty - found.own.margin).abs() < 1e-18);
    // Errors of 10 % in each compliance are about 10 % of the deflection, and not far from it.
    let share = found.own.deviation.unwrap() / found.normal_part.abs();
    assert!((0.02..0.3).contains(&share), "{share}");
}

proptest! {
    #[test]
    fn deviations_are_those_of_the_compliances_at_the_pose(
        beta in -3.0..3.0_f64, point in 0..105_usize, is_compensated in any::<bool>()
    ) {
        let problem = if is_compensated { five_segments_compensated() } else { five_segments() };
        let problem = with_uncertainty(problem, 0.1);
        let placement = published_optimum();
        let Ok(found) = problem.at(&placement).state(point, beta, Posture::ALL[2]) else { return Ok(()) };
        // What each joint adds per compliance, from the displacement when it alone yields.
        let frames = Frames::new(&problem.robot, &found.joints);
        let workpiece = placement.base_from_workpiece();
        let tip = workpiece.point(&problem.task.points()[point].position);
        let force = workpiece.rotation * problem.task.loads()[point].wrench.force;
        let moment = workpiece.rotation * problem.task.loads()[point].wrench.moment;
        let normal = workpiece.rotation * problem.task.points()[point].workpiece_from_point().column(1);
        let parts = Vector6::from_fn(|j, _| {
            let alone = std::array::from_fn(|k| if k == j { 1.0 } else { 0.0 });
            displacement(&frames, &tip, &alone, &force, &moment).linear.dot(&normal)
        });
        let covariance = problem.robot.compliance_covariance_at(&found.joints);
        let variance = (parts.transpose() * covariance * parts)[0];
        let deviation = found.own.deviation.unwrap();
        prop_assert!((deviation * deviation - variance).abs() < 1e-11 * variance, "{} {}", deviation * deviation, variance);
    }

    #[test]
    fn margins_carry_derivatives(beta in -3.0..3.0_f64, point in 0..105_usize, is_compensated in any::<bool>()) {
        let problem = if is_compensated { five_segments_compensated() } else { five_segments() };
        let mut problem = with_uncertainty(problem, 0.1);
        problem.criterion.confidence = 2.0;
        let placement = published_optimum();
        let variables = Placement::from(std::array::from_fn(|k| Dual::<5>::variable(placement[k], k)));
        let Ok(exact) = problem.at(&variables).state(point, Dual::variable(beta, 4), Posture::ALL[2]) else { return Ok(()) };
        prop_assume!(exact.inverse_condition.value > 0.05);
        let sign = if exact.normal_part.value < 0.0 { -1.0 } else { 1.0 };
        for k in 0..5 {
            let h = 1e-6;
            let at = |h: f64| {
                let shifted = Placement::from(std::array::from_fn(|j| placement[j] + if j == k { h } else { 0.0 }));
                problem.at(&shifted).state(point, beta + if k == 4 { h } else { 0.0 }, Posture::ALL[2])
            };
            let (Ok(up), Ok(down)) = (at(h), at(-h)) else { continue };
            let slope = (up.own.margin - down.own.margin) / (2.0 * h);
            prop_assert!((exact.own.margin.gradient[k] - slope).abs() < 1e-8, "{} {}", exact.own.margin.gradient[k], slope);
            let whole = sign * exact.normal_part.gradient[k] + exact.own.margin.gradient[k];
            prop_assert_eq!(whole, exact.score().gradient[k]);
        }
    }
}
