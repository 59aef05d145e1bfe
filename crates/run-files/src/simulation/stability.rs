//! The `[stability]` table of a simulation file.

use super::file::AnalysisTable;
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::shapes::Span;
use stead_format::units::{Mm, Positive};
use stead_model::cutting::Cutter;
use stead_model::cutting::PassCut;
use stead_simulation::setup::Setup;
use stead_simulation::stability_analysis::AnalysisSettings;

/// What is to be found out of the stability of a cut.
///
/// # Errors
/// [`InputError`] with file, line and field: a place beyond the pass, a depth beyond the flutes.
pub(super) fn analysis_from(
    table: &AnalysisTable,
    at: &Place<'_>,
    setup: &Setup,
    cutter: &Cutter,
    cut: &PassCut,
) -> Result<AnalysisSettings, InputError> {
    let length_mm = setup.motion.length * 1e3;
    if table.way_mm.is_some_and(|way| way.written() > length_mm) {
        let allowed = format!("a number from 0 to the length of the pass, {length_mm} mm");
        return Err(at.key("way_mm").out_of_range(allowed));
    }
    Ok(AnalysisSettings {
        distance: table.way_mm.map_or(0.0, Quantity::si),
        speeds: table.lobes_rpm.map_or([cut.spindle_speed / 3.0, cut.spindle_speed * 3.0], Span::si),
        points: table.lobes_points.map_or(60, |points| points.count()),
        max_depth: max_depth(table.max_depth_mm, cutter, at)?,
        frequencies: table.frequencies_hz.map_or([1.0, 250.0], Span::si),
    })
}

/// The largest depth (m) that is examined; the length of the flutes where the file does not say.
///
/// # Errors
/// [`InputError`] at `max_depth_mm` of the table that is here where it is more than that.
pub(crate) fn max_depth(depth: Option<Mm<Positive>>, cutter: &Cutter, at: &Place<'_>) -> Result<f64, InputError> {
    let flute = cutter.flute_length().unwrap_or(cutter.diameter());
    let flute_mm = flute * 1e3;
    match depth {
        Some(depth) if depth.written() > flute_mm => Err(at
            .key("max_depth_mm")
            .out_of_range(format!("a number above 0 and not above flute_length_mm = {flute_mm}"))),
        depth => Ok(depth.map_or(flute, Quantity::si)),
    }
}
