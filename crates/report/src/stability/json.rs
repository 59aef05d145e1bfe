//! The JSON document of a stability analysis.

use crate::document::Document;
use crate::figure::{DepthMm, Exponent, FrequencyHz, PlaceMm, RatePerS, Share, SpeedRpm, TimeS, some};
use serde_json::Value;
use stead_runs::SimulationRun;
use stead_simulation::modes::Mode;
use stead_simulation::stability::Lobe;
use stead_simulation::stability_analysis::{CutStability, StabilityAnalysis};

records! {
    /// A stability analysis.
    pub struct StabilityFigures of (run: &SimulationRun, analysis: &StabilityAnalysis) {
        /// Name of the robot.
        robot: String = run.setup.robot.name().to_owned(),
        /// The model of the arm.
        variant: &'static str = run.setup.variant.word(),
        /// What the damping of the robot file is multiplied by.
        damping_scale: f64 = run.setup.damping_scale,
        /// Distance along the pass at which the arm is linearised.
        way_mm: PlaceMm = run.analysis.distance.into(),
        /// Spindle speed.
        spindle_rpm: SpeedRpm = run.cut.spindle_speed.into(),
        /// Axial depth of the cut.
        axial_depth_mm: DepthMm = run.cut.section.axial_depth.into(),
        /// Depths are searched up to this.
        max_depth_mm: DepthMm = run.analysis.max_depth.into(),
        /// Time of the pass.
        pass_time_s: TimeS = analysis.pass_time.into(),
        /// Growth of small motions in that time, as an exponent.
        growth_in_pass: Exponent = Exponent(analysis.cut_stability.verdict.growth_rate() * analysis.pass_time),
        /// The modes.
        modes: Vec<ModeFigures> = analysis.modes.iter().map(Into::into).collect(),
        /// Critical depths over the spindle speed.
        lobes: Vec<LobeFigures> = analysis.lobes.iter().map(Into::into).collect(),
        #[serde(flatten)] verdict: VerdictFigures = (&analysis.cut_stability).into(),
    }
}

/// What `stead stability --json` prints, and the content of `summary.json`.
pub fn stability_json(run: &SimulationRun, analysis: &StabilityAnalysis) -> Value {
    Document::new(&run.inputs)
        .notes(&analysis.notes)
        .warnings(&analysis.warnings)
        .with(StabilityFigures::of(run, analysis))
}

records! {
    /// Critical depths and verdict of a cut.
    pub struct VerdictFigures from depths: &CutStability {
        /// Critical depths; null where all depths up to the largest are stable.
        critical_depth_mm: CriticalDepths = CriticalDepths::of(depths),
        /// Whether the cut is stable.
        stable: bool = depths.verdict.is_stable(),
        /// What small motions do.
        kind: &'static str = depths.verdict.kind().word(),
        /// The rate at which small motions grow.
        growth_rate_per_s: RatePerS = depths.verdict.growth_rate().into(),
    }

    /// Critical depths by two methods.
    pub struct CriticalDepths of (depths: &CutStability) {
        /// By semi-discretisation.
        semi_discretisation: Option<DepthMm> = some(depths.semi_discretisation),
        /// By the zero-order solution.
        zero_order: Option<DepthMm> = some(depths.zero_order),
    }

    /// A mode of the arm.
    pub struct ModeFigures from mode: &Mode {
        /// Natural frequency.
        frequency_hz: FrequencyHz = mode.natural_frequency().into(),
        /// Share of the critical damping.
        damping_ratio: Share = mode.damping_ratio.into(),
        /// Amplitudes of the joints, the largest 1.
        joints: Vec<Share> = mode.joints.iter().map(|amplitude| Share(*amplitude)).collect(),
        /// Amplitude of the tip in the base frame, for a joint that swings by 1 rad.
        tip_mm_per_rad: Vec<PlaceMm> = mode.tip.iter().map(|part| PlaceMm(*part)).collect(),
    }

    /// Critical depths at a spindle speed.
    #[derive(Default)]
    pub struct LobeFigures from lobe: &Lobe {
        /// The spindle speed.
        spindle_rpm: SpeedRpm = lobe.spindle_speed.into(),
        /// Critical depth by semi-discretisation; none where all depths up to the largest are stable.
        critical_depth_mm: Option<DepthMm> = some(lobe.semi_discretisation),
        /// Critical depth by the zero-order solution.
        zero_order_mm: Option<DepthMm> = some(lobe.zero_order),
    }
}
