//! The certificate as a whole: what it relaxes, and why there may be none.

use super::super::branch_and_bound::{Bound, Status};
use super::super::certificate::{Certificate, NoProof, Proof, certify};
use super::*;
use crate::requirements::without_axes;
use crate::worst::certifiable_from_above;
use crate::{best, certifiable};
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::constraints::ConstraintKind;
use stead_problem::criterion::{Over, StiffnessSets};
use stead_problem::problem::{BetaPlan, Cell, Placement};
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;
use stead_problem::setup::{AxisPositions, Setup};
use stead_problem::symmetry::Unsupported;
use stead_problem::testing::Beside;

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
        keeps_open: None,
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
    still.constraints.min_inverse_condition = 1e-3;
    let reason = || NoProof::Unsupported(certifiable(&still, u64::MAX).unwrap_err());
    assert!(matches!(reason(), NoProof::Unsupported(Unsupported::Conditioning { .. })));
    let Err(Unsupported::Several(reasons)) = certifiable(&still, 0) else { panic!("one reason") };
    assert!(matches!(reasons[..], [Unsupported::Conditioning { .. }, Unsupported::TooLarge { .. }]), "{reasons:?}");
    assert_eq!(run(&still, 1e-4, settings, &Monitor::silent()), (reason(), reason(), vec!["no-certificate"]));
}

/// The path of the paper beside a rail.
fn on_rail(carries: Carried, axis_use: AxisUse) -> Problem {
    let mut problem = five_segments();
    problem.external_axes = vec![ExternalAxis {
        name: "rail".to_owned(),
        kind: AxisKind::Rail,
        carries,
        direction: Vector3::new(0.6, 0.8, 0.0),
        point: Vector3::zeros(),
        min: -0.2,
        max: 0.1,
        max_speed: Some(0.5),
        axis_use,
    }];
    problem.setup = Setup::at_rest(&problem.external_axes);
    problem
}

#[test]
fn rails_at_one_place_are_part_of_the_cell_and_others_are_refused() {
    let moving = on_rail(Carried::Robot, AxisUse::Continuous);
    assert_eq!(certifiable(&moving, u64::MAX), Err(Unsupported::OtherAxes));
    for carries in [Carried::Robot, Carried::Workpiece] {
        let problem = on_rail(carries, AxisUse::Fixed);
        assert_eq!(certifiable(&problem, u64::MAX), Ok(()));
        let alone = without_axes(&problem).unwrap();
        assert!(alone.external_axes.is_empty());
        // Wherever the rail stands, the workpiece is seen by the robot at a placement of the cell that is certified.
        let mut ends = [[false; 2]; 2];
        for at in [-0.2, 0.0, 0.1] {
            let mut there = problem.clone();
            there.setup.positions = AxisPositions::Same(vec![at]);
            for corner in 0..4 {
                let side = |k: usize| {
                    let range = there.cell.position[k];
                    if corner >> k & 1 == 1 { range.max } else { range.min }
                };
                let placement = Placement { x: side(0), y: side(1), z: -0.3, yaw: 0.2 };
                let seen = there.at(&placement).base_from_workpiece(0).translation;
                for k in 0..2 {
                    let Interval { min, max } = alone.cell.position[k];
                    assert!(seen[k] >= min - 1e-12 && seen[k] <= max + 1e-12, "{carries:?} {at} {seen}");
                    ends[k][0] |= seen[k] <= min + 1e-12;
                    ends[k][1] |= seen[k] >= max - 1e-12;
                }
            }
        }
        assert_eq!(ends, [[true; 2]; 2], "the cell is larger than needed");
        // From above, what a rail adds is not covered.
        assert_eq!(certifiable_from_above(&problem, u64::MAX), Err(Unsupported::ExternalAxes));
        assert!(proof(&problem, true).relaxed_words().iter().any(|words| words.contains("external axes")));
    }
}

/// A turntable on a rail for the workpiece, and one under the robot, about the vertical.
fn turned(angles: [f64; 2], under_robot: [f64; 2]) -> Problem {
    let mut problem = on_rail(Carried::Workpiece, AxisUse::Fixed);
    let rail = problem.external_axes[0].clone();
    let turntable = |name: &str, carries, direction: Vector3<f64>, [min, max]: [f64; 2]| ExternalAxis {
        name: name.to_owned(),
        kind: AxisKind::Turntable,
        carries,
        direction,
        point: Vector3::new(0.1, -1.9, 0.2),
        min,
        max,
        max_speed: None,
        axis_use: AxisUse::Fixed,
    };
    problem.external_axes = vec![
        rail,
        turntable("table", Carried::Workpiece, Vector3::z(), angles),
        turntable("column", Carried::Robot, -Vector3::z(), under_robot),
    ];
    problem.setup = Setup::at_rest(&problem.external_axes);
    problem.cell.yaw = Interval { min: -0.1, max: 0.3 };
    problem
}

