//! The candidates of a generation, evaluated side by side.

use super::{LAST_LOOK, UNEVALUATED};
use crate::evaluator::{self, Evaluator};
use crate::lookup::CollisionEffort;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use stead_numerics::monitor::Monitor;
use stead_problem::candidate::{Candidate, Objective};
use stead_problem::sense::Sense;

/// The bounds of the objectives of the better third of a sorted population: what is not within them even without
/// collisions can become a parent, but is looked at more closely before it is refined. Where the worst placement is
/// sought there are none: collisions make a mean larger. m
pub(super) fn better_third(population: &[Candidate], sense: Sense) -> [f64; 2] {
    match (population[population.len() / 3].objective.mean(), sense) {
        (Some(bound), Sense::Min) => [f64::NEG_INFINITY, bound],
        _ => CollisionEffort::ALL.within,
    }
}

/// Evaluates candidates from one on. Collisions are looked for only where the objective without them is `within` two
/// bounds (m).
pub(super) fn evaluate(
    evaluator: &Evaluator<'_>,
    population: &mut Vec<Candidate>,
    from: usize,
    within: [f64; 2],
    monitor: &Monitor,
) {
    let objective = |candidate: &Candidate, workspace: &mut evaluator::Workspace| {
        evaluator.rough_objective(&candidate.placement, candidate.scheme.as_deref(), within, workspace)
    };
    by(&|| evaluator.workspace(), &objective, population, from, LAST_LOOK, monitor);
}

/// Evaluates all candidates from one on. Once the caller asks to stop, those not begun yet are taken out; only where
/// nothing feasible was met, `last_look` of them are evaluated all the same.
pub(super) fn by<W>(
    workspace: &(impl Fn() -> W + Sync),
    objective: &(impl Fn(&Candidate, &mut W) -> Objective + Sync),
    candidates: &mut Vec<Candidate>,
    from: usize,
    last_effort: usize,
    monitor: &Monitor,
) {
    let is_feasible = |candidate: &Candidate| candidate.objective.mean().is_some();
    let is_met = AtomicBool::new(candidates[..from].iter().any(is_feasible));
    let looked = AtomicUsize::new(0);
    candidates[from..].par_iter_mut().for_each_init(workspace, |workspace, candidate| {
        let is_enough = || is_met.load(Relaxed) || looked.fetch_add(1, Relaxed) >= last_effort;
        if monitor.should_stop() && is_enough() {
            candidate.objective = UNEVALUATED;
            return;
        }
        candidate.objective = objective(candidate, workspace);
        if is_feasible(candidate) {
            is_met.store(true, Relaxed);
        }
    });
    candidates.retain(|candidate| candidate.objective != UNEVALUATED);
}
