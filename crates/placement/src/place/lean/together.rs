//! Placement, leans and betas refined together.
//!
//! With the tool leaning as planned, placement, betas, leads and tilts are refined by the gradient; then lead, tilt and
//! beta are planned anew about the leans that are known, and what both changed is followed further.
//! When that gains nothing, the placements before and behind along x, y, z and yaw are tried, each with leans planned
//! anew for it: the end is a placement of which no such neighbour is better with the best leans near the ones known.

use super::{Leaning, NEAR};
use crate::place::axes::{MOST_REFINED, refined};
use crate::place::job::Planned;
use crate::place::thinned::{Thinned, path_of, spread};
use crate::refine::{neighbours, solver};
use rayon::prelude::*;
use stead_model::task::lean::Lean;
use stead_numerics::monitor::Progress;
use stead_planning::redundancy::motion::{MotionGrid, MotionPlanner};
use stead_planning::transfer_path::whole_lines;
use stead_problem::lean::MOST_PLANNED_POINTS;
use stead_problem::problem::Placement;
use stead_problem::setup::Setup;

/// Rounds of placement and leans at the most.
const ROUNDS: usize = 24;
/// A round that gains less (relative) is followed by a look at the neighbours.
const GAIN: f64 = 1e-5;
/// Distances of the neighbours (in scaled variables), and by how much the first steps of lead and tilt are divided for
/// them.
const POLLS: [(f64, f64); 3] = [(0.15, 1.0), (0.03, 2.0), (0.006, 8.0)];
/// How often a change that gains is doubled.
const DOUBLINGS: usize = 8;

