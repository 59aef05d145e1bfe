//! Cutter and cut for the forces along a tool path.

use super::Cutting;
use crate::place::required;
use crate::units::{Mm, Positive};
use stead_disk::input::InputError;
use stead_model::cutting::{Cut, PathForces};

impl Cutting<'_> {
    /// The mean forces of milling with edge forces: coefficients `kt_mpa`, `kr` (or `kr_mpa`), `kte_n_per_mm`,
    /// `kre_n_per_mm`.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: a missing key, a cut wider than the cutter, a negative radial
    /// coefficient.
    pub fn path_forces(&self) -> Result<PathForces, InputError> {
        let (tool, cut) = (self.tool, self.cut);
        let radial_depth = required!(self.cut_at, cut.radial_depth_mm)?;
        required!(self.tool_at, tool.kte_n_per_mm)?;
        required!(self.tool_at, tool.kre_n_per_mm)?;
        let coefficients = self.coefficients()?;
        if coefficients.radial < 0.0 {
            return Err(self.tool_at.key("kr_mpa").out_of_range("a number not below 0 for forces along a path"));
        }
        let forces = PathForces {
            cutter: self.cutter(coefficients, "kt_mpa")?,
            cut: Cut {
                direction: required!(self.cut_at, cut.milling)?.0,
                radial_depth: radial_depth.si(),
                axial_depth: required!(self.cut_at, cut.axial_depth_mm)?.si(),
            },
            feed_per_tooth: required!(self.cut_at, cut.feed_per_tooth_mm)?.si(),
            concave_corners: cut.concave_corners.and_then(|word| word.0),
        };
        self.no_wider_than(radial_depth, tool.cutter_diameter_mm)?;
        Ok(forces)
    }

    /// Refuses a cut that is wider than the cutter.
    pub(super) fn no_wider_than(&self, depth: Mm<Positive>, diameter: Mm<Positive>) -> Result<(), InputError> {
        if depth.written() <= diameter.written() {
            return Ok(());
        }
        let allowed = format!("a number above 0 and not above cutter_diameter_mm = {}", diameter.written());
        Err(self.cut_at.key("radial_depth_mm").out_of_range(allowed))
    }
}
