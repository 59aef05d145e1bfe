//! A refined placement with the plan that the planner finds there by itself.
//!
//! A refined optimum likes to lie where a constraint leaves a corridor of no width for beta: the plan through it is
//! allowed, but no grid meets it, and whoever asks for the placement alone is given another plan. So a refined solution
//! is held against the plan found anew, and where they differ a compass search ends at a placement nearby that is as
//! good by the planner's own plan.

use super::{Solution, neighbours, planned};
use rayon::prelude::*;
use stead_model::robot::Posture;
use stead_numerics::monitor::Monitor;
use stead_planning::compass::CompassSteps;
use stead_planning::redundancy::Planner;
use stead_problem::problem::Placement;

/// Objectives that agree to this are the same to whoever reads a result file. m
const PRINTED: f64 = 1e-10;
/// The compass search, in scaled variables.
const STEPS: CompassSteps = CompassSteps { first: 0.0067, last: 7e-4, shrink: 3.0, rounds: 24 };
/// What a neighbour has to gain, relative.
const GAIN: f64 = 1e-6;

/// The refined solution of a best placement, if the planner finds one that reads the same there; else the best that it
/// finds in the neighbourhood, as far as it got when `monitor` asks to stop, after which nothing is planned any more.
pub fn found_again(
    planner: &Planner<'_>,
    refined: Solution,
    scheme: Option<&[Posture]>,
    monitor: &Monitor,
) -> Solution {
    let plan = |placement: &Placement| {
        let plan = || planned(planner, placement, scheme, &mut planner.workspace());
        if monitor.should_stop() { None } else { plan() }
    };
    let printed = |solution: &Solution| (solution.objective / PRINTED).round();
    let again = plan(&refined.placement);
    let start = match again {
        Some(again) if printed(&again) == printed(&refined) => return refined,
        Some(again) if again.objective <= refined.objective * (1.0 + GAIN) => return again,
        again => again,
    };
    let better = |best: &Option<Solution>, step: f64| {
        let centre = best.as_ref().map_or(refined.placement, |best| best.placement);
        let found: Vec<Option<Solution>> = neighbours(planner.problem(), &centre, step).par_iter().map(plan).collect();
        let better = found.into_iter().flatten().min_by(|a, b| a.objective.total_cmp(&b.objective));
        let limit = best.as_ref().map_or(f64::INFINITY, |best| best.objective * (1.0 - GAIN));
        better.filter(|better| better.objective < limit).map(Some)
    };
    // Where the planner finds nothing at all, the refined plan is allowed all the same.
    STEPS.search(start, monitor, better).unwrap_or(refined)
}
