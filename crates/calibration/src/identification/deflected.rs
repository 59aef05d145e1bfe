//! The arm in one configuration under its load: how far it deflects, and how that changes with the compliances.
//!
//! At small loads the deflection is linear in the compliances. At 10 mm that is off by as much as half a percent, at 30
//! mm by two, since the load turns its own levers; so the arm is taken to its exact static equilibrium,
//! `q = C tau(q)` with the elastic turns q behind the drives, the diagonal matrix C of the compliances and tau = J^T w.
//! From there `dq = (1 - C H)^-1 diag(tau) dc`, with H the derivative of the torques by the turns ([`super::elastic`]).

use super::elastic::{Elastic, Rest};
use super::response::Response;
use super::sheet::Configuration;
use super::springs::AXES;
use nalgebra::{Matrix3, SVector, Vector3};
use stead_model::robot::Robot;
use stead_model::stiffness::Displacement;
use stead_model::stiffness::equilibrium::{Load, NoEquilibrium};
use stead_model::stiffness::whole::of_matrix;
use stead_numerics::rotation::rotation_vector;

/// An arm in a configuration under load. Springs are in the order of [`super::springs`].
#[derive(Debug, Clone)]
pub struct Deflected<'a, const N: usize> {
    configuration: &'a Configuration,
    /// Where the wrench acts, in the flange frame. m
    load_point: &'a Vector3<f64>,
    /// The compliances. rad/(N m)
    compliances: SVector<f64, N>,
    before: Elastic<N>,
    /// What carries the arm, moved by the load as a small displacement at the load point, where it yields.
    base: Option<Displacement<f64>>,
    /// At rest under the load; nothing where the deflection is taken to be linear in it.
    rest: Option<Rest<N>>,
}

impl<'a, const N: usize> Deflected<'a, N> {
    /// An arm with these compliances (rad/(N m)) and a load at a point of the flange frame (m), its deflection linear
    /// in both.
    pub fn linear(
        robot: &Robot,
        compliances: SVector<f64, N>,
        configuration: &'a Configuration,
        load_point: &'a Vector3<f64>,
    ) -> Self {
        let before = Elastic::unloaded(robot, &configuration.theta);
        let base = of_base(robot, &before, configuration, load_point);
        Self { configuration, load_point, compliances, before, base, rest: None }
    }

    /// The same in its exact static equilibrium. Among springs about the axes alone a negative compliance is taken for
    /// zero; among all, where it may stand for a difference of two, it counts as it is.
    ///
    /// # Errors
    /// [`NoEquilibrium`] where the arm gives way under the load.
    pub fn at_rest(
        robot: &Robot,
        compliances: SVector<f64, N>,
        configuration: &'a Configuration,
        load_point: &'a Vector3<f64>,
    ) -> Result<Self, NoEquilibrium> {
        let compliances = if N == AXES { compliances.map(|compliance| compliance.max(0.0)) } else { compliances };
        let Configuration { theta, force, moment, .. } = configuration;
        let load = Load { point: *load_point, force: *force, moment: *moment };
        let rest = Some(Rest::new(robot, &compliances, theta, &load)?);
        let before = Elastic::unloaded(robot, theta);
        let base = of_base(robot, &before, configuration, load_point);
        Ok(Self { configuration, load_point, compliances, before, base, rest })
    }

    /// The compliances with which it deflects so. rad/(N m)
    pub fn compliances(&self) -> &SVector<f64, N> {
        &self.compliances
    }

    /// Where a point of the flange frame (m) is without the load, in the base frame. m
    pub fn unloaded(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.before.base_from_flange.point(point)
    }

    /// How far the load moves a point of the flange frame (m) and turns the flange, in the base frame.
    pub fn displacement(&self, point: &Vector3<f64>) -> Displacement<f64> {
        let moved = self.by_springs(point);
        let Some(base) = &self.base else { return moved };
        let lever = self.unloaded(point) - self.unloaded(self.load_point);
        let linear = moved.linear + base.linear + base.angular.cross(&lever);
        Displacement { linear, angular: moved.angular + base.angular }
    }

