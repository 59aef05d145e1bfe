//! The elastic arm against figures from elsewhere, the arm about its axes, and energies and closed forms.

use super::super::equilibrium::{Load, equilibrium};
use super::super::loaded::loaded_displacement;
use super::super::whole::WholeArm;
use super::super::whole::tests::oracle::{Row, micro, rows};
use super::super::whole::tests::{everything, matrix, normal_springs};
use super::*;
use crate::robot::testing::{irb4400, kr270, linked_arms, odd_arms, spindle};
use crate::robot::{BaseCompliance, Frames, Inertial, JointDynamics, SpringModel};
use nalgebra::{Vector6, vector};
use proptest::prelude::*;
use stead_numerics::rotation::{rotation_from_zyx, rotation_vector};

const FREE_FALL: Vector3<f64> = vector![0.0, 0.0, -9.81];

fn load(wrench: [f64; 6]) -> Wrench {
    let [fx, fy, fz, mx, my, mz] = wrench;
    Wrench { force: vector![fx, fy, fz], moment: vector![mx, my, mz] }
}

fn scaled(load: &Wrench, share: f64) -> Wrench {
    Wrench { force: load.force * share, moment: load.moment * share }
}

/// Half the way from one pose to another, over a share of the load.
fn slope(up: &Pose<f64>, down: &Pose<f64>, share: f64) -> Displacement<f64> {
    Displacement {
        linear: (up.translation - down.translation) / (2.0 * share),
        angular: rotation_vector(&(up.rotation * down.rotation.transpose())) / (2.0 * share),
    }
}

/// Links with mass, some joints with a compensator, and a spindle of 61 kg, 250 mm from the flange.
fn heavy(robot: Robot, spindle: Spindle) -> (Robot, Spindle) {
    let dynamics = std::array::from_fn(|j| {
        let k = j as f64;
        let centre = vector![0.1 + 0.05 * k, -0.04 * k, 0.1 - 0.03 * k];
        JointDynamics {
            link: Inertial::new(300.0 / (k + 1.0), centre, Matrix3::identity()).unwrap(),
            damping: 1.0,
            backlash: 0.0,
            gravity_compensated: j == 1,
            orthogonal: None,
            bearing: 0.0,
        }
    });
    let mass = PointMass { mass: 61.0, centre: vector![0.02, -0.05, 0.25] };
    (robot.with_dynamics(dynamics), Spindle { point_mass: Some(mass), ..spindle })
}

#[test]
fn the_slope_of_the_arm_at_rest_is_what_another_program_has() {
    let rows = rows();
    assert_eq!(rows.len(), 54);
    for Row { arm, springs, theta, force, moment, moved } in rows {
        let (robot, spindle) = arm.arm(&springs);
        let elastic = ElasticArm::new(&robot, &spindle);
        let at = |share: f64| elastic.at_rest(&theta, &Wrench { force: force * share, moment: moment * share });
        let found = slope(&at(0.002).unwrap(), &at(-0.002).unwrap(), 0.002);
        let found = micro(&(found.linear + arm.of_part(&springs, &force)), &found.angular);
        for part in 0..2 {
            let [found, expected] = [&found, &moved].map(|all| all.fixed_rows::<3>(3 * part).into_owned());
            assert!((found - expected).norm() < 3e-9 * expected.norm(), "{springs}: {found} {expected}");
        }
    }
}

