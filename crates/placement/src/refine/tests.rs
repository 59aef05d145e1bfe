//! The refinement: exact gradients, never worse, never infeasible.

mod leaning;

use super::slacks::NEAR_STEPS;
use super::solution::moved;
use super::*;
use nalgebra::DMatrix;
use stead_model::robot::{Parameter, Uncertainty, angles::yaw_from_q4};
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::off_grid;
use stead_problem::problem::{BetaPlan, Interval, Problem};
use stead_problem::testing::{
    assert_sound, corners, five_segments, five_segments_compensated, with_axes_2_3, with_turn_limits,
};

fn published_optimum() -> Placement {
    [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)].into()
}

/// Refines from a start with the planner alone, the posture scheme being free.
fn refined(planner: &Planner<'_>, start: &Placement, sense: Sense) -> Option<(Solution, Refinement)> {
    let (solution, mut report) = refine(&Evaluator::new(planner, None), start, sense, None, &Monitor::silent())?;
    state_residual(planner, &solution, None, &mut report, &Monitor::silent());
    Some((solution, report))
}

/// Every point of a solution is allowed, with joints and betas within their steps.
fn assert_allowed(problem: &Problem, solution: &Solution) {
    assert!(problem.cell.contains(&solution.placement), "{:?}", solution.placement);
    for plan in &solution.plans {
        let replayed = off_grid::replay(problem, &solution.placement, Sense::Min, plan).unwrap();
        assert!((replayed.cost - plan.cost).abs() < 1e-10 * plan.cost);
        for (a, b) in replayed.joints.iter().flatten().zip(plan.joints.iter().flatten()) {
            assert!((a - b).abs() < 1e-9);
        }
    }
}

#[test]
fn best_gets_better_and_stays_allowed() {
    for (problem, start) in
        [(five_segments(), published_optimum()), (five_segments_compensated(), [0.0, -1.7, -0.4, 0.7].into())]
    {
        let planner = Planner::finer(&problem);
        let (solution, report) = refined(&planner, &start, Sense::Min).unwrap();
        assert_allowed(&problem, &solution);
        assert!(report.end_mean < 0.6 * report.start_mean, "{report:?}");
        assert!(report.kkt_residual.unwrap() < 1e-3 * report.end_mean, "{report:?}");
        assert_eq!(report.statuses.len(), report.rounds);
        // Nothing better in the neighbourhood, everything planned anew.
        let mut workspace = planner.workspace();
        for k in 0..4 {
            for side in [-1.0, 1.0] {
                let mut placement = solution.placement;
                placement[k] += side * if k < 3 { 3e-3 } else { 3e-2 };
                if !problem.cell.contains(&placement) {
                    continue;
                }
                let near = planned(&planner, &placement, None, &mut workspace);
                assert!(near.is_none_or(|n| n.objective > solution.objective * (1.0 - 2e-5)), "variable {k} {side}");
            }
        }
    }
}

#[test]
fn margins_may_be_driven_to_their_kink() {
    // With one uncertain joint the best betas make its torque vanish at many points, where the margin has a kink.
    let mut problem = five_segments();
    problem.redundancy.beta_count = 40;
    problem.criterion.confidence = 3.0;
    let known = Uncertainty::new(vec![Parameter::Compliance(4)], DMatrix::from_element(1, 1, 4e-12)).unwrap();
    problem.robot = problem.robot.clone().with_uncertainty(known).unwrap();
    let planner = Planner::new(&problem);
    let (solution, report) = refined(&planner, &published_optimum(), Sense::Min).unwrap();
    assert!(report.end_mean < report.start_mean * 0.95, "{report:?}");
    assert_allowed(&problem, &solution);
    let locals = linearise::linearise(&problem, &solution, linearise::Curvature::Full, NEAR_STEPS).unwrap();
    let margins = || locals.iter().map(|local| local.state.own.margin.value);
    assert!(margins().filter(|margin| *margin < 1e-8).count() > 10, "{:?}", margins().collect::<Vec<_>>());
    for local in locals.iter().filter(|local| !local.sets[0].changes.is_empty()) {
        let [change] = local.sets[0].changes[..] else { panic!("one uncertain parameter is one change") };
        assert!((change.value.abs() - local.state.own.margin.value).abs() < 1e-18);
    }
    assert!(report.kkt_residual.unwrap() < 1e-3 * report.end_mean, "{report:?}");
}

#[test]
fn worst_gets_worse_and_stays_allowed() {
    let problem = five_segments();
    let planner = Planner::finer(&problem);
    let (solution, report) = refined(&planner, &Placement::from([0.2, -2.1, -0.3, -2.2]), Sense::Max).unwrap();
    assert_allowed(&problem, &solution);
    assert!(report.end_mean > 1.2 * report.start_mean, "{report:?}");
}

#[test]
fn a_start_without_a_plan_is_refused() {
    let problem = five_segments();
    let planner = Planner::finer(&problem);
    assert_eq!(refined(&planner, &Placement::from([0.0, -4.0, -0.4, 0.0]), Sense::Min), None);
}

