//! The placement job: search, refine, plan, map.

use super::evaluator::Evaluator;
use super::outcome::{Case, Cases, ForceSensitivity, Outcome};
use super::problem::Problem;
use super::redundancy::Planner;
use super::refine::Solution;
use super::refine::active::{active_bounds, active_walls};
use super::search::SearchResult;
use super::sense::Sense;
use super::sensitivity::{objective_by_stiffness, objective_with_force_errors};
use super::settings::{SearchSettings, TransferSettings};
use super::transfer::cycle;
use basins::{best_alone, choose, leading, refine_basins};
use notes::{cancellation, interruption};
use plan::{StatedPlans, detailed};
use refined::Refined;
use searched::{Searched, search_cell};
use sets::Sets;
use setups::place_in_all;
use stead_model::robot::angles::wrap;
use stead_numerics::monitor::{Monitor, Progress};

mod axes;
mod basins;
mod calmer;
mod infeasible;
mod long_path;
mod long_refinement;
mod notes;
mod plan;
mod refined;
mod score;
mod searched;
mod sets;
mod setups;

use infeasible::infeasible;
pub use infeasible::{BlockingPair, Infeasible};
pub use long_path::LongPath;
pub use score::{Score, score};
pub use setups::setup_at;

/// Memory for a point of the path while it is planned and reported, as measured with 50 000 points. Bytes
const MEMORY_PER_POINT: u64 = 12_000;

/// About how much memory the job takes for a path. Bytes
pub fn planning_memory(problem: &Problem) -> u64 {
    MEMORY_PER_POINT * problem.task.points().len() as u64
}

/// Finds the best and the worst placement, each with its best and its worst plan: the four cases of Caro 2013, Table III; or the best one
/// alone ([`SearchSettings::worst`]), which is what it is beside the worst one as long as the path is not searched on a subset.
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
    if problem.orientations.len() < 2 && problem.external_axes.is_empty() {
        return place_as_set_up(problem, settings, transfer, monitor);
    }
    place_in_all(problem, settings, transfer, monitor)
}

/// The job in the setup of the problem.
fn place_as_set_up(
    problem: &Problem,
    settings: &SearchSettings,
    transfer: &TransferSettings,
    monitor: &Monitor,
) -> Result<Outcome, Infeasible> {
    // Placements are compared by their best plans; only what is stated at the end may be worse by the tie.
    let untied = problem.untied();
    let planner = Planner::finer(&untied);
    let mut long = LongPath::new(&planner, settings, monitor);
    let searched = match &mut long {
        Some(path) => path.search(&planner, settings, monitor)?,
        None => search_cell(&planner, settings, monitor)?,
    };
    let Searched { found, table, lookup_summary, evaluations } = searched;
    let long = long.as_ref();
    let refused = || {
        let nearest = &found[0].basins[0];
        infeasible(&planner, &nearest.placement, nearest.scheme.as_deref(), true, monitor)
    };
    let evaluator = Evaluator::new(&planner, table.as_ref()).with_finer_lookup(2);
    let (basins, refinements) = refine_basins(&evaluator, long, &found, monitor);
    let sets = Sets::of(&untied, (&found, long), &basins[0], monitor);
    let (best, worst) = choose(&basins, sets.regrets().as_deref(), settings).ok_or_else(refused)?;
    monitor.report(Progress::Steps { stage: "plans and maps", done: 0, total: 1 });
    let cases = |refined, sense| stated_cases((problem, &planner), transfer, sense, refined, monitor);
    let of_worst = || worst.as_ref().map(|worst| cases(worst, Sense::Max));
    let ([best_case, best_worst_plan], worst) = rayon::join(|| cases(&best, Sense::Min), of_worst);
    let cases = Cases { best: best_case, best_worst_plan, worst };
    let interrupted = found.iter().any(|f| f.interrupted) || monitor.should_stop();
    let sensitivity = match settings.sensitivity {
        Some(size) if !interrupted => force_sensitivity(&untied, &best.solution, (&found, long), size, monitor),
        _ => None,
    };
    let named = cases.all().into_iter().zip(["case 1", "case 2", "case 3", "case 4"]);
    let of_moves = notes::moves(&named.map(|(case, name)| (name, &case.cycle)).collect::<Vec<_>>());
    let stated = (&cases.best.plan, &cases.best.cycle.feed);
    let mut notes = notes::of(problem, &cases.best.placement, stated, monitor);
    notes.extend((!settings.worst).then(notes::best_alone));
    Ok(Outcome {
        sets: sets.outcomes(&cases.best),
        set_basins: sets.basins,
        notes,
        sensitivity,
        cases,
        tried_setups: Vec::new(),
        lookup_summary,
        path_levels: long.map(|path| path.levels),
        convergence: found.iter().flat_map(|f| f.history.clone()).collect(),
        refinements,
        maps: None,
        evaluations,
        states: evaluations
            * long.map_or(problem.task.points().len(), |path| path.levels.subsets[0].points)
            * problem.redundancy.beta_count,
        interrupted,
        warnings: cancellation(problem, best.solution.objective)
            .into_iter()
            .chain(of_moves)
            .chain(interrupted.then(interruption))
            .collect(),
    })
}

