//! The displacement by the weight along plans.

use super::*;
use crate::place::tests::whole_arm::{full_arm, heavy};
use nalgebra::vector;
use proptest::prelude::*;
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_model::robot::Pose;
use stead_numerics::rotation::rotation_from_zyx;
use stead_problem::criterion::Weights;
use stead_problem::setup::{AxisPositions, Setup};

fn problem() -> Problem {
    heavy(full_arm(Weights::TOTAL))
}

const HERE: [f64; 6] = [-1.5, 0.4, -2.4, 0.3, 0.9, 0.2];
const THERE: [f64; 6] = [-1.2, 0.7, -2.0, -2.5, -0.9, 1.2];

fn sag_of(problem: &Problem, joints: &[[f64; 6]]) -> Option<Sag> {
    let placement = Placement { x: 0.0, y: -1.7, z: 0.3, yaw: 0.7 };
    Sag::of(problem, &placement, joints.iter().copied().enumerate())
}

#[test]
fn a_robot_under_the_ceiling_hangs_the_other_way_and_a_rail_changes_nothing() {
    let joints = [HERE, THERE];
    let moved = |problem: &Problem, theta: &[f64; 6]| {
        ElasticArm::new(&problem.robot, &problem.spindle).in_gravity(problem.free_fall(0)).sag(theta).linear
    };
    let floor = problem();
    let ceiling =
        Pose { rotation: rotation_from_zyx([0.0, 0.0, std::f64::consts::PI]), translation: vector![0.0, 0.0, 4.0] };
    let hanging = floor.clone().with(|parts| parts.robot = parts.robot.clone().mounted(&ceiling));
    for theta in &joints {
        // In its own frame the arm feels the same weight with the other sign.
        let (up, down) = (moved(&floor, theta), ceiling.rotation.tr_mul(&moved(&hanging, theta)));
        assert!((up + down).norm() < 1e-12 * up.norm() && up.norm() > 1e-4);
    }
    let wall =
        Pose { rotation: rotation_from_zyx([0.0, 0.0, std::f64::consts::FRAC_PI_2]), translation: Vector3::zeros() };
    let on_wall = floor.clone().with(|parts| parts.robot = parts.robot.clone().mounted(&wall));
    assert!((moved(&on_wall, &HERE).norm() / moved(&floor, &HERE).norm() - 1.0).abs() > 0.05);
    let axis = |kind, direction: Vector3<f64>| ExternalAxis {
        name: "e".to_owned(),
        kind,
        carries: Carried::Robot,
        direction,
        point: Vector3::zeros(),
        min: -3.0,
        max: 3.0,
        max_speed: None,
        axis_use: AxisUse::Fixed,
    };
    let on = |axis: ExternalAxis, position: f64| {
        floor.clone().with(|parts| {
            parts.external_axes = vec![axis];
            parts.setup = Setup { positions: AxisPositions::Same(vec![position]), ..Setup::default() };
        })
    };
    let on_rail = on(axis(AxisKind::Rail, Vector3::x()), 1.5);
    assert_eq!(sag_of(&on_rail, &joints), sag_of(&floor, &joints));
    // Turned over by the axis that carries it, the robot feels what it feels under the ceiling.
    let tilted = on(axis(AxisKind::Turntable, Vector3::x()), std::f64::consts::PI);
    assert!((moved(&tilted, &HERE) + moved(&floor, &HERE)).norm() < 1e-12);
}

#[test]
fn a_part_that_yields_does_not_feel_the_weight_and_a_mass_is_needed() {
    let soft = problem().with(|parts| {
        let count = parts.task.points().len();
        let part = nalgebra::Matrix3::from_diagonal_element(1e-7);
        parts.task = parts.task.clone().with_part_compliances(vec![part; count]).unwrap();
    });
    assert_eq!(sag_of(&soft, &[HERE, THERE]), sag_of(&problem(), &[HERE, THERE]));
    assert_eq!(sag_of(&full_arm(Weights::TOTAL), &[HERE, THERE]), None);
    assert_eq!(sag_of(&problem(), &[]), None);
}

proptest! {
    #[test]
    fn the_widest_pair_is_that_of_all_pairs(points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..60)) {
        let points: Vec<Vector3<f64>> = points.into_iter().map(Vector3::from).collect();
        let pairs = points.iter().flat_map(|a| points.iter().map(move |b| (a - b).norm()));
        prop_assert_eq!(widest(&points), pairs.fold(0.0, f64::max));
    }
}
