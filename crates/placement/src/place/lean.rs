//! How the tool leans along the path, at placements that are promising.
//!
//! The search knows the axis of the path alone. From the best placements that it finds, and from those of placements
//! [drawn](super::drawn) over the cell that are best on a coarse grid of leans, lead and tilt are planned together with
//! beta, and placement and leans are improved by turns; the best of these are improved further, with their external
//! axes ([`Descent`]).

use super::descent::Descent;
use super::found::Found;
use super::improver::Improver;
use super::infeasible::Infeasible;
use super::job::{Job, Planned};
use super::plan::stated_objective;
use stead_model::robot::angles::wrap;
use stead_numerics::monitor::{Monitor, Progress};
use stead_problem::cell::Cell;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::setup::Setup;

/// Two starts are no nearer than this in one coordinate (m, rad).
const APART: [f64; 2] = [0.05, 0.2];
/// So many of the improved placements are refined in all at once at the most, those that are worse than the best by no
/// more than this factor.
const FINALISTS: (usize, f64) = (3, 1.02);
/// A drawn placement that is worse by this factor on the coarse grid than the best that is known is not a start.
const HOPELESS: f64 = 1.25;

/// How the tool leans best at a placement, with the plan; none where no lean that was tried has one.
pub(super) fn leaned_at(problem: &Problem, placement: &Placement, monitor: &Monitor) -> Option<Planned> {
    let space = Some(problem.lean.as_deref()?);
    let pinned = problem.in_cell(Cell::at(placement));
    let job = Improver { problem: &pinned, space, monitor };
    Some(Descent::of_all(&pinned).run(&job, job.start(&problem.setup, placement)?))
}

impl Improver<'_> {
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
        let descent = Descent::of_all(self.problem);
        let finished = finalists.into_iter().map(|found| descent.run(self, found));
        finished.min_by(|a, b| a.solution.objective.total_cmp(&b.solution.objective))
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
            let planned = self.start(&start.setup, &start.placement);
            all.extend(planned.map(|planned| Descent::of_leans().run(self, planned)));
        }
        self.best_finished(all)
    }
}

/// The best placements with the axis of the path, each with its setup.
fn basins(found: &Found, most: usize) -> Vec<Start> {
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

/// Where the tool is led along the path.
pub(super) struct Start {
    pub setup: Setup,
    pub placement: Placement,
    /// What a coarse grid of leans gives there, where it was drawn. m
    pub coarse: Option<f64>,
}

/// Whether two placements are apart in some coordinate.
pub(super) fn is_apart(a: &Placement, b: &Placement) -> bool {
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
    let leaning = Improver { problem, space: Some(space), monitor };
    let basins = closed.as_ref().map_or_else(|_| Vec::new(), |found| basins(found, settings.basins));
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
