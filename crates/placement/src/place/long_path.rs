//! Long paths: the search compares placements on a subset of the path, basins are refined on a larger one, and whatever
//! can win is planned on the whole path.
//!
//! A subset ([`PathSubset`]) leaves points out, and with them what they forbid: a placement that it allows may have no
//! plan. Such a placement names the points that decide; they join the subsets, and the search continues from what it
//! found, or the refinement is repeated. How far the means on a subset are off is measured ([`SubsetAccuracy`]).

use super::infeasible::{Infeasible, infeasible};
use super::searched::{Searched, search_cell};
use crate::evaluator::{self, Evaluator};
use crate::outcome::{PathLevels, SubsetAccuracy};
use crate::path_comparison::PathComparison;
use crate::path_subset::PathSubset;
use crate::search::{self, SearchResult};
use crate::whole_path::WholePath;
use rayon::prelude::*;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::candidate::{Candidate, Objective, rank};
use stead_problem::problem::Problem;
use stead_problem::sense::{BySense, Sense};
use stead_problem::settings::SearchSettings;

/// Points of the subset for the search, beside one for every segment.
const SEARCH_POINTS: usize = 60;
/// How many times more points the subset has on which basins are refined.
const REFINEMENT_FACTOR: usize = 3;
/// Paths with fewer than this many points for every one of the refinement's subset are searched and refined whole.
const SHORT: usize = 2;
/// Placements on which a subset is held against the whole path.
const PAIRS: usize = 39;
/// The relative errors that the subsets for search and refinement may have.
const TOLERANCES: [f64; 2] = [0.05, 0.015];
/// The share of the placements drawn at which they have to be kept.
const WITHIN: f64 = 0.8;
/// How often a search continues with more points at the most.
const REPEATS: usize = 4;
/// Of the generations of a search one in so many is repeated on the subset for the refinement,
const LAST_GENERATIONS: usize = 5;
/// with the population divided by this.
const SHARE: usize = 2;
/// Candidates of a search that are improved by coordinate search, for every basin requested;
const IMPROVED: usize = 6;
/// and those that are planned on the whole path.
const PROMOTED: usize = 3;
/// A candidate whose mean is larger by more than this share on a subset with more points is improved there.
const REPAIRED: f64 = 0.08;
/// How often candidates that the whole path finds worse are improved with the points in their way.
const REPAIRS: usize = 3;

/// How candidates are planned on the whole path.
struct Promotion<'a, 'p> {
    whole: WholePath<'a, 'p>,
    /// As many basins are refined.
    basins: usize,
    monitor: &'a Monitor,
}

/// The subsets of a long path.
#[derive(Debug, Clone)]
pub struct LongPath {
    /// For the search.
    pub search: PathSubset,
    /// For the refinement.
    pub refinement: PathSubset,
    /// How large these are, how far they are off, and how many placements were planned on the whole path.
    pub levels: PathLevels,
    /// What they are measured by.
    comparison: PathComparison,
}

impl LongPath {
    /// The subsets of the path of a planner's problem; none where it is short, or where the cell leaves one placement.
    pub fn new(full: &Planner<'_>, settings: &SearchSettings, monitor: &Monitor) -> Option<Self> {
        let problem = full.problem();
        let task = &problem.task;
        let all = task.points().len();
        let count = settings.path_points.unwrap_or(SEARCH_POINTS + task.segments().len());
        let is_short = match settings.path_points {
            Some(requested) => requested >= all,
            None => all < SHORT * REFINEMENT_FACTOR * count,
        };
        if is_short || problem.cell.pinned().is_some() {
            return None;
        }
        let search = PathSubset::new(task, count);
        let refinement = PathSubset::new(task, (REFINEMENT_FACTOR * count).min(all));
        let comparison = PathComparison::draw(full, &search, settings, PAIRS, monitor);
        // A subset that was requested stays as it is.
        let largest = if settings.path_points.is_some() { 0 } else { all / SHORT };
        let accurate = |subset, tolerance| accurate(problem, subset, &comparison, tolerance, largest);
        let (search, of_search) = accurate(search, TOLERANCES[0]);
        let (refinement, of_refinement) = accurate(refinement, TOLERANCES[1]);
        let deciding = comparison.deciding.len();
        let levels = PathLevels {
            points: all,
            whole: comparison.planned,
            search: of_search,
            refinement: of_refinement,
            deciding,
        };
        Some(Self { search, refinement, levels, comparison })
    }