#[test]
fn constraints_bind_and_hold() {
    let mut problem = five_segments();
    problem.cell.yaw = Interval { min: 0.5, max: 0.9 };
    problem.constraints.min_inverse_condition = 0.4;
    problem.constraints.max_deflection = Some(1.5e-3);
    let planner = Planner::finer(&problem);
    let (solution, report) = refined(&planner, &Placement::from([0.0, -1.7, -0.4, 0.7]), Sense::Min).unwrap();
    assert_allowed(&problem, &solution);
    assert!(report.end_mean <= report.start_mean);
}

#[test]
fn joint_speeds_bind_and_hold() {
    let mut problem = five_segments();
    let mut joints = problem.robot.joints().clone();
    joints.iter_mut().for_each(|j| j.max_speed = Some(0.25));
    problem.robot = stead_model::robot::Robot::new("slow", joints).unwrap();
    let planner = Planner::finer(&problem);
    let (solution, report) = refined(&planner, &Placement::from([0.0, -1.7, -0.4, 0.7]), Sense::Min).unwrap();
    assert_allowed(&problem, &solution);
    assert!(report.end_mean <= report.start_mean);
    let used = solution.plans.iter().flat_map(|plan| {
        plan.points.clone().skip(1).enumerate().map(|(place, point)| {
            let limits = problem.joint_steps(point);
            let (a, b) = (plan.joints[place], plan.joints[place + 1]);
            (0..6).map(|j| (b[j] - a[j]).abs() / limits[j]).fold(0.0, f64::max)
        })
    });
    let used: Vec<f64> = used.collect();
    assert!(used.iter().all(|share| *share <= 1.0 + 1e-6));
    assert!(used.iter().any(|share| *share > 0.99), "no joint step is at its limit");
}

#[test]
fn the_sum_of_joints_2_and_3_and_its_speed_bind_and_hold() {
    let start = Placement::from([0.0, -1.7, -0.4, 0.7]);
    let found = |problem: &Problem| {
        let planner = Planner::finer(problem);
        let (solution, report) = refined(&planner, &start, Sense::Min).unwrap();
        assert_allowed(problem, &solution);
        assert_sound(problem, &solution.placement, &solution.plans);
        assert!(report.end_mean <= report.start_mean);
        solution
    };
    let free = with_axes_2_3(five_segments(), true, [-245.0, 175.0]);
    let solution = found(&free);
    let sums = |solution: &Solution| -> Vec<f64> {
        solution.plans.iter().flat_map(|plan| &plan.joints).map(|joints| free.robot.sum_of(joints)).collect()
    };
    let largest = sums(&solution).into_iter().fold(f64::MIN, f64::max).to_degrees();
    // The optimum is held by a range of the sum that cuts it off.
    let held = with_axes_2_3(five_segments(), true, [-245.0, largest - 1.0]);
    let solution = found(&held);
    let nearest = sums(&solution).into_iter().fold(f64::MIN, f64::max).to_degrees();
    assert!((largest - 1.0 - nearest).abs() < 0.05, "{nearest} {largest}");
    // Motor 3 at its speed: the sum steps as far as it allows, and joint 3 by itself farther.
    let mut slow = five_segments();
    let mut joints = slow.robot.joints().clone();
    joints[2].max_speed = Some(0.05);
    slow.robot = stead_model::robot::Robot::new("slow", joints).unwrap();
    let slow = with_axes_2_3(slow, true, [-245.0, 175.0]);
    let solution = found(&slow);
    let (mut most, mut beyond) = (0.0_f64, 0.0_f64);
    for plan in &solution.plans {
        for (pair, point) in plan.joints.windows(2).zip(plan.points.clone().skip(1)) {
            let limit = slow.joint_steps(point)[2];
            most = most.max((slow.robot.sum_of(&pair[1]) - slow.robot.sum_of(&pair[0])).abs() / limit);
            beyond = beyond.max((pair[1][2] - pair[0][2]).abs() / limit);
        }
    }
    assert!(most > 0.99 && most <= 1.0 + 1e-6 && beyond > 1.0, "{most} {beyond}");
}

#[test]
fn the_gradient_of_the_worst_case_agrees_with_planning_anew() {
    for problem in [five_segments(), five_segments_compensated()] {
        let spacing = off_grid::Spacing { first: 0.026, last: 1e-7 };
        let planner = Planner::finer(&problem).with_spacing(spacing);
        let mut workspace = planner.workspace();
        let placement = Placement::from([0.2, -2.1, -0.3, -2.2]);
        let here = planned(&planner, &placement, None, &mut workspace).unwrap();
        let gradient = ascent::pose_gradient(&problem, &here).unwrap();
        for k in 0..4 {
            let h = 1e-4;
            let mut at = |side: f64| {
                let mut moved = placement;
                moved[k] += side * h * UNITS[k];
                planned(&planner, &moved, None, &mut workspace).unwrap().objective
            };
            let difference = (at(1.0) - at(-1.0)) / (2.0 * h);
            assert!((gradient[k] - difference).abs() < 1e-2 * gradient.norm(), "{k} {} {difference}", gradient[k]);
        }
    }
}

