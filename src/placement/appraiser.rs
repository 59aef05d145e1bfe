//! How the search looks at a placement: through a table where the task allows one, else by the planner.
//!
//! Whatever goes on from the search is looked at by the planner in any case.

use super::control::Control;
use super::genetic::{Individual, distinct, rank};
use super::outcome::{Generation, Goal};
use super::problem::Cell;
use super::redundancy::{self, Extremum, Planner, Worth};
use super::table::{self, Lane, Table};
use crate::robot::Posture;
use rayon::prelude::*;

/// A planner, and the table before it.
#[derive(Debug, Clone)]
pub struct Appraiser<'a> {
    planner: &'a Planner<'a>,
    table: Option<&'a Table<'a>>,
    lane: Lane,
}

/// Scratch space of one thread.
#[derive(Debug)]
pub struct Workspace {
    planner: Option<redundancy::Workspace>,
    table: Option<table::Workspace>,
}

/// Candidates of a search that are polished on the table and planned for every basin asked for.
const CANDIDATES: usize = 3;

impl<'a> Appraiser<'a> {
    /// Looks through the table, if there is one; it must be for the planner's problem.
    pub fn new(planner: &'a Planner<'a>, table: Option<&'a Table<'a>>) -> Self {
        Self { planner, table, lane: Lane::of(planner) }
    }

    /// The planner.
    pub fn planner(&self) -> &'a Planner<'a> {
        self.planner
    }

    /// The table, if there is one.
    pub fn table(&self) -> Option<&'a Table<'a>> {
        self.table
    }

    /// Space for one thread.
    pub fn workspace(&self) -> Workspace {
        match self.table {
            Some(table) => Workspace { planner: None, table: Some(table.workspace(&self.lane)) },
            None => Workspace { planner: Some(self.planner.workspace()), table: None },
        }
    }

    /// The mean score of the workpiece at `pose` (x, y, z in m, yaw in rad) under its best plan on the planner's grid, with
    /// the posture scheme found exactly or given (one posture per segment): by the table to its accuracy, where there is one.
    pub fn worth(&self, pose: &[f64; 4], scheme: Option<&[Posture]>, workspace: &mut Workspace) -> Worth {
        match (self.table, &mut workspace.table) {
            (Some(table), Some(space)) => table.worth(pose, &self.lane, scheme, space),
            _ => self.planned_worth(pose, scheme, workspace),
        }
    }

    /// The same by the planner.
    pub fn planned_worth(&self, pose: &[f64; 4], scheme: Option<&[Posture]>, workspace: &mut Workspace) -> Worth {
        let space = workspace.planner.get_or_insert_with(|| self.planner.workspace());
        self.planner.worth(pose, Extremum::Smallest, scheme, space)
    }

    /// Of candidates sorted from the best, at most `most` that go on, ranked by the planner; and how many placements were
    /// looked at for that. With a table, more of them are polished first, and whichever of start and end the planner finds
    /// better goes on.
    pub fn settle(
        &self,
        cell: &Cell,
        sorted: Vec<Individual>,
        goal: Goal,
        most: usize,
        control: &dyn Control,
    ) -> (Vec<Individual>, usize) {
        let Some(table) = self.table else {
            let mut sorted = sorted;
            sorted.truncate(most);
            return (sorted, 0);
        };
        let polished: Vec<(Individual, usize)> = sorted[..sorted.len().min(CANDIDATES * most)]
            .par_iter()
            .map_init(
                || self.workspace(),
                |workspace, individual| {
                    let scheme = individual.scheme.as_deref();
                    let start = self.planned_worth(&individual.pose, scheme, workspace);
                    let mut best = Individual { worth: start, ..individual.clone() };
                    let mut looks = 1;
                    if !control.should_stop()
                        && let Some(space) = &mut workspace.table
                    {
                        let (pose, _, tried) = table.polish(&individual.pose, goal, scheme, &self.lane, space);
                        let worth = self.planned_worth(&pose, scheme, workspace);
                        looks += tried + 1;
                        if rank(goal, worth, start).is_lt() {
                            best = Individual { pose, worth, ..best };
                        }
                    }
                    (best, looks)
                },
            )
            .collect();
        let looks = polished.iter().map(|(_, looks)| looks).sum();
        let mut settled: Vec<Individual> = polished.into_iter().map(|(individual, _)| individual).collect();
        settled.sort_by(|a, b| rank(goal, a.worth, b.worth));
        // What the planner refuses goes on only where there is nothing else.
        if let Some(first) = settled.iter().position(|i| i.worth.mean().is_none()) {
            settled.truncate(first.max(1));
        }
        (distinct(cell, &settled, most), looks)
    }

    /// States what the planner says of the best of every generation in place of what the table said of it.
    pub fn check(&self, history: &mut [Generation], best: &[Individual], goal: Goal) {
        if self.table.is_none() {
            return;
        }
        let is_new = |k: &usize| *k == 0 || best[*k].pose != best[*k - 1].pose;
        let new: Vec<usize> = (0..best.len()).filter(is_new).collect();
        let worths: Vec<Worth> = new
            .par_iter()
            .map_init(
                || self.workspace(),
                |workspace, k| self.planned_worth(&best[*k].pose, best[*k].scheme.as_deref(), workspace),
            )
            .collect();
        let mut known: Option<Worth> = None;
        let mut checked = new.iter().zip(worths).peekable();
        for (k, figures) in history.iter_mut().enumerate() {
            if let Some((_, worth)) = checked.next_if(|(place, _)| **place == k)
                && known.is_none_or(|known| rank(goal, worth, known).is_lt())
            {
                known = Some(worth);
            }
            figures.best = known.and_then(Worth::mean);
        }
    }
}
