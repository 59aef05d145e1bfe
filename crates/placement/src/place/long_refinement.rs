//! Refinement of basins of a long path: on a subset, then on the whole path.

use super::job::Planned;
use super::long_path::LongPath;
use crate::coordinate_search::neighbours;
use crate::evaluator::Evaluator;
use crate::outcome::Refinement;
use crate::path_subset::PathSubset;
use crate::refine::solver::{self, Ending};
use crate::refine::{LENGTH_UNIT, Precision, Solution, kkt_residual, planned, refined};
use crate::search::SearchResult;
use crate::whole_path::WholePath;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::redundancy::Planner;
use stead_problem::candidate::Candidate;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::{BySense, Sense};
use stead_problem::symmetry::apart_about_axis_1;

/// How often a refinement is repeated with more points at the most.
const REPEATS: usize = 5;
/// Halvings of the way back to the start of a refinement that the whole path does not allow.
const HALVINGS: usize = 6;
/// Basins whose estimated objectives are this near (relative) to the best are compared on the whole path.
const CLOSE: f64 = 0.03;
/// Of these, so many at the most that are this near (relative) to the best are refined on the whole path.
const REFINED: usize = 2;
/// See [`REFINED`].
const TIED: f64 = 0.004;
/// Placements no farther apart than this, in the refinement's scaled variables, are one.
const SAME: f64 = 0.05;
/// How far around a refined placement its neighbours are planned, in the first steps of a coordinate search; the next
/// only after a gain.
const PROBES: [f64; 3] = [0.4, 0.4, 0.2];
/// A neighbour is gone on from where its plan is better by more than this (relative).
const WORTH: f64 = 1e-3;
/// On paths longer than [`MAX_REFINED`].
const CLOSE_LONG: f64 = 0.01;
/// Longer paths than this are planned whole, but not refined whole: there the gain is far below what a minute is worth.
const MAX_REFINED: usize = 10_000;

/// A basin that is so much (relative) behind the first on the whole path can still win, where refinement gains no more
/// than usual.
const BEHIND: BySense<f64> = BySense { best: 0.12, worst: 0.15 };
/// One that is behind by less than so many times what the refinement of the first gained can still win.
const GAINS: f64 = 2.0;

/// A basin refined on a subset.
struct Estimated<'c> {
    candidate: &'c Candidate,
    subset: PathSubset,
    /// On the subset.
    solution: Solution,
    placement: Placement,
    /// Its objective on the whole path: that on the subset, corrected by how far the subset is off on the coarse grid.
    /// m
    objective: f64,
    report: Refinement,
}

/// Refines the basins of both searches, on the problem of a planner, and returns those that can be the best of either
/// with their plans on the whole path. The first basin of each search goes ahead: what is so far behind it on the whole
/// path that refinement cannot make it the first is left as it is.
pub(super) fn refine_basins(
    path: &LongPath,
    planner: &Planner<'_>,
    found: &BySense<SearchResult>,
    monitor: &Monitor,
) -> (BySense<Vec<Planned>>, Vec<Refinement>) {
    let whole = WholePath::new(planner);
    let total: usize = found.values().map(|found| found.basins.len()).iter().sum();
    let done = AtomicUsize::new(0);
    let report_done = || {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        monitor.report(Progress::Steps { stage: "refining", done, total });
    };
    let refined_of = |sense: Sense| -> (Vec<Planned>, Vec<Refinement>) {
        let Some((first, others)) = found[sense].basins.split_first() else { return Default::default() };
        let estimate = |candidate| {
            let estimated = estimated(path, &whole, sense, candidate, monitor);
            report_done();
            estimated
        };
        let first = estimate(first);
        // Once the caller asks to stop, the first basin of each search is enough.
        let is_wanted = |candidate: &Candidate| {
            first.as_ref().is_none_or(|first| !monitor.should_stop() && can_win(sense, first, candidate))
        };
        let (wanted, left): (Vec<_>, Vec<_>) = others.iter().partition(|candidate| is_wanted(candidate));
        left.iter().for_each(|_| report_done());
        let others: Vec<_> = wanted.into_par_iter().filter_map(estimate).collect();
        let mut estimates: Vec<_> = first.into_iter().chain(others).collect();
        // A stable sort: of equals the one that the search ranked higher.
        estimates.sort_by(|a, b| sense.compare(a.objective, b.objective));
        let chosen = compared(planner, sense, &mut estimates, monitor);
        (chosen, estimates.into_iter().map(|estimate| estimate.report).collect())
    };
    let ((best, mut refinements), (worst, others)) = rayon::join(|| refined_of(Sense::Min), || refined_of(Sense::Max));
    refinements.extend(others);
    (BySense { best, worst }, refinements)
}

