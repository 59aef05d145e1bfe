//! How a point answers to the joint compliances (Klimchik et al. 2017, eq. 15, 16).
//!
//! A wrench acts at the load point, the deflection is read at a reference point: the column of joint j is
//! `J_j(reference) (J_j(load)^T w)`, with the Jacobian at two points.

use super::elastic::Elastic;
use super::sheet::Configuration;
use nalgebra::{SMatrix, Vector3};
use stead_model::robot::Robot;

/// The observation matrix of one point in one configuration: deflection per compliance, in the base frame. Springs are
/// columns in the order of [`super::springs`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<const N: usize> {
    /// Displacement of the point. m per rad/(N m)
    pub linear: SMatrix<f64, 3, N>,
    /// Rotation of the flange. rad per rad/(N m)
    pub angular: SMatrix<f64, 3, N>,
}

impl<const N: usize> Response<N> {
    /// For the arm in a configuration, the place read and the place of the load (m, base frame), and the wrench there.
    pub fn new(
        arm: &Elastic<N>,
        read: &Vector3<f64>,
        load: &Vector3<f64>,
        force: &Vector3<f64>,
        moment: &Vector3<f64>,
    ) -> Self {
        let mut response = Self { linear: SMatrix::zeros(), angular: SMatrix::zeros() };
        for column in 0..N {
            let torque = arm.torque(column, load, force, moment);
            let (velocity, axis) = arm.twist(column, read);
            response.linear.set_column(column, &(velocity * torque));
            response.angular.set_column(column, &(axis * torque));
        }
        response
    }

    /// Of a configuration of a sheet, for a point given in the flange frame.
    pub fn of(robot: &Robot, configuration: &Configuration, load_point: &Vector3<f64>, point: &Vector3<f64>) -> Self {
        let arm = Elastic::unloaded(robot, &configuration.theta);
        let [read, load] = [point, load_point].map(|place| arm.base_from_flange.point(place));
        Self::new(&arm, &read, &load, &configuration.force, &configuration.moment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector6;
    use proptest::prelude::*;
    use stead_model::robot::Frames;
    use stead_model::robot::testing::{linked_arms, odd_arms};
    use stead_model::stiffness::displacement;

    proptest! {
        #[test]
        fn deflection_at_the_load_point_is_that_of_the_stiffness_room_and_the_rest_follows_as_a_rigid_body(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-500.0..500.0_f64), arm in 0..32_usize
        ) {
            let robot = &if arm % 3 == 0 { linked_arms() } else { odd_arms() }[arm];
            let frames = Frames::new(robot, &theta);
            let [load, read] = [Vector3::new(0.1, -0.3, 0.2), Vector3::new(0.4, 0.1, -0.2)].map(|p| frames.base_from_flange.point(&p));
            let (force, moment) = (Vector3::new(wrench[0], wrench[1], wrench[2]), Vector3::new(wrench[3], wrench[4], wrench[5]));
            let compliances = [1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6];
            let moved = displacement(&frames, &load, &compliances, &force, &moment);
            let response = Response::<6>::new(&Elastic::unloaded(robot, &theta), &read, &load, &force, &moment);
            let linear = response.linear * Vector6::from(compliances);
            let angular = response.angular * Vector6::from(compliances);
            prop_assert!((angular - moved.angular).norm() < 1e-14);
            prop_assert!((linear - (moved.linear + moved.angular.cross(&(read - load)))).norm() < 1e-14);
        }
    }
}
