//! Inverse kinematics in closed form: eight postures of an elbow arm with a spherical wrist.
//!
//! The wrist centre fixes theta_1 (in front or back), the triangle of shoulder, elbow and wrist centre fixes theta_3
//! and theta_2, and the rest of the orientation fixes the wrist (two ways). Where a joint angle is undetermined (wrist
//! centre on axis 1, axes 4 and 6 in line, wrist centre on axis 2) it is set to zero, and the others follow from it.

use super::Robot;
use super::pose::{Pose, cast};
use super::posture::Posture;
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;
use stead_numerics::scalar::Scalar;

/// Why a posture cannot bring the flange to a pose at all, joint limits apart.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, thiserror::Error)]
pub enum Unreachable {
    /// The wrist centre is nearer to axis 1 than the arm's lateral offset.
    #[error("the wrist centre is {by} m too near to axis 1 for the lateral offset of the arm")]
    InsideOffset {
        /// By how much. m
        by: f64,
    },
    /// The wrist centre is farther from the shoulder than upper arm and forearm together.
    #[error("the wrist centre is {by} m beyond the stretched arm")]
    TooFar {
        /// By how much. m
        by: f64,
    },
    /// The wrist centre is nearer to the shoulder than the folded arm.
    #[error("the wrist centre is {by} m too near to the shoulder")]
    TooNear {
        /// By how much. m
        by: f64,
    },
}

impl Unreachable {
    /// How far the wrist centre is from where the posture can have it. m
    pub fn by(self) -> f64 {
        match self {
            Self::InsideOffset { by } | Self::TooFar { by } | Self::TooNear { by } => by,
        }
    }
}

/// Distances below this (m), and sines below this, count as zero in the singular cases.
const SINGULAR: f64 = 1e-12;

impl Robot {
    /// The joint angles (rad, theta_1, 2, 4, 5, 6 in (-pi, pi], theta_3 within a turn of that) that bring frame 6 to
    /// `base_from_flange` in the given posture. Joint limits are ignored: see [`super::turns`].
    ///
    /// # Errors
    /// [`Unreachable`] when the wrist centre is out of the arm's geometric reach.
    pub fn inverse<T: Scalar>(&self, base_from_flange: &Pose<T>, posture: Posture) -> Result<[T; 6], Unreachable> {
        let g = self.geometry();
        let root_from_base = g.base_from_root.transpose().map(T::constant);
        let wrist = root_from_base * (self.wrist_centre(base_from_flange) - cast(&g.root_in_base));
        let [theta1, theta2, theta3] = self.arm_angles(&wrist, posture)?;
        let rotation = root_from_base * base_from_flange.rotation;
        let [theta4, theta5, theta6] = self.wrist_angles(&[theta1, theta2, theta3], &rotation, posture);
        Ok([theta1, theta2, theta3, theta4, theta5, theta6])
    }

    /// Joints 1 to 3, of the wrist centre in the root frame.
    fn arm_angles<T: Scalar>(&self, wrist: &Vector3<T>, posture: Posture) -> Result<[T; 3], Unreachable> {
        let g = self.geometry();
        // Joint 1, and the wrist centre in the plane of the arm as seen from the shoulder.
        let lateral = T::constant(g.lateral);
        let radius2 = wrist.x * wrist.x + wrist.y * wrist.y;
        let forward2 = radius2 - lateral * lateral;
        if forward2.value() < -SINGULAR {
            return Err(Unreachable::InsideOffset { by: g.lateral.abs() - libm::sqrt(radius2.value()) });
        }
        let forward = if forward2.value() > 0.0 { forward2.sqrt() } else { T::zero() };
        let forward = if posture.is_back() { -forward } else { forward };
        let theta1 = if radius2.value() > SINGULAR * SINGULAR {
            (wrist.y * forward - wrist.x * lateral).atan2(wrist.x * forward + wrist.y * lateral)
        } else {
            T::zero()
        };
        let u = forward - T::constant(g.shoulder_radius);
        let v = (wrist.z - T::constant(g.shoulder_height)).scale(g.lift);

        // Joints 2 and 3 from the triangle of shoulder, elbow and wrist centre.
        let distance2 = u * u + v * v;
        let product = 2.0 * g.upper_arm * g.forearm;
        let cosine = (distance2 - T::constant(g.upper_arm * g.upper_arm + g.forearm * g.forearm)).scale(1.0 / product);
        if cosine.value() > 1.0 + SINGULAR {
            let by = libm::sqrt(distance2.value()) - (g.upper_arm + g.forearm);
            return Err(Unreachable::TooFar { by });
        }
        if cosine.value() < -1.0 - SINGULAR {
            let by = (g.upper_arm - g.forearm).abs() - libm::sqrt(distance2.value());
            return Err(Unreachable::TooNear { by });
        }
        let sine2 = (T::one() - cosine) * (T::one() + cosine);
        let sine = if sine2.value() > 0.0 { sine2.sqrt() } else { T::zero() };
        let sine = if posture.is_delta_negative() { -sine } else { sine };
        let delta = sine.atan2(cosine);
        let along = T::constant(g.upper_arm) + cosine.scale(g.forearm);
        let across = sine.scale(g.fold * g.forearm);
        let theta2 = if distance2.value() > SINGULAR * SINGULAR {
            (v * along - u * across).atan2(u * along + v * across)
        } else {
            T::zero()
        };
        let theta3 = delta - T::constant(g.forearm_angle);
        Ok([theta1, theta2, theta3])
    }

