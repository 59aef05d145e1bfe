//! The tables `[tool]` and `[cut]`: one cutter and one cut, for runs, simulations and assessments.

mod cutter;
mod engagement;
mod force_model;
mod milling;

use crate::place::Place;
use crate::quantity::Quantity;
use crate::scalars::{Whole, Word, words};
use crate::shapes::{Array, List};
use crate::units::{Acute, Deg, Mm, Mpa, NPerMm, NotNegative, Number, Positive, Rpm, Um, ranges};
pub use engagement::EngagementKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{Excluded, Included};
use stead_cell::tool_scene::{Cylinder, ToolBody};
use stead_disk::input::InputError;
use stead_model::cutting::{MillingDirection, Rotation, Side};
use stead_model::plausibility;

/// Speeds beyond this are those of no spindle. rpm
pub const MAX_SPINDLE_SPEED_RPM: f64 = 1e6;

ranges! {
    /// An entering angle. deg
    EnteringAngle: Excluded(0.0), Excluded(180.0);
    /// Angle between the side of a tapered cutter and its axis. deg
    Taper: Included(0.0), Excluded(60.0);
    /// A speed that a spindle may have. 1/min
    SpindleSpeed: Excluded(0.0), Included(MAX_SPINDLE_SPEED_RPM);
}

words!(Rotation: "clockwise" => Rotation::Clockwise, "counterclockwise" => Rotation::Counterclockwise);
words!(MillingDirection: "conventional" => MillingDirection::Conventional, "climb" => MillingDirection::Climb);
words!(Option<Side>: "left" => Some(Side::Left), "right" => Some(Side::Right), "none" => None);

/// The cutter: its geometry, its sense of rotation and the coefficients of its forces. Which of the optional keys are
/// needed depends on what is computed: all forces need `teeth`, those along a path `kt_mpa`, `kr` (or `kr_mpa`),
/// `kte_n_per_mm` and `kre_n_per_mm`; simulation and stability need `flute_length_mm`, `kt_mpa` and `kr_mpa` (or `kr`);
/// an assessment needs `kn_mpa`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ToolTable {
    /// Diameter of the cutter; of a tapered one that of its tip, which a ball end of radius r has at 2 r.
    pub cutter_diameter_mm: Mm<Positive>,
    /// Radius of the corner: 0 of a flat cutter (where left out), half the diameter of a ball, between them of a bull
    /// nose. With `taper_deg` and `centre_cutting` it shapes the cutter that `[stock]` is cut with.
    pub corner_radius_mm: Option<Mm<NotNegative>>,
    /// Angle between the side and the axis; 0 where left out.
    pub taper_deg: Option<Deg<Taper>>,
    /// Whether the bottom cuts up to the axis, as plunges and ramps need; true where left out.
    pub centre_cutting: Option<bool>,
    /// Number of teeth: needed where forces are computed.
    pub teeth: Option<Whole<1, 100>>,
    /// Sense of rotation seen from the spindle; clockwise where left out.
    pub rotation: Option<Word<Rotation>>,
    /// Angle at which each tooth follows the tooth before it, in the order in which they pass, 360 in all: the second
    /// number is that from tooth 1 to tooth 2, the first that from the last tooth to tooth 1. Equal ones where left
    /// out.
    pub pitch_deg: Option<List<Deg>>,
    /// What the radius of each edge is more than half the diameter, in the order in which the teeth pass; 0 where left
    /// out.
    pub runout_um: Option<List<Um>>,
    /// Helix angle; 0 where left out.
    pub helix_deg: Option<Deg<Acute>>,
    /// Length of the flutes.
    pub flute_length_mm: Option<Mm<Positive>>,
    /// Shank and holder above the flutes, from below: height and diameter of each cylinder. With the cutter they are
    /// kept out of the part on the moves between segments, where there are surroundings.
    pub holder_mm: Option<List<Array<Mm<Positive>, 2>>>,
    /// Entering angle of the edges, between the edge and the plane normal to the tool axis; 90 where left out.
    pub entering_angle_deg: Option<Deg<EnteringAngle>>,
    /// Rake angle of the edges; 0 where left out.
    pub rake_deg: Option<Deg<Acute>>,
    /// Tangential cutting coefficient: force per area of the chip.
    pub kt_mpa: Option<Mpa<Positive>>,
    /// Radial cutting coefficient over the tangential one; either this or `kr_mpa`.
    pub kr: Option<Number<NotNegative>>,
    /// Radial cutting coefficient; either this or `kr`.
    pub kr_mpa: Option<Mpa>,
    /// Axial cutting coefficient; 0 where left out.
    pub ka_mpa: Option<Mpa>,
    /// Tangential edge coefficient: force per length of the edge in the cut.
    pub kte_n_per_mm: Option<NPerMm<NotNegative>>,
    /// Radial edge coefficient: force per length of the edge in the cut.
    pub kre_n_per_mm: Option<NPerMm<NotNegative>>,
    /// Specific cutting force normal to the rake face.
    pub kn_mpa: Option<Mpa<Positive>>,
    /// Friction on the rake face over the force normal to it; 0 where left out.
    pub friction: Option<Number<NotNegative>>,
}