    /// States how far the subsets are off as they stand, where points joined them.
    fn measure(&mut self, problem: &Problem) {
        let known = self.levels.deciding;
        self.levels.deciding = self.comparison.deciding.len();
        if self.levels.deciding > known {
            self.levels.search = self.comparison.accuracy(problem, &self.search);
            self.levels.refinement = self.comparison.accuracy(problem, &self.refinement);
        }
    }

    /// Searches the cell on the subset, and ranks what comes out on the whole path. Where a candidate that would win
    /// has no plan there, the points that decide join the subsets, and the search continues from what it found. Where
    /// none has one even then, those by which the subsets were measured take their place, and where there are none of
    /// these, the whole path is searched: a subset never refuses.
    ///
    /// # Errors
    /// [`Infeasible`] when nothing is met that has a plan on the whole path.
    pub(super) fn search<'a>(
        &mut self,
        full: &Planner<'a>,
        settings: &SearchSettings,
        monitor: &Monitor,
    ) -> Result<Searched<'a>, Infeasible> {
        let problem = full.problem();
        let thinned = self.search.of(problem);
        let Searched { mut found, table, lookup_summary, mut evaluations } =
            search_cell(&Planner::finer(&thinned), &widest(settings), monitor)
                .map_err(|none| infeasible(full, &none.placement, None, true, monitor))?;
        if table.is_none() {
            evaluations += improve(&thinned, &mut found, monitor);
        }
        let nearest = found.best.basins[0].clone();
        let promotion = Promotion { whole: WholePath::new(full), basins: settings.basins, monitor };
        let mut allowed = BySense::from_fn(|_| Vec::new());
        let mut senses: Vec<Sense> = Sense::BOTH.into_iter().filter(|sense| settings.seeks(*sense)).collect();
        for repeat in 0..=REPEATS {
            let mut next = Vec::new();
            let known = self.search.points().len();
            for sense in senses {
                evaluations += self.search_on(problem, settings, sense, &mut found[sense], monitor);
                let basins = found[sense].basins.clone();
                if self.promote(&promotion, sense, &mut found[sense], &mut allowed[sense]) {
                    found[sense].basins = basins;
                    next.push(sense);
                }
            }
            if self.search.points().len() == known || repeat == REPEATS || monitor.should_stop() {
                break;
            }
            let anew = SearchSettings { seed: settings.seed ^ (repeat as u64 + 1) << 32, ..widest(settings) };
            for sense in &next {
                evaluations += self.repeat(problem, &anew, *sense, &mut found[*sense], monitor);
            }
            senses = next;
        }
        for (sense, found) in found.iter_mut().filter(|(sense, _)| settings.seeks(*sense)) {
            if allowed[sense].is_empty() {
                allowed[sense] = self.comparison.ranked(sense);
            }
            found.basins = search::distinct(&self.search.of(problem), &allowed[sense], settings.basins);
        }
        if !SearchResult::share_basins(&mut found, settings) {
            return match monitor.should_stop() {
                false => search_cell(full, settings, monitor),
                true => Err(infeasible(full, &nearest.placement, nearest.scheme.as_deref(), true, monitor)),
            };
        }
        self.measure(problem);
        Ok(Searched { found, table: None, lookup_summary, evaluations })
    }

    /// Goes on searching from the basins that a search found, by last generations on the subset for the refinement;
    /// returns how many placements were evaluated.
    fn search_on(
        &self,
        problem: &Problem,
        settings: &SearchSettings,
        sense: Sense,
        found: &mut SearchResult,
        monitor: &Monitor,
    ) -> usize {
        if monitor.should_stop() {
            return 0;
        }
        let thinned = self.refinement.of(problem);
        let planner = comparing(&thinned);
        let evaluator = Evaluator::new(&planner, None);
        let basins = PROMOTED * settings.basins;
        let population = settings.population.div_ceil(SHARE).max(basins);
        let settings = SearchSettings { basins, population, ..*settings };
        let first = settings.generations - settings.generations / LAST_GENERATIONS;
        let start = repaired(&evaluator, sense, std::mem::take(&mut found.basins), monitor);
        let again = search::generations(&evaluator, &settings, sense, start, first..=settings.generations, monitor);
        found.basins = again.basins;
        found.interrupted |= again.interrupted;
        again.evaluations
    }

    /// Continues a search from the basins found and from placements drawn anew, by the second half of the generations
    /// on the subset for the search, which has got points since; returns how many placements were evaluated.
    fn repeat(
        &self,
        problem: &Problem,
        settings: &SearchSettings,
        sense: Sense,
        found: &mut SearchResult,
        monitor: &Monitor,
    ) -> usize {
        let thinned = self.search.of(problem);
        let planner = comparing(&thinned);
        let evaluator = Evaluator::new(&planner, None);
        let mut start = std::mem::take(&mut found.basins);
        start.extend(search::initial(problem, settings, sense));
        let half = settings.generations / 2;
        let again = search::generations(&evaluator, settings, sense, start, half..=settings.generations, monitor);
        found.interrupted |= again.interrupted;
        let (improved, evaluations) = improved(&evaluator, sense, &again.basins, monitor);
        found.basins = improved;
        again.evaluations + evaluations
    }

    /// Plans what a search found on the whole path, and adds those that have a plan there to what is `allowed`; the
    /// points that decide join the subsets. Returns whether the first has none though it would win. Candidates for the
    /// best placement that a subset judged better than the whole path does are improved on a subset that knows the
    /// points in their way, and planned again.
    fn promote(
        &mut self,
        promotion: &Promotion<'_, '_>,
        sense: Sense,
        found: &mut SearchResult,
        allowed: &mut Vec<Candidate>,
    ) -> bool {
        let Promotion { whole, basins, monitor } = promotion;
        found.basins.truncate(PROMOTED * basins);
        let mut candidates = std::mem::take(&mut found.basins);
        let mut refused = None;
        for round in 0..=REPAIRS {
            let checked: Vec<_> = candidates.par_iter().map(|candidate| whole.check(candidate)).collect();
            self.levels.whole += checked.len();
            if round == 0 && checked.first().is_some_and(|(mean, _)| mean.is_none()) {
                refused = candidates.first().cloned();
            }
            let mut misjudged = Vec::new();
            for (candidate, (mean, points)) in candidates.into_iter().zip(checked) {
                self.comparison.add_deciding(&points);
                self.search.add(&points);
                self.refinement.add(&points);
                if mean.is_some() && WholePath::is_misjudged(&candidate, mean) {
                    misjudged.push(candidate.clone());
                }
                allowed.extend(mean.map(|mean| Candidate { objective: Objective::Feasible(mean), ..candidate }));
            }
            allowed.sort_by(|a, b| rank(sense, a.objective, b.objective));
            // What would not win even if the subset were right is left as it is.
            misjudged.retain(|candidate| {
                allowed.get(*basins).is_none_or(|last| rank(sense, candidate.objective, last.objective).is_lt())
            });
            if sense == Sense::Max || misjudged.is_empty() || round == REPAIRS || monitor.should_stop() {
                break;
            }
            let obstacles: Vec<Vec<usize>> =
                misjudged.par_iter().map(|candidate| whole.obstacles(candidate, &self.refinement)).collect();
            if !self.refinement.add(&obstacles.concat()) {
                break;
            }
            candidates = self.repaired(whole.problem(), sense, misjudged, monitor);
            found.evaluations += candidates.len();
        }
        refused.is_some_and(|refused| {
            allowed.first().is_none_or(|best| rank(sense, refused.objective, best.objective).is_lt())
        })
    }

    /// Candidates as the subset for the refinement has them; those of which it differs are improved there.
    fn repaired(
        &self,
        problem: &Problem,
        sense: Sense,
        candidates: Vec<Candidate>,
        monitor: &Monitor,
    ) -> Vec<Candidate> {
        let thinned = self.refinement.of(problem);
        let planner = comparing(&thinned);
        let evaluator = Evaluator::new(&planner, None);
        repaired(&evaluator, sense, candidates, monitor)
    }
}

