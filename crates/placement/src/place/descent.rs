//! Placements improved in what the search leaves as it is: where the external axes stand, and how the tool leans.
//!
//! A [`Descent`] goes through blocks of variables, each of which improves its own with the others held: a variable
//! neighbourhood descent. What costs more stands in a later level, which is tried where those before it gain too
//! little. A step is only taken to a plan that is better, so that a richer use of the axes is never worse than a poorer
//! one, and a tool that leans no worse than one that does not.

use super::block::{axis, gradient, motion, neighbours};
use super::job::Planned;
use stead_model::external_axis::{AxisUse, ExternalAxis};
use stead_numerics::monitor::{Monitor, Progress};
use stead_problem::lean::LeanSpace;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::Setup;

/// A step that gains less (relative) ends what repeats it.
pub(super) const GAIN: f64 = 1e-4;
/// With more path points the placement is not refined again for other axes or leans.
pub(super) const MOST_REFINED: usize = 5000;

/// What is improved.
pub(super) struct Improver<'a> {
    pub problem: &'a Problem,
    /// How the tool may lean, where leans are planned as well.
    pub space: Option<&'a LeanSpace>,
    pub monitor: &'a Monitor,
}

/// What is improved by itself, the rest held.
pub(super) enum Block {
    /// Placement, betas, leads and tilts by the gradient in all of them.
    Gradient,
    /// The placement by the gradient, its plan found anew.
    Placement,
    /// One external axis, for the path or for each segment.
    AxisBySegment(usize),
    /// External axes along the path and the leans, together.
    Motion(motion::Moving),
    /// The placements beside the known one, each with leans of its own.
    Neighbours,
}

/// Blocks, level by level, until a round gains too little.
pub(super) struct Descent {
    levels: Vec<Vec<Block>>,
    /// Rounds at the most.
    rounds: usize,
    /// A round that gains less (relative) is the last of its level.
    gain: f64,
    stage: &'static str,
}

impl Block {
    /// A better plan; nothing where there is none.
    fn better(&self, job: &Improver<'_>, known: &Planned) -> Option<Planned> {
        let found = match self {
            Self::Gradient => gradient::of_all(job, known),
            Self::Placement => gradient::of_placement(job, known),
            Self::AxisBySegment(number) => axis::by_segments(job, known, *number),
            Self::Motion(moving) => moving.better(job, known),
            Self::Neighbours => neighbours::best(job, known),
        };
        found.filter(|found| found.solution.objective < known.solution.objective)
    }
}

impl Descent {
    /// The external axes and, with them, the placement.
    pub fn of_axes(problem: &Problem) -> Self {
        let moving = moving(problem);
        let alone = moving.iter().filter(|_| moving.len() > 1).map(|number| vec![*number]);
        let motions = alone.chain((!moving.is_empty()).then(|| moving.clone()));
        let motions = motions.map(|axes| Block::Motion(motion::Moving { axes, is_whole: true }));
        let level = by_segments(problem).chain(motions).chain([Block::Placement]).collect();
        Self { levels: vec![level], rounds: 3, gain: GAIN, stage: "external axes" }
    }

    /// Leans and placement, from a start.
    pub fn of_leans() -> Self {
        let level = vec![Block::Gradient, Block::Placement, leans(true)];
        Self { levels: vec![level], rounds: 4, gain: GAIN, stage: "lead and tilt" }
    }

    /// Placement, leans and external axes, from one of the best.
    pub fn of_all(problem: &Problem) -> Self {
        let moving = moving(problem);
        let together =
            (!moving.is_empty()).then(|| Block::Motion(motion::Moving { axes: moving.clone(), is_whole: true }));
        let levels = vec![
            vec![Block::Gradient, Block::Placement, leans(false)],
            vec![Block::Neighbours],
            by_segments(problem).chain(together).collect(),
            vec![leans(true)],
        ];
        Self { levels, rounds: 48, gain: 1e-5, stage: "placement, lead and tilt together" }
    }

    /// Improves a placement until nothing gains, or the caller asks to stop.
    pub fn run(&self, job: &Improver<'_>, known: Planned) -> Planned {
        let mut best = known;
        for done in 0..self.rounds {
            job.monitor.report(Progress::Steps { stage: self.stage, done, total: self.rounds });
            let gains = |best: &mut Planned, level: &Vec<Block>| {
                let before = best.solution.objective;
                for block in level {
                    if !job.monitor.should_stop()
                        && let Some(better) = block.better(job, best)
                    {
                        *best = better;
                    }
                }
                before - best.solution.objective >= self.gain * before
            };
            if !self.levels.iter().any(|level| gains(&mut best, level)) {
                break;
            }
        }
        best
    }
}

impl Improver<'_> {
    /// The best leans at a placement, in a setup given but for its leans; none where no lean that was tried has a plan.
    pub fn start(&self, setup: &Setup, placement: &Placement) -> Option<Planned> {
        let upright = Setup { leans: [].into(), ..setup.clone() };
        let holds_path = self.space.is_none_or(|space| space.holds_path(self.problem.task.upright().path()));
        let known = holds_path.then(|| Planned::at(self.problem, upright.clone(), placement)).flatten();
        motion::Moving { axes: Vec::new(), is_whole: true }.best(self, &upright, placement, known)
    }
}

fn leans(is_whole: bool) -> Block {
    Block::Motion(motion::Moving { axes: Vec::new(), is_whole })
}

/// A block for each external axis that has somewhere to go.
fn by_segments(problem: &Problem) -> impl Iterator<Item = Block> {
    let axes = problem.external_axes.iter().enumerate().filter(|(_, axis)| axis.max > axis.min);
    axes.map(|(number, _)| Block::AxisBySegment(number))
}

/// The external axes of a problem that move along the path, by their numbers.
fn moving(problem: &Problem) -> Vec<usize> {
    let moves = |(_, axis): &(usize, &ExternalAxis)| axis.axis_use == AxisUse::Continuous && axis.max > axis.min;
    problem.external_axes.iter().enumerate().filter(moves).map(|(number, _)| number).collect()
}
