//! Words for postures: those of the plain geometry for shipped and imported arms alike, however their rows are laid.

use super::arms::{Arm, about_z, pose};
use super::*;
use crate::robot::geometry_from;
use crate::shipped;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use stead_model::robot::{Frames, Posture, PostureWord};

/// The words of joint angles from where axes and wrist are in the base frame, and whether the wrist is between axes 1
/// and 2; nothing on the boundaries.
fn plain(robot: &Robot, theta: &[f64; 6]) -> Option<([bool; 3], bool)> {
    let frames = Frames::new(robot, theta);
    let outwards = frames.rotations[0].column(0).into_owned();
    let [shoulder, elbow] = [frames.origins[1], frames.origins[2]];
    let wrist = frames.wrist_centre();
    let ahead = (wrist - frames.origins[0]).dot(&outwards);
    let [reach, out] = [wrist, elbow].map(|point| (point - shoulder).dot(&outwards));
    let above = (elbow - shoulder).z - (wrist - shoulder).z * out / reach;
    let fifth = robot.controller().map_or(theta[4], |controller| controller.angles(robot, theta)[4]);
    let is_near = [ahead, reach, above, libm::sin(fifth)].iter().any(|value| value.abs() < 1e-6);
    (!is_near).then_some(([ahead > 0.0, above > 0.0, libm::sin(fifth) < 0.0], (ahead > 0.0) != (reach > 0.0)))
}

fn assert_words(robot: &Robot, random: &mut ChaCha8Rng) -> [usize; 2] {
    let mut seen = [0; 2];
    for _ in 0..4000 {
        let theta: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.1..3.1));
        let Some(([is_front, is_above, is_flip], is_between)) = plain(robot, &theta) else { continue };
        let words = robot.posture_words(Posture::of(robot, &theta));
        let found = [PostureWord::Front, PostureWord::ElbowUp, PostureWord::Flip].map(|word| words.has(word));
        assert_eq!(found, [is_front, is_above != is_between, is_flip], "{} at {theta:?}", robot.name());
        seen[usize::from(is_between)] += 1;
    }
    seen
}

#[test]
fn words_of_shipped_and_imported_arms_are_those_of_the_geometry() {
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let mut between = 0;
    // The two TX200 have their rows laid against each other: axis 2 turns the other way.
    for name in [
        "kuka-kr270-r2700",
        "kuka-kr6-r900",
        "abb-irb6640-235",
        "abb-irb120",
        "fanuc-m900ia-260l",
        "staubli-tx200",
        "staubli-tx200l",
        "motoman-ms210",
    ] {
        let text = shipped::by_name(name).unwrap();
        let file = TomlFile::new(Path::new(name), text.as_bytes().to_vec()).unwrap();
        let [outside, inside] = assert_words(&geometry_from(&file).unwrap(), &mut random);
        assert!(outside > 3000, "{name}");
        between += inside;
    }
    for (name, text) in FIXTURES {
        let [outside, inside] = assert_words(&filled(&import(text).unwrap()), &mut random);
        assert!(outside > 3000, "{name}");
        between += inside;
    }
    assert!(between > 1000, "{between}");
}

/// The same arm by other rows: what its URDF is made of, and what is imported of that.
#[test]
fn an_imported_arm_has_the_words_of_the_arm_that_it_is() {
    let mut random = ChaCha8Rng::seed_from_u64(32);
    let mut other_numbers = 0;
    for case in 0..64_u32 {
        let sign = |bit: u32| if case >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let rows = [
            (0.0, 0.0, 0.4),
            (90.0 * sign(0), 0.3, 0.0),
            (if sign(1) > 0.0 { 0.0 } else { 180.0 }, 0.9, 0.0),
            (90.0 * sign(2), -0.05, 0.8),
            (90.0 * sign(3), 0.0, 0.0),
            (90.0 * sign(4), 0.0, 0.15),
        ];
        let mut offsets: [f64; 6] = std::array::from_fn(|_| random.random_range(-PI..PI));
        offsets[4] = 0.0;
        let signs = std::array::from_fn(|k| sign(k as u32));
        let base = pose(about_z(random.random_range(-PI..PI)), [0.1, -0.2, 0.0]);
        let made = Arm { rows, offsets, signs, base, mounted: Pose::identity() };
        let imported = import(&made.urdf(&mut random, 17)).unwrap();
        let controller = imported.controller_of_urdf(ControllerKind::Kuka);
        let found = filled(&imported).with_controller(controller);
        let joints = rows.map(|(alpha, a, d)| Joint {
            alpha: f64::to_radians(alpha),
            a,
            d,
            min: -6.0,
            max: 6.0,
            max_speed: None,
            max_acceleration: None,
            max_jerk: None,
            compliance: 1e-6.into(),
        });
        let own = Controller { sign: signs, offset: offsets, ..controller };
        let robot = Robot::new("made", joints).unwrap().with_controller(own);
        for _ in 0..100 {
            let values: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.0..3.0));
            if libm::sin(values[4]).abs() < 1e-6 {
                continue;
            }
            let [first, second] = [(&robot, own), (&found, controller)].map(|(robot, controller)| {
                let posture = Posture::of(robot, &controller.joints(robot, &values));
                (posture, robot.posture_words(posture))
            });
            assert_eq!(first.1, second.1, "{case} at {values:?}");
            other_numbers += usize::from(first.0 != second.0);
        }
    }
    assert!(other_numbers > 1000, "{other_numbers}");
}
