//! The placement job: search, refine, plan, map.

use super::evaluator::Evaluator;
use super::outcome::{Case, Cases, Outcome};
use super::problem::Problem;
use super::redundancy::{NoFeasiblePlan, Planner, SegmentPlan};
use super::refine::active::{active_bounds, active_walls};
use super::search::SearchResult;
use super::sense::Sense;
use super::sensitivity::{ForceSensitivity, SetOutcome, mean_by, objective_with_force_errors, with_set_alone};
use super::settings::{SearchSettings, TransferSettings};
use super::transfer::cycle;
use basins::{Refined, refine_basins, refine_side};
use notes::{cancellation, interruption};
use plan::{detailed, worst_plan};
use searched::{Searched, search_cell};
use stead_model::robot::angles::wrap;
use stead_numerics::monitor::{Monitor, Progress};

mod basins;
mod infeasible;
mod notes;
mod plan;
mod score;
mod searched;

pub use infeasible::Infeasible;
use infeasible::infeasible;
pub use score::{Score, score};

/// Finds the best and the worst placement, each with its best and its worst plan: the four cases of Caro 2013, Table III.
///
/// The result depends on the arguments alone, not on the number of threads. When `monitor` asks to stop, every stage ends with what
/// it has, only the plans of the best and the worst placement are still made, and [`Outcome::interrupted`] is set. Maps are not
/// made here: see [`Outcome::map`].
///
/// # Errors
/// [`Infeasible`] when the search met no feasible placement.
pub fn place(
    problem: &Problem,
    settings: &SearchSettings,
    transfer: &TransferSettings,
    monitor: &Monitor,
) -> Result<Outcome, Infeasible> {
    let planner = Planner::finer(problem);
    let Searched { found, table, lookup_summary, evaluations } = search_cell(&planner, settings, monitor)?;
    let refused = || {
        let nearest = &found[0].basins[0];
        infeasible(&planner, &nearest.placement, nearest.scheme.as_deref(), true, monitor)
    };
    let evaluator = Evaluator::new(&planner, table.as_ref()).with_finer_lookup(2);
    let (solutions, refinements) = refine_basins(&evaluator, &found, monitor).ok_or_else(refused)?;
    monitor.report(Progress::Steps { stage: "plans and maps", done: 0, total: 1 });
    let [best, worst] = &solutions;
    let worst_plan_of =
        |refined: &Refined| worst_plan(&planner, &refined.solution.placement, refined.scheme.as_deref());
    let (of_best, of_worst) = rayon::join(|| worst_plan_of(best), || worst_plan_of(worst));
    let case = |placement_sense, solution: &Refined, plan_sense, worst: &Result<Vec<SegmentPlan>, NoFeasiblePlan>| {
        let best = &solution.solution.plans;
        let plans = match plan_sense {
            Sense::Min => best,
            // A placement with a best plan has a worst one too; should the two disagree on a limit, the best stands for both.
            Sense::Max => worst.as_ref().unwrap_or(best),
        };
        let active_bounds = match plan_sense {
            Sense::Min if monitor.should_stop() => Vec::new(),
            Sense::Min if placement_sense == Sense::Min => active_bounds(problem, &solution.solution),
            Sense::Min => active_walls(&planner, &solution.solution, solution.scheme.as_deref()),
            Sense::Max => Vec::new(),
        };
        Case {
            placement_sense,
            plan_sense,
            placement: solution.solution.placement,
            plan: detailed(problem, &solution.solution.placement, plans),
            cycle: cycle(problem, transfer, plans),
            active_bounds,
        }
    };
    let interrupted = found.iter().any(|f| f.interrupted) || monitor.should_stop();
    let best_case = case(Sense::Min, best, Sense::Min, &of_best);
    let sensitivity = match settings.sensitivity {
        Some(size) if !interrupted => force_sensitivity(problem, &best_case, &found, size, monitor),
        _ => None,
    };
    let sets = if interrupted { Vec::new() } else { set_outcomes(problem, &best_case, &found, monitor) };
    Ok(Outcome {
        sets,
        notes: notes::of(problem, &best_case.plan, &best_case.cycle.feed),
        sensitivity,
        cases: Cases {
            best: best_case,
            best_worst_plan: case(Sense::Min, best, Sense::Max, &of_best),
            worst: case(Sense::Max, worst, Sense::Min, &of_worst),
            worst_worst_plan: case(Sense::Max, worst, Sense::Max, &of_worst),
        },
        lookup_summary,
        convergence: found.iter().flat_map(|f| f.history.clone()).collect(),
        refinements,
        maps: None,
        evaluations,
        states: evaluations * problem.task.points().len() * problem.redundancy.beta_count,
        interrupted,
        warnings: cancellation(problem, best.solution.objective)
            .into_iter()
            .chain(interrupted.then(interruption))
            .collect(),
    })
}

/// Refines the basins of the best placement once more, with scores that cover force errors of this relative size.
fn force_sensitivity(
    problem: &Problem,
    best: &Case,
    found: &[SearchResult; 2],
    size: f64,
    monitor: &Monitor,
) -> Option<ForceSensitivity> {
    let mut robust = problem.clone();
    robust.criterion.force_uncertainty = size;
    let planner = Planner::finer(&robust);
    let evaluator = Evaluator::new(&planner, None);
    let basins = [found[0].clone(), SearchResult { basins: Vec::new(), ..found[1].clone() }];
    let (solutions, _) = refine_side(&evaluator, &basins, monitor);
    let Refined { solution, .. } = solutions.into_iter().flatten().next()?;
    let plan = detailed(problem, &solution.placement, &solution.plans);
    let (from, to) = (&best.placement, &solution.placement);
    Some(ForceSensitivity {
        force_uncertainty: size,
        nominal: [best.plan.objective, objective_with_force_errors(problem, from, &best.plan, size)],
        robust: [plan.objective, solution.objective],
        placement: *to,
        distance: (0..3).map(|k| (to[k] - from[k]) * (to[k] - from[k])).sum::<f64>().sqrt(),
        turn: wrap(to.yaw - from.yaw).abs(),
    })
}

/// What each stiffness set of the criterion makes of the best placement, beside the best for that set alone.
fn set_outcomes(problem: &Problem, best: &Case, found: &[SearchResult; 2], monitor: &Monitor) -> Vec<SetOutcome> {
    let Some(sets) = &problem.criterion.stiffness else { return Vec::new() };
    let basins = [found[0].clone(), SearchResult { basins: Vec::new(), ..found[1].clone() }];
    let outcome = |set| {
        let alone = with_set_alone(problem, set);
        let planner = Planner::finer(&alone);
        let (solutions, _) = refine_side(&Evaluator::new(&planner, None), &basins, monitor);
        let best_alone = solutions.into_iter().flatten().next().map(|Refined { solution, .. }| {
            mean_by(&alone, &solution.placement, &detailed(&alone, &solution.placement, &solution.plans))
        });
        SetOutcome { mean: mean_by(&alone, &best.placement, &best.plan), alone: best_alone }
    };
    sets.robots.iter().map(outcome).collect()
}

#[cfg(test)]
mod brute_force;
#[cfg(test)]
mod tests;