#[test]
fn a_mounted_arm_rests_as_it_does_on_the_floor() {
    let mount = Pose { rotation: rotation_from_zyx([0.4, -1.1, 2.0]), translation: vector![0.3, -0.7, 1.9] };
    let theta = [0.3, 0.4, -1.2, 0.5, 0.7, 0.9];
    let pressed = load([500.0, -800.0, 300.0, 20.0, -30.0, 10.0]);
    for arm in odd_arms().into_iter().step_by(5) {
        let (arm, spindle) = everything(arm);
        let (arm, spindle) = heavy(arm, spindle);
        let turned = |v: &Vector3<f64>| mount.rotation * v;
        let on_the_floor = ElasticArm::new(&arm, &spindle).in_gravity(mount.rotation.tr_mul(&FREE_FALL));
        let expected = mount.then(&on_the_floor.at_rest(&theta, &pressed).unwrap());
        let sag = on_the_floor.sag(&theta);
        let mounted = arm.clone().mounted(&mount);
        let mounted = ElasticArm::new(&mounted, &spindle).in_gravity(FREE_FALL);
        let pressed = Wrench { force: turned(&pressed.force), moment: turned(&pressed.moment) };
        let found = mounted.at_rest(&theta, &pressed).unwrap();
        assert!((found.translation - expected.translation).norm() < 1e-12);
        assert!((found.rotation - expected.rotation).norm() < 1e-12);
        assert!((mounted.sag(&theta).linear - turned(&sag.linear)).norm() < 1e-12);
        assert!(sag.linear.norm() > 1e-4);
    }
}

proptest! {
    #[test]
    fn an_arm_about_its_axes_rests_where_its_six_springs_say(
        theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-5e3..5e3_f64), arm in 0..32_usize
    ) {
        let robot = &odd_arms()[arm];
        let spindle = spindle();
        let pressed = load(wrench);
        let found = ElasticArm::new(robot, &spindle).at_rest(&theta, &pressed).unwrap();
        let load = Load { point: spindle.flange_from_tool.translation, force: pressed.force, moment: pressed.moment };
        let expected = robot.forward(&equilibrium(robot, &theta, &load).unwrap()).then(&spindle.flange_from_tool);
        prop_assert!((found.translation - expected.translation).norm() < 1e-12);
        prop_assert!((found.rotation - expected.rotation).norm() < 1e-12);
        let frames = Frames::new(robot, &theta);
        let point = frames.base_from_flange.point(&load.point);
        let compliances = robot.compliances_at(&theta);
        let plain = loaded_displacement(&frames, &point, &compliances, &load.force, &load.moment).unwrap();
        let moved = ElasticArm::new(robot, &spindle).loaded_displacement(&compliances, &theta, &pressed).unwrap();
        prop_assert!((moved.linear - plain.linear).norm() < 1e-12 && (moved.angular - plain.angular).norm() < 1e-12);
    }

    #[test]
    fn torques_balance_whatever_yields(
        theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-2e3..2e3_f64), arm in 0..32_usize
    ) {
        let (robot, spindle) = everything(odd_arms()[arm].clone());
        let (robot, spindle) = heavy(robot, spindle);
        let elastic = ElasticArm::new(&robot, &spindle).in_gravity(FREE_FALL);
        let scale = elastic.scale_at(&robot.compliances_at(&theta));
        let pressed = load(wrench);
        let taken = elastic.taken(&theta);
        let rest = settled(&scale, Coordinates::zeros(), |deflection| {
            let posed = elastic.posed(&theta, &(scale * deflection));
            let applied = elastic.applied(&posed, &pressed, 1.0);
            let inverse = inverse_tangent(&(scale.tr_mul(&posed.hessian(&applied)) * scale))?;
            Some((inverse, posed.torques(&applied) + taken))
        })
        .unwrap();
        let posed = elastic.posed(&theta, &(scale * rest));
        let applied = elastic.applied(&posed, &pressed, 1.0);
        let off = rest - scale.tr_mul(&(posed.torques(&applied) + taken));
        prop_assert!((scale * off).amax() < 1e-13, "{}", (scale * off).amax());
        // The Hessian is the slope of the torques.
        let h = 1e-6;
        let hessian = posed.hessian(&applied);
        let size = hessian.amax();
        for k in 0..COUNT {
            let at = |side: f64| {
                let mut q = scale * rest;
                q[k] += side * h;
                let posed = elastic.posed(&theta, &q);
                posed.torques(&elastic.applied(&posed, &pressed, 1.0))
            };
            let slope = (at(1.0) - at(-1.0)) / (2.0 * h);
            prop_assert!((hessian.column(k) - slope).amax() < 1e-7 * size, "{} {}", k, (hessian.column(k) - slope).amax());
        }
    }

    #[test]
    fn sag_is_the_slope_of_the_rest_by_the_weight(
        theta in prop::array::uniform6(-3.0..3.0_f64), arm in 0..32_usize
    ) {
        let (robot, spindle) = everything(odd_arms()[arm].clone());
        let (robot, spindle) = heavy(robot, spindle);
        let at = |share: f64| {
            let elastic = ElasticArm::new(&robot, &spindle).in_gravity(FREE_FALL * share);
            elastic.at_rest(&theta, &Wrench::default()).unwrap()
        };
        let expected = slope(&at(0.01), &at(-0.01), 0.01);
        let found = ElasticArm::new(&robot, &spindle).in_gravity(FREE_FALL).sag(&theta);
        prop_assert!((found.linear - expected.linear).norm() < 1e-6 * expected.linear.norm());
        prop_assert!((found.angular - expected.angular).norm() < 1e-6 * expected.angular.norm());
    }

    #[test]
    fn the_loaded_displacement_agrees_with_the_rest_but_for_the_square_of_the_load(
        theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-30.0..30.0_f64), arm in 0..32_usize
    ) {
        let (robot, spindle) = everything(odd_arms()[arm].clone());
        let elastic = ElasticArm::new(&robot, &spindle);
        let compliances = robot.compliances_at(&theta);
        let unloaded = elastic.posed(&theta, &Coordinates::zeros()).base_from_tool;
        let error = |share: f64| {
            let pressed = scaled(&load(wrench), share);
            let rest = elastic.at_rest(&theta, &pressed).unwrap();
            let found = elastic.loaded_displacement(&compliances, &theta, &pressed).unwrap();
            rest.translation - unloaded.translation - found.linear
        };
        let (full, half) = (error(1.0), error(0.5));
        // What is left is of third order in the load, which bends this soft arm by less than a thousandth.
        prop_assert!((half * 4.0 - full).norm() < 5e-3 * full.norm() + 1e-13, "{} {}", full, half);
        let frames = Frames::new(&robot, &theta);
        let tip = unloaded.translation;
        let whole = WholeArm::new(&robot, &spindle, &frames, compliances, tip);
        let pressed = scaled(&load(wrench), 1e-3);
        let small = elastic.loaded_displacement(&compliances, &theta, &pressed).unwrap();
        let sum = whole.displacement(&pressed.force, &pressed.moment);
        prop_assert!((small.linear - sum.linear).norm() < 1e-6 * sum.linear.norm());
    }
}