/// What the cutter cuts. Forces along a path need `milling`, `radial_depth_mm` and `feed_per_tooth_mm`; simulation and
/// stability need `milling`, `radial_depth_mm` and `spindle_rpm`; an assessment needs `engagement`, the width that goes
/// with it, and `feed_per_tooth_mm`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct CutTable {
    /// Whether the teeth move against the feed in the cut, `conventional`, or with it, `climb`.
    pub milling: Option<Word<MillingDirection>>,
    /// Width of the cut, across the feed.
    pub radial_depth_mm: Option<Mm<Positive>>,
    /// Depth of the cut, along the tool axis: needed but with `[stock]`.
    pub axial_depth_mm: Option<Mm<Positive>>,
    /// Speed of the spindle.
    pub spindle_rpm: Option<Rpm<SpindleSpeed>>,
    /// Feed per tooth.
    pub feed_per_tooth_mm: Option<Mm<Positive>>,
    /// Which part of the cutter is in the work: all of one half (`slot`), one side of it with `radial_depth_mm` (`up`,
    /// `down`, `centred`), or a slot that is open in the middle with `open_width_mm` (`open-slot`).
    pub engagement: Option<Word<EngagementKind>>,
    /// Width of the opening with `engagement = "open-slot"`.
    pub open_width_mm: Option<Mm<Positive>>,
    /// On which side of the path its corners are those of a pocket, where the cutter is in the work all over; `none`
    /// where left out.
    pub concave_corners: Option<Word<Option<Side>>>,
}

