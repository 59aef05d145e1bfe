//! The objective of a placement: by the lookup table where the task allows one, else by the planner.
//!
//! What a search returns is evaluated by the planner in any case.

use super::coordinate_search::{Directions, coordinate_search};
use super::lookup::{self, BetaGrid, CollisionEffort, LookupTable};
use super::outcome::Generation;
use rayon::prelude::*;
use stead_model::robot::Posture;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::{self, PlanNumber, Planner};
use stead_problem::candidate::{Candidate, Objective, rank};
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;
use stead_problem::symmetry::apart_about_axis_1;

/// A planner, and the table before it.
#[derive(Debug, Clone)]
pub struct Evaluator<'a> {
    planner: &'a Planner<'a>,
    table: Option<&'a LookupTable<'a>>,
    /// Tells neighbours of a refined placement apart before they are planned.
    coarser: Option<&'a Planner<'a>>,
    grid: BetaGrid,
}

/// Scratch space of one thread.
#[derive(Debug, Default)]
pub struct Workspace {
    exact: Option<redundancy::Workspace<f64>>,
    rough: Option<redundancy::Workspace<f32>>,
    coarser: Option<redundancy::Workspace<f32>>,
    table: Option<lookup::Workspace>,
}

/// What goes on from a search.
#[derive(Debug)]
pub struct SelectedBasins {
    /// The candidates, best first by the planner.
    pub basins: Vec<Candidate>,
    /// Placements evaluated to find them.
    pub evaluations: usize,
    /// Whether what the lookup table promised is not there, so that the search is better repeated without it.
    pub lookup_rejected: bool,
}

/// What the table promises of a placement is believed if the planner finds it within this share.
const LOOKUP_TOLERANCE: f64 = 1e-3;
/// Where the best the planner finds is farther than this share from the best that the table promised, or where there is
/// none, the table is rejected: it relaxes the steps and turns of the joints.
const REJECTION_TOLERANCE: f64 = 0.02;
/// Placements as near as this to each other in radius, height (m) and yaw against the azimuth (rad) are the same to an
/// upright tool.
const SAME_PLACE: [f64; 3] = [0.005, 0.005, 0.02];

/// Of improved candidates sorted from the best, those that are not the same as a better one: at most `max_count`.
fn distinct<'s>(
    table: &LookupTable<'_>,
    sorted: Vec<(&'s Candidate, Candidate)>,
    max_count: usize,
) -> Vec<(&'s Candidate, Candidate)> {
    let mut kept: Vec<(&Candidate, Candidate)> = Vec::new();
    for (start, end) in sorted {
        let is_same = |(_, known): &(&Candidate, Candidate)| {
            let apart = apart_about_axis_1(table.problem(), &known.placement, &end.placement);
            known.scheme == end.scheme && apart.iter().zip(SAME_PLACE).all(|(apart, same)| *apart < same)
        };
        if kept.len() < max_count && !kept.iter().any(is_same) {
            kept.push((start, end));
        }
    }
    kept
}

/// Candidates of a search that are improved on the table and planned for every basin requested.
const CANDIDATES: usize = 3;

impl<'a> Evaluator<'a> {
    /// Scores candidates by the table, if there is one; it must be for the planner's problem.
    pub fn new(planner: &'a Planner<'a>, table: Option<&'a LookupTable<'a>>) -> Self {
        Self { planner, table, coarser: None, grid: BetaGrid::of(planner) }
    }

    /// The same, reading the table on a grid of beta that many times finer than the planner's.
    pub fn with_finer_lookup(mut self, parts: usize) -> Self {
        self.grid = BetaGrid::new(self.planner.problem(), self.planner.grid().beta_count * parts);
        self
    }

    /// The same with a planner on a coarser grid, by which neighbours of a refined placement are distinguished before
    /// they are planned.
    pub fn with_coarser_planner(mut self, coarser: &'a Planner<'a>) -> Self {
        self.coarser = Some(coarser);
        self
    }

    /// An approximate mean, by which neighbours can be distinguished: by the table or on a coarser grid, where there is
    /// one; where it is not within two bounds without collisions, these may be left out. m
    pub fn approximate(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        within: [f64; 2],
        workspace: &mut Workspace,
    ) -> Option<f64> {
        match self.coarser {
            Some(coarser) => {
                let space = workspace.coarser.get_or_insert_with(|| coarser.workspace_of());
                coarser.objective(placement, Sense::Min, scheme, space).mean()
            }
            None => {
                let effort = CollisionEffort { within, ..CollisionEffort::ALL };
                self.table.and_then(|_| self.looked_objective(placement, scheme, effort, workspace).mean())
            }
        }
    }

