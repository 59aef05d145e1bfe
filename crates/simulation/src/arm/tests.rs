use super::testing::{massless, spindle, start, tx200};
use super::*;
use nalgebra::Rotation3;
use proptest::prelude::*;
use stead_model::robot::chain::GRAVITY;

fn six(variant: Variant) -> Arm<6> {
    Arm::six(&tx200(), &spindle(), variant, &start()).unwrap()
}

fn eighteen(variant: Variant) -> Arm<18> {
    Arm::eighteen(&tx200(), &spindle(), variant, &start()).unwrap()
}

/// Where table 7 puts the tool: downwards, at the place that the digits of the table give.
#[test]
fn the_tool_stands_where_the_paper_has_it() {
    let spread = Arm::<18>::spread(&start());
    let poses = [
        six(Variant::Springs).chain.at(&start().into()).base_from_tip,
        eighteen(Variant::Orthogonal).chain.at(&spread).base_from_tip,
    ];
    for pose in poses {
        assert!((pose.translation - Vector3::new(0.79399, 0.18472, 0.31632)).amax() < 5e-6, "{}", pose.translation);
        assert!((pose.rotation.column(2) + Vector3::z()).norm() < 2e-4);
    }
}

/// At the robot's own zero (arm upright) all joints stand where table 1 adds them up to.
#[test]
fn bearings_stand_where_table_1_has_them() {
    let zero = [0.0, -90.0, 90.0, 0.0, 0.0, 0.0].map(f64::to_radians);
    let posed = eighteen(Variant::Orthogonal).chain.at(&Arm::<18>::spread(&zero));
    let expected = [
        [0.0, 0.0, 0.344],
        [0.25, 0.235, 0.642],
        [0.25, 0.279, 1.592],
        [0.25, 0.0, 1.771],
        [0.25, 0.0, 2.392],
        [0.25, 0.0, 2.569],
    ];
    for (j, place) in expected.into_iter().enumerate() {
        for k in 3 * j..3 * j + 3 {
            assert!((posed.origins[k] - Vector3::from(place)).norm() < 1e-12, "{j} {}", posed.origins[k]);
        }
        let motor = if [0, 3, 5].contains(&j) { Vector3::z() } else { Vector3::y() };
        assert!((posed.axes[3 * j] - motor).norm() < 1e-12);
    }
}

proptest! {
    /// With stiff orthogonal joints at zero, the larger chain is the smaller one.
    #[test]
    fn both_chains_are_the_same_arm(
        q in prop::array::uniform6(-3.0..3.0_f64), speed in prop::array::uniform6(-1.0..1.0_f64),
        rate in prop::array::uniform6(-1.0..1.0_f64)
    ) {
        let (small, large) = (six(Variant::Gravity), eighteen(Variant::Orthogonal));
        let (few, many) = (small.chain.at(&q.into()), large.chain.at(&Arm::<18>::spread(&q)));
        prop_assert!((few.tip() - many.tip()).norm() < 1e-12);
        let zero = Vector3::zeros();
        let all = many.inverse_dynamics(&large.chain, &Arm::<18>::spread(&speed), &Arm::<18>::spread(&rate), &zero);
        let torques = few.inverse_dynamics(&small.chain, &speed.into(), &rate.into(), &zero);
        let (gravity, all_gravity) = (few.gravity(&small.chain), many.gravity(&large.chain));
        for j in 0..6 {
            prop_assert!((torques[j] - all[3 * j]).abs() < 1e-9, "{} {}", torques[j], all[3 * j]);
            prop_assert!((gravity[j] - all_gravity[3 * j]).abs() < 1e-9);
        }
    }
}

/// However the robot is mounted, gravity is that of the cell: as in its own frame the field turned with it.
#[test]
fn gravity_is_that_of_the_cell() {
    let (wall, ceiling) = ([90.0_f64, 0.0, 0.0], [180.0_f64, 0.0, 30.0]);
    for [roll, pitch, yaw] in [wall, ceiling] {
        let turn = Rotation3::from_euler_angles(roll.to_radians(), pitch.to_radians(), yaw.to_radians());
        let mount = Pose { rotation: turn.into_inner(), translation: Vector3::new(0.3, -0.2, 1.9) };
        let robot = tx200().mounted(&mount);
        let field = turn.inverse() * Vector3::new(0.0, 0.0, -GRAVITY);
        let mut upright = six(Variant::Gravity);
        upright.chain = upright.chain.with_gravity(field);
        let mounted = Arm::six(&robot, &spindle(), Variant::Gravity, &start()).unwrap();
        let torques = [&mounted, &upright].map(|arm| arm.chain.at(&start().into()).gravity(&arm.chain));
        assert!((torques[0] - torques[1]).amax() < 1e-9, "{torques:?}");
        let on_the_floor = six(Variant::Gravity).chain;
        assert!((torques[0] - on_the_floor.at(&start().into()).gravity(&on_the_floor)).amax() > 100.0);
        let mut upright = eighteen(Variant::Orthogonal);
        upright.chain = upright.chain.with_gravity(field);
        let mounted = Arm::eighteen(&robot, &spindle(), Variant::Orthogonal, &start()).unwrap();
        let torques = [&mounted, &upright].map(|arm| arm.chain.at(&Arm::<18>::spread(&start())).gravity(&arm.chain));
        assert!((torques[0] - torques[1]).amax() < 1e-9, "{torques:?}");
    }
}

