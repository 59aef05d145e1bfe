//! The eight postures of an elbow arm with a spherical wrist.
//!
//! A posture is numbered `1 + 4 [back] + 2 [delta <= 0] + [theta_5 < 0]`. *Back*: theta_1 points away from the wrist
//! centre. `delta` is the elbow angle, zero with the arm stretched; in front of the robot delta <= 0 is elbow up. Two
//! postures that differ only in the wrist flip (theta_4 + 180 deg, -theta_5, theta_6 + 180 deg) place every axis of the
//! arm alike: together they are a [`PostureClass`]. Conditioning cannot tell them apart, nor can deflection where the
//! wrist joints have constant compliances ([`Robot::flips_yield_alike`]).

use super::{Robot, angles::wrap, forward::Frames};
use serde::{Deserialize, Serialize};
use std::fmt;

/// One of the eight solutions of the inverse kinematics, numbered 1 to 8.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "u8", into = "u8")]
pub struct Posture(u8);

/// Two postures that differ in the wrist flip alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PostureClass(u8);

impl Posture {
    /// All eight, in the order of their numbers.
    pub const ALL: [Posture; 8] =
        [Posture(1), Posture(2), Posture(3), Posture(4), Posture(5), Posture(6), Posture(7), Posture(8)];

    /// The posture of that number, if there is one.
    pub fn from_number(number: u8) -> Option<Self> {
        (1..=8).contains(&number).then_some(Self(number))
    }

    /// The number, 1 to 8.
    pub fn number(self) -> u8 {
        self.0
    }

    /// The posture that joint angles (rad) are in.
    pub fn of(robot: &Robot, theta: &[f64; 6]) -> Self {
        let geometry = robot.geometry();
        let frames = Frames::new(robot, theta);
        let wrist = geometry.base_from_root.transpose() * (frames.wrist_centre() - geometry.root_in_base);
        let (sine, cosine) = libm::sincos(theta[0]);
        let back = cosine * wrist.x + sine * wrist.y < 0.0;
        let delta = wrap(theta[2] + geometry.forearm_angle);
        Self(1 + 4 * u8::from(back) + 2 * u8::from(delta <= 0.0) + u8::from(wrap(theta[4]) < 0.0))
    }

    /// Whether theta_1 points away from the wrist centre.
    pub fn is_back(self) -> bool {
        (self.0 - 1) & 4 != 0
    }

    /// Whether the elbow angle delta is zero or below.
    pub fn is_delta_negative(self) -> bool {
        (self.0 - 1) & 2 != 0
    }

    /// Whether theta_5 is below zero.
    pub fn is_flipped(self) -> bool {
        (self.0 - 1) & 1 != 0
    }

    /// The class of the posture: which posture it is but for the wrist flip.
    pub fn class(self) -> PostureClass {
        PostureClass((self.0 - 1) / 2)
    }
}

/// Steps of the angles of joints 2 and 3 in [`Robot::has_posture`].
const STEPS: usize = 60;

impl Robot {
    /// Whether some joint angles inside the limits are in a posture, on a grid over joints 2, 3 and 5, which decide.
    pub fn has_posture(&self, posture: Posture) -> bool {
        let at = |j: usize, share: f64| {
            let joint = &self.joints()[j];
            joint.min + (joint.max - joint.min) * share
        };
        let shares = || (0..=STEPS).map(|step| step as f64 / STEPS as f64);
        shares().any(|second| {
            shares().any(|third| {
                [0.0, 1.0].into_iter().any(|fifth| {
                    let mut angles = [0.0; 6];
                    (angles[1], angles[2], angles[4]) = (at(1, second), at(2, third), at(4, fifth));
                    Posture::of(self, &angles) == posture
                })
            })
        })
    }
}

impl PostureClass {
    /// All four, in the order of their indices.
    pub const ALL: [PostureClass; 4] = [PostureClass(0), PostureClass(1), PostureClass(2), PostureClass(3)];

    /// The class's place in [`PostureClass::ALL`], 0 to 3.
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The two postures of the class: theta_5 not negative, theta_5 negative.
    pub fn postures(self) -> [Posture; 2] {
        [Posture(1 + 2 * self.0), Posture(2 + 2 * self.0)]
    }

    /// Whether theta_1 points away from the wrist centre.
    pub fn is_back(self) -> bool {
        self.0 & 2 != 0
    }

    /// Whether the elbow angle delta is zero or below.
    pub fn is_delta_negative(self) -> bool {
        self.0 & 1 != 0
    }
}

impl fmt::Display for Posture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

impl From<Posture> for u8 {
    fn from(posture: Posture) -> u8 {
        posture.0
    }
}

impl TryFrom<u8> for Posture {
    type Error = String;
    fn try_from(number: u8) -> Result<Self, String> {
        Self::from_number(number).ok_or_else(|| format!("posture {number} does not exist: allowed are 1 to 8"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_classes_follow_the_documented_bits() {
        for posture in Posture::ALL {
            let n = posture.number() - 1;
            assert_eq!(posture.is_back(), n & 4 != 0);
            assert_eq!(posture.is_delta_negative(), n & 2 != 0);
            assert_eq!(posture.is_flipped(), n & 1 != 0);
            assert!(posture.class().postures().contains(&posture));
            assert_eq!(posture.class().is_back(), posture.is_back());
            assert_eq!(posture.class().is_delta_negative(), posture.is_delta_negative());
        }
        assert_eq!(Posture::from_number(0), None);
        assert_eq!(Posture::from_number(9), None);
    }
}
