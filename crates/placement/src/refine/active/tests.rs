//! Gains against what a moved bound brings.

use super::*;
use crate::evaluator::Evaluator;
use crate::problem::Placement;
use crate::redundancy::Planner;
use crate::refine::{planned, refine};
use crate::sense::Sense;
use crate::testing::five_segments;

#[test]
fn gains_are_what_a_moved_wall_brings() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 60;
    problem.criterion.weights = crate::criterion::Weights::TOTAL;
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
