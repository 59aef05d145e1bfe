//! How the robot's controller counts joint angles, and where its root frame is.

use super::{Pose, Posture, Robot};

stead_numerics::worded! {
    /// Whose controller it is: it decides the words and conventions of programs.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum ControllerKind {
        /// KUKA (KRC): A1 to A6, frames as X, Y, Z, A, B, C.
        Kuka = "kuka",
        /// ABB (IRC5, OmniCore): frames as a position and a quaternion.
        Abb = "abb",
        /// Fanuc: J1 to J6, frames as X, Y, Z, W, P, R.
        Fanuc = "fanuc",
        /// Staubli (CS8, CS9): j1 to j6.
        Staubli = "staubli",
    }
}

/// The angles and the root frame of a controller against those of the rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controller {
    /// Whose it is.
    pub kind: ControllerKind,
    /// 1 where an angle of the controller counts in the direction of the row's, else -1.
    pub sign: [f64; 6],
    /// The angle of each row where the controller's is zero. rad
    pub offset: [f64; 6],
    /// Whether the controller counts axis 3 against the horizontal and not against the upper arm: its angle tells then
    /// the sum of the angles of joints 2 and 3. Where it is not stated, Fanuc's do, and the others do not.
    pub is_j3_level: Option<bool>,
    /// Pose of the base frame of the rows in the controller's robot root (`$ROBROOT`, base, world at rest), where
    /// known.
    pub root_from_base: Option<Pose<f64>>,
}

impl Controller {
    /// The controller's angles of the joint angles of an arm. rad
    pub fn angles(&self, arm: &Robot, joints: &[f64; 6]) -> [f64; 6] {
        let mut angles = std::array::from_fn(|j| (joints[j] - self.offset[j]) * self.sign[j]);
        if self.is_level() {
            angles[2] += self.a3_by_a2(arm) * angles[1];
        }
        angles
    }

    /// The joint angles of an arm at the controller's angles: theta_i = sign_i A_i + offset_i, where axis 3 is counted
    /// against the horizontal theta_3 = sign_3 A_3 + offset_3 - sign_2 A_2. rad
    pub fn joints(&self, arm: &Robot, angles: &[f64; 6]) -> [f64; 6] {
        let mut of_links = *angles;
        if self.is_level() {
            of_links[2] -= self.a3_by_a2(arm) * angles[1];
        }
        std::array::from_fn(|j| self.sign[j] * of_links[j] + self.offset[j])
    }

    /// Whether axis 3 is counted against the horizontal.
    pub fn is_level(&self) -> bool {
        self.is_j3_level.unwrap_or(self.kind == ControllerKind::Fanuc)
    }

    /// How A_2 counts in A_3: 1 or -1 where axis 3 is counted against the horizontal, else 0.
    pub fn a3_by_a2(&self, arm: &Robot) -> f64 {
        if self.is_level() { self.sign[1] * self.sign[2] * arm.geometry().fold } else { 0.0 }
    }
}

impl Robot {
    /// How the controller counts the angles, where known.
    pub fn controller(&self) -> Option<&Controller> {
        self.controller.as_deref()
    }

    /// The same arm with this controller.
    pub fn with_controller(mut self, controller: Controller) -> Self {
        self.controller = Some(Box::new(controller));
        self
    }
}

/// S and T of a pose, by which KUKA's controllers tell postures and turns apart, as Beckhoff describes them for its CNC
/// (TF5200, "Status & Turn"): from its posture, the direction in which the controller counts axis 3 (1 where it is that
/// of the row, else -1), and its joint angles as the controller counts them (rad).
pub fn kuka_status_and_turn(posture: Posture, sign_3: f64, angles: &[f64; 6]) -> [u8; 2] {
    [status(posture, sign_3, angles[4]), turn(angles)]
}

/// S of a KUKA pose: bit 0 the wrist centre behind axis 1 ("overhead"), bit 1 the forearm beyond the stretched arm (A3
/// above the A3 at which wrist centre, axis 3 and axis 2 are in line), bit 2 A5 below zero. By the geometry of the arm,
/// which the bits of a posture state: `sign_3` is 1 where A3 counts in the direction of the row. Bit 3 is not used; bit
/// 4 marks poses taught by an absolutely accurate robot.
fn status(posture: Posture, sign_3: f64, a5: f64) -> u8 {
    u8::from(posture.is_back()) + 2 * u8::from(is_beyond(posture, sign_3)) + 4 * u8::from(a5 < 0.0)
}

