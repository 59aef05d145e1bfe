//! The table `[stability]` of a run: where along the path the cut chatters.

use crate::Word;
use crate::simulation::{DampingScale, max_depth};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::tool::Cutting;
use stead_format::units::{Mm, Number, Positive};
use stead_simulation::arm::Variant;
use stead_simulation::path_stability::PathStabilityAnalysis;

/// Slices of the cutter: enough for mean coefficients.
const SLICES: usize = 32;
/// Steps a turn play no part in stability; this many tell any teeth apart.
const STEPS: usize = 3600;

/// Asks for the critical depth at each path point of a plan. The cutter and its cut are those of `[tool]` and `[cut]`;
/// robot and spindle need their masses.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct PathStabilityTable {
    /// How much of the arm is modelled: `springs` (where left out), and each of the others adds to the one before.
    pub variant: Option<Word<Variant>>,
    /// Factor on all damping of the arm; 1 where left out.
    pub damping_scale: Option<Number<DampingScale>>,
    /// Depth beyond which cuts are not looked at; the length of the flutes where left out.
    pub max_depth_mm: Option<Mm<Positive>>,
}

impl PathStabilityTable {
    /// # Errors
    /// [`InputError`] with file, line and field: a cutter and a cut that do not go together, a depth beyond the flutes.
    pub(super) fn analysis(&self, cutting: &Cutting<'_>, at: &Place<'_>) -> Result<PathStabilityAnalysis, InputError> {
        let (cutter, cut) = cutting.cutter_and_cut(1.0, SLICES, STEPS)?;
        Ok(PathStabilityAnalysis {
            variant: self.variant.map_or(Variant::Springs, |word| word.0),
            damping_scale: self.damping_scale.map_or(1.0, |scale| scale.si()),
            max_depth: max_depth(self.max_depth_mm, &cutter, at)?,
            cutter,
            cut,
        })
    }
}