#[test]
fn local_gradients_agree_with_differences_of_the_ordinary_evaluator() {
    for problem in [five_segments(), five_segments_compensated()] {
        let planner = Planner::finer(&problem);
        let here = planned(&planner, &published_optimum(), None, &mut planner.workspace()).unwrap();
        let locals = linearise::linearise(&problem, &here, linearise::Curvature::Full, NEAR_STEPS).unwrap();
        for plan in &here.plans {
            for (place, point) in plan.points.clone().enumerate().step_by(4) {
                for k in 0..LOCAL {
                    let h = 1e-6;
                    let at = |side: f64| {
                        let (mut placement, mut beta) = (here.placement, plan.betas[place]);
                        match k {
                            4 => beta += side * h,
                            _ => placement[k] += side * h * UNITS[k],
                        }
                        problem.at(&placement).state(point, beta, plan.posture).unwrap()
                    };
                    let difference = (at(1.0).normal_part - at(-1.0).normal_part) / (2.0 * h);
                    assert!((locals[point].state.normal_part.gradient[k] - difference).abs() < 1e-8);
                }
            }
        }
    }
}

#[test]
fn a_cell_without_room_is_refined_in_beta_alone() {
    let mut problem = five_segments();
    let placement = published_optimum();
    problem.cell.position = [placement[0], placement[1], placement[2]].map(|v| Interval { min: v, max: v });
    problem.cell.yaw = Interval { min: placement[3], max: placement[3] };
    let planner = Planner::finer(&problem);
    for sense in [Sense::Min, Sense::Max] {
        let (solution, report) =
            refine(&Evaluator::new(&planner, None), &placement, sense, None, &Monitor::silent()).unwrap();
        assert_allowed(&problem, &solution);
        assert!(report.end_mean <= report.start_mean * (1.0 + 1e-12));
        assert!((0..4).all(|k| (solution.placement[k] - placement[k]).abs() < 1e-12), "{:?}", solution.placement);
    }
}

#[test]
fn joint_travel_and_betas_that_stay_are_refined_with_the_placement() {
    let start = published_optimum();
    let mut problem = five_segments();
    problem.criterion.joint_travel_weight = 2e-4;
    let weighed = problem.clone();
    problem.criterion.joint_travel_weight = 0.0;
    let stays = [BetaPlan::ConstantPerSegment, BetaPlan::Constant].map(|beta| {
        let mut problem = problem.clone();
        problem.redundancy.beta = beta;
        problem
    });
    for problem in [weighed].iter().chain(&stays) {
        let planner = Planner::finer(problem);
        let (solution, report) = refined(&planner, &start, Sense::Min).unwrap();
        assert_allowed(problem, &solution);
        assert!(report.end_mean < 0.9 * report.start_mean, "{report:?}");
        assert!(report.kkt_residual.unwrap() < 3e-3 * report.end_mean, "{report:?}");
        assert!(report.iterations > 2, "{report:?}");
        let stays = |plan: &SegmentPlan| plan.betas.iter().all(|beta| *beta == plan.betas[0]);
        let is_one = solution.plans.iter().all(|plan| plan.betas[0] == solution.plans[0].betas[0]);
        match problem.redundancy.beta {
            BetaPlan::Free => {}
            BetaPlan::ConstantPerSegment => assert!(solution.plans.iter().all(stays)),
            BetaPlan::Constant => assert!(solution.plans.iter().all(stays) && is_one),
        }
        // The gradient by which a worst placement is refined is that of the replanned optimum.
        let placement = Placement::from([0.05, -1.75, -0.45, 0.5]);
        let plan = |placement: &Placement| planned(&planner, placement, None, &mut planner.workspace()).unwrap();
        let gradient = ascent::pose_gradient(problem, &plan(&placement)).unwrap();
        let step = 2e-4;
        for k in 0..3 {
            let [after, before] = [step, -step].map(|by| {
                let mut moved = placement;
                moved[k] += by * LENGTH_UNIT;
                plan(&moved).objective
            });
            let slope = (after - before) / (2.0 * step);
            let size = gradient.norm();
            assert!((slope - gradient[k]).abs() < 0.1 * size, "{k} {slope} {gradient:?} {:?}", problem.redundancy.beta);
        }
    }
}

#[test]
fn refinement_keeps_the_turn_of_the_spindle() {
    for lean in [0.0, 0.15] {
        let mut problem = with_turn_limits(corners(lean), 120, None, 3.0);
        problem.redundancy.feed /= 4.0;
        let planner = Planner::new(&problem);
        let evaluator = Evaluator::new(&planner, None);
        let start = Placement::from([0.0, -1.8, -0.4, 1.2]);
        let (refined, report) = refine(&evaluator, &start, Sense::Min, None, &Monitor::silent()).unwrap();
        assert!(report.end_mean <= report.start_mean);
        assert_sound(&problem, &refined.placement, &refined.plans);
    }
}
