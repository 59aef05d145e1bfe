//! Forward kinematics: where the joint axes and the flange are for given joint angles, and the geometric Jacobian.

use super::Robot;
use super::pose::{Pose, cast};
use nalgebra::{Matrix3, SMatrix, Vector3};
use stead_numerics::scalar::Scalar;

/// The joint frames of an arm in one configuration, in base coordinates; in those of the cell for an arm that is
/// mounted ([`Robot::mounted`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames<T: Scalar> {
    /// Unit vectors of the six joint axes.
    pub axes: [Vector3<T>; 6],
    /// A point on each joint axis: the origin of the frame fixed to the joint. m
    pub origins: [Vector3<T>; 6],
    /// The frames of the rows, which turn with their joints: rotations to base coordinates.
    pub rotations: [Matrix3<T>; 6],
    /// Frame 6 in the base frame.
    pub base_from_flange: Pose<T>,
    /// On an arm with a linkage, by how much axis 3 turns back where axis 2 yields and the forearm keeps its direction.
    held: Option<f64>,
}

impl<T: Scalar> Frames<T> {
    /// The frames for joint angles `theta` in rad, joint limits ignored.
    pub fn new(robot: &Robot, theta: &[T; 6]) -> Self {
        let mut pose = robot.cell_from_base::<T>();
        let mut axes = [Vector3::zeros(); 6];
        let mut origins = [Vector3::zeros(); 6];
        let mut rotations = [Matrix3::zeros(); 6];
        for (j, row) in robot.rows().iter().enumerate() {
            // Rx(alpha) Rz(theta), with the translation of the row.
            let (sa, ca) = (T::constant(row.rotation[(2, 1)]), T::constant(row.rotation[(1, 1)]));
            let (st, ct) = theta[j].sin_cos();
            let rotation = Matrix3::new(ct, -st, T::zero(), st * ca, ct * ca, -sa, st * sa, ct * sa, ca);
            pose = pose.then(&Pose { rotation, translation: cast(&row.translation) });
            axes[j] = pose.rotation.column(2).into_owned();
            origins[j] = pose.translation;
            rotations[j] = pose.rotation;
        }
        let held = robot.has_linkage().then_some(robot.geometry().fold);
        Self { axes, origins, rotations, base_from_flange: pose, held }
    }

    /// Where axes 4, 5 and 6 meet. m
    pub fn wrist_centre(&self) -> Vector3<T> {
        self.origins[3]
    }

    /// Linear and angular velocity of a body point at `point` (m, base frame) per unit speed of joint `j` (from 0).
    pub fn twist(&self, j: usize, point: &Vector3<T>) -> (Vector3<T>, Vector3<T>) {
        (self.axes[j].cross(&(point - self.origins[j])), self.axes[j])
    }

    /// The same per unit turn of the spring that yields with joint `j` about its axis: on an arm with a linkage that of
    /// joint 2 turns the upper arm and leaves the forearm its direction.
    #[inline]
    pub fn twist_yielding(&self, j: usize, point: &Vector3<T>) -> (Vector3<T>, Vector3<T>) {
        let (velocity, axis) = self.twist(j, point);
        let Some(held) = self.held.filter(|_| j == 1) else { return (velocity, axis) };
        let (back, around) = self.twist(2, point);
        (velocity - back.map(|entry| entry.scale(held)), axis - around.map(|entry| entry.scale(held)))
    }

    /// On an arm with a linkage, by how much joint 3 turns back where the spring of joint 2 turns.
    pub fn held(&self) -> Option<f64> {
        self.held
    }

    /// Turns of the joints per unit turn of the springs that yield about their axes: the identity but on an arm with a
    /// linkage.
    pub fn joints_by_springs(&self) -> SMatrix<f64, 6, 6> {
        let mut turns = SMatrix::identity();
        if let Some(held) = self.held {
            turns[(2, 1)] = -held;
        }
        turns
    }

    /// The same of a turn about a direction normal to the axis of joint `j`, x (0) or y (1) of the frame of its row, at
    /// a place on the axis, `bearing` (m) from the origin of that frame.
    pub fn twist_normal(&self, j: usize, about: usize, bearing: f64, point: &Vector3<T>) -> (Vector3<T>, Vector3<T>) {
        let axis = self.rotations[j].column(about).into_owned();
        let place = self.origins[j] + self.axes[j].map(|entry| entry.scale(bearing));
        (axis.cross(&(point - place)), axis)
    }