    /// Joints 4 to 6, of joints 1 to 3 and the rotation of frame 6 in the root frame.
    fn wrist_angles<T: Scalar>(&self, arm: &[T; 3], rotation: &Matrix3<T>, posture: Posture) -> [T; 3] {
        let g = self.geometry();
        // Frame 3 in root coordinates: x3 along the arm, s4 z3 beside it, z4 along axis 4.
        let (s1, c1) = arm[0].sin_cos();
        let (s23, c23) = (arm[1] + arm[2].scale(g.fold)).sin_cos();
        let radial = Vector3::new(c1, s1, T::zero());
        let up = Vector3::new(T::zero(), T::zero(), T::constant(g.lift));
        let side = Vector3::new(s1, -c1, T::zero()) * T::constant(g.lift * g.fold * g.twist[0]);
        let x3 = radial * c23 + up * s23;
        let z4 = (radial * s23 - up * c23) * T::constant(g.fold * g.twist[0]);

        // The wrist: axis 6 seen from frame 3 gives joints 4 and 5, and axis 5 seen from frame 6 gives joint 6.
        let [_, s5, s6] = g.twist;
        let z6 = rotation.column(2);
        let (m1, m2, m3) = (z6.dot(&x3), z6.dot(&side), z6.dot(&z4));
        let sine5 = m1 * m1 + m2 * m2;
        let cosine5 = m3.scale(-s5 * s6);
        let sign = if posture.is_flipped() { -1.0 } else { 1.0 };
        let (theta4, theta5) = if sine5.value() > SINGULAR * SINGULAR {
            (m2.scale(s6 * sign).atan2(m1.scale(s6 * sign)), sine5.sqrt().scale(sign).atan2(cosine5))
        } else {
            (T::zero(), T::zero().atan2(cosine5))
        };
        // Through theta_4, so that near the singularity its rounding error is undone by theta_6.
        let (s4, c4) = theta4.sin_cos();
        let z5 = (x3 * s4 - side * c4) * T::constant(s5);
        let theta6 = z5.dot(&rotation.column(0)).scale(s6).atan2(z5.dot(&rotation.column(1)).scale(s6));
        [theta4, theta5, theta6]
    }

    /// The wrist centre in the base frame, of frame 6 in that frame. m
    pub fn wrist_centre<T: Scalar>(&self, base_from_flange: &Pose<T>) -> Vector3<T> {
        let axis6 = base_from_flange.rotation.column(2).into_owned();
        base_from_flange.translation - axis6 * T::constant(self.geometry().flange)
    }

