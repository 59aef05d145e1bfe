//! External axes and leans planned together along the path, at a placement.
//!
//! What is planned axis by axis and then in lead and tilt ([`super::axes`], [`super::lean`]) is where one alone gains
//! nothing; both may gain together. So all of them are planned at once ([`MotionGrid`]): on a coarse grid over their
//! whole ranges, and about what is known, in ever smaller steps. A step is only taken to a plan that is better.

use super::axes::{GAIN, PATH_GRID, ROUNDS, between, by_turns, kept_points, refined};
use super::job::Planned;
use super::thinned::{Thinned, path_of, points_needed, spread};
use stead_model::external_axis::{AxisUse, ExternalAxis};
use stead_model::task::lean::Lean;
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::redundancy::motion::{Motion, MotionGrid, SettingSteps};
use stead_problem::lean::{LeanSpace, MOST_PLANNED_POINTS};
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::{AxisPositions, Setup};

/// Settings of a point on the coarse grid at the most.
const MOST_SETTINGS: usize = 200;
/// Steps of lead and of tilt to either side on it.
const COARSE_LEANS: usize = 1;
/// How often the steps are halved.
const HALVINGS: usize = 5;
/// How often a motion is followed with the same steps at the most.
const FOLLOWED: usize = 3;

/// Improves the positions of the axes from a placement with its setup, and the placement with them, by turns; nothing
/// where that gains nothing. Where a [`LeanSpace`] is given, axes that move along the path are planned with the leans.
///
/// Of several axes that move along the path each is first moved by itself, the others as if they were indexed, so that
/// all together are never worse than the best of them alone.
pub(super) fn with_better_axes(
    problem: &Problem,
    start: &Planned,
    space: Option<&LeanSpace>,
    monitor: &Monitor,
) -> Option<Planned> {
    let moving = moving(problem);
    let alone = |number: &usize| by_turns(problem, start, &[*number], monitor);
    let mut best = match moving.len() {
        0 | 1 => by_turns(problem, start, &moving, monitor),
        _ => moving
            .iter()
            .map(alone)
            .reduce(Planned::better)
            .map_or_else(|| start.clone(), |best| by_turns(problem, &best, &moving, monitor)),
    };
    let together = Together { problem, space, moving: &moving, monitor };
    let is_joint = moving.len() > 1 || (!moving.is_empty() && space.is_some());
    for round in 0..ROUNDS {
        if !is_joint || monitor.should_stop() {
            break;
        }
        monitor.report(Progress::Steps { stage: "external axes together", done: round, total: ROUNDS });
        let Some(better) = together.at(&best) else { break };
        let before = best.solution.objective;
        best = refined(problem, &better, monitor).unwrap_or(better);
        if before - best.solution.objective < GAIN * before {
            break;
        }
    }
    (best.solution.objective < start.solution.objective).then_some(best)
}

/// The external axes of a problem that move along the path, by their numbers.
fn moving(problem: &Problem) -> Vec<usize> {
    let moves = |(_, axis): &(usize, &ExternalAxis)| axis.axis_use == AxisUse::Continuous && axis.max > axis.min;
    problem.external_axes.iter().enumerate().filter(moves).map(|(number, _)| number).collect()
}

/// External axes that move along the path, planned together with each other and, where a [`LeanSpace`] is given, with
/// the leans.
struct Together<'a> {
    problem: &'a Problem,
    space: Option<&'a LeanSpace>,
    moving: &'a [usize],
    monitor: &'a Monitor,
}

