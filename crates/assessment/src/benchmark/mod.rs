//! The benchmark of Klimchik 2017, section 4.2: a circle milled under a force that turns with the tool, and what the
//! yielding arm makes of it (eq. 33 and 34).
//!
//! The circle lies in a plane of the cell. At polar angle phi the tip of the tool should be at `p_0 + R(phi) r`; the
//! wrench `R(phi) (F, M)` moves it by `K_C^-1 R(phi) (F, M)`, the moment through the rotational Jacobian (eq. 34 as
//! corrected). The parts of the displaced points in the plane are the machined profile, and its circularity is taken
//! about the least-squares circle (eq. 28 to 32). To first order, with the force turning with the tool, the
//! displacement is that of a quadratic form: a mean shift of radius, and an ellipse that no shift of the centre
//! removes, so that the circularity is `|F| (lambda_max - lambda_min)` of the in-plane compliance, whatever the
//! direction of the force.

mod deflected_circle;
#[cfg(test)]
mod tests;

pub use deflected_circle::{DeflectedCircle, Profile};

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;
use std::f64::consts::PI;
use stead_model::robot::Pose;
use stead_model::stiffness::loaded::Buckled;
use stead_model::task::Wrench;

/// A plane of the cell with two axes of its own, in the robot base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Where both coordinates are zero. m
    pub origin: Vector3<f64>,
    /// First axis, of unit length.
    pub x: Vector3<f64>,
    /// Second axis, of unit length and normal to the first.
    pub y: Vector3<f64>,
}

impl Plane {
    /// The vertical plane XOZ through the base axis, that of Klimchik 2017: first axis X, second axis Z.
    pub const XOZ: Self =
        Self { origin: Vector3::new(0.0, 0.0, 0.0), x: Vector3::new(1.0, 0.0, 0.0), y: Vector3::new(0.0, 0.0, 1.0) };

    /// The normal `x cross y`, about which polar angles are counted.
    pub fn normal(&self) -> Vector3<f64> {
        self.x.cross(&self.y)
    }

    /// A point of the plane in the base frame. m
    pub fn point(&self, place: [f64; 2]) -> Vector3<f64> {
        self.origin + self.x * place[0] + self.y * place[1]
    }
}

stead_numerics::worded! {
    /// Sense in which the wrench turns as the tool follows the circle.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Turning {
        /// By the polar angle, as the tool and its feed do (eq. 34 as written).
        WithTool = "with-tool",
        /// By the negative polar angle. No cut does that, but it comes nearest to the published tables; the circularity
        /// is then `|F| (lambda_max + lambda_min)` to first order.
        AgainstTool = "against-tool",
    }
}

stead_numerics::worded! {
    /// Where the limits of the joints are checked.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum LimitsAt {
        /// At every point of the circle: the whole circle can be milled in one posture.
        Circle = "circle",
        /// At its centre only. The circle may then have points that the joints cannot reach.
        Centre = "centre",
    }
}

/// The deflection of one pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StiffnessModel {
    /// The unloaded compliance (eq. 9 and 10): linear in the force.
    Unloaded,
    /// The compliance of the loaded arm (eq. 11).
    Loaded,
}

/// Largest deflection, in radii of the circle and apart from what all its points have in common, at which what is left
/// is still read as a circle: far beyond it the best circle about the points can be quite another one.
pub const MAX_DEFLECTION: f64 = 0.25;

/// A joint that moves by more than this between neighbouring points of a circle jumps. rad
const JUMP: f64 = PI / 2.0;

/// A circle to be milled, and how its deflection is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Benchmark {
    /// The plane of the circle.
    pub plane: Plane,
    /// Radius of the circle. m
    pub radius: f64,
    /// Number of points on the circle, evenly spaced from polar angle 0.
    pub points: usize,
    /// What the workpiece does to the tool at polar angle 0: along the radius outwards, along the direction of growing
    /// polar angle, and along the normal of the plane. N, N m
    pub wrench: Wrench,
    /// Which way the wrench turns.
    pub turning: Turning,
    /// Orientation of the tool frame, constant around the circle.
    pub base_from_tool: Matrix3<f64>,
    /// The tool frame, its origin at the point that follows the circle, in the flange frame. `None`: the wrist centre
    /// follows it, with the flange frame's own orientation.
    pub flange_from_tool: Option<Pose<f64>>,
    /// Which joints yield, about their axes and normal to them as far as their springs are known; the others count as
    /// rigid, and so do base and spindle.
    pub yielding: [bool; 6],
    /// Where limits are checked.
    pub limits_at: LimitsAt,
    /// How a wrench becomes a deflection.
    pub stiffness: StiffnessModel,
}

/// Why a circle cannot be milled at a place in a posture class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Obstacle {
    /// Part of the circle is out of the arm's geometric reach.
    Reach,
    /// A joint, counted from 1, would leave its limits.
    JointLimit(usize),
    /// The sum of joints 2 and 3 would leave its limits.
    AxesSum,
    /// A joint, counted from 1, would have to jump: the circle leads through a singularity.
    Singularity(usize),
    /// The arm would buckle under the load (loaded stiffness only).
    Buckling,
    /// The load would deflect the circle by more than a quarter of its radius ([`MAX_DEFLECTION`]).
    TooSoft,
}

impl From<Buckled> for Obstacle {
    fn from(_: Buckled) -> Self {
        Self::Buckling
    }
}

impl Benchmark {
    /// Size of the force in the plane of the circle. N
    pub fn in_plane_force(&self) -> f64 {
        libm::hypot(self.wrench.force.x, self.wrench.force.y)
    }
}
