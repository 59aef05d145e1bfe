//! The highest feed in closed form, and against the joint speeds of random plans sampled densely.

use super::*;
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis, robot_from_workpiece};
use stead_model::robot::testing::{kr270, robot_from};
use stead_model::robot::{Pose, Posture, Robot, angles::nearest_turns};
use stead_problem::problem::Placement;
use stead_problem::setup::AxisPositions;
use stead_problem::straight_move::StraightMove;
use stead_problem::testing::five_segments;

const BLEND: f64 = 5e-3;

/// The problem of an arm with these speeds and accelerations; without a spindle the tool centre point is the flange's,
/// for this arm the wrist centre.
fn problem(limits: [(Option<f64>, Option<f64>); 6], with_spindle: bool) -> Problem {
    let mut problem = five_segments();
    let mut joints = kr270().joints().clone();
    for (joint, (speed, acceleration)) in joints.iter_mut().zip(limits) {
        (joint.max_speed, joint.max_acceleration) = (speed, acceleration);
    }
    problem.robot = Robot::new("limited", joints).unwrap();
    if !with_spindle {
        problem.spindle.flange_from_tool = Pose::identity();
    }
    problem
}

/// No limit but those of one joint (from 1).
fn only(joint: usize, speed: Option<f64>, acceleration: Option<f64>) -> [(Option<f64>, Option<f64>); 6] {
    std::array::from_fn(|j| if j + 1 == joint { (speed, acceleration) } else { (None, None) })
}

fn plan(robot: &Robot, joints: Vec<[f64; 6]>) -> SegmentPlan {
    let posture = Posture::of(robot, &joints[0]);
    SegmentPlan { points: 0..joints.len(), posture, betas: vec![0.0; joints.len()], joints, cost: 0.0 }
}

/// The plan with which the flange comes to these poses.
fn through(robot: &Robot, posture: Posture, poses: &[Pose<f64>]) -> SegmentPlan {
    let mut joints: Vec<[f64; 6]> = Vec::new();
    for pose in poses {
        let found = robot.inverse(pose, posture).unwrap();
        let near = joints.last().copied().unwrap_or(found);
        joints.push(nearest_turns(&found, &near));
    }
    SegmentPlan { posture, ..plan(robot, joints) }
}

#[test]
fn a_straight_line_past_joint_1_is_held_by_its_speed_at_the_nearest_place_between_points() {
    let speed = 1.2;
    let problem = problem(only(1, Some(speed), None), false);
    let rotation = problem.robot.forward(&[0.0, 0.9, -1.8, 0.3, 0.7, -0.2]).rotation;
    let (distance, half) = (1.5, 0.2);
    let pose = |y: f64| Pose { rotation, translation: Vector3::new(distance, y, 0.1) };
    let plan = through(&problem.robot, Posture::ALL[2], &[pose(-half), pose(half)]);
    let feed = cut_feed(&problem, BLEND, &[plan]);
    let limit = feed.highest().unwrap();
    // theta_1 = atan(y / distance).
    assert!((limit.feed / (speed * distance) - 1.0).abs() < 1e-12, "{limit:?}");
    assert!(limit.feed < 0.999 * speed * 2.0 * half / (2.0 * libm::atan(half / distance)));
    assert_eq!((limit.joint, limit.kind, limit.segment), (1, FeedLimitKind::Speed, 1));
    assert_eq!((feed.slowed(), feed.held(0)), (0, feed.programmed));
}

/// A radial line with the flange's axis vertical: joint 6 alone turns the flange about it.
fn turning(robot: &Robot, angles: &[f64], spacing: f64) -> SegmentPlan {
    let down = Rotation3::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
    let poses = angles.iter().enumerate().map(|(k, angle)| Pose {
        rotation: *(down * Rotation3::from_euler_angles(0.0, 0.0, *angle)).matrix(),
        translation: Vector3::new(1.4 + spacing * k as f64, 0.0, 0.2),
    });
    through(robot, Posture::ALL[2], &poses.collect::<Vec<_>>())
}

#[test]
fn a_turn_that_grows_with_the_square_of_the_way_is_held_by_acceleration_or_speed() {
    let (curvature, spacing) = (40.0, 1e-3);
    let angles: Vec<f64> =
        (0..60).map(|k| 0.5 * curvature * (spacing * f64::from(k)) * (spacing * f64::from(k))).collect();
    for (speed, acceleration, kind) in [(9.0, 2.0, FeedLimitKind::Acceleration), (0.1, 9.0, FeedLimitKind::Speed)] {
        let problem = problem(only(6, Some(speed), Some(acceleration)), false);
        let feed = cut_feed(&problem, BLEND, &[turning(&problem.robot, &angles, spacing)]);
        let limit = feed.highest().unwrap();
        let expected = match kind {
            FeedLimitKind::Acceleration => libm::sqrt(acceleration / curvature),
            // In the last step, the steepest.
            FeedLimitKind::Speed => speed * spacing / (angles[59] - angles[58]),
        };
        assert!((limit.feed / expected - 1.0).abs() < 1e-6, "{limit:?} and not {expected}");
        assert_eq!((limit.joint, limit.kind), (6, kind));
        if kind == FeedLimitKind::Speed {
            assert!(limit.point >= 58);
            assert_eq!((feed.slowed(), feed.held(0)), (1, limit.feed));
        }
    }
}

