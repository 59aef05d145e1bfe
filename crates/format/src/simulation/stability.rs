//! The `[stability]` table of a simulation file.

use super::super::reader::Field;
use crate::input::InputError;
use crate::place::Place;
use crate::quantity::Quantity;
use crate::tool::FASTEST_RPM;
use crate::units::{Mm, Positive};
use std::f64::consts::TAU;
use stead_model::cutting::Cutter;
use stead_simulation::milling::PassCut;
use stead_simulation::setup::Setup;
use stead_simulation::stability_analysis::AnalysisSettings;

/// Reads the table, which may be left out as may each of its keys: `way_mm`, where on the pass (0), `lobes_rpm`, from which
/// spindle speed to which (a third to thrice that of the cut), `lobes_points` (60), `max_depth_mm` (length of the flutes)
/// and `frequencies_hz`, of the answer at the tip (1 to 250).
pub(super) fn analysis_from(
    field: &Field<'_>,
    setup: &Setup,
    cutter: &Cutter,
    cut: &PassCut,
) -> Result<AnalysisSettings, InputError> {
    let mut settings = AnalysisSettings {
        distance: 0.0,
        speeds: [cut.spindle_speed / 3.0, cut.spindle_speed * 3.0],
        points: 60,
        max_depth: cutter.flute_length().unwrap_or(cutter.diameter()),
        frequencies: [1.0, 250.0],
    };
    let Some(table) = field.optional(Field::table)? else { return Ok(settings) };
    let [distance, speeds, points, max_depth, frequencies] =
        table.fields(["way_mm", "lobes_rpm", "lobes_points", "max_depth_mm", "frequencies_hz"])?;
    let length_mm = setup.motion.length() * 1e3;
    let on_pass = format!("a number from 0 to the length of the pass, {length_mm} mm");
    let from_to = |field: &Field<'_>, min: f64, max: f64| {
        let allowed = format!("two numbers [from, to] from {min} to {max}, the first below the second");
        field.wide_interval_where(&allowed, |value| (min..=max).contains(&value))
    };
    if let Some(mm) = distance.optional(|f| f.number_where(&on_pass, |value| (0.0..=length_mm).contains(&value)))? {
        settings.distance = mm / 1e3;
    }
    if let Some(ends) = speeds.optional(|field| from_to(field, 1.0, FASTEST_RPM))? {
        settings.speeds = ends.map(|rpm| rpm / 60.0 * TAU);
    }
    if let Some(count) = points.optional(|field| field.integer(2..=10_000))? {
        settings.points = count as usize;
    }
    settings.max_depth = self::max_depth(max_depth.read()?, cutter, field)?;
    if let Some(ends) = frequencies.optional(|field| from_to(field, 0.0, 1e5))? {
        settings.frequencies = ends;
    }
    Ok(settings)
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
