//! A row of a plan.

use super::origins::OriginColumns;
use super::setup::{AxisColumns, at_point};
use crate::figure::{AngleDeg, DeflectionMm, ForceN, PlaceMm, Plain, each, some};
use crate::names;
use schemars::JsonSchema;
use serde::Serialize;
use stead_cell::Scene;
use stead_model::robot::Posture;
use stead_model::robot::turns::turns;
use stead_placement::outcome::PlanPoint;
use stead_problem::setup::AxisPath;

records! {
    /// A path point of a plan. Places are those of the tool centre point, and all vectors are in the robot base frame.
    pub struct PlanRow of (point: &PlanPoint, axes: &[AxisPath], scene: Option<&Scene>) {
        /// Path point, from 0.
        point: usize = point.point,
        /// Segment, from 1.
        segment: usize = point.segment,
        /// x of the tool centre point.
        x_mm: PlaceMm = point.position.x.into(),
        /// y of the tool centre point.
        y_mm: PlaceMm = point.position.y.into(),
        /// z of the tool centre point.
        z_mm: PlaceMm = point.position.z.into(),
        /// Angle about the tool axis.
        beta_deg: AngleDeg = point.beta.into(),
        /// Posture, 1 to 8.
        #[schemars(with = "u8")] posture: Posture = point.posture,
        /// The same in words: front or back; elbow up or down; flip or no flip.
        posture_words: String = names::posture_cell(point.posture_words),
        /// Full turns of joint 1 beyond (-180, 180] deg.
        turn_1: i32 = turns(point.joints[0]),
        /// Full turns of joint 4.
        turn_4: i32 = turns(point.joints[3]),
        /// Full turns of joint 6.
        turn_6: i32 = turns(point.joints[5]),
        #[serde(flatten)] joints: JointColumns<AngleDeg> = point.joints.into(),
        /// Inverse of the condition number of the Jacobian.
        inverse_condition: Plain = point.inverse_condition.into(),
        /// x of the force on the tool.
        force_x_n: ForceN = point.force.x.into(),
        /// y of the force on the tool.
        force_y_n: ForceN = point.force.y.into(),
        /// z of the force on the tool.
        force_z_n: ForceN = point.force.z.into(),
        /// x of the deflection.
        deflection_x_mm: DeflectionMm = point.deflection.x.into(),
        /// y of the deflection.
        deflection_y_mm: DeflectionMm = point.deflection.y.into(),
        /// z of the deflection.
        deflection_z_mm: DeflectionMm = point.deflection.z.into(),
        /// Deflection to the left of the feed, normal to feed and tool axis.
        normal_mm: DeflectionMm = point.normal_part.into(),
        /// Deflection along the feed.
        feed_mm: DeflectionMm = point.feed_part.into(),
        /// Deflection along the tool axis, positive towards the robot.
        axial_mm: DeflectionMm = point.axial_part.into(),
        /// The scored part of the deflection.
        score_mm: DeflectionMm = point.score.into(),
        /// Size of the deflection.
        total_mm: DeflectionMm = point.deflection.norm().into(),
        /// Deflection along the normal of the surface, where the task states it.
        surface_mm?: DeflectionMm = some(point.surface_part),
        /// Standard deviation of the scored part, where the robot's uncertainty is known.
        std_mm?: DeflectionMm = some(point.deviation),
        #[serde(flatten)] origins: Option<OriginColumns> = point.by_origin.as_ref().map(|origins| OriginColumns::of(Some(origins))),
        /// Lead of the tool from the axis of the path, above 0 with the spindle ahead of the tip; where it leans.
        lead_deg?: AngleDeg = some(point.lean.map(|lean| lean.lead)),
        /// Its tilt, above 0 with the spindle to the left of the feed.
        tilt_deg?: AngleDeg = some(point.lean.map(|lean| lean.tilt)),
        #[serde(flatten)] axes: AxisColumns = at_point(axes, point.point),
        #[serde(flatten)] clearance: Option<ClearanceColumns> =
            scene.map(|scene: &Scene| ClearanceColumns::of(scene, point)),
    }
}

/// The joint angles of a row.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
pub(crate) struct JointColumns<A> {
    /// Joint angle 1.
    theta1_deg: A,
    /// Joint angle 2.
    theta2_deg: A,
    /// Joint angle 3.
    theta3_deg: A,
    /// Joint angle 4.
    theta4_deg: A,
    /// Joint angle 5.
    theta5_deg: A,
    /// Joint angle 6.
    theta6_deg: A,
}

impl<A: From<f64>> From<[f64; 6]> for JointColumns<A> {
    fn from(joints: [f64; 6]) -> Self {
        let [theta1_deg, theta2_deg, theta3_deg, theta4_deg, theta5_deg, theta6_deg] = each(joints);
        Self { theta1_deg, theta2_deg, theta3_deg, theta4_deg, theta5_deg, theta6_deg }
    }
}

records! {
    /// The clearance at a path point, among shapes of a cell.
    struct ClearanceColumns of (scene: &Scene, point: &PlanPoint) {
        /// Distance of the pair with the least clearance: zero where the two touch, empty where nothing is nearer than
        /// 1 m.
        clearance_mm: Option<PlaceMm> = point.clearance.map(|clearance| clearance.distance.into()),
        /// That pair.
        nearest_pair: Option<String> =
            point.clearance.and_then(|clearance| scene.pair(clearance.pair)).map(|pair| pair.to_string()),
    }
}
