//! How a point answers to the joint compliances (Klimchik et al. 2017, eq. 15, 16).
//!
//! A wrench acts at the load point, the deflection is read at a reference point: the column of joint j is
//! `J_j(reference) (J_j(load)^T w)`, with the Jacobian at two points.

use super::sheet::Configuration;
use nalgebra::{Matrix3x6, Vector3};
use stead_model::robot::{Frames, Robot};

/// The observation matrix of one point in one configuration: deflection per joint compliance, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Displacement of the point. m per rad/(N m)
    pub linear: Matrix3x6<f64>,
    /// Rotation of the flange. rad per rad/(N m)
    pub angular: Matrix3x6<f64>,
}

impl Response {
    /// For the arm's joint frames, the place read and the place of the load (m, base frame), and the wrench there.
    pub fn new(
        frames: &Frames<f64>,
        read: &Vector3<f64>,
        load: &Vector3<f64>,
        force: &Vector3<f64>,
        moment: &Vector3<f64>,
    ) -> Self {
        let mut response = Self { linear: Matrix3x6::zeros(), angular: Matrix3x6::zeros() };
        for joint in 0..6 {
            let torque = torque(frames, joint, load, force, moment);
            let (velocity, axis) = frames.twist(joint, read);
            response.linear.set_column(joint, &(velocity * torque));
            response.angular.set_column(joint, &(axis * torque));
        }
        response
    }

    /// Of a configuration of a sheet, for a point given in the flange frame.
    pub fn of(robot: &Robot, configuration: &Configuration, load_point: &Vector3<f64>, point: &Vector3<f64>) -> Self {
        let frames = Frames::new(robot, &configuration.theta);
        let [read, load] = [point, load_point].map(|place| frames.base_from_flange.point(place));
        Self::new(&frames, &read, &load, &configuration.force, &configuration.moment)
    }
}

/// The torque of a wrench at a place (m, base frame) about a joint (from 0). N m
pub(super) fn torque(
    frames: &Frames<f64>,
    joint: usize,
    place: &Vector3<f64>,
    force: &Vector3<f64>,
    moment: &Vector3<f64>,
) -> f64 {
    let (velocity, axis) = frames.twist(joint, place);
    velocity.dot(force) + axis.dot(moment)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector6;
    use proptest::prelude::*;
    use stead_model::robot::testing::odd_arms;
    use stead_model::stiffness::displacement;

    proptest! {
        #[test]
        fn deflection_at_the_load_point_is_that_of_the_stiffness_room_and_the_rest_follows_as_a_rigid_body(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-500.0..500.0_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let frames = Frames::new(robot, &theta);
            let [load, read] = [Vector3::new(0.1, -0.3, 0.2), Vector3::new(0.4, 0.1, -0.2)].map(|p| frames.base_from_flange.point(&p));
            let (force, moment) = (Vector3::new(wrench[0], wrench[1], wrench[2]), Vector3::new(wrench[3], wrench[4], wrench[5]));
            let compliances = [1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6];
            let moved = displacement(&frames, &load, &compliances, &force, &moment);
            let response = Response::new(&frames, &read, &load, &force, &moment);
            let linear = response.linear * Vector6::from(compliances);
            let angular = response.angular * Vector6::from(compliances);
            prop_assert!((angular - moved.angular).norm() < 1e-14);
            prop_assert!((linear - (moved.linear + moved.angular.cross(&(read - load)))).norm() < 1e-14);
        }
    }
}
