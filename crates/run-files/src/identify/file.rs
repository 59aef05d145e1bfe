//! What an identification file declares.

use super::FitModel;
use super::held::HeldSprings;
use super::plan::PlanTable;
use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::Included;
use stead_format::compliance_matrix::BaseComplianceTable;
use stead_format::orientation::Quaternion;
use stead_format::scalars::Whole;
use stead_format::shapes::{List, Matrix, Vector};
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
