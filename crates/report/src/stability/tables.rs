//! The CSV tables of a stability analysis.

use super::super::output::ReportError;
use super::{DEPTH_MM, HERTZ, RESPONSE, RPM, SHARE};
use crate::csv_file::table;
use crate::units::Unit;
use stead_simulation::stability_analysis::StabilityAnalysis;

/// Amplitudes of the tip, from m to mm, for a joint that swings by 1 rad.
const TIP_MM: Unit = Unit { factor: 1e3, decimals: 4 };

/// `modes.csv`: one row for each mode: natural frequency, share of the critical damping, amplitude of the tip in the base frame,
/// and of every joint, the largest 1. With springs normal to the axes every `joint` is followed by its `x` and `y`.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn modes(analysis: &StabilityAnalysis) -> Result<Vec<u8>, ReportError> {
    let count = analysis.modes.first().map_or(0, |mode| mode.joints.len());
    const FIXED: &str = "mode,frequency_hz,damping_ratio,tip_x_mm_per_rad,tip_y_mm_per_rad,tip_z_mm_per_rad";
    let header = FIXED.split(',').map(str::to_owned).chain((0..count).map(|k| joint_name(k, count)));
    let rows = analysis.modes.iter().zip(1..).map(|(mode, number): (_, usize)| {
        let mut row = vec![number.to_string(), HERTZ.text(mode.natural_frequency()), SHARE.text(mode.damping_ratio)];
        row.extend(mode.tip.iter().map(|part| TIP_MM.text(*part)));
        row.extend(mode.joints.iter().map(|amplitude| SHARE.text(*amplitude)));
        row
    });
    table("the table of modes", header, rows)
}

/// `joint1` and so on; with three joints a motor `joint1`, `joint1_x`, `joint1_y`.
pub(super) fn joint_name(index: usize, count: usize) -> String {
    let each = (count / 6).max(1);
    format!("joint{}{}", index / each + 1, ["", "_x", "_y"][index % each])
}

/// `frequency-response.csv`: the complex frequency response of the tip: along the feed to a force along the feed, along the
/// normal of the wall to a force along it, and across.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn responses(analysis: &StabilityAnalysis) -> Result<Vec<u8>, ReportError> {
    const HEADER: &str = "\
        frequency_hz,feed_re_um_per_n,feed_im_um_per_n,normal_re_um_per_n,normal_im_um_per_n,cross_re_um_per_n,\
         cross_im_um_per_n";
    let rows = analysis.frequency_response.iter().map(|response| {
        let mut row = vec![HERTZ.text(response.frequency)];
        let parts = [response.feed, response.normal, response.cross];
        row.extend(parts.iter().flat_map(|part| [part.re, part.im]).map(|value| RESPONSE.text(value)));
        row
    });
    table("the table of the frequency response", HEADER.split(','), rows)
}

/// `lobes.csv`: critical depth over spindle speed, empty where all depths up to the largest are stable.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn lobes(analysis: &StabilityAnalysis) -> Result<Vec<u8>, ReportError> {
    const HEADER: &str = "spindle_rpm,critical_depth_mm,zero_order_mm";
    let rows = analysis.lobes.iter().map(|lobe| {
        let depths = [lobe.semi_discretisation, lobe.zero_order].map(|depth| DEPTH_MM.text_or_empty(depth));
        std::iter::once(RPM.text(lobe.spindle_speed)).chain(depths).collect()
    });
    table("the table of lobes", HEADER.split(','), rows)
}