proptest! {
    #[test]
    fn an_arm_with_a_linkage_rests_where_its_six_springs_say(
        theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-5e3..5e3_f64), arm in 0..32_usize
    ) {
        let robot = &linked_arms()[arm];
        let spindle = spindle();
        let pressed = load(wrench);
        let elastic = ElasticArm::new(robot, &spindle);
        let found = elastic.at_rest(&theta, &pressed).unwrap();
        let load = Load { point: spindle.flange_from_tool.translation, force: pressed.force, moment: pressed.moment };
        let expected = robot.forward(&equilibrium(robot, &theta, &load).unwrap()).then(&spindle.flange_from_tool);
        prop_assert!((found.translation - expected.translation).norm() < 1e-12);
        let frames = Frames::new(robot, &theta);
        let point = frames.base_from_flange.point(&load.point);
        let compliances = robot.compliances_at(&theta);
        let plain = loaded_displacement(&frames, &point, &compliances, &load.force, &load.moment).unwrap();
        let moved = elastic.loaded_displacement(&compliances, &theta, &pressed).unwrap();
        prop_assert!((moved.linear - plain.linear).norm() < 1e-12 && (moved.angular - plain.angular).norm() < 1e-12);
    }
}

/// Weight turns the spring of joint 2 by the torque about it less that about joint 3, and that of axis 3 by the latter.
#[test]
fn weight_on_a_linkage_is_carried_by_both_motors_and_a_compensator_stays_with_the_upper_arm() {
    let mass = PointMass { mass: 61.0, centre: vector![0.02, -0.05, 0.25] };
    let spindle = Spindle { point_mass: Some(mass), ..spindle() };
    let theta = [0.3, 0.9, -2.9, 0.0, 0.4, 0.0];
    let frames = Frames::new(&irb4400(), &theta);
    let [centre, tip] =
        [mass.centre, spindle.flange_from_tool.translation].map(|place| frames.base_from_flange.point(&place));
    let torque = |j: usize| frames.twist(j, &centre).0.z * -9.81 * 61.0;
    let moves = |j: usize| frames.twist(j, &tip).0;
    let sag = |compliances: [f64; 6], taken: Option<[usize; 2]>| {
        let arm = irb4400().with_compliances(compliances).unwrap();
        let arm = match taken {
            None => arm,
            Some(taken) => {
                let (heavy, _) = heavy(arm, spindle);
                let links = heavy.dynamics().unwrap().each_ref().map(|joint| JointDynamics {
                    link: Inertial::new(1e-9, Vector3::zeros(), Matrix3::identity()).unwrap(),
                    ..*joint
                });
                let mut links = links;
                for (j, joint) in links.iter_mut().enumerate() {
                    joint.gravity_compensated = taken.contains(&j);
                }
                heavy.with_dynamics(links)
            }
        };
        ElasticArm::new(&arm, &spindle).in_gravity(FREE_FALL).sag(&theta).linear
    };
    let only = |j: usize| std::array::from_fn(|k| if k == j { 5e-7 } else { 1e-30 });
    let second = (moves(1) - moves(2)) * ((torque(1) - torque(2)) * 5e-7);
    let third = moves(2) * (torque(2) * 5e-7);
    assert!((sag(only(1), None) - second).norm() < 1e-12 * second.norm() && second.norm() > 1e-5);
    assert!((sag(only(2), None) - third).norm() < 1e-12 * third.norm() && third.norm() > 1e-5);
    // One of joint 2 leaves motor 3 its load, and the other way round.
    assert!(sag(only(1), Some([1; 2])).norm() < 1e-12);
    assert!((sag(only(2), Some([1; 2])) - third).norm() < 1e-8 * third.norm());
    assert!((sag(only(1), Some([2; 2])) - second).norm() < 1e-8 * second.norm());
    assert!(sag(only(2), Some([2; 2])).norm() < 1e-12);
    assert!(sag(only(1), Some([1, 2])).norm() < 1e-12 && sag(only(2), Some([1, 2])).norm() < 1e-12);
}

