//! Speed of the dynamics of the arm and of stability: `cargo bench --bench multibody`.

#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark of shipped files")]

use divan::{Bencher, black_box};
use nalgebra::{SMatrix, SVector, Vector3};
use std::path::Path;
use stead_model::cutting::CutFrame;
use stead_numerics::monitor::Monitor;
use stead_run_files::{Overrides, read_simulation};
use stead_runs::SimulationRun;
use stead_simulation::arm::{AnyArm, Arm, Compensation, Variant};
use stead_simulation::integrator::{MotionState, Newmark, Settings, System, Tangent};
use stead_simulation::stability_analysis::{analyse, cut_stability, linear_at};

fn main() {
    divan::main();
}

fn shipped(variant: Variant) -> SimulationRun {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/umons-steel.toml");
    let overrides = Overrides { variant: Some(variant), ..Overrides::default() };
    read_simulation(&file, &overrides).expect("the shipped file is good")
}

/// The arm with motors at rest and a force on its tip that swings.
struct Shaken<const N: usize> {
    arm: Arm<N>,
    reference: SVector<f64, N>,
    compensation: Compensation<N>,
}

impl<const N: usize> System<N> for Shaken<N> {
    fn unbalanced(&mut self, time: f64, state: &MotionState<N>) -> SVector<f64, N> {
        let posed = self.arm.chain.at(&state.q);
        let force = Vector3::new(0.0, 50.0 * libm::sin(400.0 * time), 0.0);
        let motion = [&state.q, &state.speed, &state.acceleration];
        let reference = [&self.reference, &SVector::zeros()];
        self.arm.unbalanced(&posed, motion, reference, &mut self.compensation) - posed.tip_torques(&force)
    }

    fn tangent(&mut self, _: f64, state: &MotionState<N>) -> Tangent<N> {
        Tangent {
            mass: self.arm.chain.at(&state.q).mass_matrix(&self.arm.chain),
            damping: SMatrix::from_diagonal(&self.arm.drive.damping),
            stiffness: SMatrix::from_diagonal(&self.arm.drive.stiffness),
        }
    }
}

fn steps<const N: usize>(bencher: Bencher<'_, '_>, arm: Arm<N>, motors: &[f64; 6]) {
    let reference = Arm::<N>::spread(motors);
    let mut state = MotionState { q: arm.at_rest(&reference), speed: SVector::zeros(), acceleration: SVector::zeros() };
    let compensation = Compensation::about(&arm, &state.q);
    let mut system = Shaken { arm, reference, compensation };
    let mut newmark = Newmark::new(Settings::default());
    let mut step = 0;
    bencher.bench_local(|| {
        for _ in 0..1000 {
            let time = 3.6e-5 * f64::from(step);
            newmark.step(&mut system, time, 3.6e-5, &mut state).expect("the arm can be integrated");
            step += 1;
        }
    });
}

/// A thousand steps of the whole arm: the time printed in ms is that of a step in us.
#[divan::bench(args = [Variant::Springs, Variant::Gravity, Variant::Orthogonal, Variant::Backlash])]
fn a_thousand_steps(bencher: Bencher<'_, '_>, variant: Variant) {
    let run = shipped(variant);
    let motors = run.setup.motion.motors(0.0).0;
    match run.setup.arm().expect("the shipped robot has masses") {
        AnyArm::Six(arm) => steps(bencher, *arm, &motors),
        AnyArm::Eighteen(arm) => steps(bencher, *arm, &motors),
    }
}

/// Critical depths and verdict at one place and spindle speed.
#[divan::bench(args = [Variant::Springs, Variant::Orthogonal], sample_count = 10)]
fn depths_at_one_speed(bencher: Bencher<'_, '_>, variant: Variant) {
    let run = shipped(variant);
    let linear = linear_at(&run.setup, 0.0).expect("the shipped robot has masses");
    let frame = CutFrame::new(Vector3::x(), Vector3::z(), run.cut.wall(&run.cutter));
    let plant = linear.plant(&frame).expect("the mass matrix is positive definite");
    bencher.bench_local(|| cut_stability(&plant, &run.cutter, black_box(&run.cut), run.analysis.max_depth));
}

/// All that `stead stability` finds, on all processors.
#[divan::bench(sample_count = 3)]
fn a_survey(bencher: Bencher<'_, '_>) {
    let run = shipped(Variant::Springs);
    bencher.bench_local(|| analyse(&run.setup, &run.cutter, black_box(&run.cut), &run.analysis, &Monitor::silent()));
}
