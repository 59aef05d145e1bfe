//! How the tool leans along the path, at placements that are promising.
//!
//! The search knows the axis of the path alone. From the best placements that it finds, and from those of placements
//! drawn over the cell that are best on a coarse grid of leans, lead and tilt are planned together with beta
//! ([`MotionGrid`]), first over their whole ranges, then off that grid; placement, betas and leans are refined by
//! the gradient in all of them, and lead and tilt are planned anew, by turns. The best of these are refined further
//! ([`Leaning::together`]), with their external axes. A step is only taken to a plan that is better, so that where the
//! axis of the path is allowed the result is never worse than with it.

mod drawn;
mod together;

use super::axes::{kept_points, refined};
use super::found::Found;
use super::infeasible::Infeasible;
use super::job::{Job, Planned};
use super::motion::with_better_axes;
use super::plan::stated_objective;
use super::thinned::{Thinned, path_of, points_needed, spread};
use stead_model::robot::angles::wrap;
use stead_model::task::lean::Lean;
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::redundancy::motion::MotionGrid;
use stead_problem::cell::Cell;
use stead_problem::lean::{LeanSpace, MOST_PLANNED_POINTS};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::setup::Setup;

/// Two starts are no nearer than this in one coordinate (m, rad).
const APART: [f64; 2] = [0.05, 0.2];
/// Rounds of leans and placement.
const ROUNDS: usize = 4;
/// A round that gains less (relative) is the last.
const GAIN: f64 = 1e-4;
/// How often the steps of lead and tilt are halved.
const HALVINGS: usize = 6;
/// Steps to either side in a halving.
const NEAR: i32 = 1;
/// So many of the improved placements are refined in all at once at the most, those that are worse than the best by no
/// more than this factor.
const FINALISTS: (usize, f64) = (3, 1.02);
/// A drawn placement that is worse by this factor on the coarse grid than the best that is known is not a start.
const HOPELESS: f64 = 1.25;

/// What is leaned.
struct Leaning<'a> {
    problem: &'a Problem,
    space: &'a LeanSpace,
    monitor: &'a Monitor,
}

/// How the tool leans best at a placement, with the plan; none where no lean that was tried has one.
pub(super) fn leaned_at(problem: &Problem, placement: &Placement, monitor: &Monitor) -> Option<Planned> {
    let space = problem.lean.as_deref()?;
    let pinned = problem.in_cell(Cell::at(placement));
    let job = Leaning { problem: &pinned, space, monitor };
    let best = job.at(&problem.setup, placement, None)?;
    let best = job.with_axes(job.by_gradient(&best).unwrap_or(best));
    Some(job.by_gradient(&best).unwrap_or(best))
}