#[test]
fn a_weight_on_a_spring_sinks_and_a_compensator_takes_it() {
    // Joint 2 alone yields, the arm stretched level: 61 kg at a lever about it.
    let mut compliances = [1e-30; 6];
    compliances[1] = 5e-7;
    let arm = kr270().with_compliances(compliances).unwrap();
    let theta = [0.3, 0.0, 0.0, 0.2, 0.4, 0.1];
    let mass = PointMass { mass: 61.0, centre: vector![0.02, -0.05, 0.25] };
    let spindle = Spindle { point_mass: Some(mass), ..spindle() };
    let frames = Frames::new(&arm, &theta);
    let centre = frames.base_from_flange.point(&mass.centre);
    let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
    let torque = frames.twist(1, &centre).0.z * -9.81 * 61.0;
    let expected = frames.twist(1, &tip).0 * (torque * 5e-7);
    let found = ElasticArm::new(&arm, &spindle).in_gravity(FREE_FALL).sag(&theta);
    assert!((found.linear - expected).norm() < 1e-12 * expected.norm(), "{} {expected}", found.linear);
    assert!(expected.norm() > 1e-4);
    // Without gravity there is none, and without masses neither.
    assert_eq!(ElasticArm::new(&arm, &spindle).sag(&theta).linear.norm(), 0.0);
    let light = Spindle { point_mass: None, ..spindle };
    assert_eq!(ElasticArm::new(&arm, &light).in_gravity(FREE_FALL).sag(&theta).linear.norm(), 0.0);
    // A compensator of joint 2 carries what the weight does about it with joints 4 and 6 at zero.
    let (compensated, _) = heavy(arm, spindle);
    let links = compensated.dynamics().unwrap().map(|joint| JointDynamics {
        link: Inertial::new(1e-9, Vector3::zeros(), Matrix3::identity()).unwrap(),
        ..joint
    });
    let compensated = compensated.with_dynamics(links);
    let of = |theta: &[f64; 6]| ElasticArm::new(&compensated, &spindle).in_gravity(FREE_FALL).sag(theta).linear.norm();
    assert!(of(&[0.3, 0.0, 0.0, 0.0, 0.4, 0.0]) < 1e-12);
    assert!(of(&theta) > 0.0 && of(&theta) < 0.1 * expected.norm());
}