#[test]
fn turntables_at_one_place_are_part_of_the_cell() {
    for (angles, under_robot) in [([-0.3, 0.4], [0.0, 0.0]), ([1.0, 2.9], [-0.2, 0.1]), ([-3.0, 3.0], [0.0, 0.5])] {
        let problem = turned(angles, under_robot);
        assert_eq!(certifiable(&problem, u64::MAX), Ok(()));
        let alone = without_axes(&problem).unwrap();
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let share = |[min, max]: [f64; 2], k: usize| min + (max - min) * k as f64 / 40.0;
        for (first, second, corner) in (0..=40).flat_map(|k| (0..=40).flat_map(move |l| (0..8).map(move |c| (k, l, c))))
        {
            let side = |k: usize, range: Interval| if corner >> k & 1 == 1 { range.max } else { range.min };
            let [x, y, _] = problem.cell.position;
            let placement = Placement { x: side(0, x), y: side(1, y), z: -0.3, yaw: side(2, problem.cell.yaw) };
            let mut there = problem.clone();
            let rail = if (first + second) % 2 == 0 { -0.2 } else { 0.1 };
            there.setup.positions = AxisPositions::Same(vec![rail, share(angles, first), share(under_robot, second)]);
            let seen = there.at(&placement).base_from_workpiece(0);
            let yaw = libm::atan2(seen.rotation[(1, 0)], seen.rotation[(0, 0)]);
            let [x, y, z] = seen.translation.into();
            // Rounding, by which a rotation about the vertical lets an x into the z of what it turns.
            let grown = |range: Interval| Interval { min: range.min - 1e-9, max: range.max + 1e-9 };
            let cell = Cell { position: alone.cell.position.map(grown), yaw: grown(alone.cell.yaw) };
            assert!(cell.contains(&Placement { x, y, z, yaw }), "{angles:?} {under_robot:?} {seen:?} {:?}", alone.cell);
            for (k, at) in [x, y].into_iter().enumerate() {
                ends[k] = [ends[k][0].min(at), ends[k][1].max(at)];
            }
        }
        // With one turntable alone the box is no larger than what it goes through, as far as its steps tell.
        if under_robot == [0.0, 0.0] {
            for (range, [min, max]) in alone.cell.position.iter().zip(ends) {
                assert!(min - range.min < 0.01 && range.max - max < 0.01, "{range:?} {min} {max}");
            }
        }
    }
    let mut tilting = turned([0.0, 1.0], [0.0, 0.0]);
    tilting.external_axes[1].direction = Vector3::x();
    assert_eq!(certifiable(&tilting, u64::MAX), Err(Unsupported::OtherAxes));
}

/// A part on a turntable: the certificate holds below what is found at any angle of it.
#[test]
fn a_bound_on_a_turntable_is_below_what_it_is_at_any_angle() {
    let mut problem = turned([-0.05, 0.05], [0.0, 0.0]);
    problem.external_axes.remove(2);
    problem.external_axes.remove(0);
    let best_at = Placement::from_mm_deg([0.0284, -1640.0, -214.0], 78.9664);
    let near = |value: f64| Interval { min: value - 1e-3, max: value + 1e-3 };
    problem.cell = Cell { position: [near(best_at.x), near(best_at.y), near(best_at.z)], yaw: near(best_at.yaw) };
    problem.setup = Setup::at_rest(&problem.external_axes);
    let settings = CertificateSettings::new(0.2);
    let value = 0.1075e-3;
    let bound = best(&problem, value, &settings, &Monitor::silent()).unwrap();
    assert!(bound.bound > 0.5 * value, "{}", bound.bound);
    for angle in [-0.05, -0.02, 0.0, 0.03, 0.05] {
        let mut there = problem.clone();
        there.setup.positions = AxisPositions::Same(vec![angle]);
        let planner = stead_planning::redundancy::Planner::finer(&there);
        let plans = planner.plan_fine(&best_at, Sense::Min, None, &mut planner.workspace());
        let mean = plans.map_or(f64::INFINITY, |plans| there.objective(plans.iter().map(|plan| plan.cost)));
        assert!(mean >= bound.bound, "{angle}: {mean} {}", bound.bound);
    }
}

#[test]
fn what_a_bound_leaves_out_of_the_objective_is_named() {
    let mut problem = five_segments();
    problem.redundancy.beta = BetaPlan::Constant;
    problem.criterion.joint_travel_weight = 1e-6;
    assert_eq!(certifiable(&problem, u64::MAX), Ok(()));
    let reasons = vec![Unsupported::JointTravel, Unsupported::ConstantBeta { beta: BetaPlan::Constant }];
    assert_eq!(certifiable_from_above(&problem, u64::MAX), Err(Unsupported::Several(reasons)));
    let words = proof(&problem, true).relaxed_words();
    assert_eq!(words[words.len() - 2..], ["travel of the joints in the objective", "beta that stays along the path"]);
}

