//! The choice among plans of segments, against all combinations of them, and on a zigzag.

use super::*;
use crate::redundancy::Planner;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_model::robot::{Joint, Robot};
use stead_model::task::{PathPoint, Task, ToolPath};
use stead_problem::candidate::Objective;
use stead_problem::postures::PostureRules;
use stead_problem::testing::five_segments;

/// The five segments with joints of known speed.
fn timed() -> Problem {
    let mut problem = five_segments();
    let joints = problem.robot.joints().clone().map(|joint| Joint { max_speed: Some(1.5), ..joint });
    problem.robot = Robot::new("timed", joints).unwrap();
    problem
}

/// Random plans of the five segments, the best first, each driven in up to three ways.
fn plans(problem: &Problem, random: &mut ChaCha8Rng) -> Vec<Vec<SegmentChoice>> {
    let segments = problem.task.segments().iter();
    let one = |span: &Span<usize>, random: &mut ChaCha8Rng| {
        let mut costs: Vec<f64> =
            (0..random.random_range(1..4)).map(|_| random.random_range(1e-3..1.02e-3) * span.len() as f64).collect();
        costs.sort_by(f64::total_cmp);
        let way = |random: &mut ChaCha8Rng| JointPath {
            posture: Posture::ALL[random.random_range(0..8)],
            joints: (0..span.len()).map(|_| std::array::from_fn(|_| random.random_range(-3.0..3.0))).collect(),
        };
        let choice = |cost: f64| SegmentChoice {
            points: span.clone(),
            betas: vec![0.0; span.len()],
            cost,
            joint_paths: (0..random.random_range(1..4)).map(|_| way(random)).collect(),
        };
        costs.into_iter().map(choice).collect()
    };
    segments.map(|span| one(span, random)).collect()
}

/// Every way through the plans: the sum of their costs and the length of the moves.
fn all(problem: &Problem, plans: &[Vec<SegmentChoice>]) -> Vec<(Vec<f64>, i64)> {
    let mut found: Vec<(Vec<f64>, i64, Option<[f64; 6]>)> = vec![(Vec::new(), 0, None)];
    for options in plans {
        let mut next = Vec::new();
        for (costs, moved, at) in &found {
            for choice in options {
                for way in &choice.joint_paths {
                    let step = length(problem, at.as_ref(), way.joints.first());
                    next.push(([&costs[..], &[choice.cost]].concat(), moved + step, way.joints.last().copied()));
                }
            }
        }
        found = next;
    }
    found.into_iter().map(|(costs, moved, _)| (costs, moved)).collect()
}

fn moved(problem: &Problem, plans: &[SegmentPlan]) -> i64 {
    plans.windows(2).map(|pair| length(problem, pair[0].joints.last(), pair[1].joints.first())).sum()
}

#[test]
fn the_choice_is_the_best_of_all_combinations() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut problem = timed();
    for number in 0..40 {
        let plans = plans(&problem, &mut random);
        let all = all(&problem, &plans);
        let best: Vec<f64> = plans.iter().map(|options| options[0].cost).collect();
        // Nothing but the best; within a tie the shortest moves.
        for tie in [0.0, 0.005, 0.2] {
            problem.postures = PostureRules { tie, ..PostureRules::NONE };
            let found = select_joint_paths(&problem, Sense::Min, plans.clone());
            let is_tied = |costs: &[f64]| costs.iter().zip(&best).all(|(cost, best)| *cost <= best * (1.0 + tie));
            let expected = all.iter().filter(|(costs, _)| is_tied(costs)).map(|(_, moved)| *moved).min();
            assert_eq!(Some(moved(&problem, &found)), expected, "{number} {tie}");
            assert!(is_tied(&found.iter().map(|plan| plan.cost).collect::<Vec<_>>()));
        }
        // With a weight, the least of both together.
        let move_weight = [1e-7, 1e-5, 1e-3][number % 3];
        problem.postures = PostureRules { move_weight, ..PostureRules::NONE };
        let found = select_joint_paths(&problem, Sense::Min, plans.clone());
        let total =
            |costs: &[f64], moved: i64| problem.objective(costs.iter().copied()) + move_weight * moved as f64 * 1e-6;
        let expected = all.iter().map(|(costs, moved)| total(costs, *moved)).fold(f64::INFINITY, f64::min);
        let costs: Vec<f64> = found.iter().map(|plan| plan.cost).collect();
        assert!((total(&costs, moved(&problem, &found)) / expected - 1.0).abs() < 1e-12, "{number}");
    }
}

