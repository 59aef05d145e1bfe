//! Cutter and cut for simulation and stability.

use super::Cutting;
use crate::input::InputError;
use crate::place::required;
use crate::quantity::{Quantity, Unit};
use crate::shapes::List;
use std::f64::consts::TAU;
use stead_simulation::milling::{Coefficients, Cut, CutError, Cutter, CutterError, Tooth};

impl Cutting<'_> {
    /// The cutter and its cut, for work of a length (m), in so many slices and steps a turn: `flute_length_mm`, `kt_mpa`,
    /// `kr_mpa` (or `kr`), `milling`, `radial_depth_mm` and `spindle_rpm`.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: a missing key, pitches that do not make a turn, a cut wider than the cutter or
    /// deeper than its flutes, too few steps.
    pub fn cutter_and_cut(
        &self,
        length: f64,
        slices: usize,
        steps_per_turn: usize,
    ) -> Result<(Cutter, Cut), InputError> {
        let (at, table) = (&self.cut_at, self.cut);
        let cutter = self.cutter()?;
        let radius = self.tool.cutter_diameter_mm.written() / 2e3;
        // With runout the cutter cuts wider or less wide than its diameter: a cut of the whole diameter is a slot all the same.
        let (width, mean) = (required!(at, table.radial_depth_mm)?.si(), 2.0 * cutter.radius());
        let is_slot = (2.0 * radius.min(cutter.radius())..=2.0 * radius).contains(&width);
        let cut = Cut {
            milling: required!(at, table.milling)?.0,
            radial_depth: if is_slot { mean } else { width },
            axial_depth: table.axial_depth_mm.si(),
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

    fn cutter(&self) -> Result<Cutter, InputError> {
        let (tool, at) = (self.tool, &self.tool_at);
        let count = tool.teeth.count();
        let radius = tool.cutter_diameter_mm.written() / 2e3;
        let pitches =
            self.one_each("pitch_deg", &tool.pitch_deg, "pitches from one tooth to the next in deg that make 360")?;
        let radii = "what the radius of an edge is more than half the diameter, in um";
        let offsets = self.one_each("runout_um", &tool.runout_um, radii)?;
        let edges = (0..count).map(|k| Tooth {
            pitch: pitches.as_ref().map_or(TAU / count as f64, |pitches| pitches[k]),
            radius: radius + offsets.as_ref().map_or(0.0, |offsets| offsets[k]),
        });
        let pressures = self.tangential_and_radial()?;
        let coefficients = Coefficients {
            tangential: pressures.tangential,
            radial: pressures.radial,
            axial: tool.ka_mpa.map_or(0.0, Quantity::si),
        };
        let helix = tool.helix_deg.map_or(0.0, Quantity::si);
        let flute = required!(at, tool.flute_length_mm)?.si();
        Cutter::new(edges.collect(), helix, flute, coefficients).map_err(|error| {
            let key = match error {
                CutterError::Toothless => "teeth",
                CutterError::Pitch { .. } => "pitch_deg",
                CutterError::Radius { .. } => "runout_um",
                CutterError::Helix { .. } => "helix_deg",
                CutterError::Flute { .. } => "flute_length_mm",
                CutterError::Coefficient { .. } => "kt_mpa",
            };
            at.key(key).error(format!("makes no cutter: {error}"), "the numbers of a real cutter")
        })
    }

    /// Numbers in SI units, one for each tooth.
    fn one_each<U: Unit>(
        &self,
        key: &str,
        list: &Option<List<Quantity<U>>>,
        what: &str,
    ) -> Result<Option<Vec<f64>>, InputError> {
        let count = self.tool.teeth.count();
        match list {
            Some(list) if list.0.len() != count => {
                let problem = format!("has {} numbers for {count} teeth", list.0.len());
                Err(self.tool_at.key(key).error(problem, format!("{what}, one for each of the {count} teeth")))
            }
            list => Ok(list.as_ref().map(List::si)),
        }
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
            CutError::Positive { .. } | CutError::Slices => {
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
