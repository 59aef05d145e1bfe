//! The identification as a whole, on sheets of arms that are known.

use super::law::{Law, LawError, Quantity};
use super::model::Parameter;
use super::spring::Geometry;
use super::synthetic::{Cell, Shot, sheet};
use super::*;
use crate::robot::testing::kr270;
use crate::robot::{Compensator, Compliance, Pose, Robot};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};

const COMPENSATOR: Compensator =
    Compensator { spring_stiffness: 1.8e5, a: 0.9, l: 0.2, alpha: -0.4, free_length: 0.45 };
const GEOMETRY: Geometry = Geometry { a: COMPENSATOR.a, l: COMPENSATOR.l, alpha: COMPENSATOR.alpha };
const ALONE: f64 = 0.33e-6;
const NOISE: f64 = 3e-5;

/// The arm to be found: compliances as identified for a KR 270 (Klimchik et al. 2017, Table 4), with a compensator.
fn arm() -> Robot {
    let mut laws = [0.54e-6, ALONE, 0.42e-6, 2.79e-6, 3.48e-6, 2.074e-6].map(Compliance::from);
    laws[1] = Compliance::Compensated { alone: ALONE, compensator: COMPENSATOR };
    kr270().with_compliances(laws).unwrap()
}

fn cell(points: usize) -> Cell {
    let places = [Vector3::new(0.1, 0.05, 0.2), Vector3::new(-0.12, 0.08, 0.25), Vector3::new(0.02, -0.15, 0.3)];
    Cell {
        tracker_from_base: Pose {
            rotation: rotation::rotation_from_vector(&Vector3::new(0.7, -1.9, 1.2)),
            translation: Vector3::new(3.1, -2.2, 0.7),
        },
        load_point: Vector3::new(0.25, 0.0, 0.18),
        points: places[..points].to_vec(),
        is_full_pose: false,
    }
}

/// A direction all round.
fn direction(random: &mut ChaCha8Rng) -> Vector3<f64> {
    let z: f64 = random.random_range(-1.0..1.0);
    let (sine, cosine) = libm::sincos(random.random_range(0.0..TAU));
    let radius = libm::sqrt(1.0 - z * z);
    Vector3::new(radius * cosine, radius * sine, z)
}

/// Configurations all over the limits, joint 2 at one of some angles, with 2.7 kN in random directions.
fn shots(random: &mut ChaCha8Rng, count: usize, distinct: usize) -> Vec<Shot> {
    let robot = arm();
    let shot = |index: usize| {
        let mut theta: [f64; 6] = std::array::from_fn(|joint| {
            let joint = &robot.joints()[joint];
            random.random_range(joint.min.max(-PI)..joint.max.min(PI))
        });
        theta[1] = 0.2 + 2.1 * (index % distinct) as f64 / distinct as f64;
        (theta, direction(random) * 2700.0, Vector3::zeros())
    };
    (0..count).map(shot).collect()
}

/// Normal numbers (Box and Muller 1958).
fn gauss(random: &mut ChaCha8Rng) -> f64 {
    let u: f64 = random.random_range(f64::MIN_POSITIVE..1.0);
    libm::sqrt(-2.0 * libm::log(u)) * libm::cos(random.random_range(0.0..TAU))
}

fn problem(sheet: Sheet, cell: &Cell) -> Problem {
    Problem {
        robot: kr270(),
        sheet,
        load_point: cell.load_point,
        noise: None,
        orientation_noise: None,
        varying: Some((1, Law::Spring(GEOMETRY))),
        angle_tolerance: 1e-4,
        start: None,
        reduce: false,
    }
}

/// A problem of 20 configurations and 5 distinct angles.
fn standard(seed: u64, noise: f64, points: usize) -> Problem {
    let cell = cell(points);
    let shots = shots(&mut ChaCha8Rng::seed_from_u64(3), 20, 5);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let readings = sheet(&arm(), &cell, &shots, || noise * gauss(&mut random), || 0.0);
    problem(readings, &cell)
}

/// The true value of an estimate.
fn truth(parameter: Parameter, angle: Option<f64>) -> f64 {
    match parameter {
        Parameter::Joint(joint) => arm().joints()[joint].compliance_at(0.0),
        Parameter::Group(_) => arm().joints()[1].compliance_at(angle.unwrap()),
    }
}

fn arm_truth(parameter: law::ArmParameter) -> f64 {
    match parameter.quantity {
        Quantity::Compliance if parameter.joint == 1 => ALONE,
        Quantity::Compliance => truth(Parameter::Joint(parameter.joint), None),
        Quantity::SpringStiffness => COMPENSATOR.spring_stiffness,
        Quantity::FreeLength => COMPENSATOR.free_length,
    }
}

#[test]
fn without_noise_everything_is_found_again() {
    for points in [1, 3] {
        let found = identify(&standard(1, 0.0, points)).unwrap();
        assert_eq!(found.seen.len(), 10);
        for estimate in &found.seen {
            let truth = truth(estimate.parameter, estimate.angle);
            assert!((estimate.value / truth - 1.0).abs() < 1e-9, "{estimate:?} {truth}");
        }
        for estimate in &found.arm {
            let truth = arm_truth(estimate.parameter);
            assert!((estimate.value / truth - 1.0).abs() < 1e-9, "{estimate:?} {truth}");
        }
        let cell = cell(points);
        for (place, truth) in found.setup.points.iter().zip(&cell.points) {
            assert!((place - truth).norm() < 1e-11);
        }
        let turned = found.setup.tracker_from_base.rotation - cell.tracker_from_base.rotation;
        assert!(turned.norm() < 1e-11);
        assert!((found.setup.tracker_from_base.translation - cell.tracker_from_base.translation).norm() < 1e-11);
        assert_eq!(found.outliers().count(), 0);
        assert!(found.residual_rms < 1e-14 && found.prediction.rms < 1e-13);
        assert!(found.law_probability.unwrap() > 0.5);
    }
}
