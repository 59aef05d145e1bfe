//! Refinement of basins of a long path: on a subset, then on the whole path.

use super::job::Planned;
use super::long_path::LongPath;
use crate::coordinate_search::neighbours;
use crate::evaluator::Evaluator;
use crate::outcome::Refinement;
use crate::path_subset::PathSubset;
use crate::refine::solver::{self, Ending};
use crate::refine::{LENGTH_UNIT, Solution, planned, refine, state_residual};
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
const CLOSE: f64 = 0.015;
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
/// It is planned where the coarse grid has it worse by no more than this part of what that grid is off here, and where
/// it differs at all (relative).
const DOUBT: f64 = 0.2;
/// See [`DOUBT`].
const DIFFERENT: f64 = 1e-6;
/// On paths longer than [`MAX_REFINED`].
const CLOSE_LONG: f64 = 0.01;
/// Longer paths than this are planned whole, but not refined whole: there the gain is far below what a minute is worth.
const MAX_REFINED: usize = 10_000;

/// A basin refined on a subset.
struct Estimated<'c> {
    candidate: &'c Candidate,
    placement: Placement,
    /// Its objective on the whole path: that on the subset, corrected by how far the subset is off on the coarse grid.
    /// m
    objective: f64,
    report: Refinement,
    /// The subset on which it ended, and how.
    subset: PathSubset,
    on_subset: Solution,
}

impl Estimated<'_> {
    /// States the residual of what the refinement came to on its subset.
    fn state_residual(&mut self, problem: &Problem, monitor: &Monitor) {
        let thinned = self.subset.of(problem);
        let planner = Planner::finer(&thinned);
        state_residual(&planner, &self.on_subset, self.candidate.scheme.as_deref(), &mut self.report, monitor);
    }
}

/// Refines the basins of both searches, on the problem of a planner, and returns those that can be the best of either
/// with their plans on the whole path.
pub(super) fn refine_basins(
    path: &LongPath,
    planner: &Planner<'_>,
    found: &BySense<SearchResult>,
    monitor: &Monitor,
) -> (BySense<Vec<Planned>>, Vec<Refinement>) {
    let jobs = SearchResult::jobs(found);
    let whole = WholePath::new(planner);
    let done = AtomicUsize::new(0);
    let estimate = |job: usize| {
        let (sense, rank, candidate) = jobs[job];
        // Once the caller asks to stop, the first basin of each search is enough.
        let is_wanted = rank == 0 || !monitor.should_stop();
        let estimated = is_wanted.then(|| estimated(path, &whole, sense, candidate, monitor)).flatten();
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        monitor.report(Progress::Steps { stage: "refining", done, total: jobs.len() });
        (sense, estimated)
    };
    let mut estimates: [Vec<Estimated<'_>>; 2] = [Vec::new(), Vec::new()];
    for (sense, estimated) in (0..jobs.len()).into_par_iter().map(estimate).collect::<Vec<_>>() {
        estimates[usize::from(sense == Sense::Max)].extend(estimated);
    }
    let choose = |sense: Sense, mut estimates: Vec<Estimated<'_>>| {
        // A stable sort: of equals the one that the search ranked higher.
        estimates.sort_by(|a, b| sense.compare(a.objective, b.objective));
        let chosen = compared(&whole, sense, &mut estimates, monitor);
        (chosen, estimates.into_iter().map(|estimate| estimate.report).collect::<Vec<_>>())
    };
    let [best, worst] = estimates;
    let ((best, mut refinements), (worst, others)) =
        rayon::join(|| choose(Sense::Min, best), || choose(Sense::Max, worst));
    refinements.extend(others);
    (BySense { best, worst }, refinements)
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
        let (solution, report) = refine(&evaluator, &candidate.placement, sense, scheme, monitor)?;
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
        return Some(Estimated { candidate, placement: end, objective, report, subset, on_subset: solution });
    }
}

/// Plans the best of refined basins on the whole path, and those near it; for the best placement the first of these by
/// their plans are refined on the whole path, and the best of all is taken. The residual is stated of that alone.
fn compared(
    whole: &WholePath<'_, '_>,
    sense: Sense,
    estimates: &mut [Estimated<'_>],
    monitor: &Monitor,
) -> Vec<Planned> {
    let Some(first) = estimates.first().map(|first| first.objective) else { return Vec::new() };
    let planner = whole.finer();
    let is_long = planner.problem().task.points().len() > MAX_REFINED;
    let close = if is_long { CLOSE_LONG } else { CLOSE };
    let is_close = |estimate: &Estimated<'_>| (estimate.objective - first).abs() <= close * first;
    let plan = |(rank, estimate): (usize, &mut Estimated<'_>)| {
        if rank > 0 && (!is_close(estimate) || (is_long && rank >= REFINED) || monitor.should_stop()) {
            return None;
        }
        let scheme = estimate.candidate.scheme.clone();
        let solution = planned_end(planner, sense, estimate)?;
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
            let report = refine_whole(whole, &mut basin, estimates[rank].report.clone(), monitor);
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
        estimates[*rank].state_residual(planner.problem(), monitor);
    }
    planned.into_iter().map(|(_, basin)| basin).collect()
}

/// The plan of a refined basin on the whole path, or where that is better of its start, since what a subset gains may
/// be lost there. A start whose mean the coarse grid has below that of the end is no worst placement: plans on the
/// finer grid are no worse.
fn planned_end(planner: &Planner<'_>, sense: Sense, estimate: &Estimated<'_>) -> Option<Solution> {
    let Estimated { candidate, placement, .. } = estimate;
    let plan = |at: &Placement| planned(planner, at, candidate.scheme.as_deref(), &mut planner.workspace());
    let is_below = |end: &Solution| candidate.objective.mean().is_some_and(|start| start < end.objective);
    let (end, start) = match sense {
        Sense::Min => rayon::join(|| plan(placement), || plan(&candidate.placement)),
        Sense::Max => match plan(placement) {
            Some(end) if is_below(&end) => (Some(end), None),
            end => (end, plan(&candidate.placement)),
        },
    };
    end.into_iter()
        .chain(start)
        .reduce(|end, start| if sense.compare(start.objective, end.objective).is_lt() { start } else { end })
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
fn refine_whole(
    whole: &WholePath<'_, '_>,
    best: &mut Planned,
    mut report: Refinement,
    monitor: &Monitor,
) -> Refinement {
    let (planner, scheme) = (whole.finer(), best.scheme.as_deref());
    let plan = |placement: &Placement| planned(planner, placement, scheme, &mut planner.workspace());
    let refined = |from: &Solution, report: &mut Refinement| {
        let run = solver::run(planner.problem(), from, Ending::LOOSE, monitor);
        report.rounds += 1;
        report.iterations += run.iterations;
        report.statuses.push(run.status);
        let is_moved = run.solution.placement != from.placement;
        is_moved.then(|| plan(&run.solution.placement)).flatten().filter(|anew| anew.objective < from.objective)
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
        let here = whole.rough(&solution.placement, scheme);
        let is_promising = |there: &&Placement| {
            let promised = here.zip(whole.rough(there, scheme));
            promised.is_none_or(|(here, there)| {
                let doubt = DOUBT * (solution.objective / here - 1.0).abs();
                let more = there / here - 1.0;
                more < doubt && more.abs() > DIFFERENT
            })
        };
        let around: Vec<Solution> = around.par_iter().filter(is_promising).filter_map(plan).collect();
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
