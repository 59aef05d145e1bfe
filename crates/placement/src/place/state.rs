//! What is stated of the best and the worst placement: made once, when both are known.

use super::basins::{leading, of_best, refine_basins};
use super::found::{Found, Record};
use super::job::{Job, Planned, shifted_back};
use super::notes;
use super::plan::{StatedPlans, detailed, stated};
use super::sets::Sets;
use crate::evaluator::Evaluator;
use crate::outcome::{Case, Cases, ForceSensitivity, Outcome};
use crate::refine::active::{active_bounds, active_walls};
use crate::sensitivity::{objective_by_stiffness, objective_with_force_errors};
use stead_model::robot::angles::wrap;
use stead_numerics::monitor::Progress;
use stead_planning::redundancy::Planner;
use stead_problem::sense::{BySense, Sense};

/// States what was found.
pub(super) fn state(job: &Job<'_>, mut found: Found) -> Outcome {
    let (problem, settings, monitor) = (job.problem, job.settings, job.monitor);
    monitor.report(Progress::Steps { stage: "plans and maps", done: 0, total: 1 });
    let of_worst = || found.worst.as_ref().map(|worst| cases(job, worst, Sense::Max));
    let (of_best, worst) = rayon::join(|| cases(job, &found.best, Sense::Min), of_worst);
    let cases = Cases { best: of_best.best, best_worst_plan: of_best.worst, worst };
    let is_whole = !found.record.interrupted && !monitor.should_stop();
    let size = settings.sensitivity.filter(|_| is_whole);
    let sensitivity = size.and_then(|size| force_sensitivity(job, &found, &cases.best, size));
    let mut beside = Vec::new();
    if problem.lean.is_some() {
        let set_up = problem.in_setup(&cases.best.setup);
        let objective = cases.best.plan.objective;
        beside = notes::of_lean(&set_up, found.upright, objective, cases.worst.is_some());
        beside.extend(problem.criterion.stiffness.is_some().then(notes::no_sets));
        found.record.sets = Sets::default();
    } else if found.is_improved {
        let set_up = found.best.problem(job.without_tie_rule);
        let (long, best) = (found.record.long.as_ref(), std::slice::from_ref(&found.best));
        found.record.sets = Sets::of(&set_up, &found.starts(), long, best, monitor);
        let is_held = sensitivity.is_some() || !found.record.sets.basins.is_empty();
        beside.extend(is_held.then(notes::held_axes));
    }
    let sets = found.record.sets.outcomes(&found.best.solution.placement, &cases.best.plan);
    let interrupted = found.record.interrupted || monitor.should_stop();
    let (notes, warnings) = notes::of_cases(job, &cases, beside, interrupted);
    let Record { sets: of_sets, tried, lookup_summary, long, convergence, refinements, evaluations, states, .. } =
        found.record;
    Outcome {
        cases,
        tried_setups: tried,
        lookup_summary,
        path_levels: long.map(|path| path.levels),
        convergence,
        refinements,
        maps: None,
        lean_map: None,
        sheet: None,
        evaluations,
        states,
        interrupted,
        sensitivity,
        sets,
        set_basins: of_sets.basins,
        notes,
        warnings,
    }
}

/// The best and the worst plan at a placement, with everything that there is to say of them.
fn cases(job: &Job<'_>, found: &Planned, placement_sense: Sense) -> BySense<Case> {
    let problem = &*found.problem(job.problem);
    let without_tie_rule = found.problem(job.without_tie_rule);
    let planner = Planner::finer(&without_tie_rule);
    let with_tie_rule = (problem.postures.tie > 0.0).then(|| Planner::finer(problem));
    let (solution, scheme) = (&found.solution, found.scheme.as_deref());
    let of_sense = StatedPlans::of(with_tie_rule.as_ref().unwrap_or(&planner), found, job.monitor);
    BySense::from_fn(|plan_sense| {
        let plans = match plan_sense {
            Sense::Min => &of_sense.best,
            Sense::Max => &of_sense.worst,
        };
        let active_bounds = match plan_sense {
            Sense::Min if job.monitor.should_stop() => None,
            Sense::Min if placement_sense == Sense::Min => active_bounds(&without_tie_rule, solution),
            Sense::Min => Some(active_walls(&planner, solution, scheme)),
            Sense::Max => Some(Vec::new()),
        };
        let (mut plan, cycle) = stated(problem, &solution.placement, job.transfer, plans);
        let objective_by_stiffness = (!job.monitor.should_stop())
            .then(|| objective_by_stiffness(problem, &solution.placement, plans, plan_sense));
        if found.shift.is_some() {
            plan.axes = job.problem.in_setup(&found.setup).axis_paths();
        }
        Case {
            placement_sense,
            plan_sense,
            placement: found.placement(),
            setup: found.setup.clone(),
            orientation: problem.orientation().map(|orientation| orientation.name.clone()),
            plan,
            cycle,
            active_bounds,
            objective_by_stiffness,
        }
    })
}

/// Refines from where the best placement was refined from once more, in its setup, with scores that cover force errors
/// of this relative size.
fn force_sensitivity(job: &Job<'_>, found: &Found, best: &Case, size: f64) -> Option<ForceSensitivity> {
    let problem = found.best.problem(job.without_tie_rule);
    let robust = problem.changed(|parts| parts.criterion.force_uncertainty = size).ok()?;
    let planner = Planner::finer(&robust);
    let evaluator = Evaluator::new(&planner, None);
    let (starts, long) = (of_best(found.starts()), found.record.long.as_ref());
    let refined = refine_basins(&evaluator, long, &starts, job.monitor).0.best;
    let solution = &leading(Sense::Min, &refined)?.solution;
    let plan = detailed(&problem, &solution.placement, &solution.plans);
    let (from, to) = (&found.best.solution.placement, &solution.placement);
    Some(ForceSensitivity {
        force_uncertainty: size,
        nominal: [best.plan.objective, objective_with_force_errors(&problem, &robust, from, &best.plan)],
        robust: [plan.objective, solution.objective],
        placement: shifted_back(to, found.best.shift),
        distance: (0..3).map(|k| (to[k] - from[k]) * (to[k] - from[k])).sum::<f64>().sqrt(),
        turn: wrap(to.yaw - from.yaw).abs(),
    })
}
