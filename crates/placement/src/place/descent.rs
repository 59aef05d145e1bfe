//! Placements improved in what the search leaves as it is: positions of the external axes, and leans of the tool.
//!
//! A [`Descent`] goes through blocks of variables, each of which improves its own with the others held: a variable
//! neighbourhood descent. What costs more is in a later level, which is tried where those before it gain too
//! little. A step is only taken to a plan that is better, so that a richer use of the axes is never worse than a poorer
//! one, and a tool that leans no worse than one that does not.

use super::block::motion::Moving;
use super::block::{ahead, axis, gradient, neighbours};
use super::improver::{GAIN, Improver};
use super::job::Planned;
use stead_model::external_axis::{AxisUse, ExternalAxis};
use stead_numerics::monitor::Progress;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::Setup;

/// Variables that are improved by themselves, the others held.
pub(super) enum Block {
    /// Placement, betas, leads and tilts by the gradient in all of them.
    Gradient,
    /// The placement by the gradient, its plan found anew.
    Placement,
    /// One external axis, for the path or for each segment.
    AxisBySegment(usize),
    /// External axes along the path and the leans, together.
    Motion(Moving),
    /// The placements beside the known one, each with leans of its own.
    Neighbours,
}

/// Blocks, level by level, until a round gains too little.
pub(super) struct Descent {
    levels: Vec<Vec<Block>>,
    /// So many blocks of a level have been gone through before the first round.
    begun: usize,
    /// Rounds at the most.
    rounds: usize,
    /// A round that gains no more (relative) is the last of its level.
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
        let level = axes(problem, false).chain([Block::Placement]).collect();
        Self { levels: vec![level], begun: 0, rounds: 8, gain: GAIN, stage: "external axes" }
    }

    /// Leans and placement, from a [start](Improver::start), which has planned the leans.
    pub fn of_leans() -> Self {
        let level = vec![leans(true), Block::Gradient, Block::Placement];
        Self { levels: vec![level], begun: 1, rounds: 4, gain: GAIN, stage: "lead and tilt from a start" }
    }

    /// Placement, leans and external axes, from one of the best.
    pub fn of_all(problem: &Problem) -> Self {
        // Where the placement stays, so do the leans that are near.
        let near = problem.cell.pinned().is_none().then(|| leans(false));
        let levels = vec![
            [Block::Gradient, Block::Placement].into_iter().chain(near).collect(),
            vec![Block::Neighbours],
            axes(problem, true).collect(),
            vec![leans(true)],
        ];
        Self { levels, begun: 0, rounds: 48, gain: 1e-5, stage: "placement, lead and tilt together" }
    }

    /// Improves a placement until nothing gains, or the caller asks to stop.
    #[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
    pub fn run(&self, job: &Improver<'_>, known: Planned) -> Planned {
        let mut best = known;
        for done in 0..self.rounds {
            job.monitor.report(Progress::Steps { stage: self.stage, done, total: self.rounds });
            let gains = |best: &mut Planned, level: &Vec<Block>| {
                let from = best.clone();
                for block in level.iter().skip(if done == 0 { self.begun } else { 0 }) {
                    if !job.monitor.should_stop()
                        && let Some(better) = block.better(job, best)
                    {
                        *best = better;
                    }
                }
                let before = from.solution.objective;
                if best.solution.objective < before {
                    *best = ahead::ahead(job, &from, best.clone());
                }
                before - best.solution.objective > self.gain * before
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
        Moving { axes: Vec::new(), leans: true, is_whole: true }.best(self, &upright, placement, known)
    }
}

fn leans(is_whole: bool) -> Block {
    Block::Motion(Moving { axes: Vec::new(), leans: true, is_whole })
}

/// The external axes that have somewhere to go, one by one, then those that move along the path with the leans.
fn axes(problem: &Problem, is_leaning: bool) -> impl Iterator<Item = Block> {
    let has_range = |(_, axis): &(usize, &ExternalAxis)| axis.max > axis.min;
    let axes = || problem.external_axes.iter().enumerate().filter(has_range);
    let moving = axes().filter(|(_, axis)| axis.axis_use == AxisUse::Continuous).map(|(number, _)| number);
    let moving: Vec<usize> = moving.collect();
    let along = |axes, leans| Block::Motion(Moving { axes, leans, is_whole: true });
    let is_joint = moving.len() > 1 || (!moving.is_empty() && is_leaning);
    let alone = moving.clone().into_iter().map(move |number| along(vec![number], false));
    let together = is_joint.then(|| along(moving, true));
    axes().map(|(number, _)| Block::AxisBySegment(number)).chain(alone).chain(together)
}
