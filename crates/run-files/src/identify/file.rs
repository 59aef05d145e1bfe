//! What an identification file declares.

use super::FitModel;
use super::directions::Directions;
use super::held::HeldSprings;
use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::Included;
use stead_format::compliance_matrix::BaseComplianceTable;
use stead_format::orientation::Quaternion;
use stead_format::scalars::Whole;
use stead_format::shapes::{Array, Interval, List, Matrix, Vector};
use stead_format::units::*;
use stead_model::robot::MeasuredFrom;

ranges! {
    /// By how much angles may differ that count as one. deg
    AngleTolerance: Included(0.0), Included(5.0);
}

/// Joint compliances from measured deflections: the file of `stead identify fit` and `stead identify plan`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IdentificationFile {
    /// The robot file to start from, relative to the folder of this file: geometry, limits, compliances of about the
    /// right size.
    pub robot: String,
    /// The measurement sheet, relative to the folder of this file: CSV with one row for each configuration and
    /// reference point. Needed by `fit` alone.
    pub sheet: Option<String>,
    /// Where the load acts, in the flange frame.
    pub load_point_mm: Vector<Mm>,
    /// Standard deviation of one coordinate of one reading. Needed by `plan`, and by `fit` where the sheet has
    /// orientations; elsewhere the residuals tell it.
    pub noise_mm: Option<Mm<Positive>>,
    /// Standard deviation of one angle of one orientation. Needed where the sheet has orientations.
    pub noise_deg: Option<Deg<Positive>>,
    /// Known geometry of a gravity compensator; that of the robot file where left out.
    pub compensator: Option<CompensatorGeometryTable>,
    /// Where the tracker stands.
    pub base: Option<BaseTable>,
    /// How what carries the robot yields, where the readings have it (`fit.stiffness_measured_from` is `floor`): it is
    /// taken as stated, and the springs are found without it.
    pub base_compliance: Option<BaseComplianceTable>,
    /// What is identified.
    pub fit: Option<FitTable>,
    /// Which measurements to choose. Needed by `plan` alone.
    pub plan: Option<PlanTable>,
}

/// Known geometry of a gravity compensator, a spring between two points, one on either link of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CompensatorGeometryTable {
    /// Number of the joint.
    pub joint: Whole<1, 6>,
    /// Distance of the spring's one end from the joint axis.
    pub a_mm: Mm<Positive>,
    /// Distance of its other end from the joint axis.
    pub l_mm: Mm<Positive>,
    /// Angle between the two ends about the joint axis, less half a turn, at joint angle 0.
    pub alpha_deg: Deg,
}

/// Where the tracker stands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BaseTable {
    /// Rotation from the base frame of the robot to the tracker's frame, by rows, to start the search from; without it
    /// all orientations are tried. Exactly one of this and the four keys below.
    pub rotation: Option<Matrix>,
    /// The same as KUKA's A, B, C: Rz(A) Ry(B) Rx(C).
    pub abc_deg: Option<Vector<Deg>>,
    /// The same as Fanuc's W, P, R: Rz(R) Ry(P) Rx(W).
    pub wpr_deg: Option<Vector<Deg>>,
    /// The same as roll, pitch, yaw of a URDF: Rz(y) Ry(p) Rx(r).
    pub rpy_deg: Option<Vector<Deg>>,
    /// The same as ABB's quaternion.
    pub quaternion_wxyz: Option<Quaternion>,
}

/// What is identified.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct FitTable {
    /// Whether parameters that the readings do not determine keep their values of the robot file; false where left out,
    /// and then such a sheet is refused.
    pub reduce: Option<bool>,
    /// Which springs are sought: those about the joint axes, `axes` (where left out), or those about z, x and y of the
    /// frame of every row, `full`.
    pub model: Option<Word<FitModel>>,
    /// What the measuring instrument stood on, `base` (of the robot) or `floor`: the robot file that is made says so.
    /// Needed where `model` is `full`.
    pub stiffness_measured_from: Option<Word<MeasuredFrom>>,
    /// What keeps its compliance of the robot file: numbers of joints, whose springs are all held, or names of springs,
    /// `joints[3].z` about the axis, `joints[3].x` and `joints[3].y` normal to it; not all.
    pub hold: Option<List<HeldSprings>>,
    /// Whether joint 2 has one compliance for each of its angles without a compensator too; false where left out.
    pub distinct_q2: Option<bool>,
    /// Angles of the joint beside the compensator that differ by no more than this count as one; 0.05 where left out.
    pub angle_tolerance_deg: Option<Deg<AngleTolerance>>,
}

/// Which measurements to choose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlanTable {
    /// Number of configurations to measure; where left out, 20, and 60 for springs about three directions of every
    /// joint (`fit.model = "full"`).
    pub configurations: Option<Whole<1, 1000>>,
    /// Size of the load.
    pub load_n: N<Positive>,
    /// Directions of the load in the base frame, whose z axis points up: `any` (where left out), `horizontal`,
    /// `vertical` (down, as a weight hangs), or a list.
    pub load_directions: Option<Directions>,
    /// About where the reference points are, in the flange frame.
    pub reference_points_mm: List<Vector<Mm>>,
    /// Angles of the joint beside the compensator, in ascending order; without a compensator of joint 2, and then any
    /// angle where left out.
    pub levels_deg: Option<List<Deg>>,
    /// Joint limits for measuring, where narrower ones than those of the robot are needed.
    pub limits_deg: Option<Array<Interval<Deg>, 6>>,
    /// No reference point may move further; 10 where left out.
    pub max_deflection_mm: Option<Mm<Positive>>,
    /// The point whose deflection is to be known, in the flange frame; the load point where left out.
    pub tip_mm: Option<Vector<Mm>>,
    /// Number of random poses at which it is to be known, under the load in any direction; 200 where left out.
    pub tests: Option<Whole<1, 100000>>,
    /// Poses and loads at which it is to be known, in place of `tests`.
    pub test: Option<Vec<TestTable>>,
    /// Random configurations to choose from; 2000 where left out, or `configurations` if that is more.
    pub candidates: Option<Whole<2, 100000>>,
    /// Seed of all random numbers: the same seed gives the same result; 1 where left out.
    pub seed: Option<Whole<0, 9223372036854775807>>,
    /// Starts of the search: a greedy one, the best random set, and others; 8 where left out.
    pub starts: Option<Whole<2, 100000>>,
    /// Random sets to compare with; 1000 where left out.
    pub random_sets: Option<Whole<1, 100000>>,
    /// A compliance with a larger expected standard deviation is warned of; 20 where left out.
    pub hardly_seen_percent: Option<Percent<Positive>>,
    /// Where wrist, flange, tip, load and reference points must be, in the base frame; anywhere where left out.
    pub volume: Option<VolumeTable>,
}

/// Where wrist, flange, tip, load and reference points must be, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VolumeTable {
    /// Range `[min, max]` of the x coordinate; any where left out.
    pub x_mm: Option<Interval<Mm>>,
    /// Range `[min, max]` of the y coordinate; any where left out.
    pub y_mm: Option<Interval<Mm>>,
    /// Range `[min, max]` of the z coordinate; any where left out.
    pub z_mm: Option<Interval<Mm>>,
    /// Least distance from the z axis; 0 where left out.
    pub min_radius_mm: Option<Mm<NotNegative>>,
}

/// A pose and a load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TestTable {
    /// Joint angles.
    pub joints_deg: Array<Deg, 6>,
    /// Force at the tip, in the base frame.
    pub force_n: Vector<N>,
    /// Moment at the tip, in the base frame; 0 where left out.
    pub moment_nm: Option<Vector<Nm>>,
}
