//! Long paths: the search compares placements on a subset of the path, basins are refined on a larger one, and whatever can win is
//! planned on the whole path.
//!
//! A subset ([`PathSubset`]) leaves points out, and with them what they forbid: a placement that it allows may have no plan. Such a
//! placement names the points that decide; they join the subsets, and the search or the refinement is repeated. How far the
//! means on a subset are off is measured ([`SubsetAccuracy`]).

use super::infeasible::{Infeasible, infeasible};
use super::searched::{Searched, search_cell};
use crate::candidate::{Candidate, Objective, rank};
use crate::evaluator::Evaluator;
use crate::outcome::{PathLevels, SubsetAccuracy};
use crate::path_subset::PathSubset;
use crate::problem::{Placement, Problem};
use crate::redundancy::{NoFeasiblePlan, Planner};
use crate::search::{self, SearchResult};
use crate::sense::Sense;
use crate::settings::SearchSettings;
use rayon::prelude::*;
use stead_model::robot::Posture;
use stead_numerics::monitor::{Monitor, Progress};

/// Points of the subset for the search, beside one for every segment.
const SEARCH_POINTS: usize = 60;
/// How many times more points the subset has on which basins are refined.
const REFINEMENT_FACTOR: usize = 3;
/// Paths with fewer than this many points for every one of the refinement's subset are searched and refined whole.
const SHORT: usize = 2;
/// Placements on which a subset is held against the whole path.
const PAIRS: usize = 39;
/// Populations drawn for them at the most.
const DRAWS: u64 = 8;
/// The relative errors of their means that the subsets for search and refinement may have.
const TOLERANCES: [f64; 2] = [0.05, 0.015];
/// The share of the placements drawn at which they have to be kept.
const WITHIN: f64 = 0.8;
/// How often a search is repeated with more points at the most.
const REPEATS: usize = 4;
/// Of the generations of a search one in so many is repeated on the subset for the refinement,
const LAST_GENERATIONS: usize = 5;
/// with the population divided by this.
const SHARE: usize = 2;
/// Candidates of a search that are planned on the whole path, for every basin asked for.
const PROMOTED: usize = 3;
/// Of every stretch of points that decide, so many join a subset.
const STRETCH: usize = 3;
/// Of a placement, at most so many stretches.
const STRETCHES: usize = 12;

/// The subsets of a long path.
#[derive(Debug, Clone)]
pub(super) struct LongPath {
    /// For the search.
    search: PathSubset,
    /// For the refinement.
    pub refinement: PathSubset,
    pub levels: PathLevels,
}

/// A placement drawn from the cell, and its objective on the whole path. m
type Pair = (Placement, f64);

impl LongPath {
    /// The subsets of a path; none where it is short, or where the cell leaves one placement.
    pub fn new(full: &Planner<'_>, settings: &SearchSettings, monitor: &Monitor) -> Option<Self> {
        let problem = full.problem();
        let task = &problem.task;
        let all = task.points().len();
        let count = settings.path_points.unwrap_or(SEARCH_POINTS + task.segments().len());
        let is_short = match settings.path_points {
            Some(asked) => asked >= all,
            None => all < SHORT * REFINEMENT_FACTOR * count,
        };
        if is_short || problem.cell.pinned().is_some() {
            return None;
        }
        let mut path = Self {
            search: PathSubset::new(task, count),
            refinement: PathSubset::new(task, (REFINEMENT_FACTOR * count).min(all)),
            levels: PathLevels { points: all, ..PathLevels::default() },
        };
        let (pairs, deciding) = path.pairs(full, settings, monitor);
        // A subset that was asked for stays as it is.
        let largest = if settings.path_points.is_some() { 0 } else { all / SHORT };
        let [search, refinement] = &mut path.levels.subsets;
        (path.search, *search) = accurate(problem, path.search, &pairs, &deciding, (TOLERANCES[0], largest));
        (path.refinement, *refinement) =
            accurate(problem, path.refinement, &pairs, &deciding, (TOLERANCES[1], largest));
        Some(path)
    }

