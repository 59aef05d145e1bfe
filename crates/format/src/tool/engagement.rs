//! Cutter and cut for the forces of teeth with a geometry (Klimchik et al. 2017, section 2.2).

use super::Cutting;
use crate::place::required;
use crate::quantity::Quantity;
use crate::scalars::words;
use stead_disk::input::InputError;
use stead_model::cutting::{Coefficients, Cutter, CuttingForce, Engagement, ForceHistory, RakeFace};
use stead_model::task::Wrench;

stead_numerics::worded! {
    /// The ways of milling that the key `engagement` names.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum EngagementKind {
        /// The whole width of the cutter.
        Slot = "slot",
        /// Up-milling.
        Up = "up",
        /// Down-milling.
        Down = "down",
        /// The middle of the cutter.
        Centred = "centred",
        /// A slot that is open in its middle.
        OpenSlot = "open-slot",
    }
}

words!(EngagementKind);

/// A cutter in the work.
#[derive(Debug, Clone, PartialEq)]
pub struct EngagedCutter {
    pub(super) cutter: Cutter,
    pub(super) axial_depth: f64,
    pub(super) feed_per_tooth: f64,
    pub(super) engagement: Engagement,
}

impl EngagedCutter {
    /// The forces over the engagement and over a turn.
    pub fn force_history(&self) -> ForceHistory {
        let Self { cutter, axial_depth, feed_per_tooth, engagement } = self;
        let force = CuttingForce { cutter, axial_depth: *axial_depth, feed_per_tooth: *feed_per_tooth };
        ForceHistory::new(&force, engagement)
    }
}

impl Cutting<'_> {
    /// The cutter in the work, its force by the rake face: coefficients `kn_mpa` and `friction`.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: a missing key, a width that the engagement does not have or that is
    /// larger than the cutter, values that make no finite force.
    pub fn engaged_cutter(&self) -> Result<EngagedCutter, InputError> {
        let (tool, cut) = (self.tool, self.cut);
        let face = RakeFace {
            entering_angle: tool.entering_angle_deg.map_or(90_f64.to_radians(), Quantity::si),
            rake: tool.rake_deg.map_or(0.0, Quantity::si),
            friction: tool.friction.map_or(0.0, Quantity::si),
            normal_pressure: required!(self.tool_at, tool.kn_mpa)?.si(),
        };
        let feed_per_tooth = required!(self.cut_at, cut.feed_per_tooth_mm)?.si();
        let (axial_depth, engagement) = (required!(self.cut_at, cut.axial_depth_mm)?.si(), self.engagement()?);
        let no_force = || {
            let problem = "gives, with the other values of [tool] and [cut], no finite force";
            self.tool_at.key("kn_mpa").error(problem, "values whose forces are finite")
        };
        let coefficients = face.coefficients(tool.helix_deg.map_or(0.0, Quantity::si));
        let Coefficients { tangential, radial, axial, .. } = coefficients;
        if ![tangential, radial, axial].iter().all(|part| part.is_finite()) {
            return Err(no_force());
        }
        let cutter = self.cutter(coefficients, "kn_mpa")?;
        let force = CuttingForce { cutter: &cutter, axial_depth, feed_per_tooth };
        let Wrench { force, moment } = force.mean_wrench(&engagement);
        let is_finite = force.iter().chain(moment.iter()).all(|part| part.is_finite());
        if is_finite { Ok(EngagedCutter { cutter, axial_depth, feed_per_tooth, engagement }) } else { Err(no_force()) }
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
