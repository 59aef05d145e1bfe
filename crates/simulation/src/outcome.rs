//! What is found out by simulating a pass.

use super::coupled::{End, Job, JobError, Run};
use super::modes::Mode;
use super::roughness::{Profile, Roughness};
use super::stability::{SemiDiscretisation, Verdict};
use super::stability_analysis::{StabilityError, linear_at};
use serde::Serialize;
use stead_numerics::message::Warning;

/// How to look at a pass.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationSettings {
    /// Times between which forces are summed up; from a quarter to nine tenths of the work where nothing is said. s
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

/// A simulated pass and what it tells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Simulation {
    /// Forces, places, and how it ended.
    pub run: Run,
    /// Between which times forces are summed up. s
    pub window: [f64; 2],
    /// On the tool along the feed, and towards the wall, which is what is printed of such passes; none if the run ended before.
    pub forces: Option<[Statistics; 2]>,
    /// How much the force differs from that a turn before, in the second half of the window: root mean square, as a share of that
    /// of the force; none if the run ended before.
    pub period_variation: Option<f64>,
    /// Small motions in the middle of the work.
    pub verdict: Verdict,
    /// All modes at the start of the pass.
    pub modes: Vec<Mode>,
    /// The wall that was left.
    pub wall: Profile,
    /// That without what is longer than the cutoff.
    pub filtered: Profile,
    /// How rough both are, the wall as it is and filtered; none if no wall was made.
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
    /// Nothing can be said of small motions.
    #[error("{0}")]
    StabilityAnalysis(#[from] StabilityError),
}

/// Forces that differ by more than this from turn to turn are not those of a calm cut.
pub const MAX_PERIOD_VARIATION: f64 = 0.2;
/// Distance of the points of a wall. m
const SPACING: f64 = 10e-6;

impl Simulation {
    /// Looks at the run of a job, whether it came to its end or not.
    ///
    /// # Errors
    /// [`SimulationError`] where nothing can be said of small motions.
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

    /// What a program or a person should know before using the figures.
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

    /// Whether the cut stayed calm: it came to its end, with forces that hardly change from turn to turn.
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

/// How much forces differ from those a turn (in steps) before, between two times (s), as a share of themselves.
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

/// The wall as far as the tool came.
fn wall(job: &Job<'_>, settings: &EvaluationSettings, run: &Run) -> Profile {
    let reached = run.trail.nodes().last().map_or(0.0, |node| node.place[0]);
    let end = reached.min(job.cut.length);
    if end <= 0.0 {
        return Profile { start: 0.0, spacing: SPACING, heights: Vec::new() };
    }
    Profile::of_wall(&run.trail, job.cutter, job.cut, settings.height, [0.0, end], SPACING)
}