impl Leaning<'_> {
    /// The plan with the tool leaning so.
    fn planned(&self, setup: &Setup, placement: &Placement, leans: Vec<Lean>) -> Option<Planned> {
        Planned::at(self.problem, Setup { leans: leans.into(), ..setup.clone() }, placement)
    }

    /// The upright plan, where the axis of the path is allowed everywhere.
    fn upright(&self, setup: &Setup, placement: &Placement) -> Option<Planned> {
        let is_allowed = self.space.holds_path(self.problem.task.upright().path());
        is_allowed.then(|| self.planned(setup, placement, Vec::new()))?
    }

    /// The best lean at a placement, in the setup given but for its leans, no worse than what is known there.
    ///
    /// Where the contact or the joints do not allow a step of the grid from one point to the next, lead and tilt are
    /// planned on fewer points, and once more on all of them.
    fn at(&self, setup: &Setup, placement: &Placement, known: Option<Planned>) -> Option<Planned> {
        let mut best = known.or_else(|| self.upright(setup, placement));
        let upright = self.problem.in_setup(&Setup { leans: [].into(), ..setup.clone() });
        let sparse = kept_points(&upright, MOST_PLANNED_POINTS, |time| points_needed(self.space, &upright, time));
        let sparse = Thinned::new(&upright, sparse);
        let dense = Thinned::to_at_most(&upright, MOST_PLANNED_POINTS);
        let is_one = sparse.kept == dense.kept;
        best = self.on_points(setup, placement, &sparse, best);
        if !is_one && (best.is_none() || !self.monitor.should_stop()) {
            best = self.on_points(setup, placement, &dense, best);
        }
        best
    }

    /// The best lean at a placement with lead and tilt planned on some points.
    fn on_points(
        &self,
        setup: &Setup,
        placement: &Placement,
        on: &Thinned<'_>,
        best: Option<Planned>,
    ) -> Option<Planned> {
        let way =
            MotionGrid::new(on.problem()).and_then(|grid| path_of(&grid, placement)).map(|path| path.motion.leans);
        self.halved(setup, placement, on, way, self.space.steps, best)
    }

    /// The best of leans at some points and of those near them, in ever smaller steps of lead and tilt.
    fn halved(
        &self,
        setup: &Setup,
        placement: &Placement,
        on: &Thinned<'_>,
        mut way: Option<Vec<Lean>>,
        mut steps: [f64; 2],
        mut best: Option<Planned>,
    ) -> Option<Planned> {
        for _ in 0..=HALVINGS {
            let Some(leans) = way.take().filter(|_| best.is_none() || !self.monitor.should_stop()) else { break };
            let candidate = spread(self.space, on, &leans).and_then(|leans| self.planned(setup, placement, leans));
            if let Some(candidate) = candidate
                && best.as_ref().is_none_or(|best| candidate.solution.objective < best.solution.objective)
            {
                best = Some(candidate);
            }
            steps = steps.map(|step| step / 2.0);
            let near = MotionGrid::near_leans(on.problem(), &leans, steps, NEAR);
            way = path_of(&near, placement).map(|path| path.motion.leans);
        }
        best
    }

    /// Leans and placement by turns, from a placement.
    fn improved(&self, setup: &Setup, placement: &Placement) -> Option<Planned> {
        let mut best = self.at(setup, placement, None)?;
        for _ in 0..ROUNDS {
            let before = best.solution.objective;
            if self.monitor.should_stop() {
                break;
            }
            let by_gradient = self.by_gradient(&best);
            let from = by_gradient.as_ref().unwrap_or(&best);
            let Some(moved) = refined(self.problem, from, self.monitor).or(by_gradient) else { break };
            let placement = moved.solution.placement;
            best = self.at(&moved.setup.clone(), &placement, Some(moved)).unwrap_or(best);
            if before - best.solution.objective < GAIN * before {
                break;
            }
        }
        Some(best)
    }

    /// The best of improved placements, of which the best few are refined in all at once.
    fn best_finished(&self, mut all: Vec<Planned>) -> Option<Planned> {
        all.sort_by(|a, b| a.solution.objective.total_cmp(&b.solution.objective));
        let limit = FINALISTS.1 * all.first()?.solution.objective;
        let mut finalists: Vec<Planned> = Vec::new();
        for found in all {
            let is_new = finalists.iter().all(|known| is_apart(&known.solution.placement, &found.solution.placement));
            if finalists.len() < FINALISTS.0 && found.solution.objective <= limit && is_new {
                finalists.push(found);
            }
        }
        let finished = finalists.into_iter().map(|found| self.finished(found));
        finished.min_by(|a, b| a.solution.objective.total_cmp(&b.solution.objective))
    }

    /// Placement and leans refined together, and once more wherever leans over their whole ranges are better there.
    fn finished(&self, known: Planned) -> Planned {
        let mut best = known;
        for _ in 0..ROUNDS {
            best = self.with_axes(self.together(best));
            let before = best.solution.objective;
            if self.monitor.should_stop() {
                break;
            }
            let (setup, placement) = (best.setup.clone(), best.solution.placement);
            best = self.at(&setup, &placement, Some(best.clone())).unwrap_or(best);
            if best.solution.objective >= before {
                break;
            }
        }
        best
    }

    /// With the external axes improved for the tool that leans, and planned with lead and tilt where they move along
    /// the path.
    fn with_axes(&self, known: Planned) -> Planned {
        if self.problem.external_axes.is_empty() {
            return known;
        }
        with_better_axes(self.problem, &known, Some(self.space), self.monitor).unwrap_or(known)
    }

    /// The best placements with the axis of the path, each with its setup.
    fn basins(&self, found: &Found, most: usize) -> Vec<Start> {
        let start = |placement: Placement| Start { setup: found.best.setup.clone(), placement, coarse: None };
        let mut starts = vec![start(found.best.placement())];
        let mut others: Vec<_> = found.record.refinements.iter().filter(|one| one.sense == Sense::Min).collect();
        others.sort_by(|a, b| a.end_mean.total_cmp(&b.end_mean));
        for other in others {
            if starts.len() < most && starts.iter().all(|start| is_apart(&start.placement, &other.end)) {
                starts.push(start(other.end));
            }
        }
        starts
    }

    /// The best placement from these starts, leaning.
    fn best_from(&self, starts: &[Start]) -> Option<Planned> {
        let mut all: Vec<Planned> = Vec::new();
        for (number, start) in starts.iter().enumerate() {
            let known = all.iter().map(|found| found.solution.objective).fold(f64::INFINITY, f64::min);
            if !all.is_empty() && self.monitor.should_stop() {
                break;
            }
            if start.coarse.is_some_and(|coarse| coarse > HOPELESS * known) {
                continue;
            }
            self.monitor.report(Progress::Steps { stage: "lead and tilt", done: number, total: starts.len() });
            all.extend(self.improved(&start.setup, &start.placement));
        }
        self.best_finished(all)
    }
}