/// Candidates as an evaluator has them that knows more points of the path than what they were found by. For the best
/// placement those of which it thinks otherwise are improved by coordinate search, if what was promised of them would
/// win.
fn repaired(evaluator: &Evaluator<'_>, sense: Sense, candidates: Vec<Candidate>, monitor: &Monitor) -> Vec<Candidate> {
    let known = |workspace: &mut evaluator::Workspace, promised: Candidate| {
        let objective = evaluator.objective(&promised.placement, promised.scheme.as_deref(), workspace);
        (promised.objective, Candidate { objective, ..promised })
    };
    let known: Vec<(Objective, Candidate)> =
        candidates.into_par_iter().map_init(|| evaluator.workspace(), known).collect();
    let best = known.iter().filter_map(|(_, candidate)| candidate.objective.mean()).fold(f64::INFINITY, f64::min);
    let repair = |workspace: &mut evaluator::Workspace, (promised, candidate): (Objective, Candidate)| {
        let is_kept = promised.mean().is_none_or(|promised| {
            let is_off = candidate.objective.mean().is_none_or(|mean| mean > promised * (1.0 + REPAIRED));
            !is_off || promised > best
        });
        match is_kept || sense == Sense::Max {
            true => candidate,
            false => evaluator.improved(&candidate, sense, monitor, workspace).0,
        }
    };
    known.into_par_iter().map_init(|| evaluator.workspace(), repair).collect()
}

