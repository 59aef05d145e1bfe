//! Stability analysis of a cut: modes of the arm, frequency response of the tool tip, critical depth of cut over the
//! spindle speed.

use super::arm::{AnyArm, Arm, Variant};
use super::modes::{LinearArm, Mode};
use super::setup::Setup;
use super::stability::{Lobe, Plant, SemiDiscretisation, Verdict, ZeroOrder, ZeroOrderError, lobes};
pub use super::stability_error::StabilityError;
use nalgebra::{Complex, Matrix3, Vector3};
use serde::Serialize;
use stead_model::cutting::{CutFrame, Cutter, PassCut};
use stead_model::plausibility;
use stead_model::robot::{Robot, Spindle};
use stead_numerics::message::{Note, Warning};
use stead_numerics::monitor::Monitor;

/// Settings of a stability analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnalysisSettings {
    /// Distance along the pass at which the arm is linearised. m
    pub distance: f64,
    /// Spindle speeds of the lobes, from and to. rad/s
    pub speeds: [f64; 2],
    /// Number of spindle speeds, both ends included.
    pub points: usize,
    /// Largest depth of cut that is examined. m
    pub max_depth: f64,
    /// Frequencies of the frequency response, from and to. Hz
    pub frequencies: [f64; 2],
}

/// Frequency response of the tool tip at one frequency, in the plane of the cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrequencyResponse {
    /// Frequency of the force. Hz
    pub frequency: f64,
    /// Along the feed, to a force along the feed. m/N
    pub feed: Complex<f64>,
    /// Along the normal of the wall, to a force along it. m/N
    pub normal: Complex<f64>,
    /// Along the normal, to a force along the feed, and the other way round. m/N
    pub cross: Complex<f64>,
}

/// Critical depths of cut, and the stability of the cut at its own depth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CutStability {
    /// By semi-discretisation; none where all depths up to the largest are stable. m
    pub semi_discretisation: Option<f64>,
    /// By the zero-order solution. m
    pub zero_order: Option<f64>,
    /// Largest Floquet multiplier at the depth of the cut.
    pub verdict: Verdict,
}

/// Result of a stability analysis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StabilityAnalysis {
    /// All modes, by natural frequency.
    pub modes: Vec<Mode>,
    /// Frequency response of the tool tip.
    pub frequency_response: Vec<FrequencyResponse>,
    /// At the spindle speed of the cut.
    pub cut_stability: CutStability,
    /// Over the spindle speed.
    pub lobes: Vec<Lobe>,
    /// Time of the pass through the work at the feed. s
    pub pass_time: f64,
    /// What makes it another result than that of the arm as its file states it: `springs-left-out`.
    pub warnings: Vec<Warning>,
    /// What the result rests on.
    pub notes: Vec<Note>,
}

/// That the analysis leaves the runout of a cutter out, where it has one.
pub fn runout_note(cutter: &Cutter) -> Option<Note> {
    cutter.has_runout().then(|| {
        "the stability of small motions is that of the cutter without its runout: every tooth is taken to cut, with equal radii"
            .to_owned()
            .into()
    })
}

/// Number of frequencies of the frequency response.
const FREQUENCIES: usize = 1000;

/// Modes, frequency response, critical depths and stability lobes of a cut, linearised where the settings say.
///
/// # Errors
/// [`StabilityError`] for an arm that says too little, or a cut without width, or when `monitor` asked to stop.
pub fn analyse(
    setup: &Setup,
    cutter: &Cutter,
    cut: &PassCut,
    settings: &AnalysisSettings,
    monitor: &Monitor,
) -> Result<StabilityAnalysis, StabilityError> {
    monitor.go_on()?;
    let linear = linear_at(setup, settings.distance)?;
    let frame = setup.motion.cut_frame(cut.wall(cutter));
    let plant = linear.plant(&frame)?;
    let between = |[from, to]: [f64; 2], count: usize| -> Vec<f64> {
        (0..count).map(|k| from + (to - from) * k as f64 / (count - 1).max(1) as f64).collect()
    };
    let speeds = between(settings.speeds, settings.points);
    Ok(StabilityAnalysis {
        modes: linear.modes().ok_or(StabilityError::Singular)?,
        frequency_response: linear.frequency_response(&frame, &between(settings.frequencies, FREQUENCIES))?,
        cut_stability: cut_stability(&plant, cutter, cut, settings.max_depth)?,
        lobes: lobes(&plant, cutter, cut, &speeds, settings.max_depth, monitor)?,
        pass_time: cut.length / setup.motion.ramp.feed,
        warnings: setup.warnings(),
        notes: setup
            .notes()
            .into_iter()
            .chain(runout_note(cutter))
            .chain(cut_notes(cutter, cut).into_iter().map(Note::may_be_wrong))
            .collect(),
    })
}