/// Whether a basin may win against the refined first one of its search, by what both come to on the whole path.
fn can_win(sense: Sense, first: &Estimated<'_>, candidate: &Candidate) -> bool {
    let (Some(start), Some(other)) = (first.candidate.objective.mean(), candidate.objective.mean()) else {
        return true;
    };
    let gained = (first.objective - start).abs();
    (other - start) * sense.sign() <= (GAINS * gained).max(BEHIND[sense] * start)
}

/// Refines a candidate on the subset; what the whole path does not allow adds the points that decide, and begins again.
fn estimated<'c>(
    path: &LongPath,
    whole: &WholePath<'_, '_>,
    sense: Sense,
    candidate: &'c Candidate,
    monitor: &Monitor,
) -> Option<Estimated<'c>> {
    let problem = whole.problem();
    let scheme = candidate.scheme.as_deref();
    let mut subset = path.refinement.clone();
    let mut repeats = 0;
    loop {
        let thinned = subset.of(problem);
        let planner = Planner::finer(&thinned);
        let coarse = Planner::new(&thinned);
        let evaluator = Evaluator::new(&planner, None).with_coarser_planner(&coarse);
        let precision = Precision::OF_SUBSET;
        let (solution, report) = refined(&evaluator, &candidate.placement, sense, scheme, precision, monitor)?;
        let placement = solution.placement;
        let on_subset =
            |placement: &Placement| coarse.objective(placement, Sense::Min, scheme, &mut coarse.workspace()).mean();
        let check = |placement: &Placement| whole.objective(placement, scheme, on_subset(placement));
        let mut checked = check(&placement);
        if let Err(points) = &checked
            && repeats < REPEATS
            && !monitor.should_stop()
            && subset.add(points)
        {
            repeats += 1;
            continue;
        }
        // The last resort: back towards the start, which the whole path allows.
        let mut end = placement;
        for halving in 1..=HALVINGS {
            if checked.is_ok() {
                break;
            }
            let share = if halving == HALVINGS { 1.0 } else { 1.0 - libm::pow(0.5, halving as f64) };
            end = problem.cell.between(&placement, &candidate.placement, share);
            checked = check(&end);
        }
        let on_whole = checked.ok()?;
        let on_subset = match on_whole.is_fine {
            true => planner.objective(&end, Sense::Min, scheme, &mut planner.workspace()).mean(),
            false => on_subset(&end),
        };
        let objective = match on_subset {
            Some(on_subset) if end == placement && on_subset > 0.0 => solution.objective * on_whole.mean / on_subset,
            _ => on_whole.mean,
        };
        let report = Refinement { end, end_mean: objective, ..report };
        return Some(Estimated { candidate, subset, solution, placement: end, objective, report });
    }
}

