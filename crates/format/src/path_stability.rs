//! The `[stability]` table of a run: what is to be cut along the path, to be told where it chatters.

use super::reader::Table;
use super::simulation::{MILLING_KEYS, damping_scale_from, max_depth_from, milling_from, variant_from};
use crate::input::InputError;
use stead_simulation::path_stability::PathStabilityAnalysis;

/// Slices of the cutter: enough for mean coefficients.
const SLICES: usize = 32;
/// Steps a turn play no part in stability; this many tell any teeth apart.
const STEPS: usize = 3600;

/// Reads the table: cutter and cut as in `[milling]` of a simulation file, and optionally `variant`, `damping_scale` and
/// `max_depth_mm` (the length of the flutes).
///
/// # Errors
/// [`InputError`] with file, line and field: a missing or unknown key, a value of the wrong kind or out of range.
pub(super) fn path_stability_from(table: &Table<'_>) -> Result<PathStabilityAnalysis, InputError> {
    const OWN: [&str; 3] = ["variant", "damping_scale", "max_depth_mm"];
    let keys: [&str; MILLING_KEYS.len() + OWN.len()] =
        std::array::from_fn(|k| *MILLING_KEYS.get(k).unwrap_or(&OWN[k.saturating_sub(MILLING_KEYS.len())]));
    table.fields(keys)?;
    let [variant, damping_scale, max_depth] = OWN.map(|key| table.field(key));
    let (cutter, cut) = milling_from(table, 1.0, SLICES, STEPS)?;
    Ok(PathStabilityAnalysis {
        variant: variant_from(&variant)?,
        damping_scale: damping_scale_from(&damping_scale)?,
        max_depth: max_depth_from(&max_depth, &cutter)?,
        cutter,
        cut,
    })
}
