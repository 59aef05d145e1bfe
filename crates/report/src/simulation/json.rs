//! The JSON documents of a simulated pass.

use crate::document::Document;
use crate::figure::{
    ForceN, FrequencyHz, HeightUm, MomentS, PlaceMm, RatePerS, Share, SpeedRpm, StepS, TimeS, each, some,
};
use serde_json::Value;
use stead_model::published::Published;

use stead_runs::SimulationRun;
use stead_simulation::coupled::End;
use stead_simulation::modes::Mode;
use stead_simulation::outcome::{PassFigures, Simulation, Statistics};
use stead_simulation::roughness::Roughness;

records! {
    /// A simulated pass.
    pub struct SimulationFigures of (run: &SimulationRun, found: &Simulation) {
        let (end, reason) = end_words(&found.run.end);
    } with {
        /// Name of the robot.
        robot: String = run.setup.robot.name().to_owned(),
        /// The model of the arm.
        variant: &'static str = run.setup.variant.word(),
        /// What the damping of the robot file is multiplied by.
        damping_scale: f64 = run.setup.damping_scale,
        /// Spindle speed.
        spindle_rpm: SpeedRpm = run.cut.spindle_speed.into(),
        /// Slices of the tool along its axis.
        slices: usize = run.cut.slices,
        /// Steps in a turn of the tool.
        steps_per_turn: usize = run.cut.steps_per_turn,
        /// Time of a step.
        step_s: StepS = found.run.step.into(),
        /// Steps.
        steps: usize = found.run.samples.len().saturating_sub(1),
        /// Evaluations of the equations of motion.
        evaluations: usize = found.run.evaluations,
        /// How the run ended.
        end: String = end.to_string(),
        /// Why it ended early.
        end_reason: Option<String> = reason,
        /// Whether the cut is stable.
        stable: bool = found.is_stable(),
        /// What was judged of the cut.
        judgement: &'static str = found.judgement.word(),
        /// How far turns differ from each other.
        unrest: Option<Share> = some(found.turn_variation),
        /// The same where all teeth are taken for alike.
        unrest_of_teeth_alike: Option<Share> = some(found.period_variation),
        /// What small motions do.
        small_motions: SmallMotions = SmallMotions::of(run, found),
        /// The times between which the cut was judged.
        window_s: [MomentS; 2] = each(found.window),
        /// The force along the feed.
        force_x: Option<ForceFigures> = forces(&found.forces, 0),
        /// The force towards the wall.
        force_y: Option<ForceFigures> = forces(&found.forces, 1),
        /// The profile of the wall.
        profile: Option<ProfileFigures> =
            found.roughness.as_ref().map(|[raw, filtered]| ProfileFigures::of(raw, filtered, run)),
        /// The modes of the arm.
        modes: Vec<PassMode> = found.modes.iter().map(PassMode::of).collect(),
        /// Published figures.
        published: Option<PublishedFigures> = run.published.as_ref().map(Into::into),
        /// Time on the clock.
        wall_s?: TimeS = None,
        /// Time of the pass for each second on the clock.
        real_time_factor?: Option<TimeS> = None,
    }

    /// What small motions do in the middle of the pass and where `stead stability` analyses it.
    pub struct SmallMotions of (run: &SimulationRun, found: &Simulation) {
        /// What they do.
        kind: &'static str = found.verdict.kind().word(),
        /// The rate at which they grow.
        growth_rate_per_s: RatePerS = found.verdict.growth_rate().into(),
        /// Where `stead stability` analyses the cut.
        where_stability_looks: SmallMotionsAt = SmallMotionsAt::of(run, found),
    }

    /// What small motions do at a place.
    pub struct SmallMotionsAt of (run: &SimulationRun, found: &Simulation) {
        /// How far along the path.
        way_mm: PlaceMm = run.evaluation.analysis_distance.into(),
        /// What they do.
        kind: &'static str = found.analysis_verdict.kind().word(),
        /// The rate at which they grow.
        growth_rate_per_s: RatePerS = found.analysis_verdict.growth_rate().into(),
    }

    /// A force over time.
    pub struct ForceFigures from statistics: &Statistics {
        /// Least.
        min_n: ForceN = statistics.min.into(),
        /// Largest.
        max_n: ForceN = statistics.max.into(),
        /// Mean.
        mean_n: ForceN = statistics.mean.into(),
        /// Root mean square.
        rms_n: ForceN = statistics.root_mean_square.into(),
    }

    /// Roughness of a profile.
    pub struct RoughnessFigures from roughness: &Roughness {
        /// Mean height.
        ra_um: HeightUm = roughness.mean.into(),
        /// Root mean square height.
        rq_um: HeightUm = roughness.root_mean_square.into(),
        /// Total height.
        rt_um: HeightUm = roughness.total.into(),
    }

    /// The profile of a wall.
    pub struct ProfileFigures of (raw: &Roughness, filtered: &Roughness, run: &SimulationRun) {
        #[serde(flatten)] filtered: RoughnessFigures = filtered.into(),
        /// The same without the filter.
        raw: RoughnessFigures = raw.into(),
        /// Height of the profile above the tip of the tool.
        height_mm: PlaceMm = run.evaluation.height.into(),
        /// Cutoff of the Gaussian filter.
        cutoff_mm: PlaceMm = run.evaluation.cutoff.into(),
    }

    /// A mode of the arm.
    pub struct PassMode of (mode: &Mode) {
        /// Natural frequency.
        frequency_hz: FrequencyHz = mode.natural_frequency().into(),
        /// Share of the critical damping.
        damping_ratio: Share = mode.damping_ratio.into(),
    }

    /// Published figures of a pass.
    pub struct PublishedFigures from published: &Published<PassFigures> {
        /// Where they are from.
        source: String = published.source.clone(),
        /// The force along the feed.
        force_x: Option<ForceFigures> = forces(&published.figures.forces, 0),
        /// The force towards the wall.
        force_y: Option<ForceFigures> = forces(&published.figures.forces, 1),
        /// The profile of the wall.
        profile: Option<RoughnessFigures> = published.figures.roughness.as_ref().map(Into::into),
    }
}

fn forces(forces: &Option<[Statistics; 2]>, axis: usize) -> Option<ForceFigures> {
    forces.as_ref().map(|forces| (&forces[axis]).into())
}

fn document(run: &SimulationRun, found: &Simulation, figures: SimulationFigures) -> Value {
    Document::new(&run.inputs).notes(&found.notes).warnings(&found.warnings).with(figures)
}

/// The content of `summary.json`: byte for byte the same for the same inputs.
pub fn simulation_json(run: &SimulationRun, found: &Simulation) -> Value {
    document(run, found, SimulationFigures::of(run, found))
}

/// What `stead simulate --json` prints: the summary, and how long the run took.
pub fn timed_json(run: &SimulationRun, found: &Simulation, wall: f64) -> Value {
    let duration = found.run.step * found.run.samples.len().saturating_sub(1) as f64;
    let factor = (wall > 0.0).then(|| TimeS(duration / wall));
    let timing = SimulationFigures {
        wall_s: Some(wall.into()),
        real_time_factor: Some(factor),
        ..SimulationFigures::of(run, found)
    };
    document(run, found, timing)
}

/// The word for how a run ended, and the reason if it ended early.
pub(super) fn end_words(end: &End) -> (&'static str, Option<String>) {
    match end {
        End::Complete => ("complete", None),
        End::Limit(limit) => ("limit", Some(limit.to_string())),
        End::Step(error) => ("step", Some(error.to_string())),
    }
}
