//! Deflection of the arm: joint compliances mapped to the tool centre point.
//!
//! With rigid links and compliant joints the Cartesian compliance is `J K_theta^-1 J^T` (Caro 2013, eq. 12 as
//! corrected: no complementary stiffness). [`displacement`] inverts no matrix: it is a sum over the joints, `K^-1 w =
//! sum_j J_j (J_j . w) / k_j`, with J_2 - J_3 in the place of J_2 on an arm with a linkage. Loads so high that they
//! change the configuration are for [`loaded`] (the tangent, Klimchik et al. 2017, eq. 11) and [`equilibrium`] (where
//! the arm comes to rest); what yields beside the joints about their axes is for [`whole`], with the weight and at rest
//! under a load for [`elastic`]. Rotations are vectors here: [`stead_numerics::rotation`].

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
        let (velocity, axis) = frames.twist_yielding(j, point);
        let yielding = (velocity.dot(force) + axis.dot(moment)) * *compliance;
        linear += velocity * yielding;
        angular += axis * yielding;
    }
    Displacement { linear, angular }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;
    use crate::robot::testing::{irb4400, kr270, linked_arms, odd_arms};
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

    /// Where the flange of an IRB 4400 is at angles of its controller, and how far a force at it deflects the arm: made
    /// by another program, with springs at `theta_2` and `theta_2 + theta_3`; by finite differences the same to 1e-6
    /// mm.
    #[test]
    fn a_parallelogram_arm_deflects_as_another_program_has_it() {
        // Angles in deg, flange and displacement in mm, its size, and that over the size of an arm in series.
        type Row = ([f64; 6], [f64; 3], [f64; 3], f64, f64);
        const ROWS: [Row; 3] = [
            (
                [0.0, 30.0, 0.0, 0.0, 0.0, 0.0],
                [1665.000, 0.0, 1600.763],
                [-0.113885, 0.166333, 0.237262],
                0.311336,
                0.49,
            ),
            (
                [10.0, -20.0, 35.0, 0.0, 40.0, 0.0],
                [727.504, 128.279, 999.222],
                [0.013261, 0.046530, 0.061977],
                0.078626,
                0.64,
            ),
            (
                [-25.0, 50.0, -10.0, 15.0, 60.0, 0.0],
                [1655.162, -737.190, 1449.435],
                [-0.069345, 0.118382, 0.247161],
                0.282687,
                0.44,
            ),
        ];
        let arm = irb4400();
        let in_series = arm.clone().with_axes_2_3(None).unwrap();
        let (force, none) = (vector![-200.0, 150.0, 300.0], Vector3::zeros());
        for (angles, flange, expected, size, share) in ROWS {
            let theta = arm.controller().unwrap().joints(&arm, &angles.map(f64::to_radians));
            let of = |arm: &Robot| {
                let frames = Frames::new(arm, &theta);
                let point = frames.base_from_flange.translation;
                (point, displacement(&frames, &point, &arm.compliances_at(&theta), &force, &none))
            };
            let (point, moved) = of(&arm);
            assert!((point * 1e3 - Vector3::from(flange)).amax() < 5.1e-4, "{point}");
            assert!((moved.linear * 1e3 - Vector3::from(expected)).amax() < 1e-6, "{}", moved.linear * 1e3);
            assert!((moved.linear.norm() * 1e3 - size).abs() < 1e-6);
            let share_found = moved.linear.norm() / of(&in_series).1.linear.norm();
            assert!((share_found - share).abs() < 5.1e-3, "{share_found}");
        }
    }

    proptest! {
        /// The energy `sum tau_j^2 c_j / 2` in the springs, of torques that differences of the forward kinematics give.
        #[test]
        fn the_springs_of_a_linkage_are_at_axis_2_and_at_the_sum(
            theta in prop::array::uniform6(-3.0..3.0_f64), force in prop::array::uniform3(-500.0..500.0_f64), arm in 0..32_usize
        ) {
            let robot = &linked_arms()[arm];
            let fold = robot.geometry().fold;
            let (force, compliances) = (Vector3::from(force), [1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6]);
            let frames = Frames::new(robot, &theta);
            let point = vector![0.1, -0.3, 0.2];
            let at = |springs: [f64; 6]| {
                let mut theta: [f64; 6] = std::array::from_fn(|j| theta[j] + springs[j]);
                theta[2] -= fold * springs[1];
                robot.forward(&theta).point(&point)
            };
            let h = 1e-5;
            let moves = |j: usize| {
                let turned = |side: f64| at(std::array::from_fn(|k| if k == j { side * h } else { 0.0 }));
                (turned(1.0) - turned(-1.0)) / (2.0 * h)
            };
            let expected: Vector3<f64> =
                (0..6).map(|j| moves(j) * (moves(j).dot(&force) * compliances[j])).sum();
            let found = displacement(&frames, &frames.base_from_flange.point(&point), &compliances, &force, &Vector3::zeros());
            prop_assert!((found.linear - expected).norm() < 1e-11 * force.norm() + 1e-12, "{}", found.linear - expected);
        }

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
