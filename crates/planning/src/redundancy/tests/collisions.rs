//! Plans among shapes: states that hit are forbidden, moves between them are free, and nothing else changes.

use super::*;
use crate::redundancy::{Planner, StateSet};
use nalgebra::{Vector3, vector};
use std::sync::Arc;
use stead_cell::testing::{kr270_shapes, scene_of, shape};
use stead_cell::{Attachment, KeepOut, PairKind, Poses, Scene, Shape, Solid, Surroundings, TrackedPoint, Zone};
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_model::robot::Pose;
use stead_numerics::rotation::rotation_from_zyx;
use stead_problem::sense::Sense;
use stead_problem::testing::five_segments;

/// The five segments with the shapes of the KR 270, and more shapes in the cell.
fn among(more: Vec<stead_cell::Shape>, clearance: f64) -> Problem {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 60;
    let shapes = kr270_shapes().into_iter().filter(|shape| shape.name != "pillar").chain(more).collect();
    problem.scene = Some(Arc::new(scene_of(shapes, clearance)));
    problem
}

fn post(at: [f64; 3]) -> stead_cell::Shape {
    shape("post", Attachment::Base, Solid::Cylinder { radius: 0.12, length: 2.5 }, at)
}

fn placements() -> [Placement; 3] {
    [[0.1, -1.9, -0.4, 1.0], [-0.05, -1.75, -0.3, -0.6], [0.2, -1.7, -0.45, 2.4]].map(Placement::from)
}

/// All states of the planner's grid that hit, looked at one by one, as what a plan may not use.
fn all_hits(problem: &Problem, placement: &Placement, planner: &Planner<'_>) -> StateSet {
    let mut forbidden = StateSet::default();
    for point in 0..problem.task.points().len() {
        for posture in Posture::ALL.into_iter().filter(|posture| !posture.is_flipped()) {
            for beta in 0..planner.grid().beta_count {
                if problem.posture_hit(point, placement, planner.grid().beta(beta), posture).is_some() {
                    forbidden.add(point, posture.class(), beta);
                }
            }
        }
    }
    forbidden
}

#[test]
fn plans_made_lazily_are_those_over_all_free_states() {
    let problem = among(vec![post([0.55, -1.35, 0.3])], 0.02);
    let free = problem.clone().with(|parts| parts.scene = None);
    let (planner, plain) = (Planner::new(&problem), Planner::new(&free));
    let mut changed = 0;
    for placement in placements() {
        let lazy = planner.objective(&placement, Sense::Min, None, &mut planner.workspace());
        let forbidden = all_hits(&problem, &placement, &planner);
        let dense = plain.objective_without(&placement, Sense::Min, &forbidden);
        let relaxed = plain.objective(&placement, Sense::Min, None, &mut plain.workspace());
        match (lazy.mean(), dense.mean()) {
            (Some(lazy), Some(dense)) => assert!((lazy - dense).abs() < 1e-15, "{lazy} {dense}"),
            (lazy, dense) => assert_eq!(lazy.is_some(), dense.is_some()),
        }
        changed += usize::from(lazy != relaxed);
    }
    assert!(changed > 0);
}

#[test]
fn final_plans_are_free_in_small_steps() {
    let problem = among(vec![post([0.55, -1.35, 0.3])], 0.02);
    let scene = problem.scene.as_deref().unwrap();
    let planner = Planner::finer(&problem);
    for placement in placements() {
        for sense in Sense::BOTH {
            let Ok(plans) = planner.plan_fine(&placement, sense, None, &mut planner.workspace()) else { continue };
            let workpiece = placement.base_from_workpiece();
            for plan in &plans {
                for pair in plan.joints.windows(2) {
                    for step in 0..=20 {
                        let share = f64::from(step) / 20.0;
                        let joints: [f64; 6] = std::array::from_fn(|j| pair[0][j] + share * (pair[1][j] - pair[0][j]));
                        let clearance = scene.clearance(&scene.poses(&joints, &workpiece), &PairKind::ALL);
                        assert!(clearance.is_none_or(|clearance| clearance.distance > 0.0));
                    }
                }
                assert!(plan.joints.iter().all(|joints| problem.state_hit(0, &placement, joints).is_none()));
            }
        }
    }
}

