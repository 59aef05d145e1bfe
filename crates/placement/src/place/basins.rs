//! Refinement of the basins that a search found, and the choice among what comes out.

use super::long_path::LongPath;
use super::long_refinement;
use crate::candidate::Candidate;
use crate::evaluator::Evaluator;
use crate::outcome::Refinement;
use crate::redundancy::off_grid;
use crate::refine::{Solution, found_again, planned, refine};
use crate::search::SearchResult;
use crate::sense::Sense;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_model::robot::Posture;
use stead_numerics::monitor::{Monitor, Progress};

/// A refined solution with the scheme it was held to.
#[derive(Clone)]
pub(super) struct Refined {
    pub solution: Solution,
    pub scheme: Option<Vec<Posture>>,
}

/// Basins whose means differ by less than this (relative) are equal: the one that the search ranked higher is taken, so
/// that rounding does not choose between mirror images.
pub(super) const TIE: f64 = 1e-5;

/// A basin whose mean after the search is this much (relative) behind the best one refined is left alone, where both were
/// improved on a lookup table: refinement gains less from there.
pub(super) const MAX_DEFICIT: f64 = 0.03;

/// Refines the basins of both searches, and takes the best and the worst of what comes out; `None` when nothing feasible went
/// in.
pub(super) fn refine_basins(
    evaluator: &Evaluator<'_>,
    long: Option<&LongPath>,
    found: &[SearchResult; 2],
    monitor: &Monitor,
) -> Option<([Refined; 2], Vec<Refinement>)> {
    let (chosen, refinements) = refine_side(evaluator, long, found, monitor);
    match chosen {
        // Of two searches that were stopped early either may have met the better placement.
        [Some(best), Some(worst)] if best.solution.objective > worst.solution.objective => {
            Some(([worst, best], refinements))
        }
        [Some(best), Some(worst)] => Some(([best, worst], refinements)),
        // A search whose basins have no plan on the finer grid takes the other's.
        [Some(only), None] | [None, Some(only)] => Some(([only.clone(), only], refinements)),
        [None, None] => None,
    }
}

/// Refines the basins of both searches side by side. The first basin of each search goes ahead, to tell which of the others can
/// still win. Those of a long path are refined on its subset.
pub(super) fn refine_side(
    evaluator: &Evaluator<'_>,
    long: Option<&LongPath>,
    found: &[SearchResult; 2],
    monitor: &Monitor,
) -> ([Option<Refined>; 2], Vec<Refinement>) {
    if let Some(path) = long {
        return long_refinement::refine_side(path, evaluator.planner(), found, monitor);
    }
    let jobs: Vec<(Sense, usize, &Candidate)> = Sense::BOTH
        .into_iter()
        .zip(found)
        .flat_map(|(sense, f)| f.basins.iter().enumerate().map(move |(rank, candidate)| (sense, rank, candidate)))
        .collect();
    let done = AtomicUsize::new(0);
    let run = |jobs: &[(Sense, usize, &Candidate)],
               of: usize,
               known: &[Sense]|
     -> Vec<(Sense, Refined, Option<Refinement>)> {
        let refined = |(sense, rank, candidate): &(Sense, usize, &Candidate)| {
            if *rank > 0 && monitor.should_stop() && known.contains(sense) {
                return None;
            }
            let refined = refine_one(evaluator, *sense, candidate, monitor);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            monitor.report(Progress::Steps { stage: "refining", done, total: of });
            refined.map(|(refined, report)| (*sense, refined, report))
        };
        jobs.par_iter().filter_map(refined).collect()
    };
    let (ahead, others): (Vec<_>, Vec<_>) = jobs.iter().copied().partition(|(_, rank, _)| *rank == 0);
    let mut results = run(&ahead, jobs.len(), &[]);
    let known: Vec<Sense> = results.iter().map(|(sense, ..)| *sense).collect();
    let can_win = |(sense, _, candidate): &(Sense, usize, &Candidate)| {
        let first = results.iter().find(|(known, ..)| known == sense).map(|(_, refined, _)| refined.solution.objective);
        match (evaluator.table(), first, candidate.objective.mean()) {
            (Some(_), Some(first), Some(mean)) => match sense {
                Sense::Min => mean * (1.0 - MAX_DEFICIT) < first,
                Sense::Max => mean * (1.0 + MAX_DEFICIT) > first,
            },
            _ => true,
        }
    };
    // Once the caller asks to stop, other basins are only for a search whose first one has no plan.
    let is_wanted =
        |job: &(Sense, usize, &Candidate)| can_win(job) && !(monitor.should_stop() && known.contains(&job.0));
    let others: Vec<_> = others.into_iter().filter(is_wanted).collect();
    let of = ahead.len() + others.len();
    results.extend(run(&others, of, &known));
    // In the order of the searches: a stable sort.
    results.sort_by_key(|(sense, ..)| usize::from(*sense == Sense::Max));
    let mut refinements = Vec::new();
    let mut chosen: [Option<Refined>; 2] = [None, None];
    for (sense, refined, report) in results {
        refinements.extend(report);
        let slot = &mut chosen[usize::from(sense == Sense::Max)];
        let better = slot.as_ref().is_none_or(|known| match sense {
            Sense::Min => refined.solution.objective < known.solution.objective * (1.0 - TIE),
            Sense::Max => refined.solution.objective > known.solution.objective * (1.0 + TIE),
        });
        if better {
            *slot = Some(refined);
        }
    }
    (chosen, refinements)
}

/// Refines one basin, or only plans it where the job is to stop.
pub(super) fn refine_one(
    evaluator: &Evaluator<'_>,
    sense: Sense,
    candidate: &Candidate,
    monitor: &Monitor,
) -> Option<(Refined, Option<Refinement>)> {
    let (placement, scheme) = (&candidate.placement, candidate.scheme.as_deref());
    let (solution, report) = if monitor.should_stop() {
        let planner = evaluator.planner();
        let spacing = off_grid::Spacing::full(planner.grid());
        (planned(planner, placement, scheme, spacing, &mut planner.workspace())?, None)
    } else {
        let (solution, report) = refine(evaluator, placement, sense, scheme, monitor)?;
        (found_again(evaluator.planner(), solution, scheme, monitor), Some(report))
    };
    Some((Refined { solution, scheme: candidate.scheme.clone() }, report))
}