/// Whether the controller's third axis is beyond where wrist centre, axis 3 and axis 2 are in line, in its own
/// direction.
fn is_beyond(posture: Posture, sign_3: f64) -> bool {
    posture.is_delta_negative() != (sign_3 > 0.0)
}

/// T of a KUKA pose: bit i - 1 is set where A_i is below zero.
fn turn(angles: &[f64; 6]) -> u8 {
    angles.iter().rev().fold(0, |bits, angle| 2 * bits + u8::from(*angle < 0.0))
}

#[cfg(test)]
mod tests {
    use super::super::Frames;
    use super::super::testing::{kr270, odd_arms};
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    proptest! {
        #[test]
        fn there_and_back(
            angles in prop::array::uniform6(-6.0..6.0_f64), signs in 0..64_u32, is_level: bool, arm in 0..32_usize
        ) {
            let arm = &odd_arms()[arm];
            let sign = std::array::from_fn(|j| if signs >> j & 1 == 0 { 1.0 } else { -1.0 });
            let offset = [0.0, -FRAC_PI_2, FRAC_PI_2, 0.0, 0.0, 3.1];
            let controller =
                Controller { kind: ControllerKind::Fanuc, sign, offset, is_j3_level: Some(is_level), root_from_base: None };
            let back = controller.angles(arm, &controller.joints(arm, &angles));
            prop_assert!(angles.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-14 * 64.0), "{:?}", back);
        }
    }

    #[test]
    fn an_axis_3_counted_against_the_horizontal_keeps_the_forearm_its_direction() {
        let (kind, offset) = (ControllerKind::Fanuc, [0.3, 0.1, -1.1, 0.0, 0.2, 0.0]);
        for (arm, signs) in odd_arms().into_iter().flat_map(|arm| (0..4).map(move |signs| (arm.clone(), signs))) {
            let mut sign = [1.0; 6];
            (sign[1], sign[2]) = (if signs & 1 == 0 { 1.0 } else { -1.0 }, if signs & 2 == 0 { 1.0 } else { -1.0 });
            let controller = Controller { kind, sign, offset, is_j3_level: Some(true), root_from_base: None };
            let forearm = |angles| Frames::new(&arm, &controller.joints(&arm, &angles)).axes[3];
            let [at_rest, leaning, other] = [[0.0, 0.0, 0.1], [0.0, 0.3, 0.1], [0.0, 0.0, 0.2]]
                .map(|[a1, a2, a3]| forearm([a1, a2, a3, 0.4, -0.3, 0.2]));
            assert!((at_rest - leaning).norm() < 1e-15 && (at_rest - other).norm() > 0.09);
        }
    }

    /// What the controllers of ABB's IRB 8700 and of Fanuc's arms state: with the upper arm leaning forwards by A2, the
    /// angle between the links is told by A3 - A2 at ABB's (RobotComponents, issue 181), by J2 + J3 at Fanuc's.
    #[test]
    fn the_angle_between_the_links_is_a_difference_at_abb_and_a_sum_at_fanuc() {
        let arm = kr270();
        let (offset, root_from_base) = ([0.0, FRAC_PI_2, -PI, 0.0, 0.0, 0.0], None);
        let of = |kind, sign: [f64; 6]| Controller { kind, sign, offset, is_j3_level: Some(true), root_from_base };
        let abb = of(ControllerKind::Abb, [1.0, -1.0, -1.0, 1.0, -1.0, 1.0]);
        let fanuc = of(ControllerKind::Fanuc, [1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
        let third = |controller: &Controller, a2: f64, a3: f64| {
            let angles = [0.0, a2.to_radians(), a3.to_radians(), 0.0, 0.0, 0.0];
            controller.joints(&arm, &angles)[2].to_degrees()
        };
        // Its two rows: A3 - A2 goes up to 67 deg, so that A3 goes to 82 deg at A2 = 15 and to 97 deg at A2 = 30.
        for (a2, a3) in [(0.0, 67.0), (15.0, 82.0), (30.0, 97.0)] {
            assert!((third(&abb, a2, a3) - (-180.0 - 67.0)).abs() < 1e-12);
        }
        for (j2, j3) in [(0.0, 40.0), (15.0, 25.0), (60.0, -20.0)] {
            assert!((third(&fanuc, j2, j3) - (-180.0 + 40.0)).abs() < 1e-12);
        }
    }
}
