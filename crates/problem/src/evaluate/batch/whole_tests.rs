//! What yields beside the joints about their axes: the closed form against the reference evaluator.

use super::tests::{bits, compare};
use super::*;
use crate::criterion::{Criterion, Over, StiffnessSets, Weights};
use crate::testing::{
    Beside, compensated, five_segments, slanted, with_axes_2_3, with_beside, with_laws, with_normal_springs,
};
use nalgebra::DMatrix;
use stead_model::robot::testing::odd_arms;
use stead_model::robot::{Compliance, NormalSprings, Parameter, Uncertainty};
use stead_model::task::{Task, Wrench};

/// Forces and moments so large that the tolerance of the comparison, 1e-12 of a score beside one, is one of the score.
fn loaded(mut problem: Problem) -> Problem {
    let wrenches = problem.task.wrenches().map(|w| Wrench {
        force: (w.force + Vector3::new(3.0, 5.0, 40.0)) * 1e4,
        moment: Vector3::new(3.0, -5.0, 11.0) * 1e4,
    });
    problem.task = Task::new(problem.task.path().clone(), wrenches.collect()).unwrap();
    problem
}

fn placements() -> [Placement; 2] {
    [[2.2e-3, -1.6435, -0.5564, 2.1], [0.2, -1.9, -0.3, -1.0]].map(Placement::from)
}

const MIXED: Weights = Weights { wall: 1.0, axis: 0.5, feed: 2.0, surface: 0.0 };

#[test]
fn agrees_whatever_yields_and_whatever_is_scored() {
    for beside in Beside::ALL {
        for weights in [Weights::WALL, Weights::AXIS, Weights::TOTAL, MIXED] {
            let mut problem = with_beside(loaded(slanted()), beside);
            problem.criterion.weights = weights;
            assert_eq!(Flips::of(&problem).len() == 1, matches!(beside, Beside::Alike | Beside::Matrices));
            let points = (0..105).step_by(9);
            let allowed: usize = placements().iter().map(|at| compare(&problem, at, points.clone())).sum();
            assert!(allowed > 300, "{allowed} {beside:?} {weights:?}");
            let linked = with_axes_2_3(problem, true, [-150.0, 0.0]);
            let allowed: usize = placements().iter().map(|at| compare(&linked, at, points.clone())).sum();
            assert!(allowed > 100, "{allowed} {beside:?} {weights:?}");
        }
    }
}

#[test]
fn agrees_for_arms_of_every_build() {
    for (number, arm) in odd_arms().into_iter().enumerate() {
        let mut problem = loaded(five_segments());
        problem.robot = arm;
        let mut problem = with_beside(problem, Beside::ALL[number % 4]);
        problem = with_beside(problem, if number % 2 == 0 { Beside::Pairs } else { Beside::Everything });
        problem.redundancy.beta_count = 30;
        problem.constraints.min_inverse_condition = 0.05;
        let mut allowed = 0;
        for placement in [[0.9, 0.5, 0.4, 0.3], [0.3, -1.3, 0.1, 2.0], [-0.5, 0.9, -0.3, -1.0]].map(Placement::from) {
            allowed += compare(&problem, &placement, (0..105).step_by(15));
        }
        assert!(allowed > 100, "{allowed}");
    }
}

/// The compliances of all springs known to a tenth, in correlated errors.
fn with_all_uncertain(mut problem: Problem) -> Problem {
    let parameters: Vec<Parameter> =
        (0..6).flat_map(|j| [Parameter::Compliance(j), Parameter::AboutY(j), Parameter::AboutX(j)]).collect();
    let count = parameters.len();
    let factor = DMatrix::from_fn(count, count, |k, r| 1e-7 * libm::sin((7 * k + 3 * r + k * r) as f64));
    let known = Uncertainty::new(parameters, &factor * factor.transpose()).unwrap();
    problem.robot = problem.robot.clone().with_uncertainty(known).unwrap();
    problem
}

#[test]
fn agrees_with_errors_of_the_force_and_of_the_springs() {
    for beside in [Beside::Alike, Beside::Everything] {
        for weights in [Weights::WALL, MIXED] {
            for (force_uncertainty, confidence) in [(0.1, 0.0), (0.0, 2.0), (0.1, 2.0)] {
                let mut problem = with_all_uncertain(with_beside(loaded(slanted()), beside));
                problem.criterion = Criterion { weights, force_uncertainty, confidence, ..Criterion::default() };
                let points = (0..105).step_by(9);
                let allowed: usize = placements().iter().map(|at| compare(&problem, at, points.clone())).sum();
                assert!(allowed > 300, "{allowed} {beside:?}");
                let linked = with_axes_2_3(problem, true, [-245.0, 175.0]);
                let allowed: usize = placements().iter().map(|at| compare(&linked, at, points.clone())).sum();
                assert!(allowed > 300, "{allowed} {beside:?}");
            }
        }
    }
}

#[test]
fn agrees_over_sets_of_which_some_are_full() {
    for (weights, force_uncertainty) in [(Weights::WALL, 0.0), (MIXED, 0.1)] {
        for over in [Over::Mean, Over::Worst] {
            let mut problem = with_beside(loaded(five_segments()), Beside::Matrices);
            let plain = problem.robot.clone();
            let robots =
                vec![plain.clone(), with_normal_springs(plain.clone(), false), with_normal_springs(plain, true)];
            let stiffness = Some(StiffnessSets { robots, over });
            problem.criterion = Criterion { weights, force_uncertainty, stiffness, ..Criterion::default() };
            let points = (0..105).step_by(9);
            let allowed: usize = placements().iter().map(|at| compare(&problem, at, points.clone())).sum();
            assert!(allowed > 300, "{allowed} {over:?}");
        }
    }
}