#[test]
fn a_tube_under_the_arm_buckles_at_its_hinge() {
    // A base that turns about x alone, the tool straight above it: it gives way at F = 1 / (c h).
    let mut turning = Matrix6::zeros();
    turning[(3, 3)] = 1e-6;
    let base = BaseCompliance::new(Vector3::zeros(), turning).unwrap();
    let arm = kr270().with_compliances([1e-30; 6]).unwrap().with_base_compliance(Some(base));
    let theta = [0.0, 1.2, -2.0, 0.0, 1.0, 0.0];
    let spindle = spindle();
    let height = arm.forward(&theta).then(&spindle.flange_from_tool).translation.z;
    let side = arm.forward(&theta).then(&spindle.flange_from_tool).translation.y;
    assert!(height > 0.5 && side.abs() < 0.05);
    let pressed = |share: f64| Wrench { force: vector![0.0, 0.0, -share / (1e-6 * height)], moment: Vector3::zeros() };
    let elastic = ElasticArm::new(&arm, &spindle);
    assert!(elastic.at_rest(&theta, &pressed(0.9)).is_ok());
    let compliances = arm.compliances_at(&theta);
    assert!(elastic.loaded_displacement(&compliances, &theta, &pressed(0.999)).is_ok());
    let Buckled { share } = elastic.loaded_displacement(&compliances, &theta, &pressed(2.0)).unwrap_err();
    assert!((share - 0.5).abs() < 1e-9, "{share}");
}

#[test]
fn springs_that_hardly_yield_leave_the_arm_as_it_was() {
    let arm = kr270();
    let stiff = normal_springs().map(|springs| NormalSprings { compliance: [0.0, 1e-30], ..springs });
    let with = arm.clone().with_normal_springs(Some(stiff)).unwrap().with_spring_model(Some(SpringModel::Full));
    let (theta, pressed) = ([0.3, -0.4, 0.7, 1.1, -0.9, 2.0], load([900.0, 300.0, -500.0, 10.0, 20.0, 30.0]));
    let [a, b] = [&arm, &with].map(|robot| ElasticArm::new(robot, &spindle()).at_rest(&theta, &pressed).unwrap());
    assert!((a.translation - b.translation).norm() < 1e-13);
    // A root of a matrix is none of its own kind: it stands for the matrix.
    let mount = matrix(17, 2e-8);
    assert!((root::of(&mount) * root::of(&mount).transpose() - mount).norm() < 1e-14 * mount.norm());
    assert_eq!(root::of(&Matrix6::zeros()), Matrix6::zeros());
    let _: Vector6<f64> = root::of(&mount).column(0).into_owned();
}