#[test]
fn what_stands_far_away_changes_nothing() {
    let free = five_segments();
    let links = kr270_shapes().into_iter().filter(|shape| ["upper arm", "spindle"].contains(&shape.name.as_str()));
    let shapes = links.chain([post([0.0, 2.5, 0.0])]).collect();
    let problem = free.clone().with(|parts| parts.scene = Some(Arc::new(scene_of(shapes, 0.02))));
    let (planner, plain) = (Planner::finer(&problem), Planner::finer(&free));
    for placement in placements() {
        for sense in Sense::BOTH {
            let [with, without] =
                [&planner, &plain].map(|planner| planner.plan_fine(&placement, sense, None, &mut planner.workspace()));
            assert_eq!(with, without);
        }
    }
}

#[test]
fn a_part_in_the_fence_blocks_every_point_and_is_named() {
    let problem = among(Vec::new(), 0.02);
    let planner = Planner::new(&problem);
    let placement = Placement::from([0.0, -2.9, -0.4, 0.0]);
    let none = planner.plan(&placement, Sense::Min, None, &mut planner.workspace()).unwrap_err();
    assert_eq!(none.blocked_points.len(), 105);
    let scene = problem.scene.as_deref().unwrap();
    let pair = scene.pair(*none.collisions.keys().next().unwrap()).unwrap();
    assert_eq!(pair.to_string(), "part and fence");
}

#[test]
fn neighbours_that_hit_are_forbidden_as_far_as_they_hit() {
    let mut forbidden = StateSet::default();
    let class = stead_model::robot::PostureClass::ALL[1];
    let ring = BetaRing { count: 10, stride: 1 };
    forbidden.add_around(4, class, 1, ring, |k| [9, 0, 1, 2, 5].contains(&k));
    let found: Vec<usize> = (0..10).filter(|k| forbidden.contains(4, class, *k)).collect();
    assert_eq!(found, [0, 1, 2, 9]);
}

/// Shapes, zone and workpiece as an arm sees them that is not mounted: moved by a pose into its base frame.
fn seen_from(base: &Pose<f64>, shapes: &[Shape], floor: (Vector3<f64>, Vector3<f64>)) -> Surroundings {
    let moved = |shape: &Shape| match shape.attached {
        Attachment::Base => Shape { pose: base.then(&shape.pose), ..shape.clone() },
        _ => shape.clone(),
    };
    let zone = Zone::HalfSpace { point: base.point(&floor.0), normal: base.rotation * floor.1 };
    let zones = vec![KeepOut { name: "floor".to_owned(), zone, points: TrackedPoint::ALL.to_vec() }];
    Surroundings::new(shapes.iter().map(moved).collect(), zones, 0.01, Vec::new()).unwrap()
}