#[test]
fn beta_that_trembles_from_point_to_point_counts_as_far_as_the_blended_path_does() {
    let (tremble, spacing, acceleration) = (1e-4, 1e-4, 2.0);
    let angles: Vec<f64> = (0..400).map(|k| if k % 2 == 0 { tremble } else { -tremble }).collect();
    let problem = problem(only(6, None, Some(acceleration)), false);
    let feed = cut_feed(&problem, BLEND, &[turning(&problem.robot, &angles, spacing)]).highest().unwrap().feed;
    // At the worst all of the tremble is in the second difference over the blending distance.
    assert!(feed >= libm::sqrt(acceleration * BLEND * BLEND / (4.0 * tremble)) * 0.999, "{feed}");
}

#[test]
fn a_limit_that_is_not_known_is_not_guessed() {
    let problem = problem(only(6, None, None), false);
    let feed = cut_feed(&problem, BLEND, &[turning(&problem.robot, &[0.0, 0.5, 1.0], 1e-2)]);
    assert_eq!((feed.highest(), feed.slowed(), feed.held(0)), (None, 0, problem.redundancy.feed));
}

#[test]
fn a_single_point_holds_any_feed() {
    let problem = problem([(Some(1.0), Some(1.0)); 6], true);
    let feed = cut_feed(&problem, BLEND, &[plan(&problem.robot, vec![[0.1, 0.9, -1.8, 0.3, 0.7, -0.2]])]);
    assert_eq!(feed.segments, [None]);
}

/// The largest speeds of the joints per unit of feed along a plan, from densely sampled joint angles alone. rad/m
fn largest_speeds(problem: &Problem, plan: &SegmentPlan) -> Option<[f64; 6]> {
    const PARTS: usize = 4000;
    let tool = &problem.spindle.flange_from_tool;
    let mut largest = [0.0_f64; 6];
    for pair in plan.joints.windows(2) {
        let [from, to] = [0, 1].map(|k| problem.robot.forward(&pair[k]).then(tool));
        let length = (to.translation - from.translation).norm();
        let turn = Rotation3::from_matrix_unchecked(from.rotation.transpose() * to.rotation).scaled_axis();
        let mut before = pair[0];
        for part in (1..=PARTS).map(|k| k as f64 / PARTS as f64) {
            let pose = Pose {
                rotation: from.rotation * Rotation3::from_scaled_axis(turn * part).matrix(),
                translation: from.translation.lerp(&to.translation, part),
            };
            let found = problem.robot.inverse(&pose.then(&tool.inverse()), plan.posture).ok()?;
            let now = nearest_turns(&found, &before);
            for j in 0..6 {
                largest[j] = largest[j].max((now[j] - before[j]).abs() * PARTS as f64 / length);
            }
            before = now;
        }
        if (0..6).any(|j| (before[j] - pair[1][j]).abs() > 1e-6) {
            return None;
        }
    }
    Some(largest)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn at_the_highest_feed_every_speed_holds_and_beyond_it_one_does_not(
        start in prop::array::uniform6(-0.4..0.4_f64),
        changes in prop::collection::vec(prop::array::uniform6(-0.06..0.06_f64), 2..6),
        speeds in prop::array::uniform6(0.5..3.0_f64),
        wrist in 0.1..0.8_f64,
    ) {
        let problem = problem(speeds.map(|speed| (Some(speed), None)), true);
        let middle = [0.0, 1.0, -2.4, 0.2, 0.0, 0.4];
        let mut joints: [f64; 6] = std::array::from_fn(|j| middle[j] + start[j]);
        joints[4] = wrist;
        let mut path = vec![joints];
        for change in changes {
            joints = std::array::from_fn(|j| joints[j] + change[j]);
            path.push(joints);
        }
        let posture = Posture::of(&problem.robot, &path[0]);
        prop_assume!(path.iter().all(|joints| Posture::of(&problem.robot, joints) == posture));
        let tips = path.iter().map(|joints| problem.robot.forward(joints).then(&problem.spindle.flange_from_tool));
        let tips: Vec<Vector3<f64>> = tips.map(|pose| pose.translation).collect();
        // Nearer to the singularity of the wrist the samples are too far apart.
        prop_assume!(path.iter().all(|joints| joints[4] > 0.08));
        prop_assume!(tips.windows(2).all(|pair| (pair[1] - pair[0]).norm() > 1e-3));
        let plan = plan(&problem.robot, path);
        let Some(largest) = largest_speeds(&problem, &plan) else { return Ok(()) };
        let limit = cut_feed(&problem, BLEND, &[plan]).highest().unwrap();
        let used = |feed: f64| (0..6).map(|j| largest[j] * feed / speeds[j]).fold(0.0, f64::max);
        prop_assert!(used(limit.feed) <= 1.0005, "{} at {:?}", used(limit.feed), limit);
        prop_assert!(used(1.002 * limit.feed) > 1.0, "{} at {:?}", used(limit.feed), limit);
    }
}

