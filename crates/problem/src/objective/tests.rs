//! Scores against their definition: parts of the deflection, and errors of the force drawn at random.

use super::*;
use crate::criterion::{StiffnessSets, Weights, worst_force_error, worst_gain};
use crate::evaluate::reference::State;
use crate::problem::{Placement, Problem};
use crate::testing::{slanted, with_uncertainty};
use nalgebra::{Rotation3, Unit, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_model::robot::{Posture, angles::yaw_from_q4};
use stead_model::task::Task;
use stead_numerics::scalar::Dual;

fn optimum() -> Placement {
    [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)].into()
}

/// Forces and normals of the surface in every direction.
fn with_surface() -> Problem {
    let mut problem = slanted();
    let normals = (0..105).map(|k| Rotation3::from_euler_angles(0.1 * f64::from(k), 0.7, 0.2) * Vector3::z());
    let path = problem.task.path().clone().with_surface_normals(normals.collect()).unwrap();
    problem.task = Task::new(path, problem.task.wrenches().copied().collect()).unwrap();
    problem
}

fn mixed() -> Weights {
    Weights { wall: 1.0, axis: 0.5, feed: 0.25, surface: 2.0 }
}

#[test]
fn scores_are_what_the_weights_say() {
    let mut problem = with_surface();
    let at = |problem: &Problem| problem.at(&optimum()).state(41, 0.4, Posture::ALL[2]).unwrap();
    for (weights, expected) in [
        (Weights::WALL, (|s| s.normal_part.abs()) as fn(&State<f64>) -> f64),
        (Weights::AXIS, |s| s.axial_part.abs()),
        (Weights::SURFACE, |s| s.surface_part.unwrap().abs()),
        (Weights::TOTAL, |s| s.deflection.norm()),
        (mixed(), |s| {
            let square = |value: f64| value * value;
            let parts = square(s.normal_part) + 0.5 * square(s.axial_part) + 0.25 * square(s.feed_part);
            libm::sqrt(parts + 2.0 * square(s.surface_part.unwrap()))
        }),
    ] {
        problem.criterion.weights = weights;
        let found = at(&problem);
        assert!((found.score() / expected(&found) - 1.0).abs() < 1e-12, "{weights:?}");
    }
}

#[test]
fn surfaces_are_unit_vectors_one_for_each_point() {
    use stead_model::task::TaskError;
    let path = slanted().task.path().clone();
    let normals = |count: usize, z: f64| vec![Vector3::new(0.0, 0.0, z); count];
    assert!(matches!(
        path.clone().with_surface_normals(normals(104, 1.0)),
        Err(TaskError::Normals { normals: 104, .. })
    ));
    assert!(matches!(path.clone().with_surface_normals(normals(105, 2.0)), Err(TaskError::NotUnit { point: 0, .. })));
    assert!(path.with_surface_normals(normals(105, f64::NAN)).is_err());
}

#[test]
fn objectives_put_points_and_segments_together() {
    let mut problem = slanted();
    let costs = |problem: &Problem| -> Vec<f64> {
        let span_cost = |span: &std::ops::Range<usize>| {
            let costs = span.clone().map(|point| problem.point_cost(point, 1.0 + point as f64));
            costs.reduce(|a, b| problem.criterion.aggregate.join(a, b)).unwrap()
        };
        problem.task.segments().iter().map(span_cost).collect()
    };
    let scores = || (1..=105).map(f64::from);
    assert!((problem.objective(costs(&problem)) - 53.0).abs() < 1e-12);
    problem.criterion.aggregate = Aggregate::Rms;
    let rms = libm::sqrt(scores().map(|s| s * s).sum::<f64>() / 105.0);
    assert!((problem.objective(costs(&problem)) - rms).abs() < 1e-12);
    problem.criterion.aggregate = Aggregate::Max;
    assert_eq!(problem.objective(costs(&problem)), 105.0);
    // The first of five segments, 21 points, counts three times.
    problem.criterion.segment_weights = vec![3.0, 1.0, 1.0, 1.0, 1.0];
    problem.criterion.aggregate = Aggregate::Mean;
    let expected = (scores().sum::<f64>() + 2.0 * (1..=21).map(f64::from).sum::<f64>()) / (105.0 + 42.0);
    assert!((problem.objective(costs(&problem)) - expected).abs() < 1e-12);
}

/// The largest of `|parts + gain e|` over drawn errors of a size.
fn drawn(gain: &Matrix3<f64>, parts: &Vector3<f64>, size: f64, random: &mut ChaCha8Rng) -> f64 {
    let mut largest = 0.0_f64;
    for _ in 0..2000 {
        let e = loop {
            let e = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0_f64));
            if (0.01..1.0).contains(&e.norm()) {
                break e.normalize() * size;
            }
        };
        largest = largest.max((parts + gain * e).norm());
    }
    largest
}

