use super::*;
use crate::arm::testing::{spindle, start, tx200};
use proptest::prelude::*;
use stead_model::robot::turns::Range;

const RAMP: Ramp = Ramp { feed: 3.7 / 60.0, time: 0.2 };

fn pass(direction: Vector3<f64>, length: f64) -> Pass {
    Pass { start: start(), direction, length }
}

#[test]
fn the_ramp_is_smooth_and_reaches_the_feed() {
    let h = 1e-6;
    let mut acceleration_before = 0.0;
    for k in 1..300 {
        let time = 0.001 * f64::from(k);
        let slope = (RAMP.at(time + h).0 - RAMP.at(time - h).0) / (2.0 * h);
        let (distance, speed) = RAMP.at(time);
        assert!((slope - speed).abs() < 1e-9, "{time}: {slope} {speed}");
        let acceleration = (RAMP.at(time + h).1 - RAMP.at(time - h).1) / (2.0 * h);
        // The jerk is at most 4 feed / time^2.
        let jerk = 4.0 * RAMP.feed / (RAMP.time * RAMP.time);
        assert!((acceleration - acceleration_before).abs() <= jerk * 0.001 * 1.001, "{time}");
        acceleration_before = acceleration;
        assert!((RAMP.time_of(distance) - time).abs() < 1e-9);
    }
    assert_eq!(RAMP.at(0.0), (0.0, 0.0));
    assert_eq!(RAMP.at(0.2).1, RAMP.feed);
    assert!((RAMP.at(0.2).0 - RAMP.feed * 0.1).abs() < 1e-15);
    let at_once = Ramp { time: 0.0, ..RAMP };
    assert_eq!((at_once.at(0.0), at_once.at(2.0)), ((0.0, RAMP.feed), (2.0 * RAMP.feed, RAMP.feed)));
}

proptest! {
    /// Everywhere along the pass, also between knots, the arm stands where the tool should be, and moves as it should.
    #[test]
    fn the_motors_take_the_tool_along_the_pass(time in 0.0..1.6_f64, heading in 0.0..std::f64::consts::TAU) {
        let (robot, spindle) = (tx200(), spindle());
        let direction = Vector3::new(libm::cos(heading), libm::sin(heading), 0.0);
        let motion = Motion::new(&robot, &spindle, &pass(direction, 0.1), RAMP).unwrap();
        let (angles, speeds) = motion.motors(time);
        let pose = robot.forward(&angles).then(&spindle.flange_from_tool);
        let (wanted, distance) = motion.tool(time);
        prop_assert!((pose.translation - wanted).norm() < 1e-12, "{}", (pose.translation - wanted).norm());
        prop_assert!((pose.rotation - motion.start.rotation).amax() < 1e-12);
        prop_assert!((wanted - motion.start.translation - direction * distance).norm() < 1e-15);
        let velocity = Frames::new(&robot, &angles).jacobian(&pose.translation) * Vector6::from(speeds);
        let expected = direction * RAMP.at(time).1;
        prop_assert!((velocity.fixed_rows::<3>(0) - expected).norm() < 1e-9);
        prop_assert!(velocity.fixed_rows::<3>(3).norm() < 1e-9);
    }
}

#[test]
fn a_pass_starts_at_the_angles_given_and_ends_in_time() {
    let motion = Motion::new(&tx200(), &spindle(), &pass(Vector3::x(), 0.1), RAMP).unwrap();
    let (angles, speeds) = motion.motors(0.0);
    for j in 0..6 {
        assert!((angles[j] - start()[j]).abs() < 1e-12 && speeds[j] == 0.0);
    }
    assert!((motion.duration() - (0.1 / RAMP.feed + 0.1)).abs() < 1e-12);
    assert!((motion.tool(motion.duration()).1 - 0.1).abs() < 1e-15);
    // Joint 6 starts beyond half a turn in this posture and stays there.
    let mut turned = pass(Vector3::x(), 0.1);
    turned.start[5] += TAU;
    let further = Motion::new(&tx200(), &spindle(), &turned, RAMP).unwrap().motors(1.0).0[5];
    assert!((further - motion.motors(1.0).0[5] - TAU).abs() < 1e-12);
}

#[test]
fn what_the_arm_cannot_follow_is_said_with_its_place() {
    let (robot, spindle) = (tx200(), spindle());
    let far = Motion::new(&robot, &spindle, &pass(Vector3::x(), 5.0), RAMP).unwrap_err();
    assert!(matches!(far, MotionError::Unreachable { distance_mm, .. } if distance_mm > 500.0), "{far}");
    let mut joints = robot.joints().clone();
    let at = Range::of(&joints[0]).nearest(start()[0]).0;
    joints[0].min = at - 0.01;
    let narrow = Robot::new("narrow", joints).unwrap();
    let error = Motion::new(&narrow, &spindle, &pass(-Vector3::y(), 0.3), RAMP).unwrap_err();
    assert!(matches!(error, MotionError::Limit { joint: 1, .. }), "{error}");
}
