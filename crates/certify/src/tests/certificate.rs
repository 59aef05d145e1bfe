//! The certificate as a whole: what it relaxes, and why there may be none.

use super::super::branch_and_bound::{Bound, Status};
use super::super::certificate::{Certificate, NoProof, Proof, certify};
use super::*;
use crate::certifiable;
use crate::settings::CertificateSettings;
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_numerics::monitor::Monitor;
use stead_planning::constraints::ConstraintKind;
use stead_planning::problem::{BetaPlan, Placement};
use stead_planning::sense::Sense;
use stead_planning::setup::Setup;
use stead_planning::symmetry::Unsupported;
use stead_planning::testing::{Beside, with_beside};

const PLACEMENT: Placement = Placement { x: 0.0, y: -1.9, z: -0.214, yaw: 1.4 };

fn proof(problem: &Problem, with_rate: bool) -> Proof {
    let bound = Bound {
        value: 1.0,
        met: None,
        bound: 1.0,
        with_rate,
        with_turn: false,
        nodes: 1,
        status: Status::Reached,
        open: Vec::new(),
    };
    Proof::new(problem, Sense::Min, PLACEMENT, bound)
}

#[test]
fn every_constraint_that_a_bound_does_not_evaluate_is_listed() {
    let mut problem = five_segments();
    let before = proof(&problem, true).relaxed;
    let without_rate = proof(&problem, false).relaxed;
    assert_eq!(without_rate.len(), before.len() + 1);
    assert!(!before.contains(&ConstraintKind::BetaRate) && without_rate.contains(&ConstraintKind::BetaRate));
    // A constraint more in the problem: it is listed, though nothing here knows of it.
    problem.constraints.max_deflection = Some(1e-3);
    let after = proof(&problem, true).relaxed;
    let added: Vec<_> = after.iter().filter(|kind| !before.contains(kind)).collect();
    assert_eq!(added, [&ConstraintKind::MaxDeflection]);
    let words = "steps and turns of the joints between path points, limits of joints 1, 4 and 6, max_deflection_mm";
    assert_eq!(proof(&problem, true).relaxed_words().join(", "), words);
}

#[test]
fn why_there_is_no_bound_is_told() {
    let problem = five_segments();
    let settings = CertificateSettings::new(1e-3);
    let run = |problem: &Problem, mean: f64, settings: CertificateSettings, monitor: &Monitor| {
        let certificate = certify(problem, &PLACEMENT, mean, Some(&PLACEMENT), settings, monitor);
        let kinds: Vec<_> = certificate.warnings.iter().map(|warning| warning.kind).collect();
        let Certificate { best, worst, .. } = certificate;
        (best.unwrap_err(), worst.unwrap_err(), kinds)
    };
    let stopped = Monitor::silent();
    stopped.stop_handle().stop();
    let both = vec!["no-bound"; 2];
    let interrupted = run(&problem, 1e-4, settings, &stopped);
    assert_eq!(interrupted, (NoProof::Interrupted, NoProof::Interrupted, both.clone()));
    let timed = CertificateSettings { time_limit: Some(0.0), ..settings };
    let late = run(&problem, 0.0, timed, &Monitor::silent());
    assert_eq!(late, (NoProof::TimeLimit, NoProof::TimeLimit, both));
    // The deadline of the caller, before that of the settings or without one.
    let over = Monitor::silent().with_deadline(Some(std::time::Instant::now()));
    for time_limit in [None, Some(1e3)] {
        let timed = CertificateSettings { time_limit, ..settings };
        let (best, ..) = run(&problem, 1e-4, timed, &over);
        assert_eq!(best, NoProof::TimeLimit);
        let certificate = certify(&problem, &PLACEMENT, 1e-4, Some(&PLACEMENT), timed, &over);
        assert_eq!(certificate.settings.time_limit, None);
    }
    // A placement that was not looked for is no shortfall.
    let alone = certify(&problem, &PLACEMENT, 0.0, None, settings, &Monitor::silent());
    assert_eq!((alone.worst.unwrap_err(), alone.warnings.len()), (NoProof::NotLookedFor, 1));
    let mut still = problem;
    still.redundancy.beta = BetaPlan::Constant;
    let reason = || NoProof::Unsupported(Unsupported::ConstantBeta { beta: BetaPlan::Constant });
    assert_eq!(run(&still, 1e-4, settings, &Monitor::silent()), (reason(), reason(), vec!["no-certificate"]));
}

#[test]
fn external_axes_are_refused() {
    let mut problem = five_segments();
    let (direction, point) = (Vector3::x(), Vector3::zeros());
    problem.external_axes = vec![ExternalAxis {
        name: "rail".to_owned(),
        kind: AxisKind::Rail,
        carries: Carried::Robot,
        direction,
        point,
        min: 0.0,
        max: 1.0,
        max_speed: Some(0.5),
        axis_use: AxisUse::Fixed,
    }];
    problem.setup = Setup::at_rest(&problem.external_axes);
    assert_eq!(certifiable(&problem, u64::MAX), Err(Unsupported::ExternalAxes));
}

#[test]
fn whatever_yields_beside_the_joints_is_refused() {
    for (beside, word) in
        [(Beside::Alike, "springs normal"), (Beside::Pairs, "springs normal"), (Beside::Matrices, "base")]
    {
        let problem = with_beside(five_segments(), beside);
        let error = certifiable(&problem, u64::MAX).unwrap_err();
        assert!(matches!(error, Unsupported::YieldsBeside { what } if what.starts_with(word)), "{error}");
        assert!(error.to_string().contains("a bound without them would be none"));
        let settings = CertificateSettings::new(0.05);
        let certificate = certify(&problem, &PLACEMENT, 1e-4, None, settings, &Monitor::silent());
        assert_eq!(certificate.best.unwrap_err(), NoProof::Unsupported(error));
    }
    let whole = with_beside(five_segments(), Beside::Matrices);
    let with = |change: &dyn Fn(&mut Problem)| {
        let mut problem = five_segments();
        change(&mut problem);
        certifiable(&problem, u64::MAX).unwrap_err().to_string()
    };
    assert!(with(&|problem| problem.spindle.mount = whole.spindle.mount).contains("spindle.mount_matrix"));
    assert!(with(&|problem| problem.spindle.tip = whole.spindle.tip).contains("spindle.tip_um_per_n"));
    assert!(with(&|problem| problem.task = whole.task.clone()).contains("part_compliance"));
}