/// Numbers of a cutter and its cut that look wrong, by the keys of their files.
pub(super) fn cut_notes(cutter: &Cutter, cut: &PassCut) -> Vec<String> {
    let (diameter, coefficients) = (cutter.diameter() * 1e3, cutter.coefficients());
    let numbers = [
        ("tool.cutter_diameter_mm", diameter),
        ("tool.kt_mpa", coefficients.tangential / 1e6),
        ("tool.kr_mpa", coefficients.radial / 1e6),
        ("tool.ka_mpa", coefficients.axial / 1e6),
        ("cut.spindle_rpm", cut.spindle_speed / std::f64::consts::TAU * 60.0),
        ("cut.axial_depth_mm", cut.section.axial_depth * 1e3),
    ];
    plausibility::cut(diameter, &numbers)
}

/// Critical depths up to `max_depth` (m), and the stability of the cut.
///
/// # Errors
/// [`ZeroOrderError`] for a cut without width, and for a spindle too slow for the zero-order solution.
pub fn cut_stability(
    plant: &Plant,
    cutter: &Cutter,
    cut: &PassCut,
    max_depth: f64,
) -> Result<CutStability, ZeroOrderError> {
    let motion = SemiDiscretisation::new(plant, cutter, cut)?;
    Ok(CutStability {
        semi_discretisation: motion.critical_depth(max_depth),
        zero_order: ZeroOrder::new(plant).critical_depth(cutter, cut, max_depth)?,
        verdict: motion.verdict(cut.section.axial_depth),
    })
}

/// The arm of a setup, linearised at a distance (m) along its pass.
///
/// # Errors
/// [`StabilityError::Missing`] when the robot says too little for the variant.
pub fn linear_at(setup: &Setup, distance: f64) -> Result<LinearArm, StabilityError> {
    let motors = setup.motion.motors_at(distance, 0.0).0;
    linear_of(&setup.robot, &setup.spindle, setup.variant, setup.damping_scale, &motors)
}

/// The arm linearised about its rest, with its motors at joint angles `theta` (rad).
///
/// # Errors
/// [`StabilityError::Missing`] when the robot says too little for the variant.
pub fn linear_of(
    robot: &Robot,
    spindle: &Spindle,
    variant: Variant,
    damping_scale: f64,
    theta: &[f64; 6],
) -> Result<LinearArm, StabilityError> {
    fn about<const N: usize>(arm: &Arm<N>, motors: &[f64; 6], damping_scale: f64) -> LinearArm {
        LinearArm::of(arm, &arm.at_rest(&Arm::<N>::spread(motors)), damping_scale)
    }
    Ok(match AnyArm::new(robot, spindle, variant, theta)? {
        AnyArm::Six(arm) => about(&arm, theta, damping_scale),
        AnyArm::Eighteen(arm) => about(&arm, theta, damping_scale),
    })
}

impl LinearArm {
    /// The tip as a plant of the stability analysis.
    ///
    /// # Errors
    /// [`StabilityError::Plant`].
    pub fn plant(&self, frame: &CutFrame) -> Result<Plant, StabilityError> {
        Ok(Plant::of_arm(self, [frame.feed, frame.normal, frame.axis])?)
    }

    /// Frequency response in the plane of the cut at frequencies (Hz).
    ///
    /// # Errors
    /// [`StabilityError::Singular`] in a resonance without damping.
    pub fn frequency_response(
        &self,
        frame: &CutFrame,
        frequencies: &[f64],
    ) -> Result<Vec<FrequencyResponse>, StabilityError> {
        let along = |response: &Matrix3<Complex<f64>>, to: &Vector3<f64>, from: &Vector3<f64>| {
            let pairs = (0..3).flat_map(|row| (0..3).map(move |column| (row, column)));
            pairs.map(|(row, column)| response[(row, column)] * (to[row] * from[column])).sum()
        };
        let response = |frequency: &f64| {
            let response = self.response(*frequency).ok_or(StabilityError::Singular)?;
            Ok(FrequencyResponse {
                frequency: *frequency,
                feed: along(&response, &frame.feed, &frame.feed),
                normal: along(&response, &frame.normal, &frame.normal),
                cross: along(&response, &frame.normal, &frame.feed),
            })
        };
        frequencies.iter().map(response).collect()
    }
}

#[cfg(test)]
mod tests;