impl Leaning<'_> {
    /// The best placement near one that is known, with the best leans and betas there.
    pub(super) fn together(&self, known: Planned) -> Planned {
        let is_long = self.problem.task.points().len() > MOST_REFINED;
        if self.problem.cell.pinned().is_some() || is_long {
            return known;
        }
        let mut best = known;
        for round in 0..ROUNDS {
            if self.monitor.should_stop() {
                break;
            }
            let stage = "placement, lead and tilt together";
            self.monitor.report(Progress::Steps { stage, done: round, total: ROUNDS });
            let from = best.clone();
            best = self.by_gradient(&best).unwrap_or(best);
            best = refined(self.problem, &best, self.monitor).unwrap_or(best);
            best = self.near(&best).unwrap_or(best);
            best = self.ahead(&from, best);
            if from.solution.objective - best.solution.objective < GAIN * from.solution.objective {
                match self.polled(&best) {
                    Some(better) => best = self.ahead(&best, better),
                    None => break,
                }
            }
        }
        best
    }

    /// Placement, betas, leads and tilts by the gradient in all of them; nothing where that gains nothing.
    pub(super) fn by_gradient(&self, known: &Planned) -> Option<Planned> {
        let set_up = self.problem.in_setup(&known.setup);
        let is_long = self.problem.task.points().len() > MOST_REFINED;
        if set_up.setup.leans.is_empty() || is_long || self.monitor.should_stop() {
            return None;
        }
        let (run, leans) = solver::run_leaning(&set_up, &known.solution, solver::Ending::TIGHT, self.monitor);
        // In a narrow space what the gradient reaches may be no plan of the grid, from which it would be found again.
        let again = Planned::at(self.problem, Setup { leans, ..known.setup.clone() }, &run.solution.placement)?;
        if again.solution.objective >= known.solution.objective {
            return None;
        }
        let is_better = again.solution.objective < run.solution.objective;
        // The gradient knows nothing of the lines into the cut and out of it.
        let loses_lines = || {
            let leaning = self.problem.in_setup(&again.setup);
            again.solution.plans.iter().zip(&run.solution.plans).any(|(planned, reached)| {
                let planned = whole_lines(&leaning, &again.solution.placement, planned);
                let reached = whole_lines(&leaning, &run.solution.placement, reached);
                (planned[0] && !reached[0]) || (planned[1] && !reached[1])
            })
        };
        let is_planned = is_better || loses_lines();
        Some(if is_planned { again } else { Planned { solution: run.solution, ..again } })
    }

    /// The leans planned anew about those that are known, at the placement that is known.
    fn near(&self, known: &Planned) -> Option<Planned> {
        let upright = self.problem.in_setup(&upright(&known.setup));
        let on = Thinned::to_at_most(&upright, MOST_PLANNED_POINTS);
        let leans = self.leans_on(known, &on.kept);
        let near = MotionGrid::near_leans(on.problem(), &leans, self.space.steps.map(|step| step / 2.0), NEAR);
        let way = path_of(&near, &known.solution.placement)?.motion.leans;
        self.halved(
            &known.setup,
            &known.solution.placement,
            &on,
            Some(way),
            self.space.steps.map(|step| step / 2.0),
            Some(known.clone()),
        )
    }

    /// The best neighbour, if it is better, with leans planned anew there; of those planned before a stop.
    fn polled(&self, known: &Planned) -> Option<Planned> {
        let upright = self.problem.in_setup(&upright(&known.setup));
        let on = Thinned::to_at_most(&upright, MOST_PLANNED_POINTS);
        let leans = self.leans_on(known, &on.kept);
        let limit = known.solution.objective * (1.0 - GAIN);
        POLLS.into_iter().find_map(|(distance, part)| {
            let grid = MotionGrid::near_leans(on.problem(), &leans, self.space.steps.map(|step| step / part), NEAR);
            let problems = grid.problems();
            let planner = MotionPlanner::new(&grid, &problems);
            let at = |placement: &Placement| {
                let path = (!self.monitor.should_stop()).then(|| planner.path(placement))??;
                self.planned(&known.setup, placement, spread(self.space, &on, &path.motion.leans)?)
            };
            let around = neighbours(self.problem, &known.solution.placement, distance);
            let tried: Vec<Option<Planned>> = around.par_iter().map(at).collect();
            let better = tried.into_iter().flatten().filter(|near| near.solution.objective < limit);
            better.reduce(|a, b| if b.solution.objective < a.solution.objective { b } else { a })
        })
    }

    /// What changed from one placement with its leans to a better one, followed further as long as that gains.
    fn ahead(&self, from: &Planned, to: Planned) -> Planned {
        let upright = self.problem.in_setup(&upright(&from.setup));
        let all: Vec<usize> = (0..upright.task.points().len()).collect();
        let [old, new] = [from, &to].map(|known| self.leans_on(known, &all));
        let (start, end) = (from.solution.placement, to.solution.placement);
        let on = Thinned::new(&upright, all);
        let mut best = to;
        let mut share = 1.0;
        for _ in 0..DOUBLINGS {
            if self.monitor.should_stop() || (0..4).all(|k| start[k] == end[k]) {
                break;
            }
            let further = |from: f64, to: f64| to + share * (to - from);
            let placement = Placement::from(std::array::from_fn(|k| further(start[k], end[k])));
            let lean = |(old, new): (&Lean, &Lean)| Lean {
                lead: further(old.lead, new.lead),
                tilt: further(old.tilt, new.tilt),
            };
            let leans: Vec<Lean> = old.iter().zip(&new).map(lean).collect();
            let placement = self.problem.cell.clamp(&placement);
            let next = spread(self.space, &on, &leans).and_then(|leans| self.planned(&best.setup, &placement, leans));
            match next.filter(|next| next.solution.objective < best.solution.objective) {
                Some(next) => best = next,
                None => break,
            }
            share = 2.0 * share + 1.0;
        }
        best
    }

    /// How the tool leans at some points.
    fn leans_on(&self, known: &Planned, points: &[usize]) -> Vec<Lean> {
        points.iter().map(|point| known.setup.leans.get(*point).copied().unwrap_or(Lean::NONE)).collect()
    }
}

/// The setup with the axis of the path.
fn upright(setup: &Setup) -> Setup {
    Setup { leans: [].into(), ..setup.clone() }
}