/// The planner by which placements are compared on a subset.
fn comparing(thinned: &Problem) -> Planner<'_> {
    Planner::new(thinned).with_finer(&Planner::finer(thinned))
}

/// As many basins of a search as are improved by coordinate search.
fn widest(settings: &SearchSettings) -> SearchSettings {
    SearchSettings { basins: IMPROVED * settings.basins, ..*settings }
}

/// Improves the basins of both searches by coordinate search; returns how many placements were evaluated.
fn improve(problem: &Problem, found: &mut BySense<SearchResult>, monitor: &Monitor) -> usize {
    let planner = comparing(problem);
    let evaluator = Evaluator::new(&planner, None);
    let mut evaluations = 0;
    for (sense, found) in found.iter_mut() {
        let (basins, number) = improved(&evaluator, sense, &found.basins, monitor);
        found.basins = basins;
        evaluations += number;
    }
    evaluations
}

/// Candidates improved by coordinate search, best first, and how many placements were evaluated.
fn improved(
    evaluator: &Evaluator<'_>,
    sense: Sense,
    basins: &[Candidate],
    monitor: &Monitor,
) -> (Vec<Candidate>, usize) {
    let improve = |workspace: &mut evaluator::Workspace, start| evaluator.improved(start, sense, monitor, workspace);
    let improved: Vec<(Candidate, usize)> = basins.par_iter().map_init(|| evaluator.workspace(), improve).collect();
    let (mut candidates, numbers): (Vec<Candidate>, Vec<usize>) = improved.into_iter().unzip();
    candidates.sort_by(|a, b| rank(sense, a.objective, b.objective));
    (candidates, numbers.into_iter().sum())
}

/// A subset with the points that decide, doubled until its error is small enough or it is too large a part of the path,
/// and how far it is off.
fn accurate(
    problem: &Problem,
    mut subset: PathSubset,
    comparison: &PathComparison,
    tolerance: f64,
    largest: usize,
) -> (PathSubset, SubsetAccuracy) {
    loop {
        subset.add(&comparison.deciding);
        let errors = comparison.errors(problem, &subset);
        let within = errors.iter().filter(|error| **error <= tolerance).count() as f64;
        let points = subset.points().len();
        if within >= WITHIN * errors.len() as f64 || 2 * points > largest {
            let accuracy = SubsetAccuracy::new(&subset, errors);
            return (subset, accuracy);
        }
        subset = PathSubset::new(&problem.task, 2 * points);
    }
}