    /// The geometric Jacobian at `point` (m, base frame): rows are linear velocity (m/s) and angular velocity (rad/s),
    /// columns are the joints, base first.
    pub fn jacobian(&self, point: &Vector3<T>) -> SMatrix<T, 6, 6> {
        let mut jacobian = SMatrix::<T, 6, 6>::zeros();
        for j in 0..6 {
            let (linear, angular) = self.twist(j, point);
            jacobian.fixed_view_mut::<3, 1>(0, j).copy_from(&linear);
            jacobian.fixed_view_mut::<3, 1>(3, j).copy_from(&angular);
        }
        jacobian
    }
}

impl Robot {
    /// The frames of the six rows in base coordinates, in those of the cell for an arm that is mounted, for joint
    /// angles `theta` in rad, each fixed to its link.
    pub fn link_frames(&self, theta: &[f64; 6]) -> [Pose<f64>; 6] {
        let mut pose = self.cell_from_base();
        std::array::from_fn(|j| {
            let row = &self.rows()[j];
            let (sine, cosine) = libm::sincos(theta[j]);
            let turned = Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
            pose = pose.then(&Pose { rotation: row.rotation * turned, translation: row.translation });
            pose
        })
    }

    /// Frame 6 in the base frame for joint angles `theta` in rad, joint limits ignored.
    pub fn forward<T: Scalar>(&self, theta: &[T; 6]) -> Pose<T> {
        Frames::new(self, theta).base_from_flange
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{kr270, odd_arms};
    use super::*;
    use proptest::prelude::*;
    use stead_numerics::rotation::rotation_from_zyx;

    #[test]
    fn the_frames_of_links_are_those_of_the_joints() {
        let mount = Pose { rotation: rotation_from_zyx([0.4, -1.1, 2.0]), translation: Vector3::new(0.3, -0.7, 1.9) };
        let arms = || odd_arms().into_iter().chain([kr270()]);
        for robot in &arms().chain(arms().map(|arm| arm.mounted(&mount))).collect::<Vec<_>>() {
            let theta = [0.3, -0.4, 0.7, 1.1, -0.9, 2.0];
            let (links, frames) = (robot.link_frames(&theta), Frames::new(robot, &theta));
            for j in 0..6 {
                assert!((links[j].translation - frames.origins[j]).norm() < 1e-12);
                assert!((links[j].rotation.column(2) - frames.axes[j]).norm() < 1e-12);
            }
            assert!((links[5].rotation - frames.base_from_flange.rotation).norm() < 1e-12);
        }
    }

    #[test]
    fn stretched_arm_reaches_the_sum_of_its_lengths() {
        let robot = kr270();
        let theta = [0.0, 0.0, -robot.geometry().forearm_angle, 0.0, 0.0, 0.0];
        let wrist = Frames::new(&robot, &theta).wrist_centre();
        let expected = 0.35 + 1.25 + libm::hypot(0.055, 1.1);
        assert!((wrist - Vector3::new(expected, 0.0, 0.0)).norm() < 1e-12, "{wrist}");
    }

    proptest! {
        #[test]
        fn jacobian_agrees_with_differences_of_the_forward_kinematics(
            theta in prop::array::uniform6(-3.0..3.0_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let tool = Vector3::new(0.1, -0.2, 0.3);
            let tip = |theta: &[f64; 6]| robot.forward(theta).point(&tool);
            let frames = Frames::new(robot, &theta);
            let jacobian = frames.jacobian(&tip(&theta));
            let h = 1e-6;
            for j in 0..6 {
                let (mut up, mut down) = (theta, theta);
                up[j] += h;
                down[j] -= h;
                let linear = (tip(&up) - tip(&down)) / (2.0 * h);
                prop_assert!((jacobian.fixed_view::<3, 1>(0, j) - linear).norm() < 1e-8);
                let spin = (robot.forward(&up).rotation - robot.forward(&down).rotation) / (2.0 * h)
                    * frames.base_from_flange.rotation.transpose();
                let angular = Vector3::new(spin.m32, spin.m13, spin.m21);
                prop_assert!((jacobian.fixed_view::<3, 1>(3, j) - angular).norm() < 1e-8);
            }
        }
    }
}