    /// The planner.
    pub fn planner(&self) -> &'a Planner<'a> {
        self.planner
    }

    /// The table, if there is one.
    pub fn table(&self) -> Option<&'a LookupTable<'a>> {
        self.table
    }

    /// Space for one thread.
    pub fn workspace(&self) -> Workspace {
        Workspace { table: self.table.map(|table| table.workspace(&self.grid)), ..Workspace::default() }
    }

    /// The mean score of the workpiece at a placement under its best plan on the planner's grid, with the posture
    /// scheme found exactly or given (one posture per segment): by the table to its accuracy, where there is one, else
    /// in single precision.
    pub fn objective(&self, placement: &Placement, scheme: Option<&[Posture]>, workspace: &mut Workspace) -> Objective {
        self.looked_objective(placement, scheme, CollisionEffort::ALL, workspace)
    }

    /// The same to tell candidates of a search apart: by the table, of points close to each other only some are looked
    /// at for collisions, and none where the objective is not `within` two bounds (m) without them.
    pub fn rough_objective(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        within: [f64; 2],
        workspace: &mut Workspace,
    ) -> Objective {
        let stride = self.table.map_or(1, |table| table.stride);
        self.looked_objective(placement, scheme, CollisionEffort { stride, within }, workspace)
    }

    fn looked_objective(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        effort: CollisionEffort,
        workspace: &mut Workspace,
    ) -> Objective {
        match (self.table, &mut workspace.table) {
            (Some(table), Some(space)) => table.objective(placement, &self.grid, scheme, effort, space),
            _ => self.planned_with(placement, scheme, &mut workspace.rough),
        }
    }

    /// The same by the planner.
    pub fn planned_objective(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        workspace: &mut Workspace,
    ) -> Objective {
        self.planned_with(placement, scheme, &mut workspace.exact)
    }

    fn planned_with<E: PlanNumber>(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        space: &mut Option<redundancy::Workspace<E>>,
    ) -> Objective {
        let space = space.get_or_insert_with(|| self.planner.workspace_of());
        self.planner.objective(placement, Sense::Min, scheme, space)
    }

    /// Of candidates sorted from the best, at most `max_count` that go on, ranked by the planner. With a table, more of
    /// them are improved first, those that end at the same place are taken once, and where the planner does not find
    /// what the table promised, the start may go on instead. Once the caller asks to stop, candidates go on as they
    /// are.
    pub fn select_basins(
        &self,
        sorted: Vec<Candidate>,
        sense: Sense,
        max_count: usize,
        monitor: &Monitor,
    ) -> SelectedBasins {
        let Some(table) = self.table.filter(|_| !monitor.should_stop()) else {
            let mut basins = sorted;
            if basins.first().is_some_and(|best| best.objective.mean().is_some()) {
                basins.truncate(max_count);
            }
            if !monitor.should_stop() {
                self.state_exactly(&mut basins, sense);
            }
            return SelectedBasins { basins, evaluations: 0, lookup_rejected: false };
        };
        let improved: Vec<(Candidate, usize)> = sorted[..sorted.len().min(CANDIDATES * max_count)]
            .par_iter()
            .map_init(|| self.workspace(), |workspace, start| self.improved(start, sense, monitor, workspace))
            .collect();
        let mut evaluations: usize = improved.iter().map(|(_, evaluations)| evaluations).sum();
        let mut ends: Vec<(&Candidate, Candidate)> =
            sorted.iter().zip(improved).map(|(start, (end, _))| (start, end)).collect();
        ends.sort_by(|a, b| rank(sense, a.1.objective, b.1.objective));
        let ends = distinct(table, ends, max_count);
        let promised = ends.first().and_then(|(_, end)| end.objective.mean());
        let plan = |workspace: &mut Workspace, (start, end): &(&Candidate, Candidate)| match monitor.should_stop() {
            true => (end.clone(), 0),
            false => self.planned_candidate(start, end, sense, workspace),
        };
        let planned: Vec<(Candidate, usize)> = ends.par_iter().map_init(|| self.workspace(), plan).collect();
        evaluations += planned.iter().map(|(_, evaluations)| evaluations).sum::<usize>();
        let mut selected: Vec<Candidate> = planned.into_iter().map(|(candidate, _)| candidate).collect();
        selected.sort_by(|a, b| rank(sense, a.objective, b.objective));
        // What the planner refuses goes on only where there is nothing else.
        if let Some(first @ 1..) = selected.iter().position(|i| i.objective.mean().is_none()) {
            selected.truncate(first);
        }
        let found = selected.first().and_then(|candidate| candidate.objective.mean());
        let lookup_rejected = match (promised, found) {
            (Some(promised), Some(found)) => (found - promised).abs() > REJECTION_TOLERANCE * promised,
            _ => true,
        };
        SelectedBasins { basins: selected, evaluations, lookup_rejected }
    }

