//! External axes and leans planned together along the path, at a placement.
//!
//! What is planned axis by axis and then in lead and tilt is where one alone gains nothing; both may gain together. So
//! all of them are planned at once ([`MotionGrid`]): on a coarse grid over their whole ranges, and about what is known,
//! in ever smaller steps; beside it one axis alone, on a finer grid.
//!
//! Where the contact, the joints or the axes do not allow a step of the grid from one point to the next, the motion is
//! planned on fewer points, leans then on all of them too.

use crate::place::improver::{GAIN, Improver};
use crate::place::job::Planned;
use crate::place::thinned::{Thinned, between, kept_points, path_of, points_needed, spread};
use stead_model::external_axis::ExternalAxis;
use stead_planning::redundancy::motion::{Motion, MotionGrid, SettingSteps};
use stead_problem::lean::{LeanSpace, MOST_PLANNED_POINTS};
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::{AxisPositions, Setup};

/// Positions of an axis on the coarse grid at the most.
const POSITIONS: usize = 13;
/// Settings of a point on the coarse grid of axes at the most.
const MOST_SETTINGS: usize = 200;
/// Steps of lead and of tilt to either side on the coarse grid of axes.
const COARSE_LEANS: usize = 1;

/// What moves along the path.
#[derive(Debug, Clone)]
pub(in crate::place) struct Moving {
    /// External axes, by number.
    pub axes: Vec<usize>,
    /// Whether the leans are planned, where the tool may lean; else they stay.
    pub leans: bool,
    /// Whether whole ranges are planned: of leans in place of what is near to those that are known, of axes beside it.
    pub is_whole: bool,
}

/// How what is near to a motion is planned.
struct Narrowing {
    /// Steps to either side.
    half: i32,
    /// By how much the steps shrink, and how often they are planned with.
    shrink: f64,
    levels: usize,
    /// How often a motion is followed with the same steps at the most.
    followed: usize,
}

/// A motion is planned at a placement in a setup, on an upright problem.
struct At<'a> {
    job: &'a Improver<'a>,
    moving: &'a Moving,
    setup: &'a Setup,
    placement: &'a Placement,
}

impl Moving {
    /// A better motion at the placement that is known.
    pub fn better(&self, job: &Improver<'_>, known: &Planned) -> Option<Planned> {
        self.best(job, &known.setup, &known.solution.placement, Some(known.clone()))
    }

    /// The best motion at a placement, in a setup given but for what moves; no worse than what is known there.
    pub fn best(
        &self,
        job: &Improver<'_>,
        setup: &Setup,
        placement: &Placement,
        known: Option<Planned>,
    ) -> Option<Planned> {
        let upright = job.problem.in_setup(&Setup { leans: [].into(), ..setup.clone() });
        let at = At { job, moving: self, setup, placement };
        let steps = at.steps();
        let dense = kept_points(&upright, MOST_PLANNED_POINTS, |_| 0.0);
        let sparse = kept_points(&upright, MOST_PLANNED_POINTS, |time| at.points_needed(&upright, &steps, time));
        let of_leans = self.axes.is_empty();
        let mut best = known;
        if best.is_some() && !(of_leans && self.is_whole) {
            let on = Thinned::new(&upright, if of_leans { dense.clone() } else { sparse.clone() });
            best = at.narrowed(&on, at.known_motion(&on), &steps, best);
        }
        let is_two = of_leans && sparse != dense;
        let points = [Some(sparse), is_two.then_some(dense)].into_iter().flatten().filter(|_| self.is_whole);
        for kept in points {
            if best.is_some() && job.monitor.should_stop() {
                break;
            }
            let on = Thinned::new(&upright, kept);
            let Some(motion) = at.coarse_motion(&on) else { continue };
            best = at.better(&on, &motion, best);
            best = at.narrowed(&on, motion, &steps, best);
        }
        best
    }
}