    /// How far the wrist centre may move from where it is, in any direction, and still be in the geometric reach of a
    /// posture; joint limits are ignored. Zero out of reach. m
    pub fn reach_margin(&self, base_from_flange: &Pose<f64>, posture: Posture) -> f64 {
        let g = self.geometry();
        let wrist = g.base_from_root.transpose() * (self.wrist_centre(base_from_flange) - g.root_in_base);
        let radius = libm::hypot(wrist.x, wrist.y);
        let lateral = g.lateral.abs();
        if radius < lateral {
            return 0.0;
        }
        let forward = libm::sqrt((radius - lateral) * (radius + lateral));
        let outward = if posture.is_back() { -forward } else { forward };
        let distance = libm::hypot(outward - g.shoulder_radius, wrist.z - g.shoulder_height);
        let room = (g.upper_arm + g.forearm - distance).min(distance - (g.upper_arm - g.forearm).abs()).max(0.0);
        if lateral == 0.0 {
            // The distance from the shoulder changes by no more than the wrist centre moves; past axis 1 the arm turns
            // about.
            return room.min(radius);
        }
        // As far as `forward` stays above its half, it changes by so many times what the wrist centre moves.
        let inwards = radius - libm::hypot(lateral, forward / 2.0);
        let rate = (radius + inwards) / (forward / 2.0);
        if forward > 0.0 { inwards.min(room / rate) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::angles::wrap;
    use super::super::testing::{kr270, odd_arms};
    use super::*;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Largest error of position (m) and rotation (rad) of FK(IK) over all reachable postures of one pose.
    fn round_trip(robot: &Robot, theta: &[f64; 6]) -> (f64, usize) {
        let target = robot.forward(theta);
        let mut worst = 0.0_f64;
        let mut reached = 0;
        for posture in Posture::ALL {
            let Ok(solution) = robot.inverse(&target, posture) else { continue };
            reached += 1;
            let pose = robot.forward(&solution);
            let turn = pose.rotation * target.rotation.transpose();
            let angle = Vector3::new(turn.m32 - turn.m23, turn.m13 - turn.m31, turn.m21 - turn.m12).norm() / 2.0;
            worst = worst.max(angle).max((pose.translation - target.translation).norm());
            assert!(turn.trace() > 0.0);
        }
        (worst, reached)
    }

    #[test]
    fn a_hundred_thousand_random_poses_come_back() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut arms = odd_arms();
        arms.push(kr270());
        let mut postures = 0;
        for k in 0..100_000 {
            let theta: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.1..3.1));
            let (error, reached) = round_trip(&arms[k % arms.len()], &theta);
            assert!(error < 1e-9, "{error} at {theta:?}");
            postures += reached;
        }
        assert!(postures > 500_000, "only {postures} postures were reached");
    }

    proptest! {
        #[test]
        fn the_posture_of_the_angles_gives_the_angles_back(theta in prop::array::uniform6(-3.1..3.1_f64), arm in 0..32_usize) {
            let robot = &odd_arms()[arm];
            let posture = Posture::of(robot, &theta);
            let found = robot.inverse(&robot.forward(&theta), posture).unwrap_or([9.0; 6]);
            // Near a singularity the angles are badly determined although the pose is not.
            prop_assume!(libm::sin(theta[4]).abs() > 1e-3);
            prop_assume!(libm::sin(theta[2] + robot.geometry().forearm_angle).abs() > 1e-3);
            let wrist = super::super::Frames::new(robot, &theta).wrist_centre() - robot.geometry().root_in_base;
            let local = robot.geometry().base_from_root.transpose() * wrist;
            prop_assume!(libm::hypot(local.x, local.y) > 0.1);
            for j in 0..6 {
                prop_assert!(wrap(found[j] - theta[j]).abs() < 1e-9, "joint {} {:?} {:?}", j + 1, found, theta);
            }
        }
    }

    #[test]
    fn singular_poses_are_solved() {
        for robot in odd_arms().into_iter().chain([kr270()]) {
            let stretched = -robot.geometry().forearm_angle;
            for theta in [
                [0.3, 0.4, -1.2, 0.5, 0.0, 0.9],
                [0.3, 0.4, stretched, 0.5, 0.7, 0.9],
                [0.3, 0.4, stretched + 1e-9, 0.5, 1e-9, 0.9],
                [0.0, std::f64::consts::FRAC_PI_2, stretched, 0.0, 0.0, 0.0],
            ] {
                let (error, reached) = round_trip(&robot, &theta);
                assert!(error < 1e-9 && reached >= 1, "{error} {reached} {theta:?}");
            }
        }
    }

    #[test]
    fn wrist_centre_on_axis_1_is_solved() {
        let robot = kr270();
        let g = robot.geometry();
        // Shoulder at 0.35 m: an elbow angle that puts the wrist centre right above axis 1.
        let (r, v) = (-g.shoulder_radius, 1.0);
        let d2 = r * r + v * v;
        let delta =
            -libm::acos((d2 - g.upper_arm * g.upper_arm - g.forearm * g.forearm) / (2.0 * g.upper_arm * g.forearm));
        let theta2 =
            libm::atan2(v, r) - libm::atan2(g.forearm * libm::sin(delta), g.upper_arm + g.forearm * libm::cos(delta));
        let theta = [0.8, theta2, delta - g.forearm_angle, 0.3, 0.7, 0.2];
        let (error, reached) = round_trip(&robot, &theta);
        assert!(error < 1e-9 && reached == 8, "{error} {reached}");
    }

    #[test]
    fn within_the_margin_of_its_reach_the_wrist_centre_may_go_anywhere() {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let mut arms = odd_arms();
        arms.push(kr270());
        let (mut near, mut far) = (0, 0);
        for k in 0..100_000 {
            let robot = &arms[k % arms.len()];
            let mut theta: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.1..3.1));
            if k % 2 == 0 {
                theta[2] = -robot.geometry().forearm_angle + random.random_range(-0.1..0.1);
            }
            let pose = robot.forward(&theta);
            let posture = Posture::of(robot, &theta);
            let margin = robot.reach_margin(&pose, posture);
            let towards = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)).normalize();
            let moved = |by: f64| Pose { translation: pose.translation + towards * by, ..pose };
            let by = 0.999 * margin;
            assert!(robot.inverse(&moved(by), posture).is_ok(), "{margin} at {theta:?}");
            near += usize::from(margin > 1e-3);
            far += usize::from(robot.inverse(&moved(2.0 * margin + 0.01), posture).is_err());
        }
        assert!(near > 40_000 && far > 20_000, "{near} {far}");
    }

    #[test]
    fn what_is_out_of_reach_says_by_how_much() {
        let robot = kr270();
        let mut pose = robot.forward(&[0.0, 0.0, -robot.geometry().forearm_angle, 0.0, 0.0, 0.0]);
        pose.translation.x += 0.25;
        let error = robot.inverse(&pose, Posture::ALL[0]);
        assert!(matches!(error, Err(Unreachable::TooFar { by }) if (by - 0.25).abs() < 1e-9), "{error:?}");
    }
}
