//! How the robot's controller counts joint angles, and where its root frame is.

use super::{Pose, Robot};

/// Whose controller it is: it decides the words and conventions of programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ControllerKind {
    /// KUKA (KRC): A1 to A6, frames as X, Y, Z, A, B, C.
    Kuka,
    /// ABB (IRC5, OmniCore): frames as a position and a quaternion.
    Abb,
    /// Fanuc: J1 to J6, frames as X, Y, Z, W, P, R.
    Fanuc,
    /// Staubli (CS8, CS9): j1 to j6.
    Staubli,
}

impl ControllerKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Kuka, Self::Abb, Self::Fanuc, Self::Staubli];

    /// The word for it in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Kuka => "kuka",
            Self::Abb => "abb",
            Self::Fanuc => "fanuc",
            Self::Staubli => "staubli",
        }
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
    /// Whether the controller counts axis 3 against the horizontal and not against the upper arm, as Fanuc's do: the
    /// angle between the two is then the sum of its angles of axes 2 and 3.
    pub is_j3_level: bool,
    /// Pose of the base frame of the rows in the controller's robot root (`$ROBROOT`, base, world at rest), where
    /// known.
    pub root_from_base: Option<Pose<f64>>,
}

impl Controller {
    /// The controller's angles of joint angles. rad
    pub fn angles(&self, joints: &[f64; 6]) -> [f64; 6] {
        let mut angles = std::array::from_fn(|j| (joints[j] - self.offset[j]) * self.sign[j]);
        if self.is_j3_level {
            angles[2] -= angles[1];
        }
        angles
    }

    /// The joint angles of the controller's angles: theta_i = sign_i A_i + offset_i. rad
    pub fn joints(&self, angles: &[f64; 6]) -> [f64; 6] {
        let mut of_links = *angles;
        if self.is_j3_level {
            of_links[2] += angles[1];
        }
        std::array::from_fn(|j| self.sign[j] * of_links[j] + self.offset[j])
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    proptest! {
        #[test]
        fn there_and_back(angles in prop::array::uniform6(-6.0..6.0_f64), signs in 0..64_u32, is_j3_level: bool) {
            let sign = std::array::from_fn(|j| if signs >> j & 1 == 0 { 1.0 } else { -1.0 });
            let offset = [0.0, -FRAC_PI_2, FRAC_PI_2, 0.0, 0.0, 3.1];
            let controller =
                Controller { kind: ControllerKind::Fanuc, sign, offset, is_j3_level, root_from_base: None };
            let back = controller.angles(&controller.joints(&angles));
            prop_assert!(angles.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-14 * 64.0), "{:?}", back);
        }
    }

    #[test]
    fn an_axis_3_counted_against_the_horizontal_keeps_the_forearm_where_it_is() {
        let kind = ControllerKind::Fanuc;
        let (sign, offset) = ([1.0; 6], [0.0; 6]);
        let controller = Controller { kind, sign, offset, is_j3_level: true, root_from_base: None };
        // Axis 2 forwards by 0.3, J3 untouched: the angle between the links grows by 0.3.
        let joints = controller.joints(&[0.0, 0.3, 0.1, 0.0, 0.0, 0.0]);
        assert!((joints[2] - 0.4).abs() < 1e-15);
    }
}
