//! Cutter and cut for simulation and stability.

use super::Cutting;
use crate::place::required;
use stead_disk::input::InputError;
use stead_model::cutting::{Cut, Cutter};
use stead_model::cutting::{CutError, PassCut};

impl Cutting<'_> {
    /// The cutter and its cut, for work of a length (m), in so many slices and steps a turn: `flute_length_mm`,
    /// `kt_mpa`, `kr_mpa` (or `kr`), `milling`, `radial_depth_mm` and `spindle_rpm`.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: a missing key, pitches that do not make a turn, a cut wider than the
    /// cutter or deeper than its flutes, too few steps.
    pub fn cutter_and_cut(
        &self,
        length: f64,
        slices: usize,
        steps_per_turn: usize,
    ) -> Result<(Cutter, PassCut), InputError> {
        let (at, table, tool) = (&self.cut_at, self.cut, self.tool);
        required!(self.tool_at, tool.flute_length_mm)?;
        let cutter = self.cutter(self.coefficients()?, "kt_mpa")?;
        let radius = tool.cutter_diameter_mm.written() / 2e3;
        // With runout the cutter cuts wider or less wide than its diameter: a cut of the whole diameter is a slot all
        // the same.
        let (width, mean) = (required!(at, table.radial_depth_mm)?.si(), 2.0 * cutter.radius());
        let is_slot = (2.0 * radius.min(cutter.radius())..=2.0 * radius).contains(&width);
        let cut = PassCut {
            section: Cut {
                direction: required!(at, table.milling)?.0,
                radial_depth: if is_slot { mean } else { width },
                axial_depth: required!(at, table.axial_depth_mm)?.si(),
            },
            length,
            spindle_speed: required!(at, table.spindle_rpm)?.si(),
            slices,
            steps_per_turn,
        };
        match cut.check(&cutter) {
            Ok(()) => Ok((cutter, cut)),
            Err(error) => Err(self.cut_error(&error, steps_per_turn)),
        }
    }

    /// Refuses edge forces, which the chips of a simulated pass do not have.
    ///
    /// # Errors
    /// [`InputError`] at the first edge coefficient that is not 0.
    pub fn without_edge_forces(&self) -> Result<(), InputError> {
        for (key, coefficient) in [("kte_n_per_mm", self.tool.kte_n_per_mm), ("kre_n_per_mm", self.tool.kre_n_per_mm)] {
            if coefficient.is_some_and(|coefficient| coefficient.si() != 0.0) {
                let problem = "is an edge force, which a simulation does not take into account";
                return Err(self.tool_at.key(key).error(problem, "0, or no edge coefficients"));
            }
        }
        Ok(())
    }

    /// A cut that cannot be, at the key that makes it so.
    fn cut_error(&self, error: &CutError, steps_per_turn: usize) -> InputError {
        let (tool, cut) = (&self.tool_at, &self.cut_at);
        match error {
            CutError::Width { .. } => {
                let diameter = tool.key("cutter_diameter_mm").written();
                let allowed = format!("a number above 0 and not above cutter_diameter_mm = {diameter}");
                cut.key("radial_depth_mm").error("is wider than the cutter", allowed)
            }
            CutError::Depth { .. } => {
                let flute = tool.key("flute_length_mm").written();
                let allowed = format!("a number above 0 and not above flute_length_mm = {flute}");
                cut.key("axial_depth_mm").error("is deeper than the flutes of the cutter", allowed)
            }
            CutError::Coefficient(_) | CutError::EdgeForces => {
                tool.key("kt_mpa").error(format!("makes no cut: {error}"), "a number above 0")
            }
            CutError::Positive(_) | CutError::Slices => {
                cut.key("spindle_rpm").error(format!("makes no cut: {error}"), "finite numbers above 0")
            }
            CutError::Steps { min, .. } => {
                let problem = format!("has teeth so close that {steps_per_turn} steps a turn do not tell them apart");
                let pitch = tool.key("pitch_deg");
                let at = if pitch.is_given() { pitch } else { tool.key("teeth") };
                at.error(problem, format!("at least {min} steps a turn"))
            }
        }
    }
}
