//! What a simulation file declares.

use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{Excluded, Included};
use stead_format::mount::MountTable;
use stead_format::scalars::Whole;
use stead_format::shapes::{Array, Span, Vector};
use stead_format::spindle::SpindleTable;
use stead_format::tool::{CutTable, MAX_SPINDLE_SPEED_RPM, ToolTable};
use stead_format::units::*;
use stead_simulation::arm::Variant;

/// Damping times more than this is none of an arm.
pub const MAX_DAMPING_SCALE: f64 = 1e4;

ranges! {
    /// A factor on all damping.
    DampingScale: Included(0.0), Included(MAX_DAMPING_SCALE);
    /// Length of a pass; more is none of an arm. mm
    PassLength: Excluded(0.0), Included(1e4);
    /// Cutoff of a profile filter. mm
    Cutoff: Included(0.08), Included(25.0);
    /// A spindle speed on an axis of lobes. 1/min
    LobeSpeed: Included(1.0), Included(MAX_SPINDLE_SPEED_RPM);
    /// A frequency of a response. Hz
    Frequency: Included(0.0), Included(1e5);
}

/// A straight milling pass of `stead simulate` and `stead stability`: the arm with its masses and damping, the cutter,
/// and what it cuts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SimulationFile {
    /// The robot file, relative to the folder of this file; it needs masses and damping.
    pub robot: String,
    /// How much of the arm is modelled: `springs` (where left out), and each of the others adds to the one before.
    pub variant: Option<Word<Variant>>,
    /// Factor on all damping of the arm; 1 where left out.
    pub damping_scale: Option<Number<DampingScale>>,
    /// The tool frame in the flange frame, and the body that the flange carries.
    pub spindle: SpindleTable,
    /// Where the robot stands in its cell, whose z axis points up: gravity follows it.
    pub mount: Option<MountTable>,
    /// The motion of the tool.
    pub pass: PassTable,
    /// The workpiece.
    pub work: WorkTable,
    /// The cutter.
    pub tool: ToolTable,
    /// What the cutter cuts.
    pub cut: CutTable,
    /// Steps of the simulation, and how its outcome is evaluated.
    pub simulation: Option<SettingsTable>,
    /// The stability analysis.
    pub stability: Option<AnalysisTable>,
    /// Published figures to print beside ours.
    pub published: Option<PublishedTable>,
}

/// A straight pass from a standing start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PassTable {
    /// Joint angles at the start, in the angles of the robot file.
    pub start_joints_deg: Array<Deg, 6>,
    /// Direction of the feed in the base frame (in the cell frame with `[mount]`), normal to the tool axis; its length
    /// does not matter.
    pub feed_direction: Vector<Number>,
    /// Length of the pass.
    pub length_mm: Mm<PassLength>,
    /// Speed of the tool centre point after the start.
    pub feed_mm_per_min: MmPerMin<Positive>,
    /// Time from rest to full speed.
    pub ramp_s: S<ZeroToTen>,
}

/// The workpiece, along the feed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorkTable {
    /// Length of the work.
    pub length_mm: Mm<Positive>,
    /// Distance from the rim of the cutter to the work at the start.
    pub gap_mm: Mm<NotNegative>,
    /// Width of the slot that the pass is part of: the cutter has to fit into it.
    pub slot_width_mm: Option<Mm<Positive>>,
}

/// Steps of the simulation, and how its outcome is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct SettingsTable {
    /// Slices of the cutter along its axis; 32 where left out.
    pub slices: Option<Whole<1, 1024>>,
    /// Time steps in a turn of the spindle; 360 where left out.
    pub steps_per_turn: Option<Whole<1, 100000>>,
    /// Times `[from, to]` between which forces are averaged; the whole pass where left out.
    pub window_s: Option<Span<S<NotNegative>>>,
    /// Height on the wall, from the tip of the cutter, at which its profile is taken; half the depth of cut where left
    /// out.
    pub wall_height_mm: Option<Mm<NotNegative>>,
    /// Cutoff of the profile filter; 2.5 where left out (ISO 21920-3 for a profile of such roughness).
    pub cutoff_mm: Option<Mm<Cutoff>>,
}

/// The stability analysis.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct AnalysisTable {
    /// Where on the pass the arm is analysed, from the start; 0 where left out.
    pub way_mm: Option<Mm<NotNegative>>,
    /// Spindle speeds `[from, to]` of the lobes; a third to thrice the speed of the cut where left out.
    pub lobes_rpm: Option<Span<Rpm<LobeSpeed>>>,
    /// Number of spindle speeds; 60 where left out.
    pub lobes_points: Option<Whole<2, 10000>>,
    /// Largest depth that is examined; the length of the flutes where left out.
    pub max_depth_mm: Option<Mm<Positive>>,
    /// Frequencies `[from, to]` of the frequency response function at the tool centre point; 1 to 250 where left out.
    pub frequencies_hz: Option<Span<Hz<Frequency>>>,
}

/// Published figures of the pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedTable {
    /// Where they were published.
    pub source: String,
    /// Forces with the variant `springs`.
    pub springs: Option<ForcesTable>,
    /// Forces with the variant `gravity`.
    pub gravity: Option<ForcesTable>,
    /// Forces with the variant `orthogonal`.
    pub orthogonal: Option<ForcesTable>,
    /// Forces with the variant `backlash`.
    pub backlash: Option<ForcesTable>,
    /// Roughness of the wall.
    pub profile: Option<ProfileTable>,
}

/// Published forces: smallest, largest, mean and root mean square.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForcesTable {
    /// Along the feed: smallest, largest, mean and root mean square.
    pub force_x_n: Array<N, 4>,
    /// Across the feed, towards the wall: smallest, largest, mean and root mean square.
    pub force_y_n: Array<N, 4>,
}

/// Published roughness.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProfileTable {
    /// Arithmetical mean height Ra.
    pub ra_um: Um<Positive>,
    /// Root mean square height Rq.
    pub rq_um: Um<Positive>,
    /// Total height Rt.
    pub rt_um: Um<Positive>,
}
