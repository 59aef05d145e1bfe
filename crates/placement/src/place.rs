//! The placement job: search, refine, plan, map.
//!
//! `searched` and `basins` are search and refinement, `plan` and `notes` what is stated of what they find, `infeasible`
//! what blocks a placement that is refused. `long_path` and `long_refinement` do the same by subsets of a long path,
//! `preview` and `from_here` are for a placement that is moved by hand: what it comes to at once, and the best one near
//! it. `setups` and `axes` choose among orientations and positions of external axes, `lean` how the tool leans, `sets`
//! covers several stiffnesses, and `calmer` tells whether a calmer plan costs little.

use super::evaluator::Evaluator;
use super::outcome::{Case, Cases, ForceSensitivity, Outcome};
use super::refine::Solution;
use super::refine::active::{active_bounds, active_walls};
use super::search::SearchResult;
use super::sensitivity::{objective_by_stiffness, objective_with_force_errors};
use super::settings::SearchSettings;
use basins::{best_alone, choose, leading, refine_basins};
use lean::place_leaned;
use plan::{StatedPlans, detailed, stated};
use refined::Refined;
use searched::{Searched, search_cell};
use sets::Sets;
use setups::place_in_all;
use stead_model::robot::angles::wrap;
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::problem::Problem;
use stead_planning::redundancy::Planner;
use stead_planning::sense::{BySense, Sense};
use stead_planning::transfer::TransferSettings;

mod axes;
mod basins;
mod calmer;
mod from_here;
mod infeasible;
mod lean;
mod long_path;
mod long_refinement;
mod motion;
mod notes;
mod plan;
mod preview;
mod refined;
mod score;
mod searched;
mod sets;
mod setups;
mod thinned;

pub use from_here::improve;
use infeasible::infeasible;
pub use infeasible::{BlockingPair, Infeasible};
pub use long_path::LongPath;
pub use preview::{Blocked, Preview, PreviewProblem};
pub use score::{Score, score};
pub use setups::setup_at;

/// Memory for a point of the path while it is planned and reported, as measured with 50 000 points. Bytes
const MEMORY_PER_POINT: u64 = 12_000;

/// About how much memory the job takes for a path. Bytes
pub fn planning_memory(problem: &Problem) -> u64 {
    MEMORY_PER_POINT * problem.task.points().len() as u64
}

/// Finds the best and the worst placement, each with its best and its worst plan: the four cases of Caro 2013, Table
/// III; or the best one alone ([`SearchSettings::worst`]), which is what it is beside the worst one as long as the path
/// is not searched on a subset.
///
/// The result depends on the arguments alone, not on the number of threads. When `monitor` asks to stop, every stage
/// ends with what it has, only the plans of the best and the worst placement are still made, and
/// [`Outcome::interrupted`] is set. Maps are not made here: see [`Outcome::map`].
///
/// # Errors
/// [`Infeasible`] when the search met no feasible placement.
pub fn place(
    problem: &Problem,
    settings: &SearchSettings,
    transfer: &TransferSettings,
    monitor: &Monitor,
) -> Result<Outcome, Infeasible> {
    let found = if problem.orientations.len() < 2 && problem.external_axes.is_empty() {
        place_as_set_up(problem, settings, transfer, monitor)
    } else {
        place_in_all(problem, settings, transfer, monitor)
    };
    let leaned = |found| place_leaned(problem, settings, transfer, monitor, found);
    let mut outcome = if problem.lean.is_some() { leaned(found) } else { found }?;
    notes::say(problem, settings, &mut outcome, monitor);
    Ok(outcome)
}