impl Together<'_> {
    /// A better motion at the placement that is known; nothing where there is none.
    fn at(&self, known: &Planned) -> Option<Planned> {
        let placement = &known.solution.placement;
        let upright = self.problem.in_setup(&Setup { leans: [].into(), ..known.setup.clone() });
        let steps = self.steps();
        let kept = kept_points(&upright, MOST_PLANNED_POINTS, |time| self.points_needed(&upright, &steps, time));
        let on = Thinned::new(&upright, kept);
        let mut best = known.clone();
        for is_known in [true, false] {
            let start =
                if is_known { Some(self.motion_of(&upright, known, &on.kept)) } else { self.coarse(&on, placement) };
            let Some(mut motion) = start else { continue };
            if !is_known {
                best = self.better(&on, &motion, best);
            }
            let mut steps = steps.clone();
            for _ in 0..=HALVINGS {
                let mut last = f64::INFINITY;
                for _ in 0..FOLLOWED {
                    if self.monitor.should_stop() {
                        break;
                    }
                    let grid = MotionGrid::near(on.problem(), &motion, &steps, 1);
                    let Some(found) = path_of(&grid, placement) else { break };
                    if found.objective > last * (1.0 - GAIN) {
                        break;
                    }
                    (last, motion) = (found.objective, found.motion);
                    best = self.better(&on, &motion, best);
                }
                steps = steps.divided(2.0);
            }
        }
        (best.solution.objective < known.solution.objective).then_some(best)
    }

    /// First steps.
    fn steps(&self) -> SettingSteps {
        let step = |(number, axis): (usize, &ExternalAxis)| match self.moving.contains(&number) {
            true => (axis.max - axis.min) / (PATH_GRID - 1) as f64,
            false => 0.0,
        };
        SettingSteps {
            lean: self.space.map_or([0.0; 2], |space| space.steps),
            axes: self.problem.external_axes.iter().enumerate().map(step).collect(),
        }
    }

    /// On how many points as far apart as those of a path (s) the steps can be made from one to the next.
    fn points_needed(&self, upright: &Problem, steps: &SettingSteps, time: f64) -> f64 {
        let by_axes = upright
            .external_axes
            .iter()
            .zip(&steps.axes)
            .map(|(axis, step)| axis.max_speed.map_or(0.0, |speed| step / (speed * time)));
        let by_lean = self.space.map(|space| points_needed(space, upright, time));
        by_axes.chain(by_lean).fold(0.0, f64::max)
    }

    /// What is known, at some points.
    fn motion_of(&self, upright: &Problem, known: &Planned, points: &[usize]) -> Motion {
        let rows = known.setup.positions.spread(&upright.task);
        let lean = |point: &usize| known.setup.leans.get(*point).copied().unwrap_or(Lean::NONE);
        Motion {
            leans: self.space.map_or_else(Vec::new, |_| points.iter().map(lean).collect()),
            axes: points.iter().map(|point| rows[*point].clone()).collect(),
        }
    }

    /// The best motion on a coarse grid over all ranges.
    fn coarse(&self, on: &Thinned<'_>, placement: &Placement) -> Option<Motion> {
        let problem = on.problem();
        let half = self.space.map(|space| space.half_counts().map(|half| half.min(COARSE_LEANS)));
        let leans = half.map_or(1, |half| half.iter().map(|half| 2 * half + 1).product());
        let each = libm::floor(libm::pow((MOST_SETTINGS / leans) as f64, 1.0 / self.moving.len() as f64)) as usize;
        let axes = self.moving.iter().map(|number| (*number, problem.external_axes[*number].grid(each.min(PATH_GRID))));
        let grid = MotionGrid::product(problem, half, &axes.collect::<Vec<_>>());
        Some(path_of(&grid, placement)?.motion)
    }

    /// The plan with a motion over all points, or what is known where it is no better.
    fn better(&self, on: &Thinned<'_>, motion: &Motion, known: Planned) -> Planned {
        let setup = || {
            let leans = match self.space {
                Some(space) => spread(space, on, &motion.leans)?.into(),
                None => known.setup.leans.clone(),
            };
            let rows = between(on.upright, &on.kept, &motion.axes);
            Some(Setup { positions: AxisPositions::shortest(rows, &on.upright.task), leans, ..known.setup.clone() })
        };
        let found = setup().and_then(|setup| Planned::at(self.problem, setup, &known.solution.placement));
        found.filter(|found| found.solution.objective < known.solution.objective).unwrap_or(known)
    }
}
