//! The spindle on the flange.

use super::{Inertial, PointMass, Pose};
#[cfg(any(test, feature = "testing"))]
use crate::stiffness::matrix::{MatrixError, checked};
use nalgebra::{Matrix3, Matrix6, Vector3};
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
    /// Mass and centre of spindle, holder and tool in the flange frame, where they are known without the inertia.
    pub point_mass: Option<PointMass>,
    /// How the spindle is fixed to the flange, where that yields: displacement and turn (m, rad) per force and moment
    /// (N, N m) at the origin of the flange frame, in that frame.
    pub mount: Option<Matrix6<f64>>,
    /// How holder and tool yield at the tool centre point: displacement (m) per force (N), in the tool frame.
    pub tip: Option<Matrix3<f64>>,
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
        Ok(Self::rigid(Pose { rotation, translation }))
    }

    /// A spindle of which nothing but the place of the tool is known; it does not yield.
    pub fn rigid(flange_from_tool: Pose<f64>) -> Self {
        Self { flange_from_tool, payload: None, point_mass: None, mount: None, tip: None }
    }

    /// Mass of all that the flange carries, and its centre in the flange frame, where they are known.
    pub fn carried_mass(&self) -> Option<PointMass> {
        self.payload.map(|body| body.point_mass()).or(self.point_mass)
    }

    /// The same fixed to the flange so that it yields by a matrix in the flange frame at its origin: displacement and
    /// turn (m, rad) per force and moment (N, N m).
    ///
    /// # Errors
    /// [`MatrixError`] for a matrix that is no compliance.
    #[cfg(any(test, feature = "testing"))]
    pub fn with_mount(self, matrix: Matrix6<f64>) -> Result<Self, MatrixError> {
        Ok(Self { mount: Some(checked(matrix)?), ..self })
    }

    /// The same with a holder and a tool that yield by a matrix in the tool frame: displacement (m) per force (N).
    ///
    /// # Errors
    /// [`MatrixError`] for a matrix that is no compliance.
    #[cfg(any(test, feature = "testing"))]
    pub fn with_tip(self, matrix: Matrix3<f64>) -> Result<Self, MatrixError> {
        Ok(Self { tip: Some(checked(matrix)?), ..self })
    }
}