    /// Draws placements that the search's subset allows, and plans them on the whole path: those that have a plan there, and the
    /// points that decide against the others.
    fn pairs(&mut self, full: &Planner<'_>, settings: &SearchSettings, monitor: &Monitor) -> (Vec<Pair>, Vec<usize>) {
        let (mut pairs, mut deciding) = (Vec::new(), Vec::new());
        let check = WholePath::new(full);
        let thinned = self.search.of(full.problem());
        let planner = Planner::new(&thinned);
        for draw in 0..DRAWS {
            if pairs.len() >= PAIRS || monitor.should_stop() {
                break;
            }
            let drawn = search::drawn(full.problem(), settings, draw);
            let allowed = objectives(&planner, &drawn);
            let likely = drawn.into_iter().zip(allowed).filter(|(_, objective)| objective.mean().is_some());
            let likely: Vec<Placement> = likely.map(|(placement, _)| placement).take(PAIRS - pairs.len()).collect();
            let checked: Vec<_> = likely.par_iter().map(|placement| check.objective(placement, None)).collect();
            self.levels.whole += checked.len();
            for (placement, checked) in likely.into_iter().zip(checked) {
                match checked {
                    Ok(mean) => pairs.push((placement, mean)),
                    Err(points) => deciding.extend(points),
                }
            }
            monitor.report(Progress::Steps { stage: "long path", done: pairs.len(), total: PAIRS });
        }
        (pairs, deciding)
    }

    /// Searches the cell on the subset, and ranks what comes out on the whole path. Where a candidate that would win has no plan
    /// there, the points that decide join the subsets, and the search is repeated.
    ///
    /// # Errors
    /// [`Infeasible`] when nothing is met that has a plan on the whole path.
    pub fn search<'a>(
        &mut self,
        full: &Planner<'a>,
        settings: &SearchSettings,
        monitor: &Monitor,
    ) -> Result<Searched<'a>, Infeasible> {
        let problem = full.problem();
        let wider = SearchSettings { basins: PROMOTED * settings.basins, ..*settings };
        let mut repeats = 0;
        let mut evaluations = 0;
        loop {
            let thinned = self.search.of(problem);
            let nowhere = |none: Infeasible| infeasible(full, &none.placement, None, true, monitor);
            let searched = search_cell(&Planner::finer(&thinned), &wider, monitor).map_err(nowhere)?;
            evaluations += searched.evaluations;
            let (mut found, lookup_summary) = (searched.found, searched.lookup_summary);
            evaluations += self.search_on(problem, &wider, &mut found, monitor);
            let nearest = found[0].basins[0].clone();
            let mut deciding = Vec::new();
            let promoted = Sense::BOTH
                .into_iter()
                .zip(&mut found)
                .map(|(sense, found)| self.promote(full, sense, found, settings.basins, &mut deciding));
            let is_refused = promoted.fold(false, |any, refused| any | refused);
            self.levels.deciding += deciding.len();
            let is_larger = self.search.add(&deciding);
            self.refinement.add(&deciding);
            if is_refused && is_larger && repeats < REPEATS && !monitor.should_stop() {
                repeats += 1;
                continue;
            }
            match found.each_ref().map(|found| !found.basins.is_empty()) {
                [true, true] => {}
                [true, false] => found[1].basins = found[0].basins.clone(),
                [false, true] => found[0].basins = found[1].basins.clone(),
                [false, false] => {
                    return Err(infeasible(full, &nearest.placement, nearest.scheme.as_deref(), true, monitor));
                }
            }
            self.levels.subsets[0].points = self.search.points().len();
            return Ok(Searched { found, table: None, lookup_summary, evaluations });
        }
    }

    /// Goes on searching from the basins that a search found, by last generations on the subset for the refinement; returns how
    /// many placements were evaluated.
    fn search_on(
        &self,
        problem: &Problem,
        settings: &SearchSettings,
        found: &mut [SearchResult; 2],
        monitor: &Monitor,
    ) -> usize {
        let thinned = self.refinement.of(problem);
        let (planner, finer) = (Planner::new(&thinned), Planner::finer(&thinned));
        let evaluator = Evaluator::new(&planner, None).with_finer_planner(&finer);
        let settings =
            SearchSettings { population: settings.population.div_ceil(SHARE).max(settings.basins), ..*settings };
        let first = settings.generations - settings.generations / LAST_GENERATIONS;
        let mut evaluations = 0;
        for (sense, found) in Sense::BOTH.into_iter().zip(found) {
            if monitor.should_stop() {
                break;
            }
            let start = std::mem::take(&mut found.basins);
            let (again, _) =
                search::generations(&evaluator, &settings, sense, start, first..=settings.generations, monitor);
            evaluations += again.evaluations;
            found.basins = again.basins;
            found.interrupted |= again.interrupted;
        }
        evaluations
    }

    /// Plans what a search found on the whole path, and keeps of those that have a plan there the best of distinct basins, at most
    /// `basins`; returns whether the first has none.
    fn promote(
        &mut self,
        full: &Planner<'_>,
        sense: Sense,
        found: &mut SearchResult,
        basins: usize,
        deciding: &mut Vec<usize>,
    ) -> bool {
        found.basins.truncate(PROMOTED * basins);
        let whole = WholePath::new(full);
        let check = |candidate: &Candidate| whole.objective(&candidate.placement, candidate.scheme.as_deref());
        let checked: Vec<Result<f64, Vec<usize>>> = found.basins.par_iter().map(check).collect();
        self.levels.whole += checked.len();
        let is_refused = checked.first().is_some_and(Result::is_err);
        let mut allowed = Vec::new();
        for (candidate, checked) in found.basins.drain(..).zip(checked) {
            match checked {
                Ok(mean) => allowed.push(Candidate { objective: Objective::Feasible(mean), ..candidate }),
                Err(points) => deciding.extend(points),
            }
        }
        allowed.sort_by(|a, b| rank(sense, a.objective, b.objective));
        found.basins = search::distinct(&full.problem().cell, &allowed, basins);
        is_refused
    }
}

