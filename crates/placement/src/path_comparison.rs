//! How far the objectives on a subset of a long path are off, measured at placements drawn from the cell.

use super::outcome::SubsetAccuracy;
use super::path_subset::PathSubset;
use super::search;
use super::whole_path::WholePath;
use rayon::prelude::*;
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::redundancy::Planner;
use stead_problem::candidate::{Candidate, Objective, rank};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::settings::SearchSettings;

/// Placements with their objectives on the whole path, by which subsets are measured.
///
/// The largest of N errors covers that of one more placement drawn in the same way with a probability of N / (N + 1).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathComparison {
    /// Placements that have a plan on the whole path, with the objective of that. m
    pub pairs: Vec<(Placement, f64)>,
    /// Points of the path that leave others without one, or that alone make up the objective.
    pub deciding: Vec<usize>,
    /// Placements planned on the whole path.
    pub planned: usize,
}

/// Populations drawn at the most.
const DRAWS: u64 = 8;

impl PathComparison {
    /// Draws placements that a subset allows, and plans them on the whole path, the problem of a planner, until so many
    /// have a plan there. There are fewer where little of the cell is feasible, and where the caller asks to stop.
    pub fn draw(
        full: &Planner<'_>,
        subset: &PathSubset,
        settings: &SearchSettings,
        wanted: usize,
        monitor: &Monitor,
    ) -> Self {
        let mut comparison = Self::default();
        let whole = WholePath::new(full);
        let thinned = subset.of(full.problem());
        let planner = Planner::new(&thinned);
        for draw in 0..DRAWS {
            let missing = wanted - comparison.pairs.len();
            if missing == 0 || monitor.should_stop() {
                break;
            }
            let drawn = search::drawn(full.problem(), settings, draw);
            let allowed = objectives(&planner, &drawn);
            let of = |(placement, objective)| Candidate { placement, scheme: None, objective };
            let likely =
                drawn.into_iter().zip(allowed).map(of).filter(|candidate| candidate.objective.mean().is_some());
            let likely: Vec<Candidate> = likely.take(missing).collect();
            let checked: Vec<_> = likely.par_iter().map(|candidate| whole.check_coarsely(candidate)).collect();
            comparison.planned += checked.len();
            for (candidate, (mean, deciding)) in likely.into_iter().zip(checked) {
                comparison.add_deciding(&deciding);
                comparison.pairs.extend(mean.map(|mean| (candidate.placement, mean)));
            }
            monitor.report(Progress::Steps { stage: "long path", done: comparison.pairs.len(), total: wanted });
        }
        comparison
    }

    /// By how much the objectives on a subset differ from those on the whole path, relative to these, one for each
    /// placement that the subset allows.
    pub fn errors(&self, problem: &Problem, subset: &PathSubset) -> Vec<f64> {
        let thinned = subset.of(problem);
        let placements: Vec<Placement> = self.pairs.iter().map(|(placement, _)| *placement).collect();
        let estimates = objectives(&Planner::new(&thinned), &placements);
        let error = |((_, whole), estimate): (&(Placement, f64), Objective)| {
            Some((estimate.mean()? - whole).abs() / whole.max(f64::MIN_POSITIVE))
        };
        self.pairs.iter().zip(estimates).filter_map(error).collect()
    }

    /// The placements as candidates, best first.
    pub fn ranked(&self, sense: Sense) -> Vec<Candidate> {
        let candidate = |(placement, mean): &(Placement, f64)| Candidate {
            placement: *placement,
            scheme: None,
            objective: Objective::Feasible(*mean),
        };
        let mut candidates: Vec<Candidate> = self.pairs.iter().map(candidate).collect();
        candidates.sort_by(|a, b| rank(sense, a.objective, b.objective));
        candidates
    }

    /// The subset, with the largest of its errors.
    pub fn accuracy(&self, problem: &Problem, subset: &PathSubset) -> SubsetAccuracy {
        SubsetAccuracy::new(subset, self.errors(problem, subset))
    }

    /// Remembers points that decide: ascending, each once.
    pub fn add_deciding(&mut self, points: &[usize]) {
        self.deciding.extend(points);
        self.deciding.sort_unstable();
        self.deciding.dedup();
    }
}

impl SubsetAccuracy {
    /// The largest of a subset's errors.
    pub(crate) fn new(subset: &PathSubset, errors: Vec<f64>) -> Self {
        Self { points: subset.points().len(), pairs: errors.len(), error: errors.into_iter().reduce(f64::max) }
    }
}

/// The objectives of placements on a planner's grid, in single precision.
fn objectives(planner: &Planner<'_>, placements: &[Placement]) -> Vec<Objective> {
    let of = |workspace: &mut _, placement: &Placement| planner.objective(placement, Sense::Min, None, workspace);
    placements.par_iter().map_init(|| planner.workspace_of::<f32>(), of).collect()
}
