//! The eight postures of an elbow arm with a spherical wrist.
//!
//! A posture is numbered `1 + 4 [back] + 2 [delta <= 0] + [theta_5 < 0]`. *Back*: theta_1 points away from the wrist
//! centre. `delta` is the elbow angle, zero with the arm stretched; in front of the robot delta <= 0 is elbow up. Two
//! postures that differ only in the wrist flip (theta_4 + 180 deg, -theta_5, theta_6 + 180 deg) place every axis of the
//! arm alike: together they are a [`PostureClass`]. Conditioning cannot tell them apart, nor can deflection where the
//! wrist joints have constant compliances ([`Robot::flips_yield_alike`]).
//!
//! Numbers rest on how the rows of a file are laid: two files of one arm may number its postures differently. Words do
//! not ([`Robot::posture_words`]): front or back, elbow up or down, flip or no flip, by the geometry of the arm in its
//! base frame and by how its controller counts A5.

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

stead_numerics::worded! {
    /// One side of a pair by which postures are told apart; the sides of a pair stand after each other.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum PostureWord {
        /// The wrist is in front of axis 1.
        Front = "front",
        /// It is behind it: the arm reaches over its head.
        Back = "back",
        /// Axis 3 is above the line from axis 2 to the wrist.
        ElbowUp = "elbow up",
        /// It is below that line.
        ElbowDown = "elbow down",
        /// A5 is below zero.
        Flip = "flip",
        /// It is not.
        NoFlip = "no flip",
    }
}

impl PostureWord {
    /// The other side of its pair.
    pub fn other(self) -> Self {
        Self::WORDS[self as usize ^ 1].1
    }
}

impl fmt::Display for PostureWord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// A posture in words, one of each pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PostureWords([PostureWord; 3]);

impl PostureWords {
    /// Whether a word is one of them.
    pub fn has(self, word: PostureWord) -> bool {
        self.0.contains(&word)
    }
}

impl fmt::Display for PostureWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second, third] = self.0;
        write!(f, "{first}, {second}, {third}")
    }
}

impl Robot {
    /// A posture in words, as seen in the base frame of the rows, wherever that is mounted.
    ///
    /// *Front* is the side of axis 1 on which axis 2 is; where the two meet, that of the x axis of row 1. *Elbow up*:
    /// axis 3 is above the line from axis 2 to the wrist centre. Nearer to axis 1 than axis 2 is, the line points the
    /// other way; there the elbow keeps the word that it has where the arm reaches farther out, since on the way
    /// between it is never stretched. *Flip*: A5 as the controller counts it, theta_5 where no controller is known, is
    /// below zero; where A5 is counted from elsewhere than the wrist with axes 4 and 6 in line, it is counted from
    /// there.
    ///
    /// With wrist centre (u, h) and axis 3 (e, g) seen from axis 2, u outwards and h upwards, axis 3 is to the left of
    /// the line where `u g - h e = -(upper arm)(forearm) lift fold sin(delta)` is above zero, which of an upright arm
    /// that reaches to the front is above the line, and to the back below. So each word follows from the number alone.
    pub fn posture_words(&self, posture: Posture) -> PostureWords {
        let geometry = self.geometry();
        // Axis 1 of the rows may point downwards.
        let base_from_root = self.cell_from_base::<f64>().rotation.transpose() * geometry.base_from_root;
        let up = if base_from_root[(2, 2)] < -LEVEL { -1.0 } else { 1.0 };
        let reaches_along_x = !posture.is_back();
        let is_left = posture.is_delta_negative() == (geometry.lift * geometry.fold * up > 0.0);
        let counts_along = self.controller().is_none_or(|of| of.sign[4] * libm::cos(of.offset[4]) > 0.0);
        let side = |is: bool, word: PostureWord| if is { word } else { word.other() };
        PostureWords([
            side(reaches_along_x == (geometry.shoulder_radius >= 0.0), PostureWord::Front),
            side(is_left == reaches_along_x, PostureWord::ElbowUp),
            side(posture.is_flipped() == counts_along, PostureWord::Flip),
        ])
    }

    /// The number of a posture with its words, for messages.
    pub fn named_posture(&self, posture: Posture) -> String {
        format!("{posture} ({})", self.posture_words(posture))
    }
}

