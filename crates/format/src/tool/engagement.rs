//! Cutter and cut for the forces of teeth with a geometry (Klimchik et al. 2017, section 2.2).

use super::Cutting;
use crate::input::InputError;
use crate::place::required;
use crate::scalars::words;
use stead_model::cutting::{Engagement, MillingTool, Rotation};

/// The ways of milling that the key `engagement` names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EngagementKind {
    /// The whole width of the cutter.
    Slot,
    /// Up-milling.
    Up,
    /// Down-milling.
    Down,
    /// The middle of the cutter.
    Centred,
    /// A slot that is open in its middle.
    OpenSlot,
}

words!(EngagementKind:
    "slot" => EngagementKind::Slot,
    "up" => EngagementKind::Up,
    "down" => EngagementKind::Down,
    "centred" => EngagementKind::Centred,
    "open-slot" => EngagementKind::OpenSlot,
);

impl Cutting<'_> {
    /// Tool and engagement of the force model by rake face: coefficients `kn_mpa` and `friction`.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: a missing key, a width that the engagement does not have or that is larger
    /// than the cutter, values that make no finite force.
    pub fn tool_and_engagement(&self) -> Result<(MillingTool, Engagement), InputError> {
        let (tool, cut) = (self.tool, self.cut);
        let kn = required!(self.tool_at, tool.kn_mpa)?;
        let milling_tool = MillingTool {
            radius: tool.cutter_diameter_mm.written() / 2e3,
            teeth: tool.teeth.get() as u32,
            rotation: tool.rotation.map_or(Rotation::Clockwise, |word| word.0),
            entering_angle: tool.entering_angle_deg.map_or(90_f64.to_radians(), |angle| angle.si()),
            helix: tool.helix_deg.map_or(0.0, |angle| angle.si()),
            rake: tool.rake_deg.map_or(0.0, |angle| angle.si()),
            friction: tool.friction.map_or(0.0, |ratio| ratio.si()),
            normal_pressure: kn.si(),
            feed_per_tooth: required!(self.cut_at, cut.feed_per_tooth_mm)?.si(),
            axial_depth: cut.axial_depth_mm.si(),
        };
        let engagement = self.engagement()?;
        let mean = milling_tool.mean_wrench(&engagement);
        if mean.force.iter().chain(mean.moment.iter()).all(|part| part.is_finite()) {
            return Ok((milling_tool, engagement));
        }
        let problem = "gives, with the other values of [tool] and [cut], no finite force";
        Err(self.tool_at.key("kn_mpa").error(problem, "values whose forces are finite"))
    }

    fn engagement(&self) -> Result<Engagement, InputError> {
        let (cut, at) = (self.cut, &self.cut_at);
        let kind = required!(at, cut.engagement)?.0;
        let has_depth = matches!(kind, EngagementKind::Up | EngagementKind::Down | EngagementKind::Centred);
        let is_open = kind == EngagementKind::OpenSlot;
        for (key, is_given, expected, allowed) in [
            (
                "radial_depth_mm",
                cut.radial_depth_mm.is_some(),
                has_depth,
                "with engagement = \"up\", \"down\" or \"centred\" alone",
            ),
            ("open_width_mm", cut.open_width_mm.is_some(), is_open, "with engagement = \"open-slot\" alone"),
        ] {
            if is_given && !expected {
                let problem = format!("does not go with engagement = {}", at.key("engagement").written());
                return Err(at.key(key).error(problem, allowed));
            }
        }
        let diameter = self.tool.cutter_diameter_mm;
        let up_to = format!("a number above 0 and not above cutter_diameter_mm = {}", diameter.written());
        let depth = || {
            let depth = cut.radial_depth_mm.ok_or_else(|| at.key("radial_depth_mm").missing(&up_to))?;
            self.no_wider_than(depth, diameter).map(|()| depth.si())
        };
        let open = || {
            let below = format!("a number above 0 and below cutter_diameter_mm = {}", diameter.written());
            let width = cut.open_width_mm.ok_or_else(|| at.key("open_width_mm").missing(&below))?;
            let is_allowed = width.written() < diameter.written();
            if is_allowed { Ok(width.si()) } else { Err(at.key("open_width_mm").out_of_range(below)) }
        };
        let diameter = diameter.si();
        let (key, made) = match kind {
            EngagementKind::Slot => ("engagement", Ok(Engagement::slot())),
            EngagementKind::Up => ("radial_depth_mm", Engagement::up(depth()?, diameter)),
            EngagementKind::Down => ("radial_depth_mm", Engagement::down(depth()?, diameter)),
            EngagementKind::Centred => ("radial_depth_mm", Engagement::centred(depth()?, diameter)),
            EngagementKind::OpenSlot => ("open_width_mm", Engagement::open_slot(open()?, diameter)),
        };
        made.map_err(|error| at.key(key).error(format!("makes no engagement: {error}"), up_to))
    }
}