/// Eq. 9, in the direction of joint 5: what wrist, flange and payload weigh about it, arm upright but for the wrist.
#[test]
fn gravity_about_joint_5_is_that_of_the_levers() {
    let arm = six(Variant::Gravity);
    for bend in [0.3_f64, -0.8] {
        let q = [0.0, -90_f64.to_radians(), 90_f64.to_radians(), 0.0, bend, 0.0];
        let torque = arm.chain.at(&q.into()).gravity(&arm.chain)[4];
        let levers = 0.068 * 14.0 + (0.194 - 0.012) * 0.6 + (0.194 + 0.158) * 44.4;
        let across = 44.4 * -0.004;
        let expected = -GRAVITY * (levers * libm::sin(bend) + across * libm::cos(bend));
        assert!((torque - expected).abs() < 1e-9, "{torque} {expected}");
    }
}

/// Eq. 9 knows of no joint 4: compensators carry all of gravity where the arm is in a plane, and what they would there
/// elsewhere.
#[test]
fn compensators_take_the_gravity_of_an_arm_in_a_plane() {
    let arm = six(Variant::Gravity);
    let gravity = |q: [f64; 6]| arm.chain.at(&q.into()).gravity(&arm.chain);
    let felt = |q: [f64; 6]| arm.felt_gravity(&arm.chain.at(&q.into()), &q.into());
    let q = start();
    let planar = [q[0], q[1], q[2], 0.0, q[4], 0.0];
    for j in 0..6 {
        let is_compensated = [1, 2, 4].contains(&j);
        let [left, expected] = match is_compensated {
            true => [felt(q)[j], gravity(q)[j] - gravity(planar)[j]],
            false => [felt(q)[j], gravity(q)[j]],
        };
        assert!((left - expected).abs() < 1e-9, "{j} {left} {expected}");
        assert!(!is_compensated || felt(planar)[j].abs() < 1e-9 && left.abs() > 1.0, "{j} {left}");
    }
}

/// Linear between angles at which it is made anew, wrong by some millionths of the 1000 N m that it takes.
#[test]
fn a_compensation_follows_the_arm() {
    let arm = eighteen(Variant::Orthogonal);
    let mut q = Arm::<18>::spread(&start());
    let mut compensation = Compensation::about(&arm, &q);
    for step in 0..50 {
        q += SVector::<f64, 18>::from_fn(|j, _| 1e-4 * (1.0 + libm::sin((step * 5 + j) as f64)));
        let gravity = arm.chain.at(&q).gravity(&arm.chain);
        let expected = gravity - arm.felt_gravity(&arm.chain.at(&q), &q);
        assert!(expected.amax() > 900.0);
        let taken = compensation.taken(&arm, &q);
        assert!((taken - expected).amax() < 5e-3, "{}", taken - expected);
    }
    assert!(compensation.at != Arm::<18>::spread(&start()));
}

#[test]
fn at_rest_drives_hold_what_is_not_compensated() {
    let arm = eighteen(Variant::Backlash);
    let reference = Arm::<18>::spread(&start());
    let (q, zero) = (arm.at_rest(&reference), SVector::zeros());
    let mut compensation = Compensation::about(&arm, &q);
    let out = arm.unbalanced(&arm.chain.at(&q), [&q, &zero, &zero], [&reference, &zero], &mut compensation);
    assert!(out.amax() < 1e-6, "{out}");
    let gap = (15.0_f64 / 3600.0).to_radians();
    // Joint 1, which carries nothing, stands in the middle of its play, the others at its end.
    let off = q - reference;
    assert!(off[0].abs() < 1e-12, "{off}");
    assert!((1..6).all(|j| off[3 * j].abs() > gap), "{off}");
    let rigid = six(Variant::Springs);
    assert_eq!(rigid.at_rest(&start().into()), SVector::from(start()));
}

#[test]
fn what_is_missing_is_said() {
    let (robot, spindle) = (tx200(), spindle());
    assert_eq!(Arm::six(&massless(&robot), &spindle, Variant::Springs, &start()), Err(Missing::Dynamics));
    let mut dynamics = *robot.dynamics().unwrap();
    dynamics[2].orthogonal = None;
    let robot = robot.with_dynamics(dynamics);
    assert!(AnyArm::new(&robot, &spindle, Variant::Gravity, &start()).is_ok());
    let missing = AnyArm::new(&robot, &spindle, Variant::Backlash, &start());
    assert_eq!(missing, Err(Missing::Orthogonal(3)));
}
