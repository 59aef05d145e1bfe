//! Rotation vectors, the logarithms of rotations (SO(3)): along the axis of a rotation, as long as its angle.

use nalgebra::{Matrix3, Vector3};

/// The vector of a rotation by less than half a turn, its logarithm. rad
pub fn rotation_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let sine =
        Vector3::new(rotation.m32 - rotation.m23, rotation.m13 - rotation.m31, rotation.m21 - rotation.m12) * 0.5;
    let length = sine.norm();
    let angle = libm::atan2(length, (rotation.trace() - 1.0) * 0.5);
    if length > 0.0 { sine * (angle / length) } else { sine }
}

/// The rotation of a vector (rad), its exponential: the formula of Rodrigues.
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;
    use proptest::prelude::*;

    #[test]
    fn small_large_and_no_rotations_come_back() {
        for v in [vector![0.3, -0.2, 0.9], vector![1e-9, 2e-9, -3e-9], vector![2.0, 1.5, -1.0], Vector3::zeros()] {
            let found = rotation_vector(nalgebra::Rotation3::new(v).matrix());
            assert!((found - v).norm() < 1e-14, "{found}");
        }
    }

    proptest! {
        #[test]
        fn formula_agrees_with_the_rotations_of_nalgebra(v in prop::array::uniform3(-1.8..1.8_f64), scale in 0..9_i32) {
            let v = Vector3::from(v) * libm::pow(10.0, -f64::from(scale));
            let found = rotation_from_vector(&v);
            prop_assert!((found - nalgebra::Rotation3::new(v).matrix()).norm() < 1e-15 * 8.0, "{}", found);
            if v.norm() < 3.0 {
                prop_assert!((rotation_vector(&found) - v).norm() < 1e-14, "{}", v);
            }
        }

        #[test]
        fn there_and_back(x in -1.7..1.7_f64, y in -1.7..1.7_f64, z in -1.7..1.7_f64, power in 0..9_i32) {
            let vector = Vector3::new(x, y, z) * libm::pow(10.0, -f64::from(power));
            let rotation = rotation_from_vector(&vector);
            prop_assert!((rotation * rotation.transpose() - Matrix3::identity()).norm() < 1e-14);
            prop_assert!((rotation * vector - vector).norm() < 1e-14);
            prop_assert!((rotation_vector(&rotation) - vector).norm() < 1e-14 + 1e-13 * vector.norm());
        }
    }

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let rotation = rotation_from_vector(&Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        assert!((rotation * Vector3::x() - Vector3::y()).norm() < 1e-15);
    }
}
