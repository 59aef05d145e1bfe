//! Gains against what a moved bound brings.

use super::*;
use crate::evaluator::Evaluator;
use crate::refine::{planned, refine};
use stead_planning::redundancy::Planner;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;
use stead_problem::testing::five_segments;

#[test]
fn gains_are_what_a_moved_wall_brings() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 60;
    problem.criterion.weights = stead_problem::criterion::Weights::TOTAL;
    let start = Placement::from([0.0, -1.65, -0.3, 0.7]);
    let best = |problem: &Problem, start: &Placement| {
        let planner = Planner::finer(problem);
        refine(&Evaluator::new(&planner, None), start, Sense::Min, None, &stead_numerics::monitor::Monitor::silent())
            .unwrap()
            .0
    };
    let optimum = best(&problem, &start);
    let bounds = active_bounds(&problem, &optimum).unwrap();
    let wall = Side { limit: Limit::CellY, is_upper: true };
    let gain = bounds.iter().find(|bound| bound.side == wall).map_or(0.0, |bound| bound.gain);
    assert!(gain > 0.0, "{bounds:?}");
    let step = 1e-3;
    let moved = |by: f64| {
        let mut moved = problem.clone();
        moved.cell.position[1].max += by;
        best(&moved, &moved.cell.clamp(&optimum.placement)).objective
    };
    let measured = (moved(-step) - moved(step)) / (2.0 * step);
    assert!((gain / measured - 1.0).abs() < 0.05, "{gain} {measured}");
    assert!(bounds.windows(2).all(|pair| pair[0].gain >= pair[1].gain));
}

#[test]
fn a_worst_placement_is_held_by_the_walls_it_touches() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 60;
    let corner = Placement::from([0.3, -2.24, -0.25, 2.0]);
    let planner = Planner::finer(&problem);
    let solution = planned(&planner, &corner, None, &mut planner.workspace()).unwrap();
    let bounds = active_walls(&planner, &solution, None);
    let wall = Side { limit: Limit::CellY, is_upper: false };
    let gain = bounds.iter().find(|bound| bound.side == wall).unwrap().gain;
    let step = 1e-4;
    let beyond = Placement { y: corner.y - step, ..corner };
    let farther = planned(&planner, &beyond, None, &mut planner.workspace()).unwrap().objective;
    let measured = (farther - solution.objective) / step;
    assert!((gain / measured - 1.0).abs() < 0.05, "{gain} {measured}");
    assert!(bounds.iter().all(|bound| bound.side.limit != Limit::CellZ));
}

/// The gain stated for a limit at a refined optimum, and what moving it by 1 % brings, in the unit of the limit.
fn stated_and_measured(limit: Limit, problem: &Problem, moved: impl Fn(&mut Problem, f64) -> f64) -> (f64, f64) {
    let best = |problem: &Problem, start: &Placement| {
        let planner = Planner::finer(problem);
        refine(&Evaluator::new(&planner, None), start, Sense::Min, None, &stead_numerics::monitor::Monitor::silent())
            .unwrap()
            .0
    };
    let optimum = best(problem, &Placement::from([0.0, -1.65, -0.3, 0.7]));
    let bounds = active_bounds(problem, &optimum).unwrap();
    let gain = bounds.iter().filter(|bound| bound.side.limit == limit).map(|bound| bound.gain).sum::<f64>();
    let [(tighter, low), (looser, high)] = [0.99, 1.01].map(|factor| {
        let mut changed = problem.clone();
        let value = moved(&mut changed, factor);
        (best(&changed, &optimum.placement).objective, value)
    });
    (gain, (tighter - looser) / (high - low))
}

#[test]
fn gains_of_rates_and_speeds_are_what_a_moved_limit_brings_in_its_unit() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 60;
    problem.redundancy.max_beta_rate = Some(2.0);
    let (gain, measured) = stated_and_measured(Limit::BetaRate, &problem, |changed, factor| {
        *changed.redundancy.max_beta_rate.insert(2.0 * factor)
    });
    assert!(gain > 0.0 && (gain / measured - 1.0).abs() < 0.1, "rate of beta: {gain} {measured}");

    problem.redundancy.max_beta_rate = None;
    problem.redundancy.max_spindle_turn = Some(2.0);
    let (gain, measured) = stated_and_measured(Limit::SpindleTurn, &problem, |changed, factor| {
        *changed.redundancy.max_spindle_turn.insert(2.0 * factor)
    });
    assert!(gain > 0.0 && (gain / measured - 1.0).abs() < 0.1, "turn of the spindle: {gain} {measured}");

    problem.redundancy.max_spindle_turn = None;
    let speed = 2.0 * problem.redundancy.feed;
    problem.redundancy.max_spindle_speed = Some(speed);
    let (gain, measured) = stated_and_measured(Limit::SpindleSpeed, &problem, |changed, factor| {
        *changed.redundancy.max_spindle_speed.insert(speed * factor)
    });
    assert!(gain > 0.0 && (gain / measured - 1.0).abs() < 0.1, "speed of the spindle: {gain} {measured}");

    problem.redundancy.max_spindle_speed = None;
    let slow = |problem: &Problem, factor: f64| {
        let mut joints = problem.robot.joints().clone();
        joints[3].max_speed = Some(3.0 * problem.redundancy.feed * factor);
        stead_model::robot::Robot::new("slow", joints).unwrap()
    };
    problem.robot = slow(&problem, 1.0);
    let (gain, measured) = stated_and_measured(Limit::JointStep(4), &problem, |changed, factor| {
        changed.robot = slow(&problem, factor);
        3.0 * problem.redundancy.feed * factor
    });
    assert!(gain > 0.0 && (gain / measured - 1.0).abs() < 0.1, "speed of joint 4: {gain} {measured}");
}
