//! The points of a path on which leans and external axes are planned, and the way from these to all.

use super::axes::kept_points;
use crate::path_subset::PathSubset;
use stead_model::task::lean::Lean;
use stead_planning::redundancy::motion::{MotionGrid, MotionPlanner, PlannedMotion};
use stead_problem::lean::{LeanSpace, lean_between};
use stead_problem::problem::{Placement, Problem};

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