/// An axis 1 that points downwards by less than this (cos) is level.
const LEVEL: f64 = 1e-9;

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
    use super::super::testing::{kr270, odd_arms, robot_from};
    use super::super::{Controller, ControllerKind, Pose};
    use super::*;
    use nalgebra::{Matrix3, Vector3};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// What the words say, of frames alone: nothing where that cannot be told to the last digits, or by the plain
    /// definition, and whether the wrist is between axis 1 and axis 2.
    fn plain(robot: &Robot, theta: &[f64; 6]) -> Option<([bool; 2], bool)> {
        let frames = Frames::new(robot, theta);
        // In the base frame of the rows.
        let base = robot.cell_from_base::<f64>().inverse();
        let [axis1, shoulder, elbow] = [0, 1, 2].map(|row| base.point(&frames.origins[row]));
        let wrist = base.point(&frames.wrist_centre());
        // Up is along axis 1, upright in the base frame or nearly so.
        let axis = base.rotation * frames.axes[0];
        let up = axis * axis.z.signum();
        // Outwards: from axis 1 to axis 2, in the plane of the arm, or along x of row 1.
        let x1 = base.rotation * frames.rotations[0].column(0);
        let outwards = x1 * if robot.geometry().shoulder_radius < 0.0 { -1.0 } else { 1.0 };
        let ahead = (wrist - axis1).dot(&outwards);
        let [reach, high] = [outwards, up].map(|axis| (wrist - shoulder).dot(&axis));
        let [e, g] = [outwards, up].map(|axis| (elbow - shoulder).dot(&axis));
        // How far axis 3 is above the line at its place.
        let above = g - high * e / reach;
        let is_near = [ahead, reach, above].iter().any(|length| length.abs() < 1e-6);
        (!is_near).then_some(([ahead > 0.0, above > 0.0], (ahead > 0.0) != (reach > 0.0)))
    }

    #[test]
    fn words_are_those_of_the_geometry_in_every_configuration() {
        let mut random = ChaCha8Rng::seed_from_u64(23);
        let mut arms = odd_arms();
        arms.push(kr270());
        // Axis 1 counted downwards, and axis 2 behind axis 1 in the frame of row 1.
        for (alpha, a2) in [(180.0, 0.35), (0.0, -0.35), (180.0, -0.35)] {
            arms.push(robot_from([
                (alpha, 0.0, 0.6, -185.0, 185.0, 3.8),
                (90.0, a2, 0.0, -146.0, 146.0, 3.32),
                (0.0, 1.25, 0.0, -245.0, 129.0, 2.79),
                (-90.0, 0.055, 1.1, -350.0, 350.0, 0.486),
                (90.0, 0.0, 0.0, -125.0, 125.0, 0.521),
                (-90.0, 0.0, 0.1, -350.0, 350.0, 0.38),
            ]));
        }
        let turned =
            Pose { rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0), translation: Vector3::z() };
        let ceiling: Vec<Robot> = arms.iter().map(|robot| robot.clone().mounted(&turned)).collect();
        arms.extend(ceiling);
        let (mut seen, mut between) = ([0; 4], 0);
        for robot in &arms {
            for _ in 0..2000 {
                let theta: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.1..3.1));
                let Some(([is_front, is_above], is_between)) = plain(robot, &theta) else { continue };
                let words = robot.posture_words(Posture::of(robot, &theta));
                assert_eq!(words.has(PostureWord::Front), is_front, "{} {theta:?}", robot.name());
                // Between axes 1 and 2 the elbow keeps the word that it has farther out, the other one.
                assert_eq!(words.has(PostureWord::ElbowUp), is_above != is_between, "{} {theta:?}", robot.name());
                seen[2 * usize::from(is_front) + usize::from(is_above)] += 1;
                between += usize::from(is_between);
            }
        }
        assert!(seen.iter().all(|count| *count > 2000) && between > 500, "{seen:?} {between}");
    }

    #[test]
    fn flip_is_a5_below_zero_however_it_is_counted() {
        let mut random = ChaCha8Rng::seed_from_u64(24);
        for (sign, offset) in [(1.0, 0.0), (-1.0, 0.0), (1.0, 180.0), (-1.0, -180.0_f64)] {
            let mut controller = Controller {
                kind: ControllerKind::Kuka,
                sign: [1.0; 6],
                offset: [0.0; 6],
                is_j3_level: Some(false),
                root_from_base: None,
            };
            (controller.sign[4], controller.offset[4]) = (sign, offset.to_radians());
            let robot = kr270().with_controller(controller);
            for _ in 0..1000 {
                let angles: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.1..3.1));
                let words = robot.posture_words(Posture::of(&robot, &controller.joints(&robot, &angles)));
                assert_eq!(words.has(PostureWord::Flip), angles[4] < 0.0, "{sign} {offset} {angles:?}");
            }
        }
        let words = kr270().posture_words(Posture::ALL[3]).to_string();
        assert_eq!(words, "front, elbow up, flip");
        assert_eq!(kr270().named_posture(Posture::ALL[2]), "3 (front, elbow up, no flip)");
    }

    #[test]
    fn each_posture_has_words_of_its_own() {
        for robot in odd_arms() {
            let words = Posture::ALL.map(|posture| robot.posture_words(posture));
            assert!((0..8).all(|k| !words[..k].contains(&words[k])), "{}", robot.name());
            assert!(PostureWord::WORDS.iter().all(|(_, word)| words.iter().filter(|of| of.has(*word)).count() == 4));
        }
    }

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
