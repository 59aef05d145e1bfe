use super::*;
use crate::evaluator::Evaluator;
use crate::lookup::LookupTable;
use crate::redundancy::{Planner, StateSet, forbid};
use crate::sense::Sense;
use crate::testing::five_segments;
use std::sync::Arc;
use stead_cell::testing::{kr270_shapes, scene_of, shape};
use stead_cell::{Attachment, Solid};

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
    let free = Problem { scene: None, ..problem.clone() };
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
    let problem = Problem { scene: Some(Arc::new(scene_of(shapes, 0.02))), ..free.clone() };
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
fn table_and_planner_agree_among_shapes() {
    let problem = among(vec![post([0.55, -1.35, 0.3])], 0.02);
    let planner = Planner::new(&problem);
    let table = LookupTable::new(&problem).unwrap();
    let evaluator = Evaluator::new(&planner, Some(&table));
    let mut space = evaluator.workspace();
    for placement in placements() {
        let by_table = evaluator.objective(&placement, None, &mut space).mean();
        let planned = planner.objective(&placement, Sense::Min, None, &mut planner.workspace()).mean();
        match (by_table, planned) {
            (Some(by_table), Some(planned)) => assert!((by_table / planned - 1.0).abs() < 0.01, "{by_table} {planned}"),
            (by_table, planned) => assert_eq!(by_table.is_some(), planned.is_some()),
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
    forbid((4, class), (1, 10, 1), |k| [9, 0, 1, 2, 5].contains(&k), &mut forbidden);
    let found: Vec<usize> = (0..10).filter(|k| forbidden.contains(4, class, *k)).collect();
    assert_eq!(found, [0, 1, 2, 9]);
}