#[test]
fn what_yields_beside_the_joints_is_covered_or_refused() {
    use stead_problem::testing::with_beside;
    let refused = |problem: &Problem| certifiable(problem, u64::MAX).unwrap_err();
    // A base that is not alike in every direction, and a joint 5 that yields beside the wrist centre.
    let error = refused(&with_beside(five_segments(), Beside::Matrices));
    assert!(error.to_string().contains("base_compliance") && error.to_string().contains("would be none"), "{error}");
    assert_eq!(refused(&with_beside(five_segments(), Beside::Pairs)), Unsupported::UnlikeFlips);
    for beside in [Beside::Alike, Beside::Pairs, Beside::Everything] {
        let whole = whole_arm(five_segments(), beside);
        assert_eq!(certifiable(&whole, u64::MAX), Ok(()));
        let mut with_moments = whole;
        let moment = Wrench { force: Vector3::x(), moment: Vector3::x() };
        let wrenches = vec![moment; with_moments.task.points().len()];
        with_moments.task = Task::new(with_moments.task.path().clone(), wrenches).unwrap();
        assert!(refused(&with_moments).to_string().contains("under moments"));
    }
}

#[test]
fn a_cell_next_to_axis_1_says_beforehand_what_that_costs() {
    let mut problem = five_segments();
    assert_eq!(crate::expected_cost(&problem), None);
    problem.cell.position[1].max = -0.3;
    let note = crate::expected_cost(&problem).unwrap();
    let missing: f64 = note.split("in a cell ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(proof(&problem, true).left_out.iter().any(|words| words.contains("axis 1")), "{note}");
    // From above such points have no bound at all.
    let worst = Proof::new(&problem, Sense::Max, PLACEMENT, proof(&problem, false).bound);
    assert!(worst.left_out.is_empty(), "{worst:?}");
    // As much farther away nothing is said any more, and a little less is not enough.
    problem.cell.position[1].max = -0.3 - missing * 1e-3;
    assert_eq!(crate::expected_cost(&problem), None);
    problem.cell.position[1].max += 2e-3;
    assert!(crate::expected_cost(&problem).is_some());
}

/// The sentence of a placement whose own figure, that of its best plan, is within 0.1 % of a bound; and the figure. m
fn sentence_at(problem: &Problem, placement: &Placement) -> (String, f64) {
    let planner = Planner::new(problem);
    let value = planner.objective(placement, Sense::Min, None, &mut planner.workspace()).mean().unwrap();
    let mut proof = proof(problem, true);
    (proof.bound.value, proof.bound.bound) = (value, 0.999 * value);
    (proof.sentence().unwrap(), value)
}

#[test]
fn the_sentence_names_what_would_be_refuted_without_it() {
    type Change = fn(&mut Problem);
    fn soft(problem: &Problem) -> Vec<Robot> {
        let mut compliances = problem.robot.compliances_at(&[0.0; 6]);
        (compliances[0], compliances[2]) = (2.0 * compliances[0], 2.0 * compliances[2]);
        vec![problem.robot.clone(), problem.robot.with_compliances(compliances).unwrap()]
    }
    let plain: Change = |_| {};
    let mean: Change = |problem| {
        problem.criterion.stiffness = Some(StiffnessSets { robots: soft(problem), over: Over::Mean });
    };
    let placement = Placement::from_mm_deg([0.03, -1640.0, -214.0], 79.0);
    // What is added, what was there before, and the words of it.
    let all: [(&str, Change, Change); 8] = [
        ("total deflection", |problem| problem.criterion.weights = Weights::TOTAL, plain),
        (
            "deflection weighted by wall 1, axis 0.5",
            |problem| problem.criterion.weights = Weights { wall: 1.0, axis: 0.5, ..Weights::NONE },
            plain,
        ),
        ("largest normal deflection", |problem| problem.criterion.aggregate = Aggregate::Max, plain),
        (
            "segments weighted 1, 1, 1, 0.1, 1",
            |problem| problem.criterion.segment_weights = vec![1.0, 1.0, 1.0, 0.1, 1.0],
            plain,
        ),
        ("of 2 sets of stiffness the mean", mean, plain),
        (
            "of 2 sets of stiffness the largest",
            |problem| problem.criterion.stiffness = Some(StiffnessSets { robots: soft(problem), over: Over::Worst }),
            mean,
        ),
        ("force errors of 10 % covered", |problem| problem.criterion.force_uncertainty = 0.1, plain),
        ("with the travel of the joints", |problem| problem.criterion.joint_travel_weight = 1e-4, plain),
    ];
    for (words, with, without) in all {
        let [mut with_it, mut without_it] = [five_segments(), five_segments()];
        with(&mut with_it);
        without(&mut without_it);
        let [(sentence, value), (other, less)] = [&with_it, &without_it].map(|of| sentence_at(of, &placement));
        assert!(sentence.contains(words) && !other.contains(words), "{words}: {sentence} {other}");
        assert!(less < 0.999 * value, "{words}: the placement itself would not refute it: {less} {value}");
    }
    // The words scale with the gap.
    let mut proof = proof(&five_segments(), true);
    for (bound, begins) in [(0.96, "No placement in this cell, "), (0.8, "Up to 20 % may"), (0.5, "Little is proved, ")]
    {
        proof.bound.bound = bound;
        assert!(proof.sentence().unwrap().starts_with(begins), "{:?}", proof.sentence());
    }
}
