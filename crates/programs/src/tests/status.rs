//! S and T by their geometry, on random postures.

use super::super::status::fanuc_config;
use super::bench::Bench;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::Path;
use stead_format::robot::geometry_from;
use stead_format::toml_file::TomlFile;
use stead_model::robot::{Controller, ControllerKind, Frames, Pose, Posture, Robot, kuka_status_and_turn};
use stead_model::testing::tried;
use stead_numerics::rotation::{rotation_from_zyx, rotation_vector};

/// The distance of the wrist centre from axis 2.
fn stretch(robot: &Robot, joints: &[f64; 6]) -> f64 {
    let frames = Frames::new(robot, joints);
    (frames.wrist_centre() - frames.origins[1]).norm()
}

/// The angle of the third axis, as the controller counts it, at which the arm is stretched: looked for, not computed.
fn stretched(robot: &Robot, controller: &Controller, angles: &[f64; 6]) -> f64 {
    let at = |a3: f64| {
        let mut angles = *angles;
        angles[2] = a3;
        stretch(robot, &controller.joints(robot, &angles))
    };
    let (mut best, mut step) = (0.0, 0.2);
    let start = (-16..16).map(|k| f64::from(k) * 0.2).max_by(|a, b| at(*a).total_cmp(&at(*b)));
    best += start.unwrap();
    while step > 1e-9 {
        best = [best - step, best, best + step].into_iter().max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
        step /= 1.5;
    }
    best
}

/// Arms whose third axis counts in either direction, and whose rows fold either way.
fn arms() -> Vec<(Robot, Controller)> {
    ["kuka", "abb", "fanuc"]
        .map(|name| {
            let robot = Bench::new(name).run.problem.robot.clone();
            let given = *robot.controller().unwrap();
            // As a KUKA counts: axis 3 downwards, so that the rows of the Fanuc, which counts upwards, count against
            // it.
            let is_upwards = name == "fanuc";
            let mut sign = given.sign;
            let mut offset = given.offset;
            if is_upwards {
                (sign[2], sign[4]) = (-sign[2], -sign[4]);
                offset[2] = given.offset[2];
            }
            let controller = Controller { kind: ControllerKind::Kuka, sign, offset, is_j3_level: Some(false), ..given };
            (robot, controller)
        })
        .to_vec()
}

#[test]
fn s_and_t_are_those_of_the_geometry() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    for (robot, controller) in arms() {
        let mut seen = [0; 8];
        for _ in 0..tried(4000) {
            let angles: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.1..3.1));
            let joints = controller.joints(&robot, &angles);
            let posture = Posture::of(&robot, &joints);
            let [s, _] = kuka_status_and_turn(posture, controller.sign[2], &angles);
            // Bit 0: the wrist centre in the frame that turns with axis 1.
            let frames = Frames::new(&robot, &joints);
            let (sine, cosine) = libm::sincos(joints[0]);
            let ahead = Vector3::new(cosine, sine, 0.0).dot(&(frames.wrist_centre() - frames.origins[0]));
            // Bit 1: beyond the stretched arm, by less than half a turn.
            let best = stretched(&robot, &controller, &angles);
            let beyond = stead_model::robot::angles::wrap(angles[2] - best);
            if ahead.abs() < 1e-6 || beyond.abs() < 1e-6 || beyond.abs() > 3.1 {
                continue;
            }
            let expected = u8::from(ahead < 0.0) + 2 * u8::from(beyond > 0.0) + 4 * u8::from(angles[4] < 0.0);
            assert_eq!(s, expected, "{} at {angles:?}", robot.name());
            seen[usize::from(s)] += 1;
            let bits: u8 = (0..6).map(|axis| u8::from(angles[axis] < 0.0) << axis).sum();
            assert_eq!(kuka_status_and_turn(Posture::ALL[0], 1.0, &angles)[1], bits);
        }
        assert!(seen.iter().all(|count| *count > tried(100)), "{seen:?}");
    }
}

/// Poses of a KUKA KR 270 R2700 (350 mm from axis 1 to axis 2, upper arm 1150 mm, forearm 1200 mm, 41 mm below the
/// elbow) with S and T worked out by hand from the published criteria (Beckhoff TF5200, "Status & Turn (IS, IT)"): 1
/// for a wrist behind axis 1, 2 for a wrist in front of the line through axes 2 and 3, 4 for A5 below zero; T adds 1,
/// 2, 4, 8, 16, 32 for A1 to A6 below zero.
#[test]
fn s_and_t_are_those_of_the_published_definition() {
    let rows = stead_format::shipped::by_name("kuka-kr270-r2700").unwrap();
    let file = TomlFile::new(Path::new("kr270.toml"), rows.as_bytes().to_vec()).unwrap();
    let robot = geometry_from(&file).unwrap();
    let controller = robot.controller().unwrap();
    for (angles, s, t) in [
        // Upper arm upright, forearm level: the wrist is 350 + 1200 = 1550 mm ahead of axis 1 and in front of the upper
        // arm.
        ([0.0, -90.0, 90.0, 0.0, 0.0, 0.0], 2, 2),
        ([0.0, -90.0, 90.0, 0.0, -30.0, 0.0], 6, 2 + 16),
        // Upper arm upright, forearm level to the back: the wrist is 350 - 1200 = -850 mm ahead, behind the upper arm.
        ([0.0, -90.0, -90.0, 0.0, 30.0, 0.0], 1, 2 + 4),
        // Upper arm 50 deg past upright, forearm 10 deg short of it: the wrist is 350 - 881 + 208 + 40 = -283 mm ahead,
        // yet in front of the line through axes 2 and 3.
        ([0.0, -140.0, 60.0, 0.0, 10.0, 0.0], 1 + 2, 2),
        ([0.0, -140.0, 60.0, 0.0, -10.0, 0.0], 1 + 2 + 4, 2 + 16),
        // The wrist is on that line at A3 = -atan(41 / 1200) = -1.96 deg.
        ([0.0, -45.0, -1.0, 0.0, 10.0, 0.0], 2, 2 + 4),
        ([0.0, -45.0, -3.0, 0.0, 10.0, 0.0], 0, 2 + 4),
        ([0.0, -45.0, -3.0, 0.0, -10.0, 0.0], 4, 2 + 4 + 16),
        // All axes below zero, 63, and above it, 0. The wrist is 350 - 200 - 600 + 36 = -414 mm and 350 + 1081 + 771 -
        // 31 = 2171 mm ahead.
        ([-10.0, -100.0, -20.0, -30.0, -40.0, -50.0], 1 + 4, 63),
        ([10.0, 20.0, 30.0, 40.0, 50.0, 60.0], 2, 0),
        // The angles of a published example of T, 18 (the guide's page `export` has its address): 350 + 813 + 1188 + 6
        // mm ahead.
        ([91.0, -45.0, 37.0, 1.0, -1.0, 0.0], 2 + 4, 18),
    ] {
        let angles = angles.map(f64::to_radians);
        let posture = Posture::of(&robot, &controller.joints(&robot, &angles));
        assert_eq!(kuka_status_and_turn(posture, controller.sign[2], &angles), [s, t], "{angles:?}");
    }
}

