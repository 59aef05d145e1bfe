//! The cutter, whatever its forces are computed for.

use super::Cutting;
use crate::place::required;
use crate::quantity::{Expects, Quantity, Unit};
use crate::shapes::List;
use crate::units::{NotNegative, Number};
use std::f64::consts::TAU;
use stead_disk::input::InputError;
use stead_model::cutting::{Coefficients, Cutter, CutterError, Rotation, Tooth};

impl Cutting<'_> {
    /// A cutter with these coefficients, which come from the key `source`.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: lists that do not fit the teeth, numbers that make no cutter.
    pub fn cutter(&self, coefficients: Coefficients, source: &str) -> Result<Cutter, InputError> {
        let (tool, at) = (self.tool, &self.tool_at);
        let count = self.count()?;
        let radius = tool.cutter_diameter_mm.written() / 2e3;
        let turn = "pitches from one tooth to the next in deg that make 360";
        let pitches = self.one_each("pitch_deg", &tool.pitch_deg, turn)?;
        let radii = "what the radius of an edge is more than half the diameter, in um";
        let offsets = self.one_each("runout_um", &tool.runout_um, radii)?;
        let teeth = (0..count).map(|k| Tooth {
            pitch: pitches.as_ref().map_or(TAU / count as f64, |pitches| pitches[k]),
            radius: radius + offsets.as_ref().map_or(0.0, |offsets| offsets[k]),
        });
        let helix = tool.helix_deg.map_or(0.0, Quantity::si);
        let flute_length = tool.flute_length_mm.map(Quantity::si);
        let rotation = tool.rotation.map_or(Rotation::Clockwise, |word| word.0);
        Cutter::new(teeth.collect(), helix, flute_length, rotation, coefficients).map_err(|error| {
            let key = match error {
                CutterError::Toothless => "teeth",
                CutterError::Pitch(_) => "pitch_deg",
                CutterError::Radius(_) => "runout_um",
                CutterError::Helix(_) => "helix_deg",
                CutterError::Flute(_) => "flute_length_mm",
                CutterError::Coefficient(_) => source,
            };
            at.key(key).error(format!("makes no cutter: {error}"), "the numbers of a real cutter, its forces finite")
        })
    }

    /// The number of teeth.
    fn count(&self) -> Result<usize, InputError> {
        Ok(self.tool_at.require("teeth", self.tool.teeth)?.count())
    }

    /// Numbers in SI units, one for each tooth.
    fn one_each<U: Unit>(
        &self,
        key: &str,
        list: &Option<List<Quantity<U>>>,
        what: &str,
    ) -> Result<Option<Vec<f64>>, InputError> {
        let count = self.count()?;
        match list {
            Some(list) if list.0.len() != count => {
                let problem = format!("has {} numbers for {count} teeth", list.0.len());
                Err(self.tool_at.key(key).error(problem, format!("{what}, one for each of the {count} teeth")))
            }
            list => Ok(list.as_ref().map(List::si)),
        }
    }

    /// The coefficients of the linear force law, the radial one by whichever of `kr` and `kr_mpa` is given.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: a missing coefficient, or both radial ones.
    pub fn coefficients(&self) -> Result<Coefficients, InputError> {
        let (tool, at) = (self.tool, &self.tool_at);
        let tangential = required!(at, tool.kt_mpa)?.si();
        let radial = match (tool.kr, tool.kr_mpa) {
            (Some(ratio), None) => ratio.si() * tangential,
            (None, Some(radial)) => radial.si(),
            (Some(_), Some(_)) => return Err(at.key("kr").error("is given beside kr_mpa", "only one of the two")),
            (None, None) => {
                let allowed = format!("kr_mpa or kr = kr_mpa / kt_mpa, {}", Number::<NotNegative>::expected());
                return Err(at.key("kr_mpa").missing(allowed));
            }
        };
        Ok(Coefficients {
            tangential,
            radial,
            axial: tool.ka_mpa.map_or(0.0, Quantity::si),
            tangential_edge: tool.kte_n_per_mm.map_or(0.0, Quantity::si),
            radial_edge: tool.kre_n_per_mm.map_or(0.0, Quantity::si),
        })
    }
}
