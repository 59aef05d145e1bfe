//! The spindle on the flange.

use super::{Inertial, Pose};
use nalgebra::{Matrix3, Vector3};
use stead_numerics::rotation::orthonormal;
use stead_numerics::scalar::Scalar;

/// Rotation from the tool frame to frame P_i of a path point (x along the feed, z along the tool axis from the
/// workpiece to the robot) for a free angle beta in rad: Caro 2013, eq. 10, which is its own inverse. The tool's z axis
/// points from the robot to the workpiece, and at beta zero its x axis lies along the feed.
pub fn point_from_tool<T: Scalar>(beta: T) -> Matrix3<T> {
    let (sine, cosine) = beta.sin_cos();
    let (zero, one) = (T::zero(), T::one());
    Matrix3::new(cosine, sine, zero, sine, -cosine, zero, zero, zero, -one)
}

/// The spindle as mounted: the rigid transform from the tool frame (7, at the tool centre point, z along the tool axis
/// out of the spindle) to the flange frame (6) of the arm (Caro 2013, eq. 9).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spindle {
    /// Coordinates in frame 7 to coordinates in frame 6.
    pub flange_from_tool: Pose<f64>,
    /// Mass of spindle, holder and tool in the flange frame, where known.
    pub payload: Option<Inertial>,
}

impl Spindle {
    /// Takes a rotation matrix as printed (rows) and a translation in m; the rotation is made orthonormal to rounding.
    ///
    /// # Errors
    /// A sentence that says what is wrong with them: not finite, or as [`orthonormal`] says.
    pub fn new(rotation: Matrix3<f64>, translation: Vector3<f64>) -> Result<Self, String> {
        if translation.iter().any(|v| !v.is_finite()) {
            return Err("must be made of finite numbers".to_owned());
        }
        let rotation = orthonormal(&rotation)?;
        Ok(Self { flange_from_tool: Pose { rotation, translation }, payload: None })
    }
}