#[test]
fn the_worst_force_error_is_the_worst_of_all_drawn() {
    let mut random = ChaCha8Rng::seed_from_u64(13);
    for trial in 0..600 {
        let mut any = || random.random_range(-1.0..1.0_f64);
        let mut gain = Matrix3::from_fn(|_, _| any());
        let mut parts = Vector3::from_fn(|_, _| 3.0 * any());
        let size = 0.05 + any().abs();
        match trial % 6 {
            // One direction scored, two, equal compliances, nothing yet, and nothing along the softest direction.
            1 => {
                gain.fill_row(1, 0.0);
                gain.fill_row(2, 0.0);
                (parts.y, parts.z) = (0.0, 0.0);
            }
            2 => {
                gain.fill_row(2, 0.0);
                parts.z = 0.0;
            }
            3 => gain = Matrix3::identity() * any(),
            4 => parts = Vector3::zeros(),
            5 => {
                gain = Matrix3::from_diagonal(&Vector3::new(1.0, 0.5, 0.2));
                parts = Vector3::new(0.0, 0.3 * any(), 0.1);
            }
            _ => {}
        }
        let error = worst_force_error(&gain, &parts, size);
        assert!((error.norm() / size - 1.0).abs() < 1e-9, "{trial} {error}");
        let worst = (parts + gain * error).norm();
        let sampled = drawn(&gain, &parts, size, &mut random);
        assert!(sampled <= worst * (1.0 + 1e-9) && sampled > worst * (1.0 - 5e-3), "{trial} {sampled} {worst}");
        let gained = worst_gain(gain.tr_mul(&gain), gain.tr_mul(&parts), size);
        let by_gain = libm::sqrt(parts.norm_squared() + gained);
        assert!((by_gain / worst - 1.0).abs() < 1e-9, "{trial} {by_gain} {worst}");
    }
}

#[test]
fn the_stated_worst_case_is_the_largest_under_errors_on_the_boundary() {
    let mut problem = with_surface();
    problem.criterion.force_uncertainty = 0.1;
    for (weights, point) in [(Weights::TOTAL, 60), (mixed(), 60), (Weights::TOTAL, 12), (Weights::AXIS, 30)] {
        problem.criterion.weights = weights;
        let stated = problem.at(&optimum()).state(point, 0.3, Posture::ALL[2]).unwrap().score();
        let size = 0.1 * problem.task.loads()[point].wrench.force.norm();
        let mut largest = 0.0_f64;
        for k in 0..2000 {
            // Directions spread over the sphere.
            let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / 2000.0;
            let (s, c) = libm::sincos(f64::from(k) * 2.399_963_229_728_653);
            let r = libm::sqrt(1.0 - z * z);
            let mut wrenches: Vec<_> = problem.task.wrenches().copied().collect();
            wrenches[point].force += Vector3::new(r * c, r * s, z) * size;
            let mut changed = problem.clone();
            changed.criterion.force_uncertainty = 0.0;
            changed.task = Task::new(problem.task.path().clone(), wrenches).unwrap();
            largest = largest.max(changed.at(&optimum()).state(point, 0.3, Posture::ALL[2]).unwrap().score());
        }
        assert!(largest <= stated * (1.0 + 1e-12) && largest > stated * (1.0 - 1e-3), "{largest} {stated} {weights:?}");
    }
}

#[test]
fn scores_over_sets_are_their_mean_or_their_largest() {
    let mut problem = with_surface();
    problem.criterion.weights = Weights::TOTAL;
    let softer = |factor: f64| {
        let compliances = problem.robot.constant_compliances().unwrap();
        problem
            .robot
            .with_compliances(
                [compliances[0] * factor]
                    .into_iter()
                    .chain(compliances[1..].iter().copied())
                    .collect::<Vec<_>>()
                    .try_into()
                    .unwrap_or(compliances),
            )
            .unwrap()
    };
    let robots = vec![softer(1.0), softer(0.3), softer(2.0)];
    let alone: Vec<f64> = robots
        .iter()
        .map(|robot| {
            let problem = problem.clone().with(|parts| parts.robot = robot.clone());
            problem.at(&optimum()).state(41, 0.4, Posture::ALL[2]).unwrap().score()
        })
        .collect();
    let mut over = |over| {
        problem.criterion.stiffness = Some(StiffnessSets { robots: robots.clone(), over });
        problem.at(&optimum()).state(41, 0.4, Posture::ALL[2]).unwrap().score()
    };
    assert!((over(Over::Mean) / (alone.iter().sum::<f64>() / 3.0) - 1.0).abs() < 1e-12);
    assert_eq!(over(Over::Worst), alone.iter().copied().fold(0.0, f64::max));
}

proptest! {
    #[test]
    fn derivatives_of_scores_agree_with_central_differences(
        beta in -3.0..3.0_f64, point in 0..105_usize, scored in 0..4_usize, is_robust in any::<bool>(), axis in any::<[i8; 3]>()
    ) {
        let mut problem = with_uncertainty(with_surface(), 0.1);
        problem.criterion.weights = [Weights::SURFACE, Weights::AXIS, Weights::TOTAL, mixed()][scored];
        if is_robust {
            (problem.criterion.force_uncertainty, problem.criterion.confidence) = (0.2, 1.0);
        }
        let direction = Vector3::from(axis.map(f64::from));
        prop_assume!(direction.norm() > 1.0);
        let direction = Unit::new_normalize(direction);
        let at = |shift: f64| {
            let base = optimum();
            let moved = [base.x + shift * direction.x, base.y + shift * direction.y, base.z + shift * direction.z, base.yaw + shift];
            problem.at(&moved.into()).state(point, beta - shift, Posture::ALL[2])
        };
        let base: [f64; 4] = optimum().into();
        let placement = Placement::from(std::array::from_fn(|k| Dual::<5>::variable(base[k], k)));
        let Ok(exact) = problem.at(&placement).state(point, Dual::variable(beta, 4), Posture::ALL[2]) else { return Ok(()) };
        // A degree and more away from where a signed part vanishes.
        prop_assume!(exact.inverse_condition.value > 0.05 && exact.own.scored.value.abs() > 1e-4);
        let gradient = exact.score().gradient;
        let along = gradient[0] * direction.x + gradient[1] * direction.y + gradient[2] * direction.z + gradient[3] - gradient[4];
        let h = 1e-5;
        let (Ok(up), Ok(down)) = (at(h), at(-h)) else { return Ok(()) };
        let difference = (up.score() - down.score()) / (2.0 * h);
        prop_assert!((along - difference).abs() < 1e-6 * (1.0 + along.abs()), "{along} {difference}");
    }
}
