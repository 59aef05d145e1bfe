//! The points of a path on which leans and external axes are planned, and the way from these to all.

use crate::path_subset::PathSubset;
use stead_model::task::lean::Lean;
use stead_planning::redundancy::motion::{MotionGrid, MotionPlanner, PlannedMotion};
use stead_problem::lean::{LeanSpace, lean_between};
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::Setup;

/// Points that are left of a segment at least, where a motion is planned on some of the points of a dense path.
const KEPT: usize = 4;

/// An upright problem with the points on which lead and tilt are planned.
pub(super) struct Thinned<'a> {
    pub(super) upright: &'a Problem,
    pub(super) kept: Vec<usize>,
    /// On these points alone, where they are not all.
    few: Option<Problem>,
}

impl<'a> Thinned<'a> {
    pub(super) fn new(upright: &'a Problem, kept: Vec<usize>) -> Self {
        let is_few = kept.len() < upright.task.points().len();
        let few = is_few.then(|| PathSubset::of_points(kept.clone()).of(upright));
        Self { upright, kept, few }
    }

    /// With all points, or so many of a longer path.
    pub(super) fn to_at_most(upright: &'a Problem, points: usize) -> Self {
        Self::new(upright, kept_points(upright, points, |_| 0.0))
    }

    pub(super) fn problem(&self) -> &Problem {
        self.few.as_ref().unwrap_or(self.upright)
    }

    /// How the tool leans on these points in a setup.
    pub(super) fn leans_of(&self, setup: &Setup) -> Vec<Lean> {
        self.kept.iter().map(|point| setup.leans.get(*point).copied().unwrap_or(Lean::NONE)).collect()
    }
}

/// The cheapest way of the tool on a grid of leans.
pub(super) fn path_of(grid: &MotionGrid<'_>, placement: &Placement) -> Option<PlannedMotion> {
    let problems = grid.problems();
    MotionPlanner::new(grid, &problems).path(placement)
}

/// Leans at every point, from those at some of them, the axis turning evenly from one of these to the next; none
/// where one between these is not allowed, or a step.
pub(super) fn spread(space: &LeanSpace, on: &Thinned<'_>, leans: &[Lean]) -> Option<Vec<Lean>> {
    let path = on.upright.task.path();
    let mut all = vec![Lean::NONE; path.points().len()];
    for (point, lean) in on.kept.iter().zip(leans) {
        all[*point] = *lean;
    }
    for pair in on.kept.windows(2).filter(|pair| path.segment_of(pair[0]) == path.segment_of(pair[1])) {
        let ends = [pair[0], pair[1]].map(|point| (point, all[point]));
        let times: Vec<f64> = (pair[0] + 1..=pair[1]).map(|point| on.upright.step_time(point)).collect();
        let whole: f64 = times.iter().sum();
        let mut done = 0.0;
        for (point, time) in (pair[0] + 1..pair[1]).zip(&times) {
            done += time;
            all[point] = lean_between(path, ends, point, done / whole);
        }
    }
    let lean = |(point, lean): (usize, &Lean)| {
        let lean = space.ranges[point].nearest(lean);
        space.allows(path, point, &lean).then_some(lean)
    };
    let leans: Vec<Lean> = all.iter().enumerate().map(lean).collect::<Option<_>>()?;
    let mut steps = path.segments().iter().flat_map(|span| span.clone().skip(1));
    steps.all(|point| space.allows_step(path, point, [&leans[point - 1], &leans[point]])).then_some(leans)
}

/// On how many points as far apart as those of a path (s) the tool can lean by a step of its grid from one to the next.
pub(super) fn points_needed(space: &LeanSpace, upright: &Problem, time: f64) -> f64 {
    let step = space.steps[0].max(space.steps[1]);
    let by_joints = slowest(upright).map_or(0.0, |speed| step / (speed * time));
    by_joints.max(step / space.usual_turn(upright.task.path()))
}

/// The speed of the slowest joint, where one is known. rad/s
fn slowest(problem: &Problem) -> Option<f64> {
    problem.robot.joints().iter().filter_map(|joint| joint.max_speed).reduce(f64::min)
}

/// Of a path at most so many points, or on a dense path so few that beta and what else is planned can take a step of
/// their grids from one to the next; `steps` says how many points that takes, by the time from one to the next (s).
/// Every segment keeps its ends.
pub(super) fn kept_points(problem: &Problem, most: usize, steps_needed: impl Fn(f64) -> f64) -> Vec<usize> {
    let count = problem.task.points().len();
    let least = count.div_ceil(most.max(1)) as f64;
    let mut kept = Vec::new();
    for span in problem.task.segments() {
        let steps = span.len().saturating_sub(1).max(1) as f64;
        let time: f64 =
            span.clone().skip(1).map(|point| problem.step_time(point)).filter(|time| time.is_finite()).sum();
        let length: f64 = span.clone().skip(1).map(|point| problem.step_length(point)).sum();
        let by_axis = steps_needed(time / steps);
        let limits = &problem.redundancy;
        let by_length = [limits.max_beta_rate, limits.max_spindle_turn].into_iter().flatten().map(|rate| rate * length);
        let by_time = limits.max_spindle_speed.map(|speed| speed * time);
        let change = by_length.chain(by_time).fold(f64::INFINITY, f64::min) / steps;
        let by_beta = limits.beta_step() / change;
        let wanted = by_axis.max(by_beta).max(least).ceil();
        let most = (span.len() / KEPT).max(1);
        let stride = if wanted.is_finite() { (wanted.max(1.0) as usize).min(most) } else { most };
        kept.extend(span.clone().step_by(stride));
        if kept.last() != Some(&(span.end - 1)) {
            kept.push(span.end - 1);
        }
    }
    kept
}

/// The positions of all axes at every point, from those at the points kept, in proportion to the time between these
/// where it is known.
pub(super) fn between(problem: &Problem, kept: &[usize], found: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut rows = problem.setup.positions.spread(&problem.task);
    for (point, row) in kept.iter().zip(found) {
        rows[*point].clone_from(row);
    }
    for (pair, ends) in kept.windows(2).zip(found.windows(2)) {
        let (first, last) = (pair[0], pair[1]);
        if problem.task.path().segment_of(first) != problem.task.path().segment_of(last) {
            continue;
        }
        let times: Vec<f64> = (first + 1..=last).map(|point| problem.step_time(point)).collect();
        let whole: f64 = times.iter().sum();
        let mut done = 0.0;
        for (point, time) in (first + 1..last).zip(&times) {
            done += time;
            let at = |(number, own): (usize, &mut f64)| {
                let (from, to) = (ends[0][number], ends[1][number]);
                if from != to {
                    *own = from + (to - from) * done / whole;
                }
            };
            rows[point].iter_mut().enumerate().for_each(at);
        }
    }
    rows
}