#[test]
fn a_mounted_arm_keeps_the_distances_of_its_base_frame_in_states_and_moves() {
    use rand::{RngExt, SeedableRng};
    let turned = |angles: [f64; 3]| rotation_from_zyx(angles.map(f64::to_radians));
    let mounts = [
        ("floor", Pose::identity()),
        ("pedestal", Pose { translation: vector![0.0, 0.0, 0.35], ..Pose::identity() }),
        ("wall", Pose { rotation: turned([20.0, 90.0, 0.0]), translation: vector![-0.4, 0.1, 1.2] }),
        ("ceiling", Pose { rotation: turned([30.0, 0.0, 180.0]), translation: vector![0.2, -0.3, 2.6] }),
    ];
    let rail = |at: f64| ExternalAxis {
        name: "rail".to_owned(),
        kind: AxisKind::Rail,
        carries: Carried::Robot,
        direction: Vector3::x(),
        point: Vector3::zeros(),
        min: at,
        max: at,
        max_speed: Some(0.5),
        axis_use: AxisUse::Fixed,
    };
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(29);
    for (name, mount) in &mounts {
        for position in [0.0, 0.7] {
            let mut problem = five_segments();
            let unmounted = problem.robot.clone();
            problem.robot = problem.robot.clone().mounted(mount);
            if position != 0.0 {
                problem.external_axes = vec![rail(position)];
                problem.setup = stead_problem::setup::Setup::at_rest(&problem.external_axes);
            }
            let floor = (vector![0.0, 0.0, -2.5], vector![0.0, 0.0, -1.0]);
            let flange_from_tool = problem.spindle.flange_from_tool;
            let around = seen_from(&Pose::identity(), &kr270_shapes(), floor);
            let scene = Scene::new(&problem.robot, &flange_from_tool, around).unwrap();
            // The arm stands at its mount, moved along the rail.
            let stand = Pose { translation: mount.translation + Vector3::x() * position, ..*mount };
            let around = seen_from(&stand.inverse(), &kr270_shapes(), floor);
            let plain = Scene::new(&unmounted, &flange_from_tool, around).unwrap();
            let (mut near, mut hits) = (0, 0);
            let mut last: Option<([f64; 6], Poses, Poses)> = None;
            for _ in 0..60 {
                let joints: [f64; 6] = std::array::from_fn(|j| {
                    let joint = &unmounted.joints()[j];
                    joint.min + (joint.max - joint.min) * random.random::<f64>()
                });
                let placement = Placement::from(std::array::from_fn(|_| 4.0 * random.random::<f64>() - 2.0));
                let poses = problem.poses(&scene, 0, &placement, &joints);
                let workpiece = stand.inverse().then(&placement.base_from_workpiece());
                let twin = plain.poses(&joints, &workpiece);
                for (number, pair) in plain.pairs().iter().enumerate() {
                    assert_eq!(scene.pair(number).unwrap().names, pair.names);
                    let [found, expected] =
                        [scene.distance(number, &poses, 5.0), plain.distance(number, &twin, 5.0)].map(|d| d.min(5.0));
                    assert!((found - expected).abs() < 1e-6, "{name}, {pair}: {found} and not {expected}");
                    near += usize::from(expected < 0.2);
                }
                if let Some((from, before, twin_before)) = last {
                    let to = std::array::from_fn(|j| from[j] + 0.1 * (joints[j] - from[j]));
                    let moved = problem.poses(&scene, 0, &placement, &to);
                    let twin_moved = plain.poses(&to, &workpiece);
                    let found = scene.motion((&from, &before), (&to, &moved));
                    let expected = plain.motion((&from, &twin_before), (&to, &twin_moved));
                    assert_eq!(found.map(|hit| hit.pair), expected.map(|hit| hit.pair), "{name}");
                    hits += usize::from(expected.is_some());
                }
                last = Some((joints, poses, twin));
            }
            assert!(near > 50 && (5..55).contains(&hits), "{name}: {near} {hits}");
        }
    }
}

/// A ball on the flange beside the axis of the tool, and a lid above where it is at the end of the first segment's best
/// plan.
fn under_a_lid(lid_radius: f64) -> (Problem, Placement) {
    let placement = Placement::from([0.1, -1.9, -0.4, 1.0]);
    let mut problem = five_segments();
    problem.redundancy.beta_count = 60;
    let planner = Planner::finer(&problem);
    let plans = planner.plan_fine(&placement, Sense::Min, None, &mut planner.workspace()).unwrap();
    let flange = problem.robot.forward(plans[0].joints.last().unwrap());
    let ball = shape("ball", Attachment::Flange, Solid::Capsule { radius: 0.03, length: 0.0 }, [0.25, 0.0, 0.0]);
    let at = flange.point(&ball.pose.translation) + Vector3::new(0.0, 0.0, 0.03 + 0.02 + 0.005);
    let lid = Solid::Cylinder { radius: lid_radius, length: 0.01 };
    problem.scene = Some(Arc::new(scene_of(vec![ball, shape("lid", Attachment::Base, lid, at.into())], 0.001)));
    (problem, placement)
}

#[test]
fn an_end_of_a_plan_whose_line_hits_is_not_chosen_where_another_can_be() {
    for (lid_radius, can_be_whole) in [(0.05, true), (3.0, false)] {
        let (problem, placement) = under_a_lid(lid_radius);
        let free = problem.clone().with(|parts| parts.scene = None);
        let [made, without] = [&problem, &free].map(|problem| {
            let planner = Planner::finer(problem);
            planner.plan_fine(&placement, Sense::Min, None, &mut planner.workspace()).unwrap()
        });
        assert!(!crate::transfer_path::whole_lines(&problem, &placement, &without[0])[1]);
        assert_eq!(crate::transfer_path::whole_lines(&problem, &placement, &made[0])[1], can_be_whole);
        if can_be_whole {
            assert!(made[0].cost >= without[0].cost * (1.0 - 1e-9));
            assert_eq!(made[2].cost, without[2].cost);
        }
        assert!(problem.is_free(&placement, &made));
    }
}
