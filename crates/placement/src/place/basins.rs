//! Refinement of the basins that a search found, and the choice among what comes out.

use super::job::Planned;
use super::long_path::LongPath;
use super::long_refinement;
use crate::evaluator::Evaluator;
use crate::outcome::Refinement;
use crate::refine::{found_again, planned, refine, state_residual};
use crate::search::SearchResult;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_numerics::monitor::{Monitor, Progress};
use stead_problem::candidate::Candidate;
use stead_problem::sense::{BySense, Sense};
use stead_problem::settings::SearchSettings;

/// Basins whose means differ by less than this (relative) are equal: the one that the search ranked higher is taken, so
/// that rounding does not choose between mirror images.
pub(super) const TIE: f64 = 1e-5;

/// A basin whose mean after the search is this much (relative) behind the best one refined is left alone, where both
/// were improved on a lookup table: refinement gains less from there.
pub(super) const MAX_DEFICIT: f64 = 0.03;

/// The best and, where it is looked for, the worst of the refined basins of both searches, the best by its regret where
/// regrets are given; `None` when there is none.
pub(super) fn choose(
    basins: &BySense<Vec<Planned>>,
    regrets: Option<&[Option<f64>]>,
    settings: &SearchSettings,
) -> Option<(Planned, Option<Planned>)> {
    let by_regret = regrets.and_then(least_regret).and_then(|place| basins.best.get(place));
    let best = by_regret.or_else(|| leading(Sense::Min, &basins.best));
    if !settings.worst {
        return best.map(|best| (best.clone(), None));
    }
    let [best, worst] = match [best, leading(Sense::Max, &basins.worst)] {
        // Of two searches that were stopped early either may have met the better placement.
        [Some(best), Some(worst)] if by_regret.is_none() && best.solution.objective > worst.solution.objective => {
            [worst, best]
        }
        [Some(best), Some(worst)] => [best, worst],
        // A search whose basins have no plan on the finer grid takes the other's.
        [Some(only), None] | [None, Some(only)] => [only, only],
        [None, None] => return None,
    };
    Some((best.clone(), Some(worst.clone())))
}

/// The first of the basins whose objective is the best in a sense.
pub(super) fn leading(sense: Sense, basins: &[Planned]) -> Option<&Planned> {
    basins.iter().reduce(|known, next| {
        let (known_objective, objective) = (known.solution.objective, next.solution.objective);
        let is_better = match sense {
            Sense::Min => objective < known_objective * (1.0 - TIE),
            Sense::Max => objective > known_objective * (1.0 + TIE),
        };
        if is_better { next } else { known }
    })
}

/// The first of the least regrets.
fn least_regret(regrets: &[Option<f64>]) -> Option<usize> {
    let known = regrets.iter().enumerate().filter_map(|(place, regret)| Some((place, (*regret)?)));
    let least = known.reduce(|known, next| if 1.0 + next.1 < (1.0 + known.1) * (1.0 - TIE) { next } else { known });
    least.map(|(place, _)| place)
}

/// Basins of the best placement alone.
pub(super) fn of_best(basins: Vec<Candidate>) -> BySense<SearchResult> {
    BySense { best: SearchResult { basins, ..SearchResult::nothing() }, worst: SearchResult::nothing() }
}

/// Refines the basins of both searches side by side, those of the best and those of the worst placement. The first
/// basin of each search goes ahead, to tell which of the others can still win. Best placements are then held against
/// the plans that are found anew ([`found_again`]): last, since that can take longer than all else and is shared among
/// the threads.
pub(super) fn refine_basins(
    evaluator: &Evaluator<'_>,
    long: Option<&LongPath>,
    found: &BySense<SearchResult>,
    monitor: &Monitor,
) -> (BySense<Vec<Planned>>, Vec<Refinement>) {
    if let Some(path) = long {
        return long_refinement::refine_basins(path, evaluator.planner(), found, monitor);
    }
    let jobs: usize = found.values().map(|found| found.basins.len()).iter().sum();
    let done = AtomicUsize::new(0);
    // Each basin is one step to refine and one to be planned anew.
    let report_done = |steps: usize| {
        let done = done.fetch_add(steps, Ordering::Relaxed) + steps;
        monitor.report(Progress::Steps { stage: "refining", done, total: 2 * jobs });
    };
    report_done(0);
    let refined = |sense: Sense, candidate: &Candidate| {
        let refined = refine_one(evaluator, sense, candidate, monitor);
        report_done(if refined.is_some() { 1 } else { 2 });
        refined
    };
    let planned_again = |sense: Sense, (mut refined, report): (Planned, Option<Refinement>)| {
        // The worst placement has the plan that the planner finds.
        if sense == Sense::Min && report.is_some() {
            let (solution, scheme) = (refined.solution.clone(), refined.scheme.as_deref());
            refined.solution = found_again(evaluator.planner(), solution, scheme, monitor);
        }
        report_done(1);
        (refined, report)
    };
    let refined_of = |sense: Sense, found: &SearchResult| -> Vec<(Planned, Option<Refinement>)> {
        let Some((first, others)) = found.basins.split_first() else { return Vec::new() };
        let first = refined(sense, first).map(|first| planned_again(sense, first));
        let ahead = first.as_ref().map(|(refined, _)| refined.solution.objective);
        let can_win = |candidate: &Candidate| match (evaluator.table(), ahead, candidate.objective.mean()) {
            (Some(_), Some(ahead), Some(mean)) => match sense {
                Sense::Min => mean * (1.0 - MAX_DEFICIT) < ahead,
                Sense::Max => mean * (1.0 + MAX_DEFICIT) > ahead,
            },
            _ => true,
        };
        // Once the caller asks to stop, other basins are only for a search whose first one has no plan.
        let is_wanted = |candidate: &Candidate| can_win(candidate) && !(monitor.should_stop() && ahead.is_some());
        let refined = |other: &Candidate| {
            if is_wanted(other) {
                return refined(sense, other);
            }
            report_done(2);
            None
        };
        let others: Vec<_> = others.par_iter().filter_map(refined).collect();
        let others: Vec<_> = others.into_par_iter().map(|other| planned_again(sense, other)).collect();
        first.into_iter().chain(others).collect()
    };
    let (best, worst) = rayon::join(|| refined_of(Sense::Min, &found.best), || refined_of(Sense::Max, &found.worst));
    let (best, reports): (Vec<_>, Vec<_>) = best.into_iter().unzip();
    let (worst, others): (Vec<_>, Vec<_>) = worst.into_iter().unzip();
    (BySense { best, worst }, reports.into_iter().chain(others).flatten().collect())
}

/// Refines one basin, or only plans it where the job is to stop.
fn refine_one(
    evaluator: &Evaluator<'_>,
    sense: Sense,
    candidate: &Candidate,
    monitor: &Monitor,
) -> Option<(Planned, Option<Refinement>)> {
    let (placement, scheme) = (&candidate.placement, candidate.scheme.as_deref());
    let (solution, report) = if monitor.should_stop() {
        let planner = evaluator.planner();
        (planned(planner, placement, scheme, &mut planner.workspace())?, None)
    } else {
        let (solution, mut report) = refine(evaluator, placement, sense, scheme, monitor)?;
        state_residual(evaluator.planner(), &solution, scheme, &mut report, monitor);
        (solution, Some(report))
    };
    Some((Planned::new(evaluator.planner().problem(), solution, candidate.scheme.clone()), report))
}
