//! Coupled simulation of a pass: the arm under the milling force, which depends on the motion of its tip.
//!
//! [`full`] moves the whole chain with its changing mass matrix. It gives a [`Run`]: forces and places over time, the
//! work that was left, and how it ended. Where the milling model is no longer valid the run ends, with the reason.

pub mod full;
#[cfg(test)]
mod tests;

use super::arm::{AnyArm, Missing};
use super::integrator::StepError;
use super::milling::{Force, Limit, Limits, MaterialRemoval};
use super::motion::Motion;
use super::setup::Setup;
use super::surface::{Node, Trail};
use nalgebra::Vector3;
use serde::Serialize;
use stead_model::cutting::{CutError, CutFrame, Cutter, PassCut};
use stead_numerics::monitor::{Monitor, Progress, Stop};

/// What is to be simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Job<'a> {
    /// The arm and its pass.
    pub setup: &'a Setup,
    /// The cutter.
    pub cutter: &'a Cutter,
    /// What it cuts.
    pub cut: &'a PassCut,
    /// How far before the work the rim of the cutter is at the start. m
    pub gap: f64,
}

/// One moment of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// On the tool: along the feed, the outward normal of the wall, the tool axis. N
    pub force: [f64; 3],
    /// The tool centre off its path, along the feed and the normal. m
    pub deflection: [f64; 2],
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum End {
    /// With the pass.
    Complete,
    /// Where the milling model is no longer valid.
    Limit(Limit),
    /// Where a step could not be made.
    Step(StepError),
}

/// A simulated pass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Run {
    /// The length of a step. s
    pub step: f64,
    /// One sample a step, the first at time 0.
    pub samples: Vec<Sample>,
    /// Where the tool centre was.
    #[serde(skip)]
    pub trail: Trail,
    /// How it ended.
    pub end: End,
    /// Evaluations of the milling force.
    pub evaluations: usize,
}

/// Why a job cannot be run.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum JobError {
    /// The robot file says too little.
    #[error("{0}")]
    Missing(#[from] Missing),
    /// The cutter cannot do the cut.
    #[error("{0}")]
    Cut(#[from] CutError),
    /// At the start the arm cannot be set in motion.
    #[error("{0}")]
    Start(#[from] StepError),
    /// The caller asked to stop.
    #[error("{0}")]
    Stopped(#[from] Stop),
}

impl Job<'_> {
    /// Simulates the pass with the whole chain.
    ///
    /// # Errors
    /// [`JobError`] before the first step, or when `monitor` asked to stop; what else happens later is the [`End`] of
    /// the run.
    pub fn run(&self, monitor: &Monitor) -> Result<Run, JobError> {
        match self.setup.arm()? {
            AnyArm::Six(arm) => full::run(self, &arm, monitor),
            AnyArm::Eighteen(arm) => full::run(self, &arm, monitor),
        }
    }
}

/// The plane of the cut in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CutPlane {
    feed: Vector3<f64>,
    normal: Vector3<f64>,
    axis: Vector3<f64>,
    /// The corner of the work where the tool enters along the nominal wall.
    origin: Vector3<f64>,
}

impl CutPlane {
    fn new(job: &Job<'_>) -> Self {
        let motion = &job.setup.motion;
        let CutFrame { feed, normal, axis } = motion.cut_frame(job.cut.wall(job.cutter));
        let radius = job.cutter.radius();
        let origin = motion.start.translation + feed * (radius + job.gap) - normal * radius;
        Self { feed, normal, axis, origin }
    }

    /// A place (m) in the plane.
    fn place(&self, point: &Vector3<f64>) -> [f64; 2] {
        self.part(&(point - self.origin))
    }

    /// A vector in the plane.
    fn part(&self, vector: &Vector3<f64>) -> [f64; 2] {
        [self.feed.dot(vector), self.normal.dot(vector)]
    }

    /// A force of milling in the base frame. N
    fn force(&self, on_tool: [f64; 3]) -> Vector3<f64> {
        self.feed * on_tool[0] + self.normal * on_tool[1] + self.axis * on_tool[2]
    }

    /// Nominal place of the tool centre at a distance (m) along the pass.
    fn nominal(&self, motion: &Motion, distance: f64) -> [f64; 2] {
        self.place(&(motion.start.translation + motion.direction * distance))
    }
}

/// Steps from one report to the next.
const WATCHED: usize = 256;

/// The milling of a run, and its samples.
#[derive(Debug)]
struct Process<'a> {
    motion: &'a Motion,
    plane: CutPlane,
    removal: MaterialRemoval,
    limits: Limits,
    step: f64,
    samples: Vec<Sample>,
    evaluations: usize,
}

impl<'a> Process<'a> {
    fn new(job: &Job<'a>) -> Result<Self, CutError> {
        let step = job.cut.step();
        let steps = (job.setup.motion.duration() / step) as usize + 2;
        Ok(Self {
            motion: &job.setup.motion,
            plane: CutPlane::new(job),
            removal: MaterialRemoval::with_room(job.cutter, job.cut, steps)?,
            limits: Limits { radius: job.cutter.radius(), spindle_speed: job.cut.spindle_speed },
            step,
            samples: Vec::with_capacity(steps),
            evaluations: 0,
        })
    }

    /// Steps of the pass.
    fn steps(&self) -> usize {
        (self.motion.duration() / self.step + 1e-9) as usize
    }

    /// Reports now and then how many steps are done, and asks whether to go on.
    fn watched(&self, monitor: &Monitor) -> Result<(), Stop> {
        let done = self.samples.len();
        if done % WATCHED != 1 {
            return Ok(());
        }
        monitor.report(Progress::Steps { stage: "simulating", done, total: 1 + self.steps() });
        monitor.go_on()
    }

    /// The force at a time (s) with the tool centre at a place.
    fn force(&mut self, time: f64, place: [f64; 2]) -> Force {
        self.evaluations += 1;
        let steps = time / self.step;
        let whole = steps.round();
        // Times are products with the step: whole ones but for rounding.
        let steps = if (steps - whole).abs() < 1e-6 { whole } else { steps };
        self.removal.force(steps, place)
    }

    /// Records the end of a step, with the tool centre at a place (m), moving at a velocity (m/s).
    fn keep(&mut self, place: [f64; 2], velocity: [f64; 2], force: Force) -> Result<(), Limit> {
        let time = self.samples.len() as f64 * self.step;
        let (distance, feed) = self.motion.ramp.at(time);
        let nominal = self.plane.nominal(self.motion, distance);
        let deflection = [place[0] - nominal[0], place[1] - nominal[1]];
        self.samples.push(Sample { force: force.on_tool, deflection });
        self.removal.remember(Node { place, motion: velocity.map(|part| part * self.step) });
        self.limits.check(time, force.chip, deflection, [velocity[0] - feed, velocity[1]])
    }

    fn ended(self, end: End) -> Run {
        Run {
            step: self.step,
            samples: self.samples,
            trail: self.removal.into_trail(),
            end,
            evaluations: self.evaluations,
        }
    }
}
