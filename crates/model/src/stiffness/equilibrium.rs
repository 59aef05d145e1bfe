//! The static equilibrium of an arm under load, with the geometry as it is when deflected.
//!
//! Each joint is driven to a commanded angle and gives way behind its drive until its torque balances the load:
//! `K_theta (theta - theta_0) = J(theta)^T w`, where force and moment keep their directions in space and act on the
//! displaced point. K_theta is that of the commanded configuration (Klimchik et al. 2017, eq. 12: it depends on q, not
//! on the deflection). Of several equilibria the one is found that the arm comes to as the load grows from zero.

#[cfg(any(test, feature = "testing"))]
use super::Displacement;
use super::loaded::{inverse_tangent, load_hessian, scale};
use crate::robot::{Frames, Robot};
use nalgebra::{SMatrix, SVector, Vector3, Vector6};
#[cfg(any(test, feature = "testing"))]
use stead_numerics::rotation::rotation_vector;

/// A load acting at a point of the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Where it acts, in the flange frame. m
    pub point: Vector3<f64>,
    /// Force in the base frame. N
    pub force: Vector3<f64>,
    /// Moment in the base frame. N m
    pub moment: Vector3<f64>,
}

/// On the way to the full load the arm buckled, or deflected so wildly that it could not be followed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the arm has no stable equilibrium beyond {share:.3} of the load")]
pub struct NoEquilibrium {
    /// The share of the load up to which it was followed, from zero to one.
    pub share: f64,
}

/// The joint angles (rad) at which the arm, commanded to `theta` (rad), rests under a load. The difference is what the
/// joints give way behind their drives.
///
/// # Errors
/// [`NoEquilibrium`] when the arm gives way before the load is complete.
pub fn equilibrium(robot: &Robot, theta: &[f64; 6], load: &Load) -> Result<[f64; 6], NoEquilibrium> {
    equilibrium_with(robot, &robot.compliances_at(theta), theta, load)
}

/// As [`equilibrium`], with other joint compliances than the robot's in rad/(N m), none of them negative.
///
/// # Errors
/// Those of [`equilibrium`].
pub fn equilibrium_with(
    robot: &Robot,
    compliances: &[f64; 6],
    theta: &[f64; 6],
    load: &Load,
) -> Result<[f64; 6], NoEquilibrium> {
    let scale = scale(&Frames::new(robot, theta), compliances);
    // Deflections are scaled: theta - theta_0 = S x.
    let turned = |deflection: &Vector6<f64>| {
        let turns = scale * deflection;
        std::array::from_fn(|j| theta[j] + turns[j])
    };
    let deflection = loaded_in_steps(Vector6::zeros(), |share, start| {
        let (force, moment) = (load.force * share, load.moment * share);
        let wrench = Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
        settled(&scale, start, |deflection| {
            let frames = Frames::new(robot, &turned(deflection));
            let point = frames.base_from_flange.point(&load.point);
            let inverse = inverse_tangent(&load_hessian(&frames, &point, &force, &moment), &scale).ok()?;
            Some((inverse, frames.jacobian(&point).transpose() * wrench))
        })
    })?;
    Ok(turned(&deflection))
}

/// Displacement of the point of a load and rotation of the tool, from the commanded configuration `theta` (rad) to the
/// equilibrium, in the base frame. The rotation must be below half a turn.
///
/// # Errors
/// Those of [`equilibrium`].
#[cfg(any(test, feature = "testing"))]
pub fn displaced(robot: &Robot, theta: &[f64; 6], load: &Load) -> Result<Displacement<f64>, NoEquilibrium> {
    let before = robot.forward(theta);
    let after = robot.forward(&equilibrium(robot, theta, load)?);
    Ok(Displacement {
        linear: after.point(&load.point) - before.point(&load.point),
        angular: rotation_vector(&(after.rotation * before.rotation.transpose())),
    })
}

/// The load is not applied in smaller steps than this share.
const MIN_LOAD_STEP: f64 = 1.0 / 4096.0;
/// Newton steps at the most; convergence is quadratic.
const MAX_STEPS: usize = 20;
/// A Newton step that turns a joint farther than this does not follow the arm any more. rad
const WIDEST_STEP: f64 = 0.5;
/// A Newton step below this is the last: the next would be below its square. rad
const LAST_STEP: f64 = 1e-9;

/// The deflection under the whole load, from none, in steps so large that each can be followed: `settle` takes the
/// share of the load and the deflection before.
pub(super) fn loaded_in_steps<D: Copy>(unloaded: D, settle: impl Fn(f64, D) -> Option<D>) -> Result<D, NoEquilibrium> {
    let (mut deflection, mut share, mut step) = (unloaded, 0.0_f64, 1.0);
    while share < 1.0 {
        let next = (share + step).min(1.0);
        match settle(next, deflection) {
            Some(settled) => {
                (deflection, share) = (settled, next);
                step *= 2.0;
            }
            None if step > MIN_LOAD_STEP => step /= 2.0,
            None => return Err(NoEquilibrium { share }),
        }
    }
    Ok(deflection)
}

