//! Deflection of the arm: joint compliances mapped to the tool centre point.
//!
//! With rigid links and compliant joints the Cartesian compliance is `J K_theta^-1 J^T` (Caro 2013, eq. 12 as
//! corrected: no complementary stiffness). [`displacement`] inverts no matrix: it is a sum over the joints,
//! `K^-1 w = sum_j J_j (J_j . w) / k_j`. Loads so high that they change the configuration are for [`loaded`] (the
//! tangent, Klimchik et al. 2017, eq. 11) and [`equilibrium`] (where the arm comes to rest); what yields beside the
//! joints about their axes is for [`whole`], with the weight and at rest under a load for [`elastic`]. Rotations are
//! vectors here: [`stead_numerics::rotation`].

pub mod elastic;
pub mod equilibrium;
pub mod loaded;
pub mod matrix;
pub mod whole;

use crate::robot::Frames;
use nalgebra::Vector3;
use serde::Serialize;
use stead_numerics::scalar::Scalar;

/// Small displacement of the tool under a wrench, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Displacement<T: Scalar> {
    /// Displacement of the point. m
    pub linear: Vector3<T>,
    /// Rotation vector. rad
    pub angular: Vector3<T>,
}

/// The displacement at `point` (m) under `force` (N) and `moment` (N m) acting there, all in the base frame, for joint
/// compliances at the pose in rad/(N m) ([`Robot::compliances_at`](crate::robot::Robot::compliances_at)).
pub fn displacement<T: Scalar>(
    frames: &Frames<T>,
    point: &Vector3<T>,
    compliances: &[T; 6],
    force: &Vector3<T>,
    moment: &Vector3<T>,
) -> Displacement<T> {
    let mut linear = Vector3::zeros();
    let mut angular = Vector3::zeros();
    for (j, compliance) in compliances.iter().enumerate() {
        let (velocity, axis) = frames.twist(j, point);
        let yielding = (velocity.dot(force) + axis.dot(moment)) * *compliance;
        linear += velocity * yielding;
        angular += axis * yielding;
    }
    Displacement { linear, angular }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::testing::{kr270, odd_arms};
    use nalgebra::{Matrix6, Vector6, vector};
    use proptest::prelude::*;

    #[test]
    fn a_single_soft_joint_turns_the_tool_about_its_axis() {
        let robot = kr270();
        let frames = Frames::new(&robot, &[0.0, 1.2, -2.0, 0.0, 1.0, 0.0]);
        let point = vector![1.5, 0.0, 0.2];
        let moved = displacement(
            &frames,
            &point,
            &[1e-6, 0.0, 0.0, 0.0, 0.0, 0.0],
            &vector![0.0, 100.0, 0.0],
            &Vector3::zeros(),
        );
        // 100 N on a lever of 1.5 m turn joint 1 by 150e-6 rad, which moves the point by 0.225 mm.
        assert!((moved.linear - vector![0.0, 2.25e-4, 0.0]).norm() < 1e-15);
        assert!((moved.angular - vector![0.0, 0.0, 1.5e-4]).norm() < 1e-15);
    }

    proptest! {
        #[test]
        fn sum_over_joints_is_the_matrix_product(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-500.0..500.0_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let frames = Frames::new(robot, &theta);
            let point = frames.base_from_flange.point(&vector![0.1, -0.3, 0.2]);
            let jacobian = frames.jacobian(&point);
            let compliances = robot.compliances_at(&theta);
            let stiffness = Matrix6::from_diagonal(&Vector6::from(compliances.map(|c| 1.0 / c)));
            let wrench = Vector6::from(wrench);
            let expected = jacobian * stiffness.try_inverse().unwrap() * jacobian.transpose() * wrench;
            let (force, moment) = (wrench.fixed_rows::<3>(0).into_owned(), wrench.fixed_rows::<3>(3).into_owned());
            let found = displacement(&frames, &point, &compliances, &force, &moment);
            prop_assert!((found.linear - expected.fixed_rows::<3>(0)).norm() < 1e-12);
            prop_assert!((found.angular - expected.fixed_rows::<3>(3)).norm() < 1e-12);
        }
    }
}