    /// The same by the springs of the arm alone.
    fn by_springs(&self, point: &Vector3<f64>) -> Displacement<f64> {
        match &self.rest {
            None => {
                let Response { linear, angular } = self.response(point);
                Displacement { linear: linear * self.compliances, angular: angular * self.compliances }
            }
            Some(Rest { arm, .. }) => {
                let (before, after) = (&self.before.base_from_flange, &arm.base_from_flange);
                Displacement {
                    linear: after.point(point) - before.point(point),
                    angular: rotation_vector(&(after.rotation * before.rotation.transpose())),
                }
            }
        }
    }

    /// The derivatives of that by the compliances.
    pub fn response(&self, point: &Vector3<f64>) -> Response<N> {
        let Configuration { force, moment, .. } = self.configuration;
        let Some(Rest { arm, turns }) = &self.rest else {
            let [read, load] = [point, self.load_point].map(|place| self.before.base_from_flange.point(place));
            return Response::new(&self.before, &read, &load, force, moment);
        };
        let jacobian = arm.jacobian(&arm.base_from_flange.point(point)) * turns;
        let turned = self.by_springs(point).angular.cross_matrix();
        // From an angular velocity to the derivative of a rotation vector: 1 - [r]/2 + [r]^2/12 - ...
        let slope = Matrix3::identity() - turned / 2.0 + turned * turned / 12.0;
        Response { linear: jacobian.fixed_rows::<3>(0).into_owned(), angular: slope * jacobian.fixed_rows::<3>(3) }
    }
}

/// The displacement of what carries the arm at the load point, where it yields; small, and linear in the load.
fn of_base<const N: usize>(
    robot: &Robot,
    arm: &Elastic<N>,
    configuration: &Configuration,
    load_point: &Vector3<f64>,
) -> Option<Displacement<f64>> {
    let (frame, matrix) = robot.yielding_base()?;
    let place = arm.base_from_flange.point(load_point);
    Some(of_matrix(matrix, &frame, &place, [&configuration.force, &configuration.moment]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector6;
    use proptest::prelude::*;
    use stead_model::robot::testing::{linked_arms, odd_arms};

    proptest! {
        #[test]
        fn responses_are_the_derivatives_of_the_displacement(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-5e3..5e3_f64), arm in 0..32_usize
        ) {
            // Every third arm with a linkage.
            let robot = &if arm % 3 == 0 { linked_arms() } else { odd_arms() }[arm];
            let [load_point, point] = [Vector3::new(0.1, -0.3, 0.2), Vector3::new(0.4, 0.1, -0.2)];
            let configuration = Configuration {
                name: String::new(),
                theta,
                force: Vector3::new(wrench[0], wrench[1], wrench[2]),
                moment: Vector3::new(wrench[3], wrench[4], wrench[5]),
                readings: 0..0,
            };
            let compliances = Vector6::new(0.5e-6, 0.3e-6, 0.4e-6, 3e-6, 3e-6, 2e-6);
            let at = |compliances| Deflected::at_rest(robot, compliances, &configuration, &load_point).unwrap();
            let response = at(compliances).response(&point);
            for joint in 0..6 {
                let step = Vector6::ith(joint, 1e-3 * compliances[joint]);
                let [up, down] = [at(compliances + step), at(compliances - step)].map(|arm| arm.displacement(&point));
                let slope = (up.linear - down.linear) / (2.0 * step[joint]);
                prop_assert!((response.linear.column(joint) - slope).norm() < 1e-6 * response.linear.norm() + 1e-6);
                let slope = (up.angular - down.angular) / (2.0 * step[joint]);
                prop_assert!((response.angular.column(joint) - slope).norm() < 1e-6 * response.angular.norm() + 1e-6);
            }
        }
    }
}
