use super::super::UNITS;
use super::*;
use crate::evaluator::Evaluator;
use crate::refine::active::{active_bounds, active_walls};
use crate::refine::{Refinement, Solution, refine, state_residual};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::sync::Arc;
use stead_cell::testing::{kr270_shapes, scene_of, shape};
use stead_cell::{Attachment, Shape, Solid};
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::limit::{ActiveBound, Limit};
use stead_problem::problem::Interval;
use stead_problem::sense::Sense;
use stead_problem::testing::five_segments;

/// The five segments with the shapes of the KR 270 but the pillar and the fence, and one more that stands in the cell.
fn among(more: Shape, clearance: f64) -> Problem {
    let own = kr270_shapes().into_iter().filter(|shape| !["pillar", "fence"].contains(&shape.name.as_str()));
    let mut problem = five_segments();
    problem.redundancy.beta_count = 60;
    problem.scene = Some(Arc::new(scene_of(own.chain([more]).collect(), clearance)));
    problem
}

/// A curb between the robot and the part.
fn curb(y: f64) -> Shape {
    shape("curb", Attachment::Base, Solid::Box(Vector3::new(2.0, 0.1, 0.6)), [0.0, y, -0.65])
}

/// A wall behind the part.
fn wall(y: f64) -> Shape {
    shape("wall", Attachment::Base, Solid::Box(Vector3::new(4.0, 0.1, 2.0)), [0.0, y, 0.0])
}

fn refined(problem: &Problem, start: &Placement, sense: Sense) -> (Solution, Refinement) {
    let planner = Planner::finer(problem);
    let (solution, mut report) =
        refine(&Evaluator::new(&planner, None), start, sense, None, &Monitor::silent()).unwrap();
    state_residual(&planner, &solution, None, &mut report, &Monitor::silent());
    (solution, report)
}

#[test]
fn a_curb_holds_the_best_placement_and_its_gain_is_that_of_a_smaller_clearance() {
    let at = |clearance: f64| {
        let mut problem = among(curb(-1.35), clearance);
        problem.cell.position[2] = Interval { min: -0.5, max: -0.45 };
        problem
    };
    let problem = at(0.02);
    let (solution, report) = refined(&problem, &Placement::from([0.0, -1.8, -0.47, 1.378]), Sense::Min);
    assert!(problem.is_free(&solution.placement, &solution.plans));
    assert!(report.kkt_residual.unwrap() < 1e-2 * report.end_mean, "{report:?}");
    let bounds = active_bounds(&problem, &solution).unwrap();
    let clearances = || bounds.iter().filter(|bound| matches!(bound.side.limit, Limit::Clearance(_)));
    let is_named = |bound: &ActiveBound| bound.names.as_ref().is_some_and(|names| names.contains(&"curb".to_owned()));
    assert!(clearances().any(is_named), "{bounds:?}");
    // All pairs have the same clearance to keep.
    let gain: f64 = clearances().map(|bound| bound.gain).sum();
    let step = 1e-3;
    let objective = |clearance: f64| refined(&at(clearance), &solution.placement, Sense::Min).0.objective;
    let looser = objective(0.02 - step);
    let measured = (solution.objective - looser) / step;
    assert!((gain / measured - 1.0).abs() < 0.1, "{gain} {measured} {bounds:?}");
}

#[test]
fn a_wall_holds_the_worst_placement_and_its_gain_is_that_of_a_smaller_clearance() {
    let at = |clearance: f64| among(wall(-2.45), clearance);
    let problem = at(0.02);
    let (solution, report) = refined(&problem, &Placement::from([0.2, -2.0, -0.3, -2.2]), Sense::Max);
    assert!(problem.is_free(&solution.placement, &solution.plans));
    assert!(report.end_mean > report.start_mean);
    let planner = Planner::finer(&problem);
    let bounds = active_walls(&planner, &solution, None);
    let held = bounds.iter().find(|bound| matches!(bound.side.limit, Limit::Clearance(_))).unwrap();
    let step = 1e-3;
    let looser = refined(&at(0.02 - step), &solution.placement, Sense::Max).0.objective;
    let measured = (looser - solution.objective) / step;
    assert!((held.gain / measured - 1.0).abs() < 0.2, "{} {measured}", held.gain);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn slopes_agree_with_differences_of_distances(
        beta in -3.0..3.0_f64, point in 0..105_usize, x in -0.2..0.2_f64, yaw in -1.5..1.5_f64, posture in 0..8_usize
    ) {
        let problem = among(wall(-2.6), 0.01);
        let scene = problem.scene.as_deref().unwrap();
        let (placement, posture) = (Placement::from([x, -1.9, -0.4, yaw]), Posture::ALL[posture]);
        let at = [x, -1.9, -0.4, yaw, beta];
        for slack in slacks(&problem, None, PointState { point, at, posture }, 0.3) {
            let (Limit::Clearance(pair) | Limit::KeepOut(pair)) = slack.limit else { panic!("{:?}", slack.limit) };
            let required = scene.pair(pair).unwrap().required;
            // Where shapes hit there is no slope.
            if slack.slack < 1e-3 {
                continue;
            }
            for k in 0..LOCAL {
                let at = |by: f64| {
                    let (mut moved, mut turned) = (placement, beta);
                    *(if k < 4 { &mut moved[k] } else { &mut turned }) += by * UNITS[k];
                    let joints = problem.robot.inverse(&problem.at(&moved).base_from_flange(point, turned), posture).ok()?;
                    Some(scene.distance(pair, &problem.poses(scene, point, &moved, &joints), 1.0))
                };
                let step = 3e-4;
                let (Some(up), Some(down)) = (at(step), at(-step)) else { continue };
                let difference = (up - down) / (2.0 * step);
                // GJK leaves some micrometres open on round surfaces; corners and edges have two slopes.
                let slope = slack.slopes[k];
                let one_sided = [(up - slack.slack - required) / step, (slack.slack + required - down) / step];
                let is_near = |value: f64| (slope - value).abs() < 0.02 * (1.0 + slope.abs());
                prop_assert!(is_near(difference) || one_sided.into_iter().any(is_near), "{k} {slope} {difference} {one_sided:?}");
            }
        }
    }
}
