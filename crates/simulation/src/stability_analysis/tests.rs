use super::*;
use crate::arm::Missing;
use crate::arm::testing::{spindle, start, tx200};
use crate::motion::{Motion, Pass, Ramp};
use crate::path_stability::{PathConfiguration, PathStabilityAnalysis, smallest};
use crate::stability::Kind;
use std::f64::consts::{PI, TAU};
use stead_model::cutting::{Coefficients, Cut, MillingDirection, Rotation, Tooth};
use stead_numerics::monitor::{Progress, Stop, StopHandle};

fn setup(variant: Variant, damping_scale: f64) -> Setup {
    let pass = Pass { start: start(), direction: Vector3::x(), length: 0.1 };
    let motion = Motion::new(&tx200(), &spindle(), &pass, Ramp { feed: 0.28 / 60.0, time: 0.2 }).unwrap();
    Setup { robot: tx200(), spindle: spindle(), variant, damping_scale, motion }
}

/// The steel cut of the paper.
fn steel() -> (Cutter, PassCut) {
    let coefficients = Coefficients::new(3333e6, 2289e6, 0.0);
    let teeth = vec![Tooth { pitch: PI, radius: 5e-3 }; 2];
    let cutter = Cutter::new(teeth, 30_f64.to_radians(), Some(0.022), Rotation::Clockwise, coefficients).unwrap();
    let cut = PassCut {
        section: Cut { direction: MillingDirection::Climb, radial_depth: 4e-3, axial_depth: 1.6e-3 },
        length: 0.09,
        spindle_speed: 3100.0 / 60.0 * TAU,
        slices: 32,
        steps_per_turn: 360,
    };
    (cutter, cut)
}

fn settings(cut: &PassCut) -> AnalysisSettings {
    let speeds = [cut.spindle_speed, cut.spindle_speed * 1.2];
    AnalysisSettings { distance: 0.0, speeds, points: 2, max_depth: 0.022, frequencies: [0.0, 100.0] }
}

/// The published steel cut chatters with a flip, which damping slows down and ends.
#[test]
fn stability_of_the_published_steel_cut() {
    let (cutter, cut) = steel();
    let found = analyse(&setup(Variant::Springs, 1.0), &cutter, &cut, &settings(&cut), &Monitor::silent()).unwrap();
    assert_eq!(found.modes.len(), 6);
    assert_eq!(found.cut_stability.verdict.kind(), Kind::Flip);
    let critical = found.cut_stability.semi_discretisation.unwrap();
    assert!(critical < found.cut_stability.zero_order.unwrap() && critical < cut.section.axial_depth);
    // The first lobe is at the speed of the cut.
    assert_eq!(found.lobes[0].semi_discretisation, Some(critical));
    assert!((found.lobes[1].spindle_speed / cut.spindle_speed - 1.2).abs() < 1e-12);
    assert!((found.pass_time - 0.09 / (0.28 / 60.0)).abs() < 1e-9);
    // Ten times the damping is nearly enough, twenty times is.
    let damped = analyse(&setup(Variant::Springs, 10.0), &cutter, &cut, &settings(&cut), &Monitor::silent()).unwrap();
    let growth = |found: &StabilityAnalysis| found.cut_stability.verdict.growth_rate();
    assert!(
        damped.cut_stability.semi_discretisation.unwrap() > 2.0 * critical && growth(&damped) < growth(&found) / 5.0
    );
    let calm = analyse(&setup(Variant::Springs, 20.0), &cutter, &cut, &settings(&cut), &Monitor::silent()).unwrap();
    assert!(calm.cut_stability.verdict.is_stable() && growth(&calm) < 0.0);
    assert!(calm.modes[0].damping_ratio > 5.0 * found.modes[0].damping_ratio);
}

/// At rest the tip yields as springs and Jacobian say; a configuration of a path is the same arm as a place on a pass.
#[test]
fn answers_and_stations_are_those_of_the_arm() {
    let (cutter, cut) = steel();
    let setup = setup(Variant::Gravity, 1.0);
    let found = analyse(&setup, &cutter, &cut, &settings(&cut), &Monitor::silent()).unwrap();
    let arm = Arm::six(&tx200(), &spindle(), Variant::Springs, &start()).unwrap();
    let jacobian = arm.chain.at(&start().into()).tip_jacobian();
    let along = |row: usize| (0..6).map(|j| jacobian[(row, j)].powi(2) / arm.drive.stiffness[j]).sum::<f64>();
    assert_eq!(found.frequency_response[0].frequency, 0.0);
    // Gravity changes the stiffness of joints 4 and 6 by far less than a percent.
    assert!((found.frequency_response[0].feed.re / along(0) - 1.0).abs() < 1e-2);
    assert!((found.frequency_response[0].normal.re / along(1) - 1.0).abs() < 1e-2);
    assert_eq!(found.frequency_response.len(), 1000);

    let chatter =
        PathStabilityAnalysis { variant: Variant::Gravity, damping_scale: 1.0, cutter, cut, max_depth: 0.022 };
    let configuration =
        |distance: f64| PathConfiguration { joints: setup.motion.motors_at(distance, 0.0).0, feed: Vector3::x() };
    let depths = chatter.along(&tx200(), &spindle(), &[configuration(0.0), configuration(0.1)]).unwrap();
    let close = |a: Option<f64>, b: Option<f64>| (a.unwrap() / b.unwrap() - 1.0).abs() < 1e-9;
    assert!(close(depths[0].semi_discretisation, found.cut_stability.semi_discretisation));
    assert!(close(depths[0].zero_order, found.cut_stability.zero_order));
    let least = smallest(&depths).unwrap();
    let expected = depths.iter().filter_map(|at| at.semi_discretisation).fold(f64::INFINITY, f64::min);
    assert_eq!(depths[least.0].semi_discretisation, Some(expected));
}

#[test]
fn what_is_missing_is_said() {
    let (cutter, cut) = steel();
    let still = crate::arm::testing::massless(&tx200());
    let setup = Setup { robot: still, ..setup(Variant::Springs, 1.0) };
    let error = analyse(&setup, &cutter, &cut, &settings(&cut), &Monitor::silent());
    assert_eq!(error, Err(StabilityError::Missing(Missing::Dynamics)));
}

#[test]
fn a_stop_before_or_during_an_analysis_leaves_none() {
    let (cutter, cut) = steel();
    let analysed = |monitor: &Monitor| {
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        alone.install(|| analyse(&setup(Variant::Springs, 1.0), &cutter, &cut, &settings(&cut), monitor))
    };
    let stopped = Monitor::silent();
    stopped.stop_handle().stop();
    assert_eq!(analysed(&stopped), Err(StabilityError::Stopped(Stop::Asked)));
    // Stopped by its own first report, which says how far it is.
    let handle = StopHandle::default();
    let stop = handle.clone();
    let watch = move |progress: &Progress| {
        assert!(matches!(progress, Progress::Steps { stage: "stability lobes", done: 1, .. }));
        stop.stop();
    };
    assert_eq!(analysed(&Monitor::new(watch).with_stop(handle)), Err(StabilityError::Stopped(Stop::Asked)));
}
