//! The placement to which small steps and then gradients lead from a given one: the bottom of its own basin.

use super::infeasible::{Infeasible, infeasible};
use crate::evaluator::Evaluator;
use crate::path_subset::PathSubset;
use crate::refine::refine;
use crate::whole_path::WholePath;
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::redundancy::Planner;
use stead_problem::candidate::{Candidate, Objective};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;

/// Longer paths are improved on some of their points, which the whole path then checks.
const WHOLE: usize = 1000;
/// So many, beside one for every segment.
const POINTS: usize = 180;
/// How often points that decide against what a subset promises join it.
const REPEATS: usize = 4;

/// The best placement near a given one, in the setup of the problem and within its cell: coordinate search where the
/// given one has no plan, then the refinement by gradients. A stop ends it with what it has.
///
/// # Errors
/// [`Infeasible`]: nothing that was met near the given placement has a plan.
pub fn improve(problem: &Problem, start: &Placement, monitor: &Monitor) -> Result<Placement, Infeasible> {
    let without_tie_rule = problem.without_tie_rule();
    let finer = Planner::finer(&without_tie_rule);
    let start = problem.cell.clamp(start);
    let all = problem.task.points().len();
    let count = POINTS + problem.task.segments().len();
    let nothing = |placement: &Placement| infeasible(&finer, placement, None, true, monitor);
    if all <= WHOLE || count >= all {
        return improved(&finer, &start, monitor).map(|(placement, _)| placement).ok_or_else(|| nothing(&start));
    }
    let whole = WholePath::new(&finer);
    let mut subset = PathSubset::new(&problem.task, count);
    let mut last = start;
    for _ in 0..REPEATS {
        let thinned = subset.of(&without_tie_rule);
        let Some((placement, objective)) = improved(&Planner::finer(&thinned), &last, monitor) else { break };
        last = placement;
        match whole.objective(&placement, None, Some(objective)) {
            Ok(_) => return Ok(placement),
            Err(points) if !monitor.should_stop() && subset.add(&points) => {}
            Err(_) => break,
        }
    }
    // What the subsets lead to has no plan on the whole path: the given placement, where that has one.
    whole.objective(&start, None, None).map(|_| start).map_err(|_| nothing(&last))
}

/// The best placement near a given one and its objective (m).
fn improved(planner: &Planner<'_>, start: &Placement, monitor: &Monitor) -> Option<(Placement, f64)> {
    let step = |done| monitor.report(Progress::Steps { stage: "search from here", done, total: 2 });
    step(0);
    let evaluator = Evaluator::new(planner, None);
    let objective = evaluator.objective(start, None, &mut evaluator.workspace());
    let mut from = Candidate { placement: *start, scheme: None, objective };
    if let Objective::Infeasible { .. } = from.objective {
        from = evaluator.improved(&from, Sense::Min, monitor, &mut evaluator.workspace()).0;
        from.objective.mean()?;
    }
    step(1);
    let (solution, _) = refine(&evaluator, &from.placement, Sense::Min, None, monitor)?;
    Some((solution.placement, solution.objective))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::score;
    use stead_problem::settings::TransferSettings;
    use stead_problem::testing::five_segments;

    fn mean(problem: &Problem, placement: &Placement) -> f64 {
        let scored = score(problem, placement, &TransferSettings::default(), &Monitor::silent());
        scored.map_or(f64::INFINITY, |score| score.plans.best.mean)
    }

    #[test]
    fn from_a_poor_placement_it_ends_at_a_better_one_in_the_cell() {
        let problem = five_segments();
        let start = Placement::from([0.1, -1.7, -0.4, 1.0]);
        let end = improve(&problem, &start, &Monitor::silent()).unwrap();
        assert!(problem.cell.contains(&end));
        assert!(mean(&problem, &end) < 0.8 * mean(&problem, &start), "{end:?}");
    }

    #[test]
    fn a_start_without_a_plan_is_left_first_and_one_with_none_near_is_refused() {
        let mut problem = five_segments();
        // Some points are too far out, and steps inwards make them fewer.
        problem.cell.position[1].min = -3.3;
        let start = Placement::from([0.0, -3.12, -0.4, 1.378]);
        assert!(mean(&problem, &start).is_infinite());
        let end = improve(&problem, &start, &Monitor::silent()).unwrap();
        assert!(mean(&problem, &end).is_finite() && problem.cell.contains(&end));
        problem.cell.position[1] = stead_problem::problem::Interval { min: -9.0, max: -8.9 };
        let none = improve(&problem, &Placement::from([0.0, -9.0, -0.4, 0.0]), &Monitor::silent()).unwrap_err();
        assert!(none.to_string().contains("beyond the stretched arm"), "{none}");
    }
}
