//! What a robot file declares.

use super::one_or_pair::{OneOrPair, OneOrRange};
use crate::inertial::InertiaTable;
use crate::orientation::Quaternion;
use crate::scalars::Word;
use crate::shapes::{Array, List, Matrix, Vector};
use crate::units::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_model::robot::{ControllerKind, MeasuredFrom, SpringModel};

/// A six-axis robot: geometry, joint limits and stiffness, where known speeds, masses and damping. Lengths are in mm
/// and angles in deg, as the keys say; every number needs a source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RobotFile {
    /// Name of the robot, on one line.
    pub name: String,
    /// Where the numbers come from.
    pub source: String,
    /// The arm whose joint stiffness the rows state, where it is not their own; every result says so.
    pub stiffness_like: Option<String>,
    /// What the stiffness stands for: `axes` for a fit of springs about the joint axes alone, `full` for springs about
    /// three directions of every joint, of one identification, `axial_part` for the springs about the axes of such a
    /// set without the others. Not stated where left out: springs normal to the axes are left out of scores then.
    pub stiffness_model: Option<Word<SpringModel>>,
    /// What the instrument stood on when the stiffness was identified: `base` for the base of the robot, `floor` for
    /// the floor, so that the stiffness has what yields under the base in it.
    pub stiffness_measured_from: Option<Word<MeasuredFrom>>,
    /// Which numbers nobody has checked against their source, and what is known of them, a sentence each; said by every
    /// run.
    pub unverified: Option<List<String>>,
    /// Largest payload by the data sheet.
    pub payload_kg: Option<Kg<Positive>>,
    /// Radius of the working range by the data sheet.
    pub working_radius_mm: Option<Mm<Positive>>,
    /// Price.
    pub price_eur: Option<Eur<Positive>>,
    /// How far the mounting flange is beyond the last row along axis 6, where the rows end before it: setup sheet and
    /// programs state the tool on it. Tool frames of run files stay in the frame of the last row.
    pub flange_mm: Option<Mm<NotNegative>>,
    /// How the controller counts joint angles; needed for programs.
    pub controller: Option<ControllerTable>,
    /// Where the base frame of the rows is in the controller's robot root; needed for programs.
    pub root: Option<RootTable>,
    /// What joins axes 2 and 3, beside the ranges of their joints.
    pub axes_2_3: Option<Axes23Table>,
    /// The six joints, base first.
    pub joints: Vec<JointRow>,
    /// How well the compliances are known: what `stead identify fit` writes.
    pub covariance: Option<CovarianceTable>,
}

/// The controller's joint angles A_i against those of the rows: theta_i = sign_i A_i + offset_i.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ControllerTable {
    /// Whose controller it is: it decides which programs can be written.
    pub kind: Word<ControllerKind>,
    /// 1 for each axis that the controller counts in the direction of the row, else -1.
    pub sign: Array<Number, 6>,
    /// Angle of each row where the controller's angle is zero.
    pub offset_deg: Array<Deg, 6>,
    /// Whether the controller counts axis 3 against the horizontal and not against the upper arm: then theta_3 =
    /// sign_3 A_3 + offset_3 - sign_2 A_2. Where left out, true for "fanuc" and false for the others; programs for an
    /// arm with `axes_2_3.linkage` need it stated.
    pub is_j3_level: Option<bool>,
}

/// What joins axes 2 and 3. The sum theta_2 + theta_3 is how far the forearm is turned against the base (theta_2 -
/// theta_3 where `alpha_deg` of row 3 is 180).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Axes23Table {
    /// Whether a parallelogram drives axis 3: speed, acceleration, jerk and stiffness of row 3 are then those of the
    /// sum. False where left out.
    pub linkage: Option<bool>,
    /// Lower limit of the sum.
    pub sum_min_deg: Deg,
    /// Upper limit of the sum.
    pub sum_max_deg: Deg,
}

/// The base frame of the rows in the controller's robot root (`$ROBROOT` of a KUKA).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RootTable {
    /// Origin of the base frame in the root frame.
    pub xyz_mm: Vector<Mm>,
    /// Rotation from base to root coordinates, by rows; exactly one of this and the four keys below.
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