/// Plans the best of refined basins on the whole path, and those near it; for the best placement the first of these by
/// their plans are refined on the whole path, and the best of all is taken.
fn compared(planner: &Planner<'_>, sense: Sense, estimates: &mut [Estimated<'_>], monitor: &Monitor) -> Vec<Planned> {
    let Some(first) = estimates.first().map(|first| first.objective) else { return Vec::new() };
    let is_long = planner.problem().task.points().len() > MAX_REFINED;
    let close = if is_long { CLOSE_LONG } else { CLOSE };
    let is_close = |estimate: &Estimated<'_>| (estimate.objective - first).abs() <= close * first;
    let plan = |(rank, estimate): (usize, &mut Estimated<'_>)| {
        if rank > 0 && (!is_close(estimate) || (is_long && rank >= REFINED) || monitor.should_stop()) {
            return None;
        }
        let scheme = estimate.candidate.scheme.clone();
        // What a subset gains may be lost on the whole path: the start may be the better one.
        let ends = [estimate.placement, estimate.candidate.placement];
        let solutions = ends
            .par_iter()
            .filter_map(|placement| planned(planner, placement, scheme.as_deref(), &mut planner.workspace()));
        let solution = solutions
            .collect::<Vec<_>>()
            .into_iter()
            .reduce(|end, start| if sense.compare(start.objective, end.objective).is_lt() { start } else { end })?;
        (estimate.report.end, estimate.report.end_mean) = (solution.placement, solution.objective);
        Some((rank, Planned::new(planner.problem(), solution, scheme)))
    };
    let mut planned: Vec<(usize, Planned)> = estimates.par_iter_mut().enumerate().filter_map(plan).collect();
    planned.sort_by(|a, b| sense.compare(a.1.solution.objective, b.1.solution.objective));
    if sense == Sense::Min && !is_long {
        let limit = planned.first().map_or(0.0, |(_, best)| best.solution.objective * (1.0 + TIED));
        planned.retain(|(_, basin)| basin.solution.objective <= limit);
        planned.dedup_by(|later, earlier| is_same(planner.problem(), &later.1, &earlier.1));
        planned.truncate(REFINED);
        let refined = |(rank, mut basin): (usize, Planned)| {
            let report = refine_whole(planner, &mut basin, estimates[rank].report.clone(), monitor);
            (rank, basin, report)
        };
        let refined: Vec<_> = planned.into_par_iter().map(refined).collect();
        planned = refined
            .into_iter()
            .map(|(rank, basin, report)| {
                estimates[rank].report = report;
                (rank, basin)
            })
            .collect();
    }
    if let Some((rank, _)) = planned.first() {
        estimates[*rank].state_residual(planner.problem(), sense, monitor);
    }
    planned.into_iter().map(|(_, basin)| basin).collect()
}

impl Estimated<'_> {
    /// States the KKT residual of its end on the subset.
    fn state_residual(&mut self, problem: &Problem, sense: Sense, monitor: &Monitor) {
        let thinned = self.subset.of(problem);
        let (planner, scheme) = (Planner::finer(&thinned), self.candidate.scheme.as_deref());
        self.report.kkt_residual = kkt_residual(&planner, &self.solution, sense, scheme, monitor);
    }
}

/// Whether two basins have come to the same end: in the same postures to the same place, but for a turn about axis 1.
fn is_same(problem: &Problem, a: &Planned, b: &Planned) -> bool {
    let (a, b) = (&a.solution, &b.solution);
    let [distance, height, yaw] = apart_about_axis_1(problem, &a.placement, &b.placement);
    a.plans.iter().zip(&b.plans).all(|(a, b)| a.posture == b.posture)
        && distance.max(height) <= SAME * LENGTH_UNIT
        && yaw <= SAME
}

/// Refines a basin on the whole path, and once more from a neighbour with a better plan: the sequential programme stays
/// among the plans that its start has, and where plans of neighbours go another way through the angles it does not see
/// them. What comes out counts as the planner plans it, so that whoever asks for the placement alone gets the same.
/// Returns the report, continued.
fn refine_whole(planner: &Planner<'_>, best: &mut Planned, mut report: Refinement, monitor: &Monitor) -> Refinement {
    let plan = |placement: &Placement| planned(planner, placement, best.scheme.as_deref(), &mut planner.workspace());
    let refined = |from: &Solution, report: &mut Refinement| {
        let run = solver::run(planner.problem(), from, Ending::LOOSE, monitor);
        report.rounds += 1;
        report.iterations += run.iterations;
        report.statuses.push(run.status);
        plan(&run.solution.placement).filter(|anew| anew.objective < from.objective)
    };
    let mut solution = best.solution.clone();
    for share in PROBES {
        if monitor.should_stop() {
            break;
        }
        if let Some(anew) = refined(&solution, &mut report) {
            solution = anew;
        }
        let around = neighbours(planner.problem(), &solution.placement, share);
        let around: Vec<Solution> = around.par_iter().filter_map(plan).collect();
        let limit = solution.objective * (1.0 - WORTH);
        let better = around.into_iter().filter(|there| there.objective < limit);
        match better.min_by(|a, b| a.objective.total_cmp(&b.objective)) {
            Some(there) => solution = there,
            None => break,
        }
    }
    best.solution = solution;
    (report.end, report.end_mean) = (best.solution.placement, best.solution.objective);
    report
}