#[test]
fn agrees_beside_compliances_that_change_with_the_joint_angle() {
    let range = Compliance::Range { at_min: 5e-7, at_max: 1.2e-6 };
    let problem = with_laws(loaded(five_segments()), &[(1, compensated(0.2, 3e-7)), (2, range), (4, range)]);
    let problem = with_beside(problem, Beside::Everything);
    let allowed: usize = placements().iter().map(|at| compare(&problem, at, (0..105).step_by(9))).sum();
    assert!(allowed > 300, "{allowed}");
}

/// All scores of a problem, in one row.
fn scores(problem: &Problem) -> Vec<f64> {
    let evaluator = BatchEvaluator::new(problem, &problem.redundancy, Flips::Both);
    let mut states = StateGrid::<f64>::new(problem.redundancy.beta_count, 0);
    let mut all = Vec::new();
    for point in (0..105).step_by(5) {
        evaluator.evaluate(point, &placements()[0], &mut states);
        let alive = PostureClass::ALL.into_iter().filter(|class| states.is_alive(*class));
        alive.for_each(|class| all.extend(states.inner_scores(class).iter().filter(|score| score.is_finite())));
    }
    assert!(all.len() > 1000);
    all
}

/// The largest difference of two rows of scores.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = a.iter().fold(0.0, |most: f64, score| most.max(*score));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

#[test]
fn springs_of_the_wrist_that_turn_about_one_line_can_be_exchanged() {
    let before = with_beside(five_segments(), Beside::Alike);
    let mut axial = before.robot.constant_compliances().unwrap();
    let mut normal = *before.robot.normal_springs().unwrap();
    let (y4_to_z5, y5_to_z6, four_to_five) = (2e-7, 1e-7, 1.5e-7);
    let [x4, y4] = normal[3].compliance;
    let [x5, y5] = normal[4].compliance;
    normal[3].compliance = [x4 + four_to_five, y4 + four_to_five - y4_to_z5];
    normal[4].compliance = [x5 - four_to_five, y5 - four_to_five - y5_to_z6];
    axial[3] += four_to_five;
    axial[4] += y4_to_z5 - four_to_five;
    axial[5] += y5_to_z6;
    let mut after = before.clone();
    after.robot = before.robot.with_compliances(axial).unwrap().with_normal_springs(Some(normal)).unwrap();
    assert!(apart(&scores(&before), &scores(&after)) < 1e-12);
    // One of them alone is seen.
    axial[4] += 1e-7;
    after.robot = after.robot.with_compliances(axial).unwrap();
    assert!(apart(&scores(&before), &scores(&after)) > 1e-3);
}

#[test]
fn springs_that_hardly_yield_change_no_score() {
    let plain = five_segments();
    let mut stiff = plain.clone();
    let springs = [NormalSprings { compliance: [1e-30, 2e-30], bearing: 0.2 }; 6];
    stiff.robot = with_normal_springs(plain.robot.clone(), true).with_normal_springs(Some(springs)).unwrap();
    assert!(stiff.yields_beside() && apart(&scores(&plain), &scores(&stiff)) < 1e-12);
}

/// Springs of the joints turn with the arm: turning the workpiece about axis 1 changes no score; a base that is not
/// alike in all directions does not turn.
#[test]
fn turning_about_axis_1_changes_no_score_but_on_an_unlike_base() {
    let about = |problem: &Problem, turn: f64| {
        let [x, y, z, yaw]: [f64; 4] = placements()[0].into();
        let (sine, cosine) = libm::sincos(turn);
        let placement = Placement::from([x * cosine - y * sine, x * sine + y * cosine, z, yaw + turn]);
        let evaluator = BatchEvaluator::new(problem, &problem.redundancy, Flips::Plain);
        let mut states = StateGrid::<f64>::new(problem.redundancy.beta_count, 0);
        evaluator.evaluate(30, &placement, &mut states);
        let class = PostureClass::ALL.into_iter().find(|class| states.is_alive(*class)).unwrap();
        states.inner_scores(class).iter().copied().filter(|score| score.is_finite()).collect::<Vec<_>>()
    };
    let full = with_beside(five_segments(), Beside::Pairs);
    assert!(apart(&about(&full, 0.0), &about(&full, 0.4)) < 1e-12);
    let based = with_beside(five_segments(), Beside::Everything);
    assert!(apart(&about(&based, 0.0), &about(&based, 0.4)) > 1e-3);
}

#[test]
fn every_processor_gives_the_same_bits_of_a_whole_arm() {
    let mut robust = with_all_uncertain(with_beside(slanted(), Beside::Everything));
    robust.criterion.force_uncertainty = 0.1;
    robust.criterion.confidence = 2.0;
    for mut problem in [with_beside(five_segments(), Beside::Alike), with_beside(slanted(), Beside::Everything), robust]
    {
        for weights in [Weights::WALL, Weights::TOTAL] {
            problem.criterion.weights = weights;
            problem.redundancy.beta_count = 37;
            let expected = bits(&problem, Instructions::plain(), &placements());
            assert!(expected.len() > 3000);
            for instructions in Instructions::all() {
                assert!(bits(&problem, instructions, &placements()) == expected, "{instructions:?}");
            }
        }
    }
}
