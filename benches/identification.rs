//! Speed of identifications and of plans for them: `cargo bench --bench identification`.

#![allow(clippy::expect_used, reason = "a benchmark of shipped files")]

use divan::{Bencher, black_box};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use stead_calibration::identification::design::{Request, design_experiment};
use stead_calibration::identification::synthetic::{MeasuringCell, sheet};
use stead_calibration::identification::{LoadCase, Problem, identify};
use stead_model::robot::Pose;
use stead_numerics::monitor::Monitor;
use stead_run_files::{read_identification, read_plan};

fn main() {
    divan::main();
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(name)
}

/// The shipped identification with so many configurations of three points, joint 2 at as many angles, noise of 0.03 mm.
fn problem(configurations: usize) -> Problem {
    let problem = read_identification(&shipped("identify-example.toml")).expect("the shipped file is good").problem;
    let found = identify(&problem, &Monitor::silent()).expect("the shipped sheet tells everything");
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let load_case = |_| {
        let theta = std::array::from_fn(|joint| {
            let joint = &problem.robot.joints()[joint];
            random.random_range(joint.min.max(-3.1)..joint.max.min(3.1))
        });
        let (sine, cosine) = libm::sincos(random.random_range(0.0..TAU));
        let z: f64 = random.random_range(-1.0..1.0);
        let radius = libm::sqrt(1.0 - z * z);
        LoadCase { theta, force: Vector3::new(radius * cosine, radius * sine, z) * 2700.0, moment: Vector3::zeros() }
    };
    let load_cases: Vec<_> = (0..configurations).map(load_case).collect();
    let cell = MeasuringCell {
        tracker_from_base: Pose::identity(),
        load_point: problem.load_point,
        points: found.setup.points.clone(),
        is_full_pose: false,
    };
    // As good as normal for this purpose.
    let noise = || (0..6).map(|_| random.random_range(-0.5..0.5)).sum::<f64>() * 1.414 * 3e-5;
    let readings = sheet(&found.robot, &cell, &load_cases, noise, || 0.0);
    Problem { sheet: readings, angle_tolerance: 0.0, ..problem }
}

/// `identify fit` of so many configurations: setup, outliers, compensator, intervals, prediction errors.
#[divan::bench(args = [100, 1000, 10_000], sample_count = 3, sample_size = 1)]
fn fit_of_configurations(bencher: Bencher, configurations: usize) {
    let problem = problem(configurations);
    bencher.bench_local(|| identify(black_box(&problem), &Monitor::silent()).expect("the sheet tells everything"));
}

fn request(candidates: usize) -> Request {
    let run = read_plan(&shipped("identify-plan-example.toml"), None).expect("the shipped file is good");
    Request { candidates, ..run.request }
}

/// `identify plan` of 20 configurations from so many candidates on all processors, with eight starts and 1000 random
/// sets.
#[divan::bench(args = [500, 2000, 8000], sample_count = 3, sample_size = 1)]
fn plan_from_candidates(bencher: Bencher, candidates: usize) {
    let request = request(candidates);
    bencher.bench_local(|| design_experiment(black_box(&request), &Monitor::silent()).expect("there is a plan"));
}
