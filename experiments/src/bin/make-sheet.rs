//! Makes a measurement sheet that an arm of known compliances would give, to try `stead identify fit` on.
//!
//! `cargo run --release -p stead-experiments --bin make-sheet -- [seed, 1] [noise in mm, 0.03] [load in N, 2700] >
//! tasks/identify-example.csv`
//!
//! The arm is a KUKA KR270-2 with the compliances that Klimchik et al. 2017 (Table 4) give for a KR 270, and beside
//! joint 2 a compensator made up for the purpose; it comes to its static equilibrium under the load. 20 configurations
//! with 5 distinct angles of joint 2, three reference points, a load of 2.7 kN in random directions, 250 mm off axis 6.

#![allow(clippy::print_stdout, reason = "an experiment prints")]

use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::env;
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::path::Path;
use stead_calibration::identification::LoadCase;
use stead_calibration::identification::synthetic::{MeasuringCell, sheet};
use stead_format::read_robot;
use stead_model::robot::{Compensator, Compliance, Pose};

/// Distinct angles of joint 2. deg
const ANGLES_DEG: [f64; 5] = [15.0, 45.0, 75.0, 105.0, 135.0];
/// Configurations.
const COUNT: usize = 20;
fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let seed: u64 = arguments.first().map_or(Ok(1), |text| text.parse())?;
    let noise: f64 = arguments.get(1).map_or(Ok(0.03), |text| text.parse())?;
    let load: f64 = arguments.get(2).map_or(Ok(2700.0), |text| text.parse())?;
    let mut laws = [0.54e-6, 0.3e-6, 0.42e-6, 2.79e-6, 3.48e-6, 2.074e-6].map(Compliance::from);
    let compensator =
        Compensator { spring_stiffness: 4e6, a: 0.75, l: 0.25, alpha: (-20.0_f64).to_radians(), free_length: 0.6 };
    laws[1] = Compliance::Compensated { alone: 0.3e-6, compensator };
    let robot = read_robot(Path::new("configs/robots/kuka-kr270-2.toml"))?.with_compliances(laws)?;
    let cell = MeasuringCell {
        tracker_from_base: Pose {
            rotation: Matrix3::new(-0.6, -0.8, 0.0, 0.8, -0.6, 0.0, 0.0, 0.0, 1.0),
            translation: Vector3::new(3.2, -1.5, 0.4),
        },
        load_point: Vector3::new(0.25, 0.0, 0.15),
        points: vec![Vector3::new(0.12, 0.0, 0.25), Vector3::new(-0.06, 0.11, 0.2), Vector3::new(-0.06, -0.11, 0.3)],
        is_full_pose: false,
    };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // What the sheet prints is what the arm did.
    let round = |value: f64, step: f64| (value / step).round() * step;
    let load_cases: Vec<LoadCase> = (0..COUNT)
        .map(|index| {
            let theta = std::array::from_fn(|joint| {
                let limits = &robot.joints()[joint];
                let (min, max) = (limits.min.max(-PI).to_degrees(), limits.max.min(PI).to_degrees());
                let free = round(random.random_range(min + 1.0..max - 1.0), 0.01);
                if joint == 1 { ANGLES_DEG[index % ANGLES_DEG.len()].to_radians() } else { free.to_radians() }
            });
            let z: f64 = random.random_range(-1.0..1.0);
            let (sine, cosine) = libm::sincos(random.random_range(0.0..TAU));
            let radius = libm::sqrt(1.0 - z * z);
            let force = Vector3::new(radius * cosine, radius * sine, z) * load;
            LoadCase { theta, force: force.map(|value| round(value, 0.1)), moment: Vector3::zeros() }
        })
        .collect();
    let gauss = || {
        let u: f64 = random.random_range(f64::MIN_POSITIVE..1.0);
        libm::sqrt(-2.0 * libm::log(u)) * libm::cos(random.random_range(0.0..TAU)) * noise / 1e3
    };
    print!("{}", sheet(&robot, &cell, &load_cases, gauss, || 0.0).csv(if noise > 0.0 { 3 } else { 12 }));
    Ok(())
}
