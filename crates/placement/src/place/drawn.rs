//! Placements drawn over the cell from which the tool is led along the path.

use super::improver::Improver;
use super::lean::{Start, is_apart};
use crate::coordinate_search::{Directions, coordinate_search};
use crate::path_subset::PathSubset;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;
use stead_numerics::monitor::Progress;
use stead_planning::redundancy::motion::{MotionGrid, MotionPlanner};
use stead_problem::candidate::{Objective, rank};
use stead_problem::lean::LeanSpace;
use stead_problem::problem::{Interval, Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::settings::SearchSettings;
use stead_problem::setup::Setup;

/// Placements drawn for each individual of the search, and so many at a time.
const DRAWN: (usize, usize) = (2, 16);
/// What they are compared on: points of the path, steps to either side in lead and in tilt, and the smallest step of
/// beta (rad).
const ON: (usize, usize, f64) = (40, 2, PI / 12.0);
/// Of the best so many are led to the bottom of their basins for each start.
const LED: usize = 3;

impl Improver<'_> {
    /// The problem on few points and a coarse grid of leans and beta.
    fn coarse(upright: &Problem, space: &LeanSpace) -> Problem {
        let (points, half, step) = ON;
        let few = PathSubset::new(&upright.task, points).of(upright);
        let [lead, tilt] = space.half_counts().map(|all| all.max(half) as f64 / half as f64);
        let coarse = few.changed(|parts| {
            parts.redundancy.beta_count = parts.redundancy.beta_count.min((2.0 * PI / step) as usize);
            if let Some(space) = &mut parts.lean {
                let wide = Arc::make_mut(space);
                wide.steps = [wide.steps[0] * lead, wide.steps[1] * tilt];
            }
        });
        coarse.unwrap_or(few)
    }

    /// Placements drawn over the cell that have a plan on a coarse grid of leans, the best first, of which the best of
    /// all, also those without a plan, are led to the bottom of their basins on it; in any case the one of a cell that
    /// holds no other.
    pub(super) fn drawn(&self, setup: &Setup, settings: &SearchSettings) -> Vec<Start> {
        let setup = Setup { leans: [].into(), ..setup.clone() };
        if let Some(placement) = self.problem.cell.pinned() {
            return vec![Start { setup, placement, coarse: None }];
        }
        let Some(space) = self.space else { return Vec::new() };
        let coarse = Self::coarse(&self.problem.in_setup(&setup), space);
        let Some(grid) = MotionGrid::new(&coarse) else { return Vec::new() };
        let problems = grid.problems();
        let planner = MotionPlanner::new(&grid, &problems);
        let objective = |placement: &Placement| match planner.path_or_unreached(placement) {
            Ok(path) => Objective::Feasible(path.objective),
            Err(missed) => Objective::Infeasible { points: missed.points, segments: missed.segments },
        };
        let mut random = ChaCha8Rng::seed_from_u64(settings.seed);
        let mut placement = || {
            let mut within = |ends: &Interval| ends.min + (ends.max - ends.min) * random.random_range(0.0..1.0);
            let [x, y, z] = [0, 1, 2].map(|k| within(&self.problem.cell.position[k]));
            Placement { x, y, z, yaw: within(&self.problem.cell.yaw) }
        };
        let placements: Vec<Placement> = (0..DRAWN.0 * settings.population).map(|_| placement()).collect();
        let mut found: Vec<(Objective, Placement)> = Vec::new();
        let led = LED * settings.basins;
        let total = placements.len() + led;
        let report = |done: usize| {
            self.monitor.report(Progress::Steps { stage: "placements for a leaning tool", done, total });
        };
        for some in placements.chunks(DRAWN.1) {
            if self.monitor.should_stop() {
                break;
            }
            report(found.len());
            found.par_extend(some.par_iter().map(|at| (objective(at), *at)));
        }
        found.sort_by(|a, b| rank(Sense::Min, a.0, b.0));
        let mut best: Vec<Placement> = Vec::new();
        for (_, placement) in &found {
            if best.len() < led && best.iter().all(|known| is_apart(known, placement)) {
                best.push(*placement);
            }
        }
        report(found.len());
        let to_bottom = |start: &Placement| {
            let (sense, directions) = (Sense::Min, Directions::All);
            let (end, reached, _) = coordinate_search(self.problem, start, sense, directions, objective, self.monitor);
            (reached, end)
        };
        found.par_extend(best.par_iter().map(to_bottom));
        found.sort_by(|a, b| rank(Sense::Min, a.0, b.0));
        let start = |(objective, placement): (Objective, Placement)| {
            Some(Start { setup: setup.clone(), placement, coarse: Some(objective.mean()?) })
        };
        found.into_iter().map_while(start).collect()
    }
}
