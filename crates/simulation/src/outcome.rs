//! Result of a simulated pass: forces, wall roughness, modes, stability.

use super::coupled::{End, Job, JobError, Run, Sample};
use super::judgement::{Evidence, Judgement, period_variation, steps};
use super::modes::Mode;
use super::roughness::{Profile, Roughness};
use super::stability::{SemiDiscretisation, Verdict};
use super::stability_analysis::{StabilityError, cut_notes, linear_at, runout_note};
use nalgebra::{Vector2, Vector3};
use serde::Serialize;
use stead_model::plausibility;
use stead_numerics::message::{Note, Warning};

/// How a simulated pass is evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationSettings {
    /// Time window of the force statistics, from and to; by default from a quarter to nine tenths of the work. s
    pub window: Option<[f64; 2]>,
    /// Height of the wall's profile above the tip of the tool. m
    pub height: f64,
    /// Cutoff of the Gaussian filter. m
    pub cutoff: f64,
    /// Distance along the pass at which the stability analysis linearises the arm: what small motions do there is found
    /// as well, so that both answers can be compared. m
    pub analysis_distance: f64,
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
    /// Root mean square of the difference between the force and that one spindle turn before, over the second half of
    /// the window, relative to the root mean square of the force; `None` if the run ended before the window did.
    pub turn_variation: Option<f64>,
    /// The same for one period of the cutter: the part of a turn after which the teeth repeat in pitch and radius.
    pub period_variation: Option<f64>,
    /// Teeth in such a period: one where all are alike.
    pub period_teeth: usize,
    /// Stability of small motions (semi-discretisation), linearised in the middle of the work.
    pub verdict: Verdict,
    /// The same where the stability analysis linearises the arm.
    pub analysis_verdict: Verdict,
    /// How the pass went.
    pub judgement: Judgement,
    /// All modes at the start of the pass.
    pub modes: Vec<Mode>,
    /// The wall that remains.
    pub wall: Profile,
    /// The wall after the Gaussian filter: waves longer than the cutoff removed.
    pub filtered: Profile,
    /// Roughness of the wall as it is, and filtered; `None` if no wall was cut.
    pub roughness: Option<[Roughness; 2]>,
    /// Why the figures may not be those of the steady cut: `ended-early`, `not-settled`, `slow-growth` or
    /// `at-the-limit`; or those of another arm than its file states: `springs-left-out`.
    pub warnings: Vec<Warning>,
    /// What the result rests on.
    pub notes: Vec<Note>,
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
            distance.min(job.setup.motion.length)
        };
        let at = |share: f64| job.setup.motion.ramp.time_of(distance(share));
        let window = settings.window.unwrap_or_else(|| [at(0.25), at(0.9)]);
        let half = [(window[0] + window[1]) / 2.0, window[1]];
        let turn = job.cut.steps_per_turn as f64;
        let repeats = job.cutter.repeats_with_runout();
        let variation = period_variation(&run, half, turn / repeats as f64);
        let [verdict, analysis_verdict] = verdicts(job, [distance(0.5), settings.analysis_distance])?;
        let verdicts = [&verdict, &analysis_verdict];
        let time = (half[0] - at(0.0)).max(0.0);
        let judgement = Evidence { end: &run.end, cutter: job.cutter, variation, verdicts, time }.judgement();
        let wall = wall(job, settings, &run);
        let filtered = wall.filtered(settings.cutoff);
        let roughness = wall.roughness().zip(filtered.roughness()).map(|(raw, filtered)| [raw, filtered]);
        Ok(Self {
            forces: statistics(&run, window),
            turn_variation: period_variation(&run, half, turn),
            period_variation: variation,
            period_teeth: job.cutter.teeth().len() / repeats,
            window,
            verdict,
            analysis_verdict,
            judgement,
            modes: linear_at(job.setup, 0.0)?.modes().ok_or(StabilityError::Singular)?,
            wall,
            filtered,
            roughness,
            warnings: warning(judgement, &run.end).into_iter().chain(job.setup.warnings()).collect(),
            notes: notes(job, &run),
            run,
        })
    }

    /// Whether the cut was free of chatter: the pass was completed, its forces repeat, and small motions die out.
    pub fn is_stable(&self) -> bool {
        self.judgement == Judgement::Calm
    }
}

/// What the result rests on, and what of it looks like a wrong unit or sign.
fn notes(job: &Job<'_>, run: &Run) -> Vec<Note> {
    let largest = |size: fn(&Sample) -> f64| run.samples.iter().map(size).fold(0.0, f64::max);
    let force = plausibility::force(largest(|sample| Vector3::from(sample.force).norm()));
    let deflection = plausibility::deflection(largest(|sample| Vector2::from(sample.deflection).norm()));
    let of_setup = job.setup.notes().into_iter().chain(runout_note(job.cutter));
    let wrong = cut_notes(job.cutter, job.cut).into_iter().chain(force).chain(deflection);
    of_setup.chain(wrong.map(Note::may_be_wrong)).collect()
}

/// What small motions do at two distances along the pass (m).
fn verdicts(job: &Job<'_>, distances: [f64; 2]) -> Result<[Verdict; 2], StabilityError> {
    let frame = job.setup.motion.cut_frame(job.cut.wall(job.cutter));
    let at = |distance: f64| -> Result<Verdict, StabilityError> {
        let plant = linear_at(job.setup, distance)?.plant(&frame)?;
        Ok(SemiDiscretisation::new(&plant, job.cutter, job.cut)?.verdict(job.cut.section.axial_depth))
    };
    let [first, second] = distances;
    Ok([at(first)?, at(second)?])
}

/// The reason not to take the figures for those of a steady cut, if there is one.
fn warning(judgement: Judgement, end: &End) -> Option<Warning> {
    let (kind, message) = match judgement {
        Judgement::Calm | Judgement::Chatter(_) => return None,
        Judgement::Ended => {
            let reason = match end {
                End::Complete => String::new(),
                End::Limit(limit) => limit.to_string(),
                End::Step(error) => error.to_string(),
            };
            return Some(Warning::new("ended-early", format!("the run ended before the pass: {reason}")));
        }
        Judgement::Unsettled => (
            "not-settled",
            "small motions die out, but the forces do not repeat yet: a longer ramp or pass tells whether the start is still felt",
        ),
        Judgement::Growing(_) => {
            ("slow-growth", "small motions grow, but have not become large by the end of the pass")
        }
        Judgement::Marginal => (
            "at-the-limit",
            "the cut is at its limit of stability: small motions grow at one place of the pass and die out at another",
        ),
    };
    Some(Warning::new(kind, message))
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

/// The wall up to where the tool came.
fn wall(job: &Job<'_>, settings: &EvaluationSettings, run: &Run) -> Profile {
    let reached = run.trail.nodes().last().map_or(0.0, |node| node.place[0]);
    let end = reached.min(job.cut.length);
    if end <= 0.0 {
        return Profile { start: 0.0, spacing: SPACING, heights: Vec::new() };
    }
    Profile::of_wall(&run.trail, job.cutter, job.cut, settings.height, [0.0, end], SPACING)
}
