//! Rotation vectors: axis times angle.

use nalgebra::{Matrix3, Vector3};

/// The rotation matrix of a rotation vector in rad (Rodrigues' formula).
pub fn rotation_from_vector(vector: &Vector3<f64>) -> Matrix3<f64> {
    let square = vector.norm_squared();
    let angle = libm::sqrt(square);
    // Series below an angle at which their next terms are beyond the last digit.
    let (a, b) = if angle < 1e-4 {
        (1.0 - square / 6.0, 0.5 - square / 24.0)
    } else {
        let (sine, cosine) = libm::sincos(angle);
        (sine / angle, (1.0 - cosine) / square)
    };
    let cross = vector.cross_matrix();
    Matrix3::identity() + cross * a + cross * cross * b
}

/// The rotation vector in rad of a rotation matrix, for angles below half a turn.
pub fn vector_from_rotation(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let axial =
        Vector3::new(rotation.m32 - rotation.m23, rotation.m13 - rotation.m31, rotation.m21 - rotation.m12) / 2.0;
    let sine = axial.norm();
    let angle = libm::atan2(sine, (rotation.trace() - 1.0) / 2.0);
    if sine > 1e-12 { axial * (angle / sine) } else { axial }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn there_and_back(x in -1.7..1.7_f64, y in -1.7..1.7_f64, z in -1.7..1.7_f64, power in 0..9_i32) {
            let vector = Vector3::new(x, y, z) * libm::pow(10.0, -f64::from(power));
            let rotation = rotation_from_vector(&vector);
            prop_assert!((rotation * rotation.transpose() - Matrix3::identity()).norm() < 1e-14);
            prop_assert!((rotation * vector - vector).norm() < 1e-14);
            prop_assert!((vector_from_rotation(&rotation) - vector).norm() < 1e-14 + 1e-13 * vector.norm());
        }
    }

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let rotation = rotation_from_vector(&Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        assert!((rotation * Vector3::x() - Vector3::y()).norm() < 1e-15);
    }
}
