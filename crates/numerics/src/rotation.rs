//! Rotations (SO(3)): vectors along the axis and as long as the angle (the logarithms), angles about z, y and x,
//! quaternions, and matrices as people print them.

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

/// `Rz(z) Ry(y) Rx(x)`, angles in rad: KUKA's A, B, C; Fanuc's R, P, W; yaw, pitch, roll of a URDF.
pub fn rotation_from_zyx(angles: [f64; 3]) -> Matrix3<f64> {
    let [(sz, cz), (sy, cy), (sx, cx)] = angles.map(libm::sincos);
    Matrix3::new(
        cz * cy,
        cz * sy * sx - sz * cx,
        cz * sy * cx + sz * sx,
        sz * cy,
        sz * sy * sx + cz * cx,
        sz * sy * cx - cz * sx,
        -sy,
        cy * sx,
        cy * cx,
    )
}

/// The angles about z, y and x of a rotation, the second in [-pi/2, pi/2]: the inverse of [`rotation_from_zyx`]. Where
/// the second is a right angle only the sum or the difference of the others counts; the third is then zero. rad
pub fn zyx_from_rotation(rotation: &Matrix3<f64>) -> [f64; 3] {
    let level = libm::hypot(rotation.m11, rotation.m21);
    let y = libm::atan2(-rotation.m31, level);
    // Below this the two other angles are noise, and together they are as good as their sum.
    if level < 1e-9 {
        return [libm::atan2(-rotation.m12, rotation.m22), y, 0.0];
    }
    [libm::atan2(rotation.m21, rotation.m11), y, libm::atan2(rotation.m32, rotation.m33)]
}

/// The rotation of a quaternion [w, x, y, z], which need not have length 1; nothing for one without a length.
pub fn rotation_from_quaternion(quaternion: [f64; 4]) -> Option<Matrix3<f64>> {
    let norm = libm::sqrt(quaternion.iter().map(|v| v * v).sum());
    if !(norm > 0.0 && norm.is_finite()) {
        return None;
    }
    let [w, x, y, z] = quaternion.map(|v| v / norm);
    Some(Matrix3::new(
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    ))
}

/// The quaternion [w, x, y, z] of a rotation, of length 1, the first of its numbers that is not zero above zero.
pub fn quaternion_from_rotation(rotation: &Matrix3<f64>) -> [f64; 4] {
    let m = rotation;
    // Four times the squares of the components; the largest is never small.
    let squares = [
        1.0 + m.m11 + m.m22 + m.m33,
        1.0 + m.m11 - m.m22 - m.m33,
        1.0 - m.m11 + m.m22 - m.m33,
        1.0 - m.m11 - m.m22 + m.m33,
    ];
    let (wx, wy, wz) = (m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12);
    let (xy, xz, yz) = (m.m12 + m.m21, m.m13 + m.m31, m.m23 + m.m32);
    let rows = [[squares[0], wx, wy, wz], [wx, squares[1], xy, xz], [wy, xy, squares[2], yz], [wz, xz, yz, squares[3]]];
    let largest = (1..4).fold(0, |best, k| if squares[k] > squares[best] { k } else { best });
    let row = rows[largest];
    let first = row.iter().copied().find(|v| v.abs() > 1e-12).unwrap_or(1.0);
    let norm = libm::copysign(libm::sqrt(row.iter().map(|v| v * v).sum()), first);
    row.map(|v| v / norm)
}

/// How far a printed rotation matrix may be from orthonormal: eight printed digits.
pub const ROTATION_TOLERANCE: f64 = 1e-6;

