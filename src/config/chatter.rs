//! The `[stability]` table of a run: what is to be cut along the path, to be told where it chatters.

use super::reader::{Field, Table};
use super::simulation::{MILLING_KEYS, MOST_DAMPING_SCALE, milling_from};
use crate::input::InputError;
use crate::simulation::arm::Variant;
use crate::simulation::chatter::Chatter;

/// Slices of the cutter: enough for mean coefficients.
const SLICES: usize = 32;
/// Steps a turn play no part in stability; this many tell any teeth apart.
const STEPS: usize = 3600;

/// Reads the table: cutter and cut as in `[milling]` of a simulation file, and optionally `variant`, `damping_scale` and
/// `max_depth_mm` (the length of the flutes).
///
/// # Errors
/// [`InputError`] with file, line and field: a missing or unknown key, a value of the wrong kind or out of range.
pub(super) fn chatter_from(table: &Table<'_>) -> Result<Chatter, InputError> {
    const OWN: [&str; 3] = ["variant", "damping_scale", "max_depth_mm"];
    let keys: [&str; MILLING_KEYS.len() + OWN.len()] =
        std::array::from_fn(|k| *MILLING_KEYS.get(k).unwrap_or(&OWN[k.saturating_sub(MILLING_KEYS.len())]));
    table.fields(keys)?;
    let [variant, damping_scale, deepest] = OWN.map(|key| table.field(key));
    let (cutter, cut) = milling_from(table, 1.0, SLICES, STEPS)?;
    let words = Variant::ALL.map(|variant| (variant.word(), variant));
    let scale = format!("a number from 0 to {MOST_DAMPING_SCALE}");
    let scaled = |field: &Field<'_>| field.number_where(&scale, |value| (0.0..=MOST_DAMPING_SCALE).contains(&value));
    let flute_mm = cutter.flute() * 1e3;
    let within = format!("a number above 0 and not above flute_length_mm = {flute_mm}");
    let depth = |field: &Field<'_>| field.number_where(&within, |value| value > 0.0 && value <= flute_mm);
    Ok(Chatter {
        variant: variant.optional(|field| field.one_of(&words))?.unwrap_or(Variant::Springs),
        damping_scale: damping_scale.optional(scaled)?.unwrap_or(1.0),
        deepest: deepest.optional(depth)?.unwrap_or(flute_mm) / 1e3,
        cutter,
        cut,
    })
}