/// The job in the setup of the problem.
fn place_as_set_up(
    problem: &Problem,
    settings: &SearchSettings,
    transfer: &TransferSettings,
    monitor: &Monitor,
) -> Result<Outcome, Infeasible> {
    // Placements are compared by their best plans; only what is stated at the end may be worse by the tie.
    let without_tie_rule = problem.without_tie_rule();
    let planner = Planner::finer(&without_tie_rule);
    let mut long = LongPath::new(&planner, settings, monitor);
    let searched = match &mut long {
        Some(path) => path.search(&planner, settings, monitor)?,
        None => search_cell(&planner, settings, monitor)?,
    };
    let Searched { found, table, lookup_summary, evaluations } = searched;
    let long = long.as_ref();
    let refused = || {
        let nearest = &found.best.basins[0];
        infeasible(&planner, &nearest.placement, nearest.scheme.as_deref(), true, monitor)
    };
    let evaluator = Evaluator::new(&planner, table.as_ref()).with_finer_lookup(2);
    let (basins, refinements) = refine_basins(&evaluator, long, &found, monitor);
    let sets = Sets::of(&without_tie_rule, &found, long, &basins.best, monitor);
    let (best, worst) = choose(&basins, sets.regrets().as_deref(), settings).ok_or_else(refused)?;
    monitor.report(Progress::Steps { stage: "plans and maps", done: 0, total: 1 });
    let cases = |refined, sense| stated_cases(problem, &planner, transfer, sense, refined, monitor);
    let of_worst = || worst.as_ref().map(|worst| cases(worst, Sense::Max));
    let (best_placement, worst) = rayon::join(|| cases(&best, Sense::Min), of_worst);
    let cases = Cases { best: best_placement.best, best_worst_plan: best_placement.worst, worst };
    let interrupted = found.values().iter().any(|f| f.interrupted) || monitor.should_stop();
    let sensitivity = match settings.sensitivity {
        Some(size) if !interrupted => force_sensitivity(&without_tie_rule, &best.solution, &found, long, size, monitor),
        _ => None,
    };
    Ok(Outcome {
        sets: sets.outcomes(&cases.best),
        set_basins: sets.basins,
        notes: Vec::new(),
        sensitivity,
        cases,
        tried_setups: Vec::new(),
        lookup_summary,
        path_levels: long.map(|path| path.levels),
        convergence: found.values().into_iter().flat_map(|f| f.history.clone()).collect(),
        refinements,
        maps: None,
        lean_map: None,
        sheet: None,
        evaluations,
        states: evaluations
            * long.map_or(problem.task.points().len(), |path| path.levels.search.points)
            * problem.redundancy.beta_count,
        interrupted,
        warnings: Vec::new(),
    })
}

/// The best and the worst plan at a refined placement, with everything that there is to say of them; `without_tie_rule`
/// plans the problem in which the best plan is taken whatever the moves.
fn stated_cases(
    problem: &Problem,
    without_tie_rule: &Planner<'_>,
    transfer: &TransferSettings,
    placement_sense: Sense,
    refined: &Refined,
    monitor: &Monitor,
) -> BySense<Case> {
    let with_tie_rule = (problem.postures.tie > 0.0).then(|| Planner::finer(problem));
    let (solution, scheme) = (&refined.solution, refined.scheme.as_deref());
    let of_sense = StatedPlans::of(with_tie_rule.as_ref().unwrap_or(without_tie_rule), refined, monitor);
    BySense::from_fn(|plan_sense| {
        let plans = match plan_sense {
            Sense::Min => &of_sense.best,
            Sense::Max => &of_sense.worst,
        };
        let active_bounds = match plan_sense {
            Sense::Min if monitor.should_stop() => None,
            Sense::Min if placement_sense == Sense::Min => active_bounds(without_tie_rule.problem(), solution),
            Sense::Min => Some(active_walls(without_tie_rule, solution, scheme)),
            Sense::Max => Some(Vec::new()),
        };
        let (plan, cycle) = stated(problem, &solution.placement, transfer, plans);
        Case {
            placement_sense,
            plan_sense,
            placement: solution.placement,
            setup: problem.setup.clone(),
            orientation: problem.orientation().map(|orientation| orientation.name.clone()),
            plan,
            cycle,
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
    found: &BySense<SearchResult>,
    long: Option<&LongPath>,
    size: f64,
    monitor: &Monitor,
) -> Option<ForceSensitivity> {
    let robust = problem.changed(|parts| parts.criterion.force_uncertainty = size).ok()?;
    let planner = Planner::finer(&robust);
    let evaluator = Evaluator::new(&planner, None);
    let refined = refine_basins(&evaluator, long, &best_alone(found), monitor).0.best;
    let solution = &leading(Sense::Min, &refined)?.solution;
    let [plan, nominal] = [solution, best].map(|solution| detailed(problem, &solution.placement, &solution.plans));
    let (from, to) = (&best.placement, &solution.placement);
    Some(ForceSensitivity {
        force_uncertainty: size,
        nominal: [nominal.objective, objective_with_force_errors(problem, &robust, from, &nominal)],
        robust: [plan.objective, solution.objective],
        placement: *to,
        distance: (0..3).map(|k| (to[k] - from[k]) * (to[k] - from[k])).sum::<f64>().sqrt(),
        turn: wrap(to.yaw - from.yaw).abs(),
    })
}

#[cfg(test)]
mod brute_force;
#[cfg(test)]
pub(crate) mod tests;
