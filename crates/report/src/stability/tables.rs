//! The CSV tables of a stability analysis.

use super::super::output::ReportError;
use super::json::LobeFigures;
use crate::csv_file::{Columns, rows_or};
use crate::figure::{FrequencyHz, ResponseUmPerN, Share, TipMm};
use stead_simulation::stability_analysis::{FrequencyResponse, StabilityAnalysis};

records! {
    /// A mode of the arm. Behind these columns is the amplitude of every joint, the largest 1: `joint1` and so on.
    #[derive(Default)]
    pub struct ModeRow of (mode: &stead_simulation::modes::Mode, number: usize) {
        let (count, joints) = (mode.joints.len(), mode.joints.iter().enumerate());
    } with {
        /// Its number, from 1.
        mode: usize = number,
        /// Natural frequency.
        frequency_hz: FrequencyHz = mode.natural_frequency().into(),
        /// Share of the critical damping.
        damping_ratio: Share = mode.damping_ratio.into(),
        /// x of the amplitude of the tip in the base frame, for a joint that swings by 1 rad.
        tip_x_mm_per_rad: TipMm = mode.tip.x.into(),
        /// y of it.
        tip_y_mm_per_rad: TipMm = mode.tip.y.into(),
        /// z of it.
        tip_z_mm_per_rad: TipMm = mode.tip.z.into(),
        #[serde(flatten)] joints: Columns<Share> =
            Columns(joints.map(|(k, amplitude)| (joint_name(k, count), Share(*amplitude))).collect()),
    }
}

/// `modes.csv`: one row for each mode. With springs normal to the axes every `joint` is followed by its `x` and `y`.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn modes(analysis: &StabilityAnalysis) -> Result<Vec<u8>, ReportError> {
    let row = |(mode, number): (&stead_simulation::modes::Mode, usize)| ModeRow::of(mode, number);
    rows_or("the table of modes", &ModeRow::default(), analysis.modes.iter().zip(1..).map(row))
}

/// `joint1` and so on; with three joints a motor `joint1`, `joint1_x`, `joint1_y`.
pub(super) fn joint_name(index: usize, count: usize) -> String {
    let each = (count / 6).max(1);
    format!("joint{}{}", index / each + 1, ["", "_x", "_y"][index % each])
}

records! {
    /// The complex frequency response of the tip.
    #[derive(Default)]
    pub struct ResponseRow of (response: &FrequencyResponse) {
        /// Frequency.
        frequency_hz: FrequencyHz = response.frequency.into(),
        /// Along the feed to a force along the feed, real part.
        feed_re_um_per_n: ResponseUmPerN = response.feed.re.into(),
        /// Its imaginary part.
        feed_im_um_per_n: ResponseUmPerN = response.feed.im.into(),
        /// Along the normal of the wall to a force along it, real part.
        normal_re_um_per_n: ResponseUmPerN = response.normal.re.into(),
        /// Its imaginary part.
        normal_im_um_per_n: ResponseUmPerN = response.normal.im.into(),
        /// Across, real part.
        cross_re_um_per_n: ResponseUmPerN = response.cross.re.into(),
        /// Its imaginary part.
        cross_im_um_per_n: ResponseUmPerN = response.cross.im.into(),
    }
}

/// `frequency-response.csv`: a `ResponseRow` for each frequency.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn responses(analysis: &StabilityAnalysis) -> Result<Vec<u8>, ReportError> {
    rows_or(
        "the table of the frequency response",
        &ResponseRow::default(),
        analysis.frequency_response.iter().map(ResponseRow::of),
    )
}

/// `lobes.csv`: a [`LobeFigures`] for each spindle speed.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn lobes(analysis: &StabilityAnalysis) -> Result<Vec<u8>, ReportError> {
    rows_or("the table of lobes", &LobeFigures::default(), analysis.lobes.iter().map(Into::into))
}
