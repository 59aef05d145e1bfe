//! Distance of a configuration from a singularity: the condition number of the normalised Jacobian.
//!
//! `kappa_F = (1/6) sqrt(tr(N N^T) tr((N N^T)^-1))` with N the Jacobian at the tool centre point, its position rows
//! divided by the characteristic length (Caro 2013, eq. 26, after their reference 8); 1/kappa_F is in (0, 1].
//!
//! A spherical wrist makes the Jacobian at the wrist centre block triangular, so its inverse needs two 3x3 inverses
//! only.

use super::forward::Frames;
use nalgebra::{Matrix3, Vector3};
use stead_numerics::scalar::Scalar;

/// 1/kappa_F in [0, 1]; zero in a singularity. `point` is the tool centre point (m, base frame), `length` the
/// characteristic length (m).
pub fn inverse_condition<T: Scalar>(frames: &Frames<T>, point: &Vector3<T>, length: f64) -> T {
    let centre = frames.wrist_centre();
    let lever = point - centre;
    let mut position = Matrix3::<T>::zeros();
    let mut turn_arm = Matrix3::<T>::zeros();
    let mut turn_wrist = Matrix3::<T>::zeros();
    let mut norm2 = T::constant(6.0);
    for j in 0..6 {
        let (linear, angular) = frames.twist(j, point);
        norm2 += linear.dot(&linear).scale(1.0 / (length * length));
        if j < 3 {
            position.set_column(j, &frames.twist(j, &centre).0);
            turn_arm.set_column(j, &angular);
        } else {
            turn_wrist.set_column(j - 3, &angular);
        }
    }
    let (Some(inverse_arm), Some(inverse_wrist)) = (inverse(&position), inverse(&turn_wrist)) else {
        return T::zero();
    };
    let cross = Matrix3::new(T::zero(), -lever.z, lever.y, lever.z, T::zero(), -lever.x, -lever.y, lever.x, T::zero());
    let spin = turn_arm * inverse_arm;
    let blocks = [
        inverse_arm * T::constant(length),
        inverse_arm * cross,
        inverse_wrist * spin * T::constant(length),
        inverse_wrist * (Matrix3::identity() - spin * cross),
    ];
    let mut inverse_norm2 = T::zero();
    for block in blocks {
        for entry in block.iter() {
            inverse_norm2 += *entry * *entry;
        }
    }
    T::constant(6.0) / (norm2 * inverse_norm2).sqrt()
}

/// The inverse by cofactors, where the determinant is not zero.
fn inverse<T: Scalar>(matrix: &Matrix3<T>) -> Option<Matrix3<T>> {
    let (a, b, c) = (matrix.column(0).into_owned(), matrix.column(1).into_owned(), matrix.column(2).into_owned());
    let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
    let determinant = a.dot(&bc);
    if determinant.value() == 0.0 {
        return None;
    }
    let factor = T::one() / determinant;
    Some(Matrix3::from_rows(&[bc.transpose(), ca.transpose(), ab.transpose()]) * factor)
}

#[cfg(test)]
mod tests {
    use super::super::testing::odd_arms;
    use super::*;
    use nalgebra::SMatrix;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn blocks_agree_with_the_full_inverse(theta in prop::array::uniform6(-3.0..3.0_f64), arm in 0..32_usize) {
            let robot = &odd_arms()[arm];
            let frames = Frames::new(robot, &theta);
            let point = frames.base_from_flange.point(&Vector3::new(0.1, 0.2, 0.4));
            let length = 0.682;
            let mut scaled: SMatrix<f64, 6, 6> = frames.jacobian(&point);
            for k in 0..3 {
                scaled.row_mut(k).scale_mut(1.0 / length);
            }
            let full = scaled.try_inverse().map_or(0.0, |i| 6.0 / (scaled.norm() * i.norm()));
            let blocks = inverse_condition(&frames, &point, length);
            prop_assert!((0.0..=1.0 + 1e-12).contains(&blocks));
            prop_assert!((blocks - full).abs() < 1e-9, "{} {}", blocks, full);
        }
    }

    #[test]
    fn zero_in_a_wrist_singularity() {
        let robot = super::super::testing::kr270();
        let frames = Frames::new(&robot, &[0.0, 0.5, -1.5, 0.0, 0.0, 0.0]);
        let point = frames.base_from_flange.point(&Vector3::new(0.0, 0.0, 0.5));
        assert!(inverse_condition(&frames, &point, 0.682) < 1e-12);
    }
}
