//! The displacement by the weight along plans.

use super::*;
use crate::place::tests::whole_arm::full_arm;
use crate::settings::SearchSettings;
use nalgebra::vector;
use proptest::prelude::*;
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_model::robot::{PointMass, Pose, Spindle};
use stead_numerics::monitor::Monitor;
use stead_numerics::rotation::rotation_from_zyx;
use stead_planning::criterion::Weights;
use stead_planning::setup::{AxisPositions, Setup};
use stead_planning::transfer::TransferSettings;

/// 61 kg, 250 mm from the flange.
fn heavy(spindle: &Spindle) -> Spindle {
    Spindle { point_mass: Some(PointMass { mass: 61.0, centre: vector![0.0, 0.0, 0.25] }), ..*spindle }
}

fn problem() -> Problem {
    full_arm(Weights::TOTAL).with(|parts| parts.spindle = heavy(&parts.spindle))
}

const HERE: [f64; 6] = [-1.5, 0.4, -2.4, 0.3, 0.9, 0.2];
const THERE: [f64; 6] = [-1.2, 0.7, -2.0, -2.5, -0.9, 1.2];

fn sag_of(problem: &Problem, joints: &[[f64; 6]]) -> Option<Sag> {
    let placement = Placement { x: 0.0, y: -1.7, z: 0.3, yaw: 0.7 };
    Sag::of(problem, &placement, joints.iter().copied().enumerate())
}

/// Both placements of the published path: figures of another program are 0.5 to 1.1 mm along the path.
#[test]
fn the_weight_of_a_spindle_moves_the_tool_more_than_the_cut_and_no_score_counts_it() {
    let settings = SearchSettings::default();
    let transfer = TransferSettings::default();
    let of = |problem: &Problem| crate::place::place(problem, &settings, &transfer, &Monitor::silent()).unwrap();
    let (with, without) = (of(&problem()), of(&full_arm(Weights::TOTAL)));
    for (case, light) in with.cases.optima().into_iter().zip(without.cases.optima()) {
        let sag = case.plan.sag.as_ref().unwrap();
        let SagRange { least, largest, spread } = sag.path;
        assert!(0.4e-3 < least && largest < 1.2e-3 && 0.1e-3 < spread && spread < 0.9e-3, "{:?}", sag.path);
        assert_eq!(sag.segments.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
        let segments = sag.segments.iter().map(|(_, range)| range);
        assert!(
            segments.clone().all(|range| range.least >= least && range.largest <= largest && range.spread <= spread)
        );
        // The plan and its score are those without a mass, which has no sag.
        assert_eq!((case.plan.mean, &case.plan.points), (light.plan.mean, &light.plan.points));
        assert!(light.plan.sag.is_none());
    }
    let is_of_weight = |note: &&String| note.contains("the weight of the 61 kg on the flange (the masses of the links");
    assert_eq!(with.notes.iter().filter(is_of_weight).count(), 1, "{:?}", with.notes);
    assert_eq!(without.notes.iter().filter(|note| note.contains("weight")).count(), 0);
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
            parts.setup = Setup { orientation: 0, positions: AxisPositions::Same(vec![position]) };
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