    /// Plans candidates in double precision that were compared in single precision, and sorts them anew.
    fn state_exactly(&self, candidates: &mut [Candidate], sense: Sense) {
        let feasible = candidates.par_iter_mut().filter(|candidate| candidate.objective.mean().is_some());
        feasible.for_each_init(
            || self.workspace(),
            |workspace, candidate| {
                let scheme = candidate.scheme.as_deref();
                candidate.objective = self.planned_objective(&candidate.placement, scheme, workspace);
            },
        );
        candidates.sort_by(|a, b| rank(sense, a.objective, b.objective));
    }

    /// An improved candidate as the planner finds it, or where that is not what the table promised, and it is better,
    /// the one it started from; and the number of placements evaluated.
    fn planned_candidate(
        &self,
        start: &Candidate,
        end: &Candidate,
        sense: Sense,
        workspace: &mut Workspace,
    ) -> (Candidate, usize) {
        let mut plan = |from: &Candidate| Candidate {
            objective: self.planned_objective(&from.placement, from.scheme.as_deref(), workspace),
            ..from.clone()
        };
        let planned = plan(end);
        let is_as_promised = match (planned.objective.mean(), end.objective.mean()) {
            (Some(found), Some(promised)) => (found - promised).abs() < LOOKUP_TOLERANCE * promised,
            _ => false,
        };
        if is_as_promised {
            return (planned, 1);
        }
        let start = plan(start);
        (if rank(sense, start.objective, planned.objective).is_lt() { start } else { planned }, 2)
    }

    /// A candidate improved by coordinate search, by the table where there is one, and the number of placements
    /// evaluated.
    pub fn improved(
        &self,
        start: &Candidate,
        sense: Sense,
        monitor: &Monitor,
        workspace: &mut Workspace,
    ) -> (Candidate, usize) {
        if monitor.should_stop() {
            return (start.clone(), 0);
        }
        let directions = if self.table.is_some() { Directions::WithoutAzimuth } else { Directions::All };
        let mut best = f64::INFINITY;
        let objective = |placement: &Placement| {
            let effort = CollisionEffort { within: [f64::NEG_INFINITY, best], ..CollisionEffort::ALL };
            let found = self.looked_objective(placement, start.scheme.as_deref(), effort, workspace);
            // Collisions only make a mean larger: where it is larger than that of the best already, they are not looked
            // for.
            if let (Sense::Min, Some(mean)) = (sense, found.mean()) {
                best = best.min(mean);
            }
            found
        };
        let problem = self.planner.problem();
        let (placement, objective, evaluations) =
            coordinate_search(problem, &start.placement, sense, directions, objective, monitor);
        (Candidate { placement, objective, ..start.clone() }, evaluations)
    }

    /// States what the planner says of the best of every generation in place of what the table, or the planner in
    /// single precision, said of it, unless the caller asks to stop before that.
    pub fn check(&self, history: &mut [Generation], best: &[Candidate], sense: Sense, monitor: &Monitor) {
        let is_new = |k: &usize| *k == 0 || best[*k].placement != best[*k - 1].placement;
        let new: Vec<usize> = (0..best.len()).filter(is_new).collect();
        let planned: Option<Vec<Objective>> = new
            .par_iter()
            .map_init(
                || self.workspace(),
                |workspace, k| {
                    let Candidate { placement, scheme, .. } = &best[*k];
                    let plan = || self.planned_objective(placement, scheme.as_deref(), workspace);
                    (!monitor.should_stop()).then(plan)
                },
            )
            .collect();
        let Some(planned) = planned else { return };
        let mut known: Option<Objective> = None;
        let mut checked = new.iter().zip(planned).peekable();
        for (k, figures) in history.iter_mut().enumerate() {
            if let Some((_, objective)) = checked.next_if(|(place, _)| **place == k)
                && known.is_none_or(|known| rank(sense, objective, known).is_lt())
            {
                known = Some(objective);
            }
            figures.best = known.and_then(Objective::mean);
        }
    }
}