impl At<'_> {
    /// The leans that are planned.
    fn space(&self) -> Option<&LeanSpace> {
        self.job.space.filter(|_| self.moving.leans)
    }

    fn narrowing(&self) -> Narrowing {
        match (self.moving.axes.len(), self.space().is_some()) {
            (0, _) => Narrowing { half: 1, shrink: 2.0, levels: 8, followed: 1 },
            (1, false) => Narrowing { half: 6, shrink: 4.0, levels: 4, followed: 1 },
            _ => Narrowing { half: 1, shrink: 2.0, levels: 6, followed: 3 },
        }
    }

    /// First steps.
    fn steps(&self) -> SettingSteps {
        let step = |(number, axis): (usize, &ExternalAxis)| match self.moving.axes.contains(&number) {
            true => (axis.max - axis.min) / (POSITIONS - 1) as f64,
            false => 0.0,
        };
        SettingSteps {
            lean: self.space().map_or([0.0; 2], |space| space.steps),
            axes: self.job.problem.external_axes.iter().enumerate().map(step).collect(),
        }
    }

    /// On how many points as far apart as those of a path (s) the steps can be made from one to the next.
    fn points_needed(&self, upright: &Problem, steps: &SettingSteps, time: f64) -> f64 {
        let by_axes = upright
            .external_axes
            .iter()
            .zip(&steps.axes)
            .map(|(axis, step)| axis.max_speed.map_or(0.0, |speed| step / (speed * time)));
        let by_lean = self.space().map(|space| points_needed(space, upright, time));
        by_axes.chain(by_lean).fold(0.0, f64::max)
    }

    /// What the setup says, on some points.
    fn known_motion(&self, on: &Thinned<'_>) -> Motion {
        let rows = self.setup.positions.spread(&on.upright.task);
        Motion {
            leans: if self.job.space.is_some() { on.leans_of(self.setup) } else { Vec::new() },
            axes: on.kept.iter().map(|point| rows[*point].clone()).collect(),
        }
    }

    /// The best motion on a coarse grid over all ranges.
    fn coarse_motion(&self, on: &Thinned<'_>) -> Option<Motion> {
        let (problem, axes) = (on.problem(), &self.moving.axes);
        let most = if axes.is_empty() { usize::MAX } else { COARSE_LEANS };
        let half = self.space().map(|space| space.half_counts().map(|half| half.min(most)));
        let leans: usize = half.map_or(1, |half| half.iter().map(|half| 2 * half + 1).product());
        let each = libm::floor(libm::pow((MOST_SETTINGS / leans.min(MOST_SETTINGS)) as f64, 1.0 / axes.len() as f64));
        let positions = |number: &usize| (*number, problem.external_axes[*number].grid(POSITIONS.min(each as usize)));
        let positions: Vec<_> = axes.iter().map(positions).collect();
        let grid = match half {
            Some(half) => MotionGrid::product(problem, Some(half), &positions),
            None => MotionGrid::of_axes(problem, &self.known_motion(on), &positions),
        };
        Some(path_of(&grid, self.placement)?.motion)
    }

    /// The best of motions near one, in ever smaller steps, from half the first ones where these have been planned.
    fn narrowed(
        &self,
        on: &Thinned<'_>,
        mut motion: Motion,
        first: &SettingSteps,
        mut best: Option<Planned>,
    ) -> Option<Planned> {
        let Narrowing { half, shrink, levels, followed } = self.narrowing();
        let mut steps = if followed == 1 { first.divided(2.0) } else { first.clone() };
        let mut last = f64::INFINITY;
        for _ in 0..levels {
            for _ in 0..followed {
                if best.is_some() && self.job.monitor.should_stop() {
                    return best;
                }
                let grid = MotionGrid::near(on.problem(), &motion, &steps, half);
                let Some(found) = path_of(&grid, self.placement).filter(|found| found.objective < last) else { break };
                let gains = found.objective <= last * (1.0 - GAIN);
                (last, motion) = (found.objective, found.motion);
                best = self.better(on, &motion, best);
                if !gains {
                    break;
                }
            }
            steps = steps.divided(shrink);
        }
        best
    }

    /// The plan with a motion over all points, or what is known where it is no better.
    fn better(&self, on: &Thinned<'_>, motion: &Motion, known: Option<Planned>) -> Option<Planned> {
        let setup = || {
            let leans = match self.space() {
                Some(space) => spread(space, on, &motion.leans)?.into(),
                None => self.setup.leans.clone(),
            };
            let positions = match self.moving.axes[..] {
                [] => self.setup.positions.clone(),
                _ => AxisPositions::shortest(between(on.upright, &on.kept, &motion.axes), &on.upright.task),
            };
            Some(Setup { positions, leans, ..self.setup.clone() })
        };
        let found = setup().and_then(|setup| Planned::at(self.job.problem, setup, self.placement));
        match (found, known) {
            (Some(found), Some(known)) => Some(known.better(found)),
            (found, known) => known.or(found),
        }
    }
}