/// Newton's method on `x - S^T tau(S x) = 0` with the tangent `1 - S^T H S`: `at` gives the inverse of the tangent and
/// the torques tau at a deflection x; `None` where it leads through a configuration that does not hold.
pub(super) fn settled<const N: usize>(
    scale: &SMatrix<f64, N, N>,
    mut deflection: SVector<f64, N>,
    at: impl Fn(&SVector<f64, N>) -> Option<(SMatrix<f64, N, N>, SVector<f64, N>)>,
) -> Option<SVector<f64, N>> {
    let mut is_last = false;
    for _ in 0..MAX_STEPS {
        let (inverse, torques) = at(&deflection)?;
        if is_last {
            return Some(deflection);
        }
        let step = inverse * (scale.tr_mul(&torques) - deflection);
        let widest = (scale * step).amax();
        if !widest.is_finite() || widest > WIDEST_STEP {
            return None;
        }
        deflection += step;
        is_last = widest <= LAST_STEP;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::{displacement, loaded::loaded_compliance, loaded::loaded_displacement};
    use super::*;
    use crate::robot::testing::{kr270, linked_arms, odd_arms};
    use nalgebra::vector;
    use proptest::prelude::*;

    fn load(wrench: [f64; 6]) -> Load {
        let [fx, fy, fz, mx, my, mz] = wrench;
        Load { point: vector![0.1, -0.3, 0.2], force: vector![fx, fy, fz], moment: vector![mx, my, mz] }
    }

    fn scaled(load: &Load, share: f64) -> Load {
        Load { force: load.force * share, moment: load.moment * share, ..*load }
    }

    proptest! {
        #[test]
        fn torques_balance_and_the_loaded_compliance_is_its_slope(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-2e4..2e4_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let compliances = robot.compliances_at(&theta);
            let full = load(wrench);
            let rest = equilibrium(robot, &theta, &full).unwrap();
            let frames = Frames::new(robot, &rest);
            let point = frames.base_from_flange.point(&full.point);
            let torques = frames.jacobian(&point).transpose() * Vector6::from(wrench);
            for j in 0..6 {
                prop_assert!((rest[j] - theta[j] - compliances[j] * torques[j]).abs() < 1e-13);
            }
            let found = loaded_compliance(&frames, &point, &compliances, &full.force, &full.moment).unwrap();
            let h = 10.0;
            for k in 0..6 {
                let at = |side: f64| {
                    let mut more = wrench;
                    more[k] += side * h;
                    robot.forward(&equilibrium(robot, &theta, &load(more)).unwrap())
                };
                let (up, down) = (at(1.0), at(-1.0));
                let linear = (up.point(&full.point) - down.point(&full.point)) / (2.0 * h);
                let angular = rotation_vector(&(up.rotation * down.rotation.transpose())) / (2.0 * h);
                prop_assert!((found.fixed_view::<3, 1>(0, k) - linear).norm() < 1e-6 * found.norm());
                prop_assert!((found.fixed_view::<3, 1>(3, k) - angular).norm() < 1e-6 * found.norm());
            }
        }

        #[test]
        fn torques_balance_at_the_springs_of_a_linkage(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-2e4..2e4_f64), arm in 0..32_usize
        ) {
            let robot = &linked_arms()[arm];
            let fold = robot.geometry().fold;
            let compliances = robot.compliances_at(&theta);
            let full = load(wrench);
            let rest = equilibrium(robot, &theta, &full).unwrap();
            let frames = Frames::new(robot, &rest);
            let point = frames.base_from_flange.point(&full.point);
            let mut torques = frames.jacobian(&point).transpose() * Vector6::from(wrench);
            torques[1] -= fold * torques[2];
            let turned: [f64; 6] = std::array::from_fn(|j| rest[j] - theta[j]);
            let springs = [turned[0], turned[1], turned[2] + fold * turned[1], turned[3], turned[4], turned[5]];
            for j in 0..6 {
                prop_assert!((springs[j] - compliances[j] * torques[j]).abs() < 1e-13);
            }
            // At small loads it is the linear displacement, and that of equation 11.
            let small = scaled(&full, 1e-5);
            let truth = displaced(robot, &theta, &small).unwrap();
            let frames = Frames::new(robot, &theta);
            let point = frames.base_from_flange.point(&small.point);
            let plain = displacement(&frames, &point, &compliances, &small.force, &small.moment);
            let loaded = loaded_displacement(&frames, &point, &compliances, &small.force, &small.moment).unwrap();
            for other in [plain, loaded] {
                prop_assert!((truth.linear - other.linear).norm() < 1e-4 * plain.linear.norm() + 1e-14);
            }
        }

        #[test]
        fn linear_and_loaded_displacements_are_off_by_the_square_of_the_load(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-10.0..10.0_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let compliances = robot.compliances_at(&theta);
            let frames = Frames::new(robot, &theta);
            let error = |share: f64| {
                let load = scaled(&load(wrench), share);
                let point = frames.base_from_flange.point(&load.point);
                let truth = displaced(robot, &theta, &load).unwrap();
                let plain = displacement(&frames, &point, &compliances, &load.force, &load.moment);
                let loaded = loaded_displacement(&frames, &point, &compliances, &load.force, &load.moment).unwrap();
                [plain, loaded].map(|d| {
                    Vector6::from_iterator((truth.linear - d.linear).iter().chain((truth.angular - d.angular).iter()).copied())
                })
            };
            let third = third_order(robot, &load(wrench));
            let (full, half) = (error(1.0), error(0.5));
            for (full, half) in full.iter().zip(half) {
                prop_assert!((half * 4.0 - full).norm() < third, "{} {}", full, half);
            }
        }

        #[test]
        fn equation_11_has_two_thirds_of_the_second_order_part_along_the_force(
            theta in prop::array::uniform6(-3.0..3.0_f64), force in prop::array::uniform3(-10.0..10.0_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let compliances = robot.compliances_at(&theta);
            let frames = Frames::new(robot, &theta);
            let load = load([force[0], force[1], force[2], 0.0, 0.0, 0.0]);
            let point = frames.base_from_flange.point(&load.point);
            let along = |d: Displacement<f64>| d.linear.dot(&load.force);
            let plain = along(displacement(&frames, &point, &compliances, &load.force, &load.moment));
            let loaded = along(loaded_displacement(&frames, &point, &compliances, &load.force, &load.moment).unwrap());
            let truth = along(displaced(robot, &theta, &load).unwrap());
            let third = third_order(robot, &load) * load.force.norm();
            prop_assert!((truth - plain - 1.5 * (loaded - plain)).abs() < third, "{} {} {}", plain, loaded, truth);
        }
    }

    /// A bound of what is of third order in the load, from the largest turn of the joints that a load on an arm of less
    /// than 3 m can cause. m
    fn third_order(robot: &Robot, load: &Load) -> f64 {
        let compliance: f64 = robot.compliances_at(&[0.0; 6]).iter().sum();
        (compliance * (3.0 * load.force.norm() + load.moment.norm())).powi(3) + 1e-14
    }

    /// Joint 2 alone yields, at the tool 2 m above it; all others are as good as rigid.
    fn column(compliance: f64) -> (Robot, [f64; 6], Vector3<f64>) {
        let theta = [0.0, 1.2, -2.0, 0.0, 1.0, 0.0];
        let mut compliances = [1e-30; 6];
        compliances[1] = compliance;
        let robot = kr270().with_compliances(compliances).unwrap();
        let frames = Frames::new(&robot, &theta);
        let point = frames.base_from_flange.inverse().point(&(frames.origins[1] + vector![0.0, 0.0, 2.0]));
        (robot, theta, point)
    }

    #[test]
    fn a_column_pulled_aside_turns_as_far_as_its_hinge_balances() {
        let (robot, theta, point) = column(1e-5);
        for (fx, fz) in [(1e3, 0.0), (2e4, -3e4), (3e3, -8e4), (5e4, 1e5)] {
            let load = Load { point, force: vector![fx, 0.0, fz], moment: Vector3::zeros() };
            // x = 2 sin t, z = 2 cos t; turning t against the joint's sense.
            let rest = equilibrium(&robot, &theta, &load).unwrap();
            let t = -(rest[1] - theta[1]);
            let (sine, cosine) = libm::sincos(t);
            assert!((t / 1e-5 - 2.0 * (fx * cosine - fz * sine)).abs() < 1e-8, "{t}");
            assert!(t > 0.0 && 1e5 + 2.0 * (fx * sine + fz * cosine) > 0.0);
            let moved = displaced(&robot, &theta, &load).unwrap();
            assert!((moved.linear - vector![2.0 * sine, 0.0, 2.0 * cosine - 2.0]).norm() < 1e-12);
            assert!((moved.angular - vector![0.0, t, 0.0]).norm() < 1e-12);
        }
    }

    #[test]
    fn a_column_pressed_straight_down_buckles_at_its_load() {
        let (robot, theta, point) = column(1e-5);
        let pressed = |force: f64| {
            let load = Load { point, force: vector![0.0, 0.0, -force], moment: Vector3::zeros() };
            equilibrium(&robot, &theta, &load)
        };
        assert!(pressed(4.99e4).is_ok());
        let NoEquilibrium { share } = pressed(1e5).unwrap_err();
        assert!((share - 0.5).abs() < 1e-3, "{share}");
        let load = Load { point, force: vector![f64::NAN, 0.0, 0.0], moment: Vector3::zeros() };
        assert_eq!(equilibrium(&robot, &theta, &load), Err(NoEquilibrium { share: 0.0 }));
    }
}