#[test]
fn an_arm_with_offsets_and_a_tilted_base_is_followed_too() {
    let wide = (-350.0, 350.0);
    let mut joints = robot_from([
        (20.0, 0.1, 0.4, wide.0, wide.1, 1.0),
        (90.0, 0.3, 0.07, wide.0, wide.1, 2.0),
        (0.0, 0.9, -0.02, wide.0, wide.1, 3.0),
        (-90.0, -0.05, 0.8, wide.0, wide.1, 4.0),
        (90.0, 0.0, 0.0, wide.0, wide.1, 5.0),
        (-90.0, 0.0, 0.15, wide.0, wide.1, 6.0),
    ])
    .joints()
    .clone();
    joints.iter_mut().for_each(|joint| joint.max_speed = Some(1.5));
    let mut problem = five_segments();
    problem.robot = Robot::new("odd", joints).unwrap();
    let path = (0..8).map(|k| [0.3, 0.9, -0.6, 0.4, 0.8, -0.2].map(|angle| angle * (1.0 + 0.02 * f64::from(k))));
    let plan = plan(&problem.robot, path.collect());
    let largest = largest_speeds(&problem, &plan).unwrap().into_iter().fold(0.0, f64::max);
    let limit = cut_feed(&problem, BLEND, &[plan]).highest().unwrap();
    assert!((limit.feed * largest / 1.5 - 1.0).abs() < 1e-3, "{limit:?}");
}

/// On a table that turns in the cut the line is straight in the frame of the part.
#[test]
fn speeds_are_those_of_a_line_on_a_turning_table() {
    let mut problem = problem([(Some(1.5), None); 6], true);
    problem.external_axes = vec![ExternalAxis {
        name: "table".to_owned(),
        kind: AxisKind::Turntable,
        carries: Carried::Workpiece,
        direction: Vector3::z(),
        point: Vector3::new(1.8, 0.0, 0.0),
        min: -1.0,
        max: 1.0,
        max_speed: None,
        axis_use: AxisUse::Continuous,
    }];
    let turned = |point: usize| vec![if point == 0 { -0.4 } else { 0.4 }];
    problem.setup.positions = AxisPositions::PerPoint((0..problem.task.points().len()).map(turned).collect());
    let joints = [[0.0, 0.9, -1.8, 0.3, 0.7, -0.2], [0.1, 0.95, -1.7, 0.5, 0.6, -0.3]];
    let plan = plan(&problem.robot, joints.to_vec());
    let placement = Placement::from([0.0; 4]);
    let straight = StraightMove::new(&problem, &placement, 1, plan.posture, joints);
    let (mut last, mut largest) = (joints[0], 0.0_f64);
    let count = 20_000;
    for step in 1..=count {
        let flange = straight.flange_at(f64::from(step) / f64::from(count));
        let found = nearest_turns(&problem.robot.inverse(&flange, plan.posture).unwrap(), &last);
        largest = (0..6).map(|j| (found[j] - last[j]).abs() * f64::from(count)).fold(largest, f64::max);
        last = found;
    }
    let tool = |point: usize| {
        let part = robot_from_workpiece(&problem.external_axes, problem.axis_positions(point));
        part.inverse()
            .point(&problem.robot.forward(&joints[point]).point(&problem.spindle.flange_from_tool.translation))
    };
    let expected = 1.5 * (tool(1) - tool(0)).norm() / largest;
    let limit = cut_feed(&problem, BLEND, std::slice::from_ref(&plan)).highest().unwrap();
    assert!((limit.feed / expected - 1.0).abs() < 1e-3, "{limit:?} and not {expected}");
    problem.setup.positions = AxisPositions::Same(vec![0.0]);
    let still = cut_feed(&problem, BLEND, &[plan]).highest().unwrap();
    assert!((still.feed / expected - 1.0).abs() > 5e-3, "{still:?}: the table does not matter");
}

/// An external axis that is slower than all joints decides, and is told by its name.
#[test]
fn an_external_axis_that_decides_is_named() {
    let limit = |joint: usize| FeedLimit { feed: 0.02, kind: FeedLimitKind::Speed, joint, segment: 2, point: 7 };
    let problem = five_segments();
    let feed = CutFeed { external_axes: vec!["rail".to_owned(), "table".to_owned()], ..cut_feed(&problem, BLEND, &[]) };
    assert_eq!((feed.external_axis(&limit(6)), feed.external_axis(&limit(8))), (None, Some("table")));
    assert_eq!(feed.decided_by(&limit(6)), "speed of joint 6 at point 7, segment 2");
    assert_eq!(feed.decided_by(&limit(8)), "speed of external axis \"table\" at point 7, segment 2");
}