/// The whole path on the coarse grid of beta, and on the finer one where that is too coarse.
pub(super) struct WholePath<'a, 'p> {
    coarse: Planner<'p>,
    full: &'a Planner<'p>,
}

impl<'a, 'p> WholePath<'a, 'p> {
    pub fn new(full: &'a Planner<'p>) -> Self {
        Self { coarse: Planner::new(full.problem()), full }
    }

    /// The problem on the whole path.
    pub fn problem(&self) -> &'p Problem {
        self.full.problem()
    }

    /// The objective of a placement (m), or points that decide against it.
    pub fn objective(&self, placement: &Placement, scheme: Option<&[Posture]>) -> Result<f64, Vec<usize>> {
        let evaluator = Evaluator::new(&self.coarse, None).with_finer_planner(self.full);
        match evaluator.planned_objective(placement, scheme, &mut evaluator.workspace()) {
            Objective::Feasible(mean) => Ok(mean),
            Objective::Infeasible { .. } => {
                let plan = self.full.plan(placement, Sense::Min, scheme, &mut self.full.workspace());
                Err(plan.err().map(|none| deciding(self.full.problem(), &none)).unwrap_or_default())
            }
        }
    }
}

/// Of the points that leave a placement without a plan, some of every stretch.
fn deciding(problem: &Problem, none: &NoFeasiblePlan) -> Vec<usize> {
    let mut points = Vec::new();
    for stretch in none.blocked_points.chunk_by(|a, b| a + 1 == *b).take(STRETCHES) {
        points.extend((0..STRETCH).map(|k| stretch[k * (stretch.len() - 1) / (STRETCH - 1)]));
    }
    for (segment, stuck) in none.broken_segments.iter().take(STRETCHES) {
        // A segment breaks between the points before and the first that cannot be reached.
        let span = &problem.task.segments()[*segment];
        points.extend((stuck.saturating_sub(2)..=stuck + 2).filter(|point| span.contains(point)));
    }
    points
}

/// The objectives of placements on a planner's grid.
fn objectives(planner: &Planner<'_>, placements: &[Placement]) -> Vec<Objective> {
    let of = |workspace: &mut _, placement: &Placement| planner.objective(placement, Sense::Min, None, workspace);
    placements.par_iter().map_init(|| planner.workspace(), of).collect()
}

/// A subset with the points that decide, doubled until its error is small enough or it is too large a part of the path.
fn accurate(
    problem: &Problem,
    mut subset: PathSubset,
    pairs: &[Pair],
    deciding: &[usize],
    (tolerance, largest): (f64, usize),
) -> (PathSubset, SubsetAccuracy) {
    let placements: Vec<Placement> = pairs.iter().map(|(placement, _)| *placement).collect();
    loop {
        subset.add(deciding);
        let thinned = subset.of(problem);
        let estimates = objectives(&Planner::new(&thinned), &placements);
        let error = |((_, whole), estimate): (&Pair, Objective)| Some((estimate.mean()? - whole).abs() / whole);
        let errors: Vec<f64> = pairs.iter().zip(estimates).filter_map(error).collect();
        let points = subset.points().len();
        let within = errors.iter().filter(|error| **error <= tolerance).count() as f64;
        let is_accurate = within >= WITHIN * errors.len() as f64;
        let accuracy = SubsetAccuracy { points, pairs: errors.len(), error: errors.into_iter().reduce(f64::max) };
        if is_accurate || 2 * points > largest {
            return (subset, accuracy);
        }
        subset = PathSubset::new(&problem.task, 2 * points);
    }
}
