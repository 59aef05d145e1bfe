//! Result of a simulated pass: forces, wall roughness, modes, stability.

use super::coupled::{End, Job, JobError, Run};
use super::modes::Mode;
use super::roughness::{Profile, Roughness};
use super::stability::{SemiDiscretisation, Verdict};
use super::stability_analysis::{StabilityError, linear_at};
use serde::Serialize;
use stead_numerics::message::Warning;

/// How a simulated pass is evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationSettings {
    /// Time window of the force statistics, from and to; by default from a quarter to nine tenths of the work. s
    pub window: Option<[f64; 2]>,
    /// Height of the wall's profile above the tip of the tool. m
    pub height: f64,
    /// Cutoff of the Gaussian filter. m
    pub cutoff: f64,
}

/// Figures of a pass that publications give.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PassFigures {
    /// Forces along the feed and towards the wall, for the variant that was run.
    pub forces: Option<[Statistics; 2]>,
    /// Roughness.
    pub roughness: Option<Roughness>,
}

/// A force over a time. N
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistics {
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub root_mean_square: f64,
}

/// A simulated pass and its evaluation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Simulation {
    /// Forces, places, and how it ended.
    pub run: Run,
    /// Time window of the force statistics, from and to. s
    pub window: [f64; 2],
    /// Forces on the tool along the feed and towards the wall; `None` if the run ended before the window did.
    pub forces: Option<[Statistics; 2]>,
    /// Root mean square of the difference between the force and that one spindle turn before, over the second half of the window,
    /// relative to the root mean square of the force; `None` if the run ended before the window did.
    pub period_variation: Option<f64>,
    /// Stability of small motions (semi-discretisation), linearised in the middle of the work.
    pub verdict: Verdict,
    /// All modes at the start of the pass.
    pub modes: Vec<Mode>,
    /// The wall that remains.
    pub wall: Profile,
    /// The wall after the Gaussian filter: waves longer than the cutoff removed.
    pub filtered: Profile,
    /// Roughness of the wall as it is, and filtered; `None` if no wall was cut.
    pub roughness: Option<[Roughness; 2]>,
    /// Why the figures may not be those of the steady cut: `ended-early`, `not-settled` or `slow-growth`.
    pub warnings: Vec<Warning>,
}

/// Why a pass cannot be simulated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The run cannot start.
    #[error("{0}")]
    Job(#[from] JobError),
    /// The arm cannot be linearised.
    #[error("{0}")]
    StabilityAnalysis(#[from] StabilityError),
}

/// Largest period variation of a cut without chatter.
pub const MAX_PERIOD_VARIATION: f64 = 0.2;
/// Distance of the points of a wall. m
const SPACING: f64 = 10e-6;

impl Simulation {
    /// Evaluates the run of a job, complete or not.
    ///
    /// # Errors
    /// [`SimulationError`] when the arm cannot be linearised.
    pub fn of(job: &Job<'_>, settings: &EvaluationSettings, run: Run) -> Result<Self, SimulationError> {
        let distance = |share: f64| {
            let distance = job.cutter.radius() + job.gap + share * job.cut.length;
            distance.min(job.setup.motion.length())
        };
        let at = |share: f64| job.setup.motion.ramp().time_of(distance(share));
        let window = settings.window.unwrap_or_else(|| [at(0.25), at(0.9)]);
        let linear = linear_at(job.setup, distance(0.5))?;
        let plant = linear.plant(&job.setup.motion.cut_frame(job.cut.wall(job.cutter)))?;
        let method = SemiDiscretisation::new(&plant, job.cutter, job.cut).map_err(StabilityError::from)?;
        let wall = wall(job, settings, &run);
        let filtered = wall.filtered(settings.cutoff);
        let roughness = wall.roughness().zip(filtered.roughness()).map(|(raw, filtered)| [raw, filtered]);
        let mut found = Self {
            forces: statistics(&run, window),
            period_variation: period_variation(
                &run,
                [(window[0] + window[1]) / 2.0, window[1]],
                job.cut.steps_per_turn,
            ),
            window,
            verdict: method.verdict(job.cut.section.axial_depth),
            modes: linear_at(job.setup, 0.0)?.modes()?,
            wall,
            filtered,
            roughness,
            run,
            warnings: Vec::new(),
        };
        found.warnings = found.judge();
        Ok(found)
    }

    /// Reasons not to take the figures for those of a steady cut.
    fn judge(&self) -> Vec<Warning> {
        let reason = match &self.run.end {
            End::Complete => None,
            End::Limit(limit) => Some(limit.to_string()),
            End::Step(error) => Some(error.to_string()),
        };
        if let Some(reason) = reason {
            return vec![Warning::new("ended-early", format!("the run ended before the pass: {reason}"))];
        }
        match (self.verdict.is_stable(), self.is_stable()) {
            (true, false) => vec![Warning::new(
                "not-settled",
                "small motions die out, but the forces still change from turn to turn: a longer ramp or pass tells whether the \
                 start is still felt",
            )],
            (false, true) => vec![Warning::new(
                "slow-growth",
                "small motions grow, but have not become large by the end of the pass",
            )],
            _ => Vec::new(),
        }
    }

    /// Whether the cut was free of chatter: the pass was completed, and the forces hardly vary from turn to turn.
    pub fn is_stable(&self) -> bool {
        self.run.end == End::Complete
            && self.period_variation.is_none_or(|period_variation| period_variation < MAX_PERIOD_VARIATION)
    }
}

/// Steps between two times; none if the run does not have them all.
fn steps(run: &Run, [from, to]: [f64; 2]) -> Option<std::ops::Range<usize>> {
    let [first, last] = [(from / run.step - 1e-9).ceil(), (to / run.step + 1e-9).floor()];
    let range = first.max(0.0) as usize..last.max(0.0) as usize + 1;
    (!range.is_empty() && range.end <= run.samples.len()).then_some(range)
}

/// Forces along the feed and towards the wall between two times (s).
pub fn statistics(run: &Run, window: [f64; 2]) -> Option<[Statistics; 2]> {
    let samples = &run.samples[steps(run, window)?];
    let count = samples.len() as f64;
    Some([0, 1].map(|axis| {
        let (mut sum, mut squares) = (0.0, 0.0);
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        for sample in samples {
            let force = if axis == 0 { sample.force[0] } else { -sample.force[1] };
            sum += force;
            squares += force * force;
            min = min.min(force);
            max = max.max(force);
        }
        Statistics { min, max, mean: sum / count, root_mean_square: (squares / count).sqrt() }
    }))
}

/// Root mean square of the difference between forces one turn (in steps) apart, between two times (s), relative to that of the forces.
pub fn period_variation(run: &Run, window: [f64; 2], turn: usize) -> Option<f64> {
    let range = steps(run, window)?;
    let (mut changes, mut squares) = (0.0, 0.0);
    for index in range.start.max(turn)..range.end {
        for axis in 0..2 {
            let (now, before) = (run.samples[index].force[axis], run.samples[index - turn].force[axis]);
            changes += (now - before) * (now - before);
            squares += now * now;
        }
    }
    (squares > 0.0).then(|| (changes / squares).sqrt())
}

/// The wall up to where the tool came.
fn wall(job: &Job<'_>, settings: &EvaluationSettings, run: &Run) -> Profile {
    let reached = run.trail.nodes().last().map_or(0.0, |node| node.place[0]);
    let end = reached.min(job.cut.length);
    if end <= 0.0 {
        return Profile { start: 0.0, spacing: SPACING, heights: Vec::new() };
    }
    Profile::of_wall(&run.trail, job.cutter, job.cut, settings.height, [0.0, end], SPACING)
}