impl ToolTable {
    /// Diameter and coefficients as they are stated, by their keys.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        let stated = [
            ("tool.cutter_diameter_mm", Some(self.cutter_diameter_mm.written())),
            ("tool.kt_mpa", self.kt_mpa.map(Quantity::written)),
            ("tool.kr", self.kr.map(Quantity::written)),
            ("tool.kr_mpa", self.kr_mpa.map(Quantity::written)),
            ("tool.ka_mpa", self.ka_mpa.map(Quantity::written)),
            ("tool.kte_n_per_mm", self.kte_n_per_mm.map(Quantity::written)),
            ("tool.kre_n_per_mm", self.kre_n_per_mm.map(Quantity::written)),
        ];
        stated.into_iter().filter_map(|(key, value)| Some((key, value?))).collect()
    }

    /// What looks wrong in its numbers, in sentences.
    pub fn notes(&self) -> Vec<String> {
        plausibility::cut(self.cutter_diameter_mm.written(), &self.numbers())
    }

    /// The cylinders that cutter, shank and holder fill.
    pub fn body(&self) -> ToolBody {
        let flutes = self.flute_length_mm.map_or(0.0, Quantity::si);
        let mut cutter = self.cutter_parts(flutes).into_iter();
        let stacked = |from: &mut f64, piece: &Array<Mm<Positive>, 2>| {
            let [height, diameter] = piece.si();
            let cylinder = Cylinder { radius: diameter / 2.0, from: *from, to: *from + height };
            *from = cylinder.to;
            Some(cylinder)
        };
        let pieces = self.holder_mm.iter().flat_map(|list| &list.0);
        ToolBody { cutter: cutter.next(), taper: cutter.collect(), holder: pieces.scan(flutes, stacked).collect() }
    }

    /// The cutter along flutes of a length (m), from below: one cylinder, or as many as a taper widens by steps.
    fn cutter_parts(&self, flutes: f64) -> Vec<Cylinder> {
        let radius = self.cutter_diameter_mm.si() / 2.0;
        let taper = self.taper_deg.map_or(0.0, Quantity::si);
        let (sine, cosine) = libm::sincos(taper);
        let corner = self.corner_radius_mm.map_or(0.0, Quantity::si).min(radius);
        // Where the side would meet the plane of the tip.
        let foot = radius - corner + corner * (1.0 - sine) / cosine;
        let side = |height: f64| if taper > 0.0 { foot + height * sine / cosine } else { radius };
        let count = ((side(flutes) - side(0.0)) / WIDER).ceil().clamp(1.0, PARTS);
        let part = |k: usize| {
            let [from, to] = [k, k + 1].map(|end| flutes * end as f64 / count);
            Cylinder { radius: side(to), from, to }
        };
        (0..count as usize).map(part).collect()
    }
}

/// Parts of a tapered cutter widen by no more, while there are no more than so many. m
const WIDER: f64 = 0.5e-3;
const PARTS: f64 = 12.0;

/// Both tables with their places in a file.
#[derive(Debug, Clone)]
pub struct Cutting<'a> {
    tool: &'a ToolTable,
    cut: &'a CutTable,
    /// Where the tool is stated.
    pub tool_at: Place<'a>,
    cut_at: Place<'a>,
}

impl<'a> Cutting<'a> {
    /// The tables of a file that has both.
    pub fn new(tool: &'a ToolTable, cut: &'a CutTable, at: &Place<'a>) -> Self {
        Self { tool, cut, tool_at: at.key("tool"), cut_at: at.key("cut") }
    }

    /// The tables of a file, if it has them.
    ///
    /// # Errors
    /// [`InputError`] at the table that is missing beside the other one.
    pub fn of(
        tool: &'a Option<ToolTable>,
        cut: &'a Option<CutTable>,
        at: &Place<'a>,
    ) -> Result<Option<Self>, InputError> {
        match (tool, cut) {
            (None, None) => Ok(None),
            (Some(tool), Some(cut)) => Ok(Some(Self::new(tool, cut, at))),
            (Some(_), None) => Err(at.key("cut").missing("a table [cut] beside [tool]")),
            (None, Some(_)) => Err(at.key("tool").missing("a table [tool] beside [cut]")),
        }
    }

    /// What looks wrong in their numbers, in sentences.
    pub fn notes(&self) -> Vec<String> {
        let stated = [
            ("cut.spindle_rpm", self.cut.spindle_rpm.map(Quantity::written)),
            ("feed per tooth", self.cut.feed_per_tooth_mm.map(Quantity::written)),
            ("cut.axial_depth_mm", self.cut.axial_depth_mm.map(Quantity::written)),
        ];
        let of_cut = stated.into_iter().filter_map(|(key, value)| Some((key, value?)));
        let numbers: Vec<_> = self.tool.numbers().into_iter().chain(of_cut).collect();
        plausibility::cut(self.tool.cutter_diameter_mm.written(), &numbers)
    }

    /// The tables where they are needed.
    ///
    /// # Errors
    /// [`InputError`] where there are none.
    pub fn required(cutting: Option<&Self>, at: &Place<'a>) -> Result<Self, InputError> {
        cutting.cloned().ok_or_else(|| at.key("tool").missing("tables [tool] and [cut]"))
    }
}

#[cfg(test)]
mod tests;