/// One joint, with the link behind it. The frame of a row is that of modified Denavit-Hartenberg parameters: its z axis
/// is the joint axis, its origin is reached after `alpha`, `a` and `d`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointRow {
    /// Angle from the previous joint axis to this one, about the previous x axis (modified Denavit-Hartenberg).
    pub alpha_deg: Deg,
    /// Distance from the previous joint axis to this one, along the previous x axis (modified Denavit-Hartenberg).
    pub a_mm: Mm,
    /// Offset along this joint axis (modified Denavit-Hartenberg).
    pub d_mm: Mm,
    /// Lower limit of the joint angle.
    pub min_deg: Deg,
    /// Upper limit of the joint angle.
    pub max_deg: Deg,
    /// Stiffness of the joint about its axis; either this or `compliance_urad_per_nm`.
    pub stiffness_mnm_per_rad: Option<MnmPerRad<Positive>>,
    /// Compliance of the joint about its axis: one number, or a range `[at min_deg, at max_deg]`, linear in between.
    pub compliance_urad_per_nm: Option<OneOrRange>,
    /// Largest speed of the joint.
    pub max_speed_deg_per_s: Option<DegPerS<Positive>>,
    /// Largest acceleration of the joint.
    pub max_acceleration_deg_per_s2: Option<DegPerS2<Positive>>,
    /// Largest jerk of the joint.
    pub max_jerk_deg_per_s3: Option<DegPerS3<Positive>>,
    /// A gravity compensator beside the joint; the stiffness or compliance of the row is then that of the joint alone.
    pub compensator: Option<CompensatorTable>,
    /// Mass of the link behind the joint. This and the keys below are for `stead simulate`, `stead stability` and
    /// `[stability]` of a run.
    pub mass_kg: Option<Kg<Positive>>,
    /// Centre of mass of the link, in the frame of the row.
    pub centre_of_mass_mm: Option<Vector<Mm>>,
    /// Inertia tensor of the link about its centre of mass, in the directions of the frame of the row.
    pub inertia_kg_m2: Option<InertiaTable>,
    /// Viscous damping about the joint axis.
    pub damping_nms_per_rad: Option<NmsPerRad<NotNegative>>,
    /// Play of the joint to either side; 0 where left out.
    pub half_backlash_arcsec: Option<Arcsec<NotNegative>>,
    /// Whether a compensator carries the gravity load of this joint; false where left out.
    pub gravity_compensated: Option<bool>,
    /// Stiffness against rotation about the two directions normal to the joint axis: one number for both, or `[about x,
    /// about y]` of the frame of the row, which turns with the joint. Scores count it where `stiffness_model` is
    /// `full`.
    pub orthogonal_stiffness_mnm_per_rad: Option<OneOrPair<MnmPerRad<Positive>>>,
    /// Compliance in these directions, in place of the stiffness; 0 is rigid.
    pub orthogonal_compliance_urad_per_nm: Option<OneOrPair<UradPerNm<NotNegative>>>,
    /// Viscous damping in these directions, one number or a pair; needed only beside masses.
    pub orthogonal_damping_nms_per_rad: Option<OneOrPair<NmsPerRad<NotNegative>>>,
    /// Where on the joint axis it yields in these directions: along z from the origin of the row's frame; 0 where left
    /// out.
    pub bearing_mm: Option<Mm>,
}

/// A spring between two points, one on either link of a joint (Klimchik et al. 2017).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CompensatorTable {
    /// Stiffness of the spring.
    pub spring_stiffness_n_per_mm: NPerMm<Positive>,
    /// Distance of the spring's one end from the joint axis.
    pub a_mm: Mm<Positive>,
    /// Distance of its other end from the joint axis.
    pub l_mm: Mm<Positive>,
    /// Angle between the two ends about the joint axis, less half a turn, at joint angle 0.
    pub alpha_deg: Deg,
    /// Length of the spring without force.
    pub free_length_mm: Mm<Positive>,
}

/// Covariance of parameters of the joint compliances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CovarianceTable {
    /// Names of the parameters, as their keys are named: `joints[1].compliance_urad_per_nm`, with `[1]` or `[2]` behind
    /// for the ends of a range, `joints[2].compensator.spring_stiffness_n_per_mm` and `.free_length_mm`,
    /// `joints[3].orthogonal_compliance_urad_per_nm[1]` about x and `[2]` about y.
    pub parameters: List<String>,
    /// Their covariance matrix, in products of the units of the keys; symmetric, positive semidefinite.
    pub matrix: List<List<Number>>,
}
