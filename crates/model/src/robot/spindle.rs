//! The spindle on the flange.

use super::{Inertial, Pose};
use nalgebra::{Matrix3, Vector3};
use stead_numerics::scalar::Scalar;

/// Rotation from the tool frame to frame P_i of a path point (x along the feed, z along the tool axis from the workpiece to
/// the robot) for a free angle beta in rad: Caro 2013, eq. 10, which is its own inverse. The tool's z axis points from the
/// robot to the workpiece, and at beta zero its x axis lies along the feed.
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
    /// How far a given rotation matrix may be from orthonormal: eight printed digits.
    pub const ROTATION_TOLERANCE: f64 = 1e-6;

    /// Takes a rotation matrix as printed (rows) and a translation in m; the rotation is made orthonormal to rounding.
    ///
    /// # Errors
    /// A sentence that says what is wrong with the matrix: not finite, columns not of unit length, not at right angles,
    /// or left-handed.
    pub fn new(rotation: Matrix3<f64>, translation: Vector3<f64>) -> Result<Self, String> {
        if rotation.iter().chain(translation.iter()).any(|v| !v.is_finite()) {
            return Err("must be made of finite numbers".to_owned());
        }
        let tolerance = Self::ROTATION_TOLERANCE;
        let x = rotation.column(0).into_owned();
        let y = rotation.column(1).into_owned();
        let z = rotation.column(2).into_owned();
        for (name, column) in [("first", x), ("second", y), ("third", z)] {
            if (column.norm() - 1.0).abs() > tolerance {
                return Err(format!("is no rotation: its {name} column has length {:.6} and not 1", column.norm()));
            }
        }
        for (names, dot) in
            [("first and second", x.dot(&y)), ("second and third", y.dot(&z)), ("third and first", z.dot(&x))]
        {
            if dot.abs() > tolerance {
                return Err(format!(
                    "is no rotation: its {names} columns are not at right angles (dot product {dot:.6})"
                ));
            }
        }
        if x.cross(&y).dot(&z) < 0.0 {
            return Err("is no rotation but a reflection: its determinant is -1".to_owned());
        }
        let z = z.normalize();
        let x = (x - z * z.dot(&x)).normalize();
        let rotation = Matrix3::from_columns(&[x, z.cross(&x), z]);
        Ok(Self { flange_from_tool: Pose { rotation, translation }, payload: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{matrix, vector};

    #[test]
    fn refuses_what_is_no_rotation() {
        let here = vector![0.0, 0.0, 0.0];
        assert!(Spindle::new(Matrix3::identity() * 1.01, here).is_err());
        assert!(Spindle::new(Matrix3::from_diagonal(&vector![1.0, 1.0, -1.0]), here).is_err());
        let shear = matrix![1.0, 0.1, 0.0; 0.0, 0.995, 0.0; 0.0, 0.0, 1.0];
        assert!(Spindle::new(shear, here).is_err());
        assert!(Spindle::new(Matrix3::identity(), vector![f64::NAN, 0.0, 0.0]).is_err());
        // Half the square root of two, as printed with eight digits.
        let h = 70_710_678.0 / 1e8;
        let printed = matrix![0.0, -h, h; 1.0, 0.0, 0.0; 0.0, h, h];
        let rotation = Spindle::new(printed, here).map(|s| s.flange_from_tool.rotation);
        let error = rotation.map(|r| (r * r.transpose() - Matrix3::identity()).abs().max());
        assert!(error.is_ok_and(|e| e < 1e-15));
    }
}