/// A rotation matrix as printed (rows), made orthonormal to rounding.
///
/// # Errors
/// A sentence that says what is wrong with the matrix: not finite, columns not of unit length, not at right angles,
/// or left-handed.
pub fn orthonormal(printed: &Matrix3<f64>) -> Result<Matrix3<f64>, String> {
    if printed.iter().any(|v| !v.is_finite()) {
        return Err("must be made of finite numbers".to_owned());
    }
    let [x, y, z] = [0, 1, 2].map(|k| printed.column(k).into_owned());
    for (name, column) in [("first", x), ("second", y), ("third", z)] {
        if (column.norm() - 1.0).abs() > ROTATION_TOLERANCE {
            return Err(format!("is no rotation: its {name} column has length {:.6} and not 1", column.norm()));
        }
    }
    let pairs = [("first and second", x.dot(&y)), ("second and third", y.dot(&z)), ("third and first", z.dot(&x))];
    for (names, dot) in pairs {
        if dot.abs() > ROTATION_TOLERANCE {
            return Err(format!("is no rotation: its {names} columns are not at right angles (dot product {dot:.6})"));
        }
    }
    if x.cross(&y).dot(&z) < 0.0 {
        return Err("is no rotation but a reflection: its determinant is -1".to_owned());
    }
    let z = z.normalize();
    let x = (x - z * z.dot(&x)).normalize();
    Ok(Matrix3::from_columns(&[x, z.cross(&x), z]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{matrix, vector};
    use proptest::prelude::*;

    #[test]
    fn small_large_and_no_rotations_come_back() {
        for v in [vector![0.3, -0.2, 0.9], vector![1e-9, 2e-9, -3e-9], vector![2.0, 1.5, -1.0], Vector3::zeros()] {
            let found = rotation_vector(nalgebra::Rotation3::new(v).matrix());
            assert!((found - v).norm() < 1e-14, "{found}");
        }
    }

    #[test]
    fn refuses_what_is_no_rotation() {
        assert!(orthonormal(&(Matrix3::identity() * 1.01)).is_err());
        assert!(orthonormal(&Matrix3::from_diagonal(&vector![1.0, 1.0, -1.0])).is_err());
        assert!(orthonormal(&matrix![1.0, 0.1, 0.0; 0.0, 0.995, 0.0; 0.0, 0.0, 1.0]).is_err());
        assert!(orthonormal(&Matrix3::from_element(f64::NAN)).is_err());
        // Half the square root of two, as printed with eight digits.
        let h = 70_710_678.0 / 1e8;
        let printed = matrix![0.0, -h, h; 1.0, 0.0, 0.0; 0.0, h, h];
        let error = orthonormal(&printed).map(|r| (r * r.transpose() - Matrix3::identity()).abs().max());
        assert!(error.is_ok_and(|e| e < 1e-15));
    }

    #[test]
    fn angles_at_the_singularity_give_the_same_rotation() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for y in [quarter, -quarter] {
            let rotation = rotation_from_zyx([0.7, y, 0.4]);
            let angles = zyx_from_rotation(&rotation);
            assert!(angles[2] == 0.0 && (rotation_from_zyx(angles) - rotation).norm() < 1e-15, "{angles:?}");
        }
    }

    proptest! {
        #[test]
        fn angles_about_z_y_and_x_are_three_rotations(z in -3.1..3.1_f64, y in -1.57..1.57_f64, x in -3.1..3.1_f64) {
            let about = |axis: Vector3<f64>, angle: f64| *nalgebra::Rotation3::new(axis * angle).matrix();
            let product = about(Vector3::z(), z) * about(Vector3::y(), y) * about(Vector3::x(), x);
            let rotation = rotation_from_zyx([z, y, x]);
            prop_assert!((rotation - product).norm() < 1e-15 * 8.0);
            let back = rotation_from_zyx(zyx_from_rotation(&rotation));
            prop_assert!((back - rotation).norm() < 1e-15 * 16.0);
        }

        #[test]
        fn quaternions_are_those_of_nalgebra(v in prop::array::uniform3(-1.8..1.8_f64), half: bool) {
            // Half turns have no first component.
            let v = if half { Vector3::from(v).normalize() * std::f64::consts::PI } else { Vector3::from(v) };
            let rotation = *nalgebra::Rotation3::new(v).matrix();
            let quaternion = quaternion_from_rotation(&rotation);
            prop_assert!((quaternion.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-14);
            prop_assert!(quaternion.iter().find(|v| v.abs() > 1e-12).is_some_and(|v| *v > 0.0));
            let tripled = rotation_from_quaternion(quaternion.map(|v| v * 3.0)).unwrap();
            prop_assert!((tripled - rotation).norm() < 1e-14, "{:?}", quaternion);
            let theirs = nalgebra::UnitQuaternion::new(v);
            let dot = theirs.w * quaternion[0] + theirs.i * quaternion[1] + theirs.j * quaternion[2] + theirs.k * quaternion[3];
            prop_assert!((dot.abs() - 1.0).abs() < 1e-14);
        }

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