/// Ten lines there and back, each a segment.
fn zigzag() -> Problem {
    let mut problem = timed();
    let (first, wrench) = (problem.task.points()[0], problem.task.loads()[0].wrench);
    let line = |line: u32| {
        (0..6).map(move |k| {
            let (side, along) = if line.is_multiple_of(2) { (1.0, k) } else { (-1.0, 5 - k) };
            let position = Vector3::new(0.02 * f64::from(along), 0.01 * f64::from(line), 0.0);
            (line + 1, PathPoint { position, feed: Vector3::x() * side, ..first })
        })
    };
    let path = ToolPath::new((0..10).flat_map(line).collect::<Vec<_>>()).unwrap();
    let force = |k: usize| stead_model::task::Wrench {
        force: if (k / 6).is_multiple_of(2) { wrench.force } else { -wrench.force },
        ..wrench
    };
    problem.task = Task::new(path, (0..60).map(force).collect()).unwrap();
    problem.redundancy.beta_count = 60;
    problem
}

#[test]
fn a_zigzag_does_not_turn_the_arm_over_for_nothing() {
    let mut problem = zigzag();
    let (mut shorter, mut compared) = (0, 0);
    for k in 0..6 {
        let placement = Placement::from([-0.1, -1.9 + 0.05 * f64::from(k), -0.4, 0.9 * f64::from(k)]);
        let mut plan = |tie: f64| {
            problem.postures = PostureRules { tie, ..PostureRules::NONE };
            let planner = Planner::new(&problem);
            let found = planner.plan_fine(&placement, Sense::Min, None, &mut planner.workspace()).ok()?;
            Some((moved(&problem, &found), found.iter().map(|plan| plan.cost).collect::<Vec<_>>()))
        };
        let Some((free, best)) = plan(0.0) else { continue };
        let (tied, costs) = plan(0.05).unwrap();
        compared += 1;
        shorter += usize::from(tied < free);
        assert!(tied <= free, "{tied} {free}");
        assert!(costs.iter().zip(&best).all(|(cost, best)| *cost <= best * (1.05 + 1e-9)));
    }
    assert!(compared > 2 && shorter > 0, "{compared} {shorter}");
}

#[test]
fn postures_are_kept_to() {
    let mut problem = zigzag();
    let placement = Placement::from([-0.1, -1.9, -0.4, 0.9]);
    let best = |problem: &Problem| {
        let planner = Planner::new(problem);
        let mut workspace = planner.workspace();
        let objective = planner.objective(&placement, Sense::Min, None, &mut workspace);
        let plans = planner.plan(&placement, Sense::Min, None, &mut workspace).ok();
        let found = plans.as_ref().map(|plans| problem.objective(plans.iter().map(|plan| plan.cost)));
        assert_eq!(objective.mean().is_some(), found.is_some());
        assert!(objective.mean().zip(found).is_none_or(|(a, b)| (a - b).abs() < 1e-12 * a));
        (objective, plans)
    };
    let (free, _) = best(&problem);
    let mut feasible = Vec::new();
    for posture in Posture::ALL {
        problem.postures = PostureRules::NONE;
        problem.postures.allowed = std::array::from_fn(|k| k + 1 == usize::from(posture.number()));
        let (objective, plans) = best(&problem);
        assert!(plans.iter().flatten().all(|plan| plan.posture == posture));
        feasible.extend(objective.mean());
        // Never better than with every posture.
        assert!(objective.mean().is_none_or(|mean| free.mean().is_some_and(|free| free <= mean * (1.0 + 1e-12))));
    }
    assert!(feasible.len() > 1);
    // One posture for all: the best of these.
    problem.postures = PostureRules { may_change: false, ..PostureRules::NONE };
    let (Objective::Feasible(never), Some(plans)) = best(&problem) else { panic!("no plan") };
    assert!(plans.iter().all(|plan| plan.posture == plans[0].posture));
    let expected = feasible.into_iter().fold(f64::INFINITY, f64::min);
    assert!((never - expected).abs() < 1e-12 * expected, "{never} {expected}");
}