/// The best and the worst plan at a refined placement, with everything that there is to say of them; `untied` plans the problem in which
/// the best plan is taken whatever the moves.
fn stated_cases(
    (problem, untied): (&Problem, &Planner<'_>),
    transfer: &TransferSettings,
    placement_sense: Sense,
    refined: &Refined,
    monitor: &Monitor,
) -> [Case; 2] {
    let tied = (problem.postures.tie > 0.0).then(|| Planner::finer(problem));
    let (solution, scheme) = (&refined.solution, refined.scheme.as_deref());
    let stated = StatedPlans::of(tied.as_ref().unwrap_or(untied), refined, monitor);
    Sense::BOTH.map(|plan_sense| {
        let plans = match plan_sense {
            Sense::Min => &stated.best,
            Sense::Max => &stated.worst,
        };
        let active_bounds = match plan_sense {
            Sense::Min if monitor.should_stop() => None,
            Sense::Min if placement_sense == Sense::Min => active_bounds(untied.problem(), solution),
            Sense::Min => Some(active_walls(untied, solution, scheme)),
            Sense::Max => Some(Vec::new()),
        };
        Case {
            placement_sense,
            plan_sense,
            placement: solution.placement,
            setup: problem.setup.clone(),
            orientation: problem.orientation().map(|orientation| orientation.name.clone()),
            plan: detailed(problem, &solution.placement, plans),
            cycle: cycle(problem, &solution.placement, transfer, plans),
            active_bounds,
            objective_by_stiffness: (!monitor.should_stop())
                .then(|| objective_by_stiffness(problem, &solution.placement, plans, plan_sense)),
        }
    })
}

/// Refines the basins of the best placement once more, with scores that cover force errors of this relative size.
fn force_sensitivity(
    problem: &Problem,
    best: &Solution,
    (found, long): (&[SearchResult; 2], Option<&LongPath>),
    size: f64,
    monitor: &Monitor,
) -> Option<ForceSensitivity> {
    let mut robust = problem.clone();
    robust.criterion.force_uncertainty = size;
    let planner = Planner::finer(&robust);
    let evaluator = Evaluator::new(&planner, None);
    let ([refined, _], _) = refine_basins(&evaluator, long, &best_alone(found), monitor);
    let solution = &leading(Sense::Min, &refined)?.solution;
    let [plan, nominal] = [solution, best].map(|solution| detailed(problem, &solution.placement, &solution.plans));
    let (from, to) = (&best.placement, &solution.placement);
    Some(ForceSensitivity {
        force_uncertainty: size,
        nominal: [nominal.objective, objective_with_force_errors(problem, from, &nominal, size)],
        robust: [plan.objective, solution.objective],
        placement: *to,
        distance: (0..3).map(|k| (to[k] - from[k]) * (to[k] - from[k])).sum::<f64>().sqrt(),
        turn: wrap(to.yaw - from.yaw).abs(),
    })
}

#[cfg(test)]
mod brute_force;
#[cfg(test)]
mod tests;
