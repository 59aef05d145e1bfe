//! Paths that wind the wrist, against plain dynamic programming over every real configuration.

use super::super::{Planner, reference_dp};
use super::*;
use stead_model::task::{PathPoint, Task, ToolPath};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::testing::{five_segments, with_beta_rate};

/// Rounds of a circle with the tool upright, as a contour is milled in several depths.
fn rounds(rounds: f64, count: usize) -> Problem {
    let mut problem = five_segments();
    let first = problem.task.points()[0];
    let points = (0..count).map(|k| {
        let (sine, cosine) = libm::sincos(TAU * rounds * k as f64 / count as f64);
        let position = first.position + nalgebra::Vector3::new(0.08 * sine, 0.08 * (1.0 - cosine), 0.0);
        (1, PathPoint { position, feed: nalgebra::Vector3::new(cosine, sine, 0.0), ..first })
    });
    let path = ToolPath::new(points.collect::<Vec<_>>()).unwrap();
    problem.task = Task::new(path, vec![problem.task.loads()[0].wrench; count]).unwrap();
    problem
}

fn placements() -> impl Iterator<Item = Placement> {
    (0..6).map(f64::from).map(|f| Placement::from([-0.3 + 0.1 * f, -1.64 - 0.05 * f, -0.6 + 0.05 * f, -3.0 + 1.1 * f]))
}

#[test]
fn winding_paths_cost_what_plain_dynamic_programming_finds() {
    let mut found = 0;
    let mut wound = 0;
    for (turns, share) in [(0.8, 2.0), (2.2, 4.0), (2.6, 5.0), (3.0, 6.0), (3.0, 9.0)] {
        let mut problem = rounds(turns, 60);
        problem.redundancy.beta_count = 36;
        let problem = with_beta_rate(problem, share);
        let planner = Planner::new(&problem);
        let mut workspace = planner.workspace();
        let span = &problem.task.segments()[0];
        for (placement, sense) in placements().flat_map(|p| [(p, Sense::Min), (p, Sense::Max)]) {
            let pass = Pass {
                evaluator: &planner.segments.evaluators[0],
                span,
                placement: &placement,
                sense,
                only: None,
                is_by_knots: false,
            };
            let relaxed = planner.segments.forward_pass(pass, &mut workspace, false);
            for class in PostureClass::ALL {
                let judge =
                    reference_dp::plan(&planner.segments, span, &placement, sense, &class.postures(), &mut workspace);
                let end = relaxed.ends[class.index()].map(|(cost, _)| cost);
                let path =
                    end.and_then(|cost| planner.segments.path_with_turns(pass, class, [true; 2], cost, &mut workspace));
                assert_eq!(path.is_some(), judge.is_some(), "{turns} {class:?} {placement:?} {sense:?}");
                let Some((path, judge)) = path.zip(judge) else { continue };
                let cost = judge.cost * sense.sign();
                assert!((path.cost - cost).abs() < 1e-12 * judge.cost, "{} {cost} {turns} {class:?}", path.cost);
                found += 1;
                let end = end.unwrap();
                wound += usize::from(path.cost > end + 1e-9 * end.abs());
                // Blocks of any length, and each flip by itself.
                for posture in class.postures() {
                    let flips = [!posture.is_flipped(), posture.is_flipped()];
                    let numbering = Numbering::new(&problem.robot);
                    let search =
                        Search { planner: &planner.segments, pass, class, flips, numbering, most: f64::INFINITY };
                    let whole = search.path(60, &mut workspace);
                    let of_one =
                        reference_dp::plan(&planner.segments, span, &placement, sense, &[posture], &mut workspace);
                    assert_eq!(whole.is_some(), of_one.is_some());
                    for block in [1, 7, 20, 59] {
                        assert_eq!(search.path(block, &mut workspace), whole, "{block}");
                    }
                }
            }
        }
    }
    assert!(found > 40 && wound > 10, "{found} {wound}");
}

#[test]
fn winding_paths_of_dense_points_are_planned() {
    // The steps between points are less than a step of the grid.
    let problem = rounds(2.2, 1200);
    let planner = Planner::new(&problem);
    let span = &problem.task.segments()[0];
    assert!(planner.segments.knots.is_spread(span));
    let mut planned = 0;
    for placement in placements() {
        let mut workspace = planner.workspace();
        let Ok(plans) = planner.plan(&placement, Sense::Min, None, &mut workspace) else { continue };
        planned += 1;
        for (joints, robot) in plans[0].joints.iter().map(|joints| (joints, &problem.robot)) {
            for (angle, joint) in joints.iter().zip(robot.joints()) {
                assert!(*angle >= joint.min - 1e-8 && *angle <= joint.max + 1e-8);
            }
        }
        let steps = plans[0].joints.windows(2).flat_map(|pair| (0..6).map(|j| (pair[1][j] - pair[0][j]).abs()));
        assert!(steps.fold(0.0, f64::max) < 0.2);
        // Not better than with turns to spare.
        let mut joints = problem.robot.joints().clone();
        joints[3..].iter_mut().for_each(|joint| (joint.min, joint.max) = (joint.min - 20.0, joint.max + 20.0));
        let free = problem.clone().with(|parts| parts.robot = stead_model::robot::Robot::new("free", joints).unwrap());
        let free = Planner::new(&free).plan(&placement, Sense::Min, None, &mut workspace).unwrap();
        assert!(plans[0].cost >= free[0].cost * (1.0 - 1e-9), "{} {}", plans[0].cost, free[0].cost);
    }
    assert!(planned >= 3, "{planned}");
}