/// Where the tool is led along the path.
struct Start {
    setup: Setup,
    placement: Placement,
    /// What a coarse grid of leans gives there, where it was drawn. m
    coarse: Option<f64>,
}

/// Whether two placements are apart in some coordinate.
fn is_apart(a: &Placement, b: &Placement) -> bool {
    let shift = [a.x - b.x, a.y - b.y, a.z - b.z];
    shift.iter().any(|by| by.abs() > APART[0]) || wrap(a.yaw - b.yaw).abs() > APART[1]
}

/// The best and the worst placement in their order, with the tool leaning at both; where they are one, with the better
/// plan.
fn in_order(best: Planned, worst: Option<Planned>) -> (Planned, Option<Planned>) {
    let Some(worst) = worst else { return (best, None) };
    let is_one = best.solution.placement == worst.solution.placement;
    let is_in_order = best.solution.objective <= worst.solution.objective;
    match (is_in_order, is_one) {
        (true, true) => (best.clone(), Some(best)),
        (true, false) => (best, Some(worst)),
        (false, true) => (worst.clone(), Some(worst)),
        (false, false) => (worst, Some(best)),
    }
}

/// The best and the worst placement where the tool may lean, from what was found with the axis of the path.
///
/// # Errors
/// [`Infeasible`] where no placement that was tried has a plan.
pub(super) fn leaned(job: &Job<'_>, closed: Result<Found, Infeasible>) -> Result<Found, Infeasible> {
    let Some(space) = job.problem.lean.as_deref() else { return closed };
    let (problem, settings, monitor) = (job.without_tie_rule, job.settings, job.monitor);
    let leaning = Leaning { problem, space, monitor };
    let basins = closed.as_ref().map_or_else(|_| Vec::new(), |found| leaning.basins(found, settings.basins));
    let mut drawn = leaning.drawn(basins.first().map_or(&problem.setup, |start| &start.setup), settings);
    // The worst placement is the one with the axis of the path, or else of those drawn, with the tool leaning as well
    // as it can there.
    let at_worst = match &closed {
        Ok(found) => found.worst.as_ref().map(|at| (at.setup.clone(), at.placement())),
        Err(_) => drawn.last().filter(|_| settings.worst).map(|at| (at.setup.clone(), at.placement)),
    };
    let mut apart: Vec<Placement> = basins.iter().map(|start| start.placement).collect();
    drawn.retain(|start| {
        let is_new = apart.len() < 2 * settings.basins && apart.iter().all(|known| is_apart(known, &start.placement));
        apart.extend(is_new.then_some(start.placement));
        is_new
    });
    let starts: Vec<Start> = basins.into_iter().chain(drawn).collect();
    let Some(best) = leaning.best_from(&starts) else {
        let at = starts.first().map_or(Placement::from([0.0; 4]), |start| start.placement);
        return Err(closed.err().unwrap_or_else(|| Infeasible::unexplained(at, monitor)));
    };
    let at_worst = at_worst.filter(|_| closed.is_err() || !monitor.should_stop());
    let worst = at_worst.and_then(|(setup, placement)| leaned_at(&problem.in_setup(&setup), &placement, monitor));
    let (best, worst) = in_order(best, worst);
    let upright = closed.as_ref().ok().map(|found| stated_objective(job, &found.best));
    let (record, of_path) = closed.map_or_else(|_| Default::default(), |found| (found.record, found.worst));
    Ok(Found { best, worst: worst.or(of_path), record, upright, is_improved: true })
}