#[test]
fn the_elbow_of_a_fanuc_is_up_where_it_is_above_the_line_from_shoulder_to_wrist() {
    let robot = Bench::new("fanuc").run.problem.robot.clone();
    let controller = robot.controller().unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(10);
    let mut ups = 0;
    for _ in 0..4000 {
        let mut angles: [f64; 6] = std::array::from_fn(|_| random.random_range(-1.5..1.5));
        angles[0] = random.random_range(-6.0..6.0);
        let joints = controller.joints(&robot, &angles);
        let posture = Posture::of(&robot, &joints);
        let frames = Frames::new(&robot, &joints);
        let [shoulder, elbow, wrist] = [frames.origins[1], frames.origins[2], frames.wrist_centre()];
        let (sine, cosine) = libm::sincos(joints[0]);
        let ahead = Vector3::new(cosine, sine, 0.0);
        let side = |v: Vector3<f64>| (v.dot(&ahead), v.z);
        let ((ex, ez), (wx, wz)) = (side(elbow - shoulder), side(wrist - shoulder));
        let above = wx * ez - wz * ex;
        if posture.is_back() || above.abs() < 1e-6 {
            continue;
        }
        let config = fanuc_config(robot.posture_words(posture), &angles);
        assert_eq!(config.contains('U'), above > 0.0, "{angles:?} {config}");
        ups += usize::from(above > 0.0);
        let turns = |angle: f64| ((angle.to_degrees() + 180.0).div_euclid(360.0)) as i32;
        assert!(config.starts_with(if angles[4] > 0.0 { 'F' } else { 'N' }) && config.contains(" T, "));
        assert!(config.ends_with(&format!(", {}, {}, {}", turns(angles[0]), turns(angles[3]), turns(angles[5]))));
    }
    assert!((500..3500).contains(&ups), "{ups}");
}

/// A pose of an R-2000iB/165F in two configurations, with its joint angles, as published by ONE Robotics ("The perils
/// of six-axis robots", 2013, onerobotics.com/posts/2013/the-perils-of-six-axis-robots). The hand is not stated there:
/// one of 270 mm agrees.
#[test]
fn a_published_pose_of_a_fanuc_has_the_angles_and_the_configurations_that_are_printed() {
    let rows = stead_format::shipped::by_name("fanuc-m900ia-260l").unwrap();
    let lengths = [
        ("d_mm = 950.0", "d_mm = 670.0"),
        ("a_mm = 370.0", "a_mm = 312.0"),
        ("a_mm = 1050.0", "a_mm = 1075.0"),
        ("a_mm = -200.0", "a_mm = -225.0"),
        ("d_mm = 1705.0", "d_mm = 1280.0"),
        ("xyz_mm = [0.0, 0.0, -950.0]", "xyz_mm = [0.0, 0.0, -670.0]"),
    ];
    let text = lengths.iter().fold(rows.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    assert!(text.contains("d_mm = 270.0"));
    let file = TomlFile::new(Path::new("r2000.toml"), text.into_bytes()).unwrap();
    let robot = geometry_from(&file).unwrap();
    let controller = robot.controller().unwrap();
    let [w, p, r] = [135.0, -45.0, 0.0_f64].map(f64::to_radians);
    let printed = Pose { rotation: rotation_from_zyx([r, p, w]), translation: Vector3::new(1.5, 0.0, 0.36) };
    for (config, angles) in [
        ("N U T, 0, 0, 0", [7.962, -5.284, -36.250, 77.661, -51.975, -79.273]),
        ("F U T, 0, 0, 0", [7.962, -5.284, -36.250, -102.339, 51.975, 100.727]),
    ] {
        let angles = angles.map(f64::to_radians);
        let joints = controller.joints(&robot, &angles);
        let flange = controller.root_from_base.unwrap().then(&robot.forward(&joints));
        let off = (flange.translation - printed.translation).norm() * 1e3;
        let turn = rotation_vector(&(flange.rotation * printed.rotation.transpose())).norm().to_degrees();
        assert!(off < 0.02 && turn < 0.002, "{off} mm, {turn} deg");
        assert_eq!(fanuc_config(robot.posture_words(Posture::of(&robot, &joints)), &angles), config);
    }
}
