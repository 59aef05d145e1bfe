//! What an assessment file declares.

use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{Excluded, Included};
use stead_assessment::benchmark::{LimitsAt, Turning};
use stead_assessment::comparison::ElbowNames;
use stead_format::scalars::{Whole, words};
use stead_format::shapes::{Interval, List, Vector};
use stead_format::spindle::SpindleTable;
use stead_format::tool::{CutTable, ToolTable};
use stead_format::units::*;

ranges! {
    /// Radius of a circle. mm
    Radius: Included(1e-3), Included(1e5);
    /// A force or a moment, within what machines can do.
    Force: Included(-1e7), Included(1e7);
    /// A share of the weight of the payload.
    RatedShare: Excluded(0.0), Included(10.0);
}

/// A comparison of robots for `stead assess`: how round a circle each would mill, wherever in a plane it is put.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AssessmentFile {
    /// The robot files, relative to the folder of this file.
    pub robots: List<String>,
    /// The circle and its load.
    pub benchmark: BenchmarkTable,
    /// The plane of the circle; XOZ of the base frame where left out.
    pub plane: Option<PlaneTable>,
    /// The tool frame in the flange frame; the flange frame itself where left out.
    pub spindle: Option<SpindleTable>,
    /// The cutter. With `[cut]` it gives the load, in place of `benchmark.force_n` and `benchmark.moment_nm`.
    pub tool: Option<ToolTable>,
    /// What the cutter cuts.
    pub cut: Option<CutTable>,
    /// The grid of centres.
    pub map: MapTable,
    /// Square zones of centres that are looked for in the map.
    pub zones: Option<ZonesTable>,
    /// How the arm yields.
    pub stiffness: Option<StiffnessTable>,
    /// The rated load.
    pub load: Option<LoadTable>,
    /// Asks which robots reach an accuracy under a force.
    pub selection: Option<SelectionTable>,
    /// Published tables to print beside ours.
    pub reference: Option<ReferenceFileTable>,
}

/// The circle and its load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BenchmarkTable {
    /// Radius of the circle.
    pub radius_mm: Mm<Radius>,
    /// Number of points on the circle; 72 where left out.
    pub points: Option<Whole<8, 100000>>,
    /// Force of the workpiece on the tool at polar angle 0: along the radius outwards, along the direction of growing
    /// polar angle, and along the normal of the plane. Needed unless `[tool]` and `[cut]` give it.
    pub force_n: Option<Vector<N<Force>>>,
    /// Moment of the workpiece on the tool in the same directions; 0 where left out.
    pub moment_nm: Option<Vector<Nm<Force>>>,
    /// Whether the load turns with the polar angle, `with-tool` (where left out), or the other way, `against-tool`.
    pub force_turns: Option<Word<Turning>>,
    /// What goes round the circle: the tool centre point, `tool` (where left out), or the `wrist-centre`.
    pub traced: Option<Word<Traced>>,
    /// Direction from the workpiece to the robot along the tool, in the base frame; the normal of the plane where left
    /// out.
    pub tool_axis: Option<Vector<Number>>,
    /// Turn of the spindle about the tool axis; 0 where left out.
    pub beta_deg: Option<Deg>,
    /// Whether joint limits hold all round the circle, `circle` (where left out), or only at its `centre`.
    pub limits_at: Option<Word<LimitsAt>>,
    /// Whether elbow up means that the elbow is above the line from shoulder to wrist, `geometric` (where left out), or
    /// below it, `swapped`.
    pub elbow_names: Option<Word<ElbowNames>>,
}

/// What goes round the circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Traced {
    /// The tool centre point.
    Tool,
    /// The centre of the wrist.
    WristCentre,
}

words!(Traced: "tool" => Traced::Tool, "wrist-centre" => Traced::WristCentre);
words!(Turning, LimitsAt, ElbowNames);

/// The plane of the circle: an origin and two directions in the base frame, of length 1 and normal to each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlaneTable {
    /// Origin of the plane in the base frame; the origin of the base frame where left out.
    pub origin_mm: Option<Vector<Mm>>,
    /// First direction.
    pub x: Vector<Number>,
    /// Second direction.
    pub y: Vector<Number>,
}

/// The grid of centres, in the coordinates of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MapTable {
    /// Range `[min, max]` along the first direction of the plane.
    pub x_mm: Interval<Mm>,
    /// Range `[min, max]` along the second direction of the plane.
    pub y_mm: Interval<Mm>,
    /// Distance from one centre to the next in either direction.
    pub step_mm: Mm<Positive>,
}

/// Square zones of centres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ZonesTable {
    /// Sides of the zones, whole multiples of the step of the map.
    pub sides_mm: List<Mm<Positive>>,
}

/// How the arm yields.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct StiffnessTable {
    /// Numbers of the joints that yield; all where left out.
    pub joints: Option<List<Whole<1, 6>>>,
    /// Takes one value of a compliance that is given as a range: so far from its smaller to its larger end. Where left
    /// out, the compliance is linear in the joint angle.
    pub range_share: Option<Number<UnitInterval>>,
    /// Whether the stiffness is that of the loaded arm; false where left out.
    pub loaded: Option<bool>,
}

/// The rated load.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct LoadTable {
    /// Rated force over the weight of the payload; 0.8 where left out.
    pub rated_share: Option<Number<RatedShare>>,
    /// Acceleration of gravity; 9.80665 where left out.
    pub gravity_m_per_s2: Option<MPerS2<Positive>>,
}

/// Asks which robots reach an accuracy under a force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SelectionTable {
    /// Accuracies, in ascending order.
    pub accuracies_mm: List<Mm<Positive>>,
    /// Forces, in ascending order.
    pub forces_n: List<N<Positive>>,
    /// Share of the error that its compensation leaves; 1 where left out.
    pub remaining_share: Option<Number<Share>>,
}

/// Published tables to print beside ours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferenceFileTable {
    /// The file of published tables, relative to the folder of this file.
    pub tables: String,
}
