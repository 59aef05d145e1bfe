//! The planner against check values, and against plain dynamic programming over every real configuration.

use super::forward_pass::Pass;
use super::*;
use stead_model::robot::angles::yaw_from_q4;
use stead_model::robot::{Compliance, Joint, PostureClass, Robot};
use stead_model::task::{PathPoint, Task, ToolPath};
use stead_problem::criterion::{Aggregate, Weights};
use stead_problem::evaluate::batch::{BatchEvaluator, StateGrid};
use stead_problem::testing::{
    assert_sound, compensated, five_segments, with_axes_2_3, with_beta_rate, with_laws, with_prototype_steps,
};

mod calm;
mod collisions;
mod dense;
mod finer;
mod proposed;
mod spindle_turn;

fn published_optimum() -> Placement {
    [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)].into()
}

fn objective(problem: &Problem, placement: &Placement, sense: Sense) -> Objective {
    let planner = Planner::new(problem);
    let mut workspace = planner.workspace();
    planner.objective(placement, sense, None, &mut workspace)
}

#[test]
fn agrees_with_the_prototype_at_the_published_optimum() {
    let problem = with_prototype_steps(five_segments());
    let best = objective(&problem, &published_optimum(), Sense::Min).mean().unwrap();
    let worst = objective(&problem, &published_optimum(), Sense::Max).mean().unwrap();
    // Printed with four and three digits.
    assert!((best * 1e3 - 0.5357).abs() < 1e-3 * 0.5357, "{best}");
    assert!((worst * 1e3 - 0.594).abs() < 1e-3 * 0.594, "{worst}");
}

/// What a search compares by: in single precision the same placements have a plan, but for some at a limit, and their
/// objectives are the same to the digits that it has.
#[test]
fn objectives_in_single_precision_are_those_in_double() {
    let coarse = |sense: Sense, mut problem: Problem| {
        problem.redundancy.beta_count = 60;
        (sense, problem)
    };
    let mut weighed = five_segments();
    (weighed.criterion.weights, weighed.criterion.force_uncertainty) = (Weights::TOTAL, 0.1);
    let mut largest = with_prototype_steps(five_segments());
    largest.criterion.aggregate = Aggregate::Max;
    let mut calm = with_axes_2_3(five_segments(), true, [-150.0, 0.0]);
    calm.criterion.joint_travel_weight = 1e-5;
    for (number, (sense, problem)) in [
        coarse(Sense::Min, with_prototype_steps(five_segments())),
        coarse(Sense::Max, weighed),
        coarse(Sense::Min, largest),
        coarse(Sense::Min, calm),
    ]
    .into_iter()
    .enumerate()
    {
        let planner = Planner::new(&problem);
        let (mut exact, mut rough) = (planner.workspace(), planner.workspace_of::<f32>());
        let (mut feasible, mut differ, mut errors) = (0, 0, Vec::new());
        for k in 0..60 {
            let share = |step: f64| (f64::from(k) * step).fract();
            let placement =
                [-0.3 + 0.6 * share(0.618), -2.0 + 0.6 * share(0.414), -0.8 + 0.5 * share(0.732), 6.0 * share(0.236)];
            let of = |found: Objective| found.mean();
            let expected = of(planner.objective(&placement.into(), sense, None, &mut exact));
            let found = of(planner.objective(&placement.into(), sense, None, &mut rough));
            feasible += usize::from(expected.is_some());
            match (expected, found) {
                (Some(expected), Some(found)) => errors.push((found / expected - 1.0).abs()),
                (None, None) => {}
                _ => differ += 1,
            }
        }
        // A state or a step at a limit may be allowed in one and not in the other.
        errors.sort_by(f64::total_cmp);
        let [middle, last] = [errors.len() / 2, errors.len() - 1].map(|k| errors[k]);
        assert!(feasible > 5 && differ <= 1, "{number}: {feasible} {differ}");
        assert!(middle < 2e-6 && last < 1e-3, "{number}: {errors:?}");
    }
}

/// The same arm with other ranges of joints 4, 5 and 6, in degrees.
fn with_wrist(mut problem: Problem, ranges: [(f64, f64); 3]) -> Problem {
    let mut joints = problem.robot.joints().clone();
    for (joint, (min, max)) in joints[3..].iter_mut().zip(ranges) {
        (joint.min, joint.max) = (min.to_radians(), max.to_radians());
    }
    problem.robot = Robot::new("other wrist", joints).unwrap();
    problem
}

#[test]
fn fast_planner_agrees_with_plain_dynamic_programming_over_real_configurations() {
    let mut compared = 0;
    let mut feasible = 0;
    for (index, ranges) in [
        [(-350.0, 350.0), (-125.0, 125.0), (-350.0, 350.0)],
        [(-185.0, 185.0), (-125.0, 125.0), (-181.0, 200.0)],
        [(-150.0, 150.0), (-30.0, 125.0), (-170.0, 120.0)],
        [(-60.0, 90.0), (-125.0, 125.0), (-200.0, 180.0)],
        [(-100.0, 80.0), (-125.0, 125.0), (-80.0, 110.0)],
        [(-180.0, 0.0), (-125.0, 125.0), (-182.0, 182.0)],
        // With laws of compliance that tell the flips apart.
        [(-185.0, 185.0), (-125.0, 125.0), (-350.0, 350.0)],
        [(-150.0, 150.0), (-30.0, 125.0), (-170.0, 120.0)],
        // With other criteria.
        [(-150.0, 150.0), (-30.0, 125.0), (-170.0, 120.0)],
        [(-185.0, 185.0), (-125.0, 125.0), (-181.0, 200.0)],
        [(-185.0, 185.0), (-125.0, 125.0), (-181.0, 200.0)],
        // With points that are not scored, forbidden states beside others.
        [(-150.0, 150.0), (-30.0, 125.0), (-170.0, 120.0)],
        [(-60.0, 90.0), (-125.0, 125.0), (-200.0, 180.0)],
        // With a range of the sum of joints 2 and 3, and with a linkage.
        [(-185.0, 185.0), (-125.0, 125.0), (-350.0, 350.0)],
        [(-350.0, 350.0), (-125.0, 125.0), (-350.0, 350.0)],
        [(-150.0, 150.0), (-30.0, 125.0), (-170.0, 120.0)],
    ]
    .into_iter()
    .enumerate()
    {
        // With and without joint speeds that bind.
        let arm = if index % 2 == 0 { five_segments() } else { with_prototype_steps(five_segments()) };
        let mut problem = with_wrist(arm, ranges);
        if index >= 13 {
            problem = with_axes_2_3(problem, index > 13, [-150.0, 0.0]);
        } else if index >= 11 {
            let path = problem.task.path();
            let is_scored = |point: usize| !point.is_multiple_of(index - 9);
            let points: Vec<_> = (0..105)
                .map(|point| (path.segment_of(point) as u32 + 1, problem.task.points()[point], is_scored(point)))
                .collect();
            problem.task =
                Task::new(ToolPath::partly_scored(points).unwrap(), problem.task.wrenches().copied().collect())
                    .unwrap();
        } else if index >= 8 {
            problem.criterion.weights = [Weights::TOTAL, Weights::WALL, Weights::AXIS][index - 8];
            problem.criterion.aggregate = [Aggregate::Rms, Aggregate::Max, Aggregate::Max][index - 8];
            problem.criterion.segment_weights = vec![1.0, 2.0, 0.5, 1.0, 3.0];
        } else if index >= 6 {
            let bent = Compliance::Range { at_min: 1e-6, at_max: 4e-6 };
            problem = with_laws(problem, &[(1, compensated(0.2, 3e-7)), (3, compensated(1.0, 2e-6)), (4, bent)]);
        }
        problem.redundancy.beta_count = 40;
        // So fast that plans swing around and meet the limits of the turns.
        problem = with_beta_rate(problem, 4.0);
        let planner = Planner::new(&problem);
        let mut workspace = planner.workspace();
        for k in 0..8 {
            let f = f64::from(k);
            let placement = Placement::from([
                -0.3 + 0.07 * f,
                -1.64 - 0.05 * f,
                -0.6 + 0.04 * f,
                -3.0 + 0.8 * f + 0.2 * index as f64,
            ]);
            for sense in [Sense::Min, Sense::Max] {
                for scheme in [None, Some([3, 4, 3, 1, 5].map(|n| Posture::from_number(n).unwrap()))] {
                    let found = planner.plan(&placement, sense, scheme.as_ref().map(|s| &s[..]), &mut workspace);
                    let mut expected = Vec::new();
                    for (segment, span) in problem.task.segments().iter().enumerate() {
                        let only = scheme.map(|s| vec![s[segment]]);
                        let postures = only.unwrap_or(Posture::ALL.to_vec());
                        let choice =
                            reference_dp::plan(&planner.segments, span, &placement, sense, &postures, &mut workspace);
                        expected.push(choice.map_or(f64::INFINITY, |c| c.cost));
                    }
                    let expected = problem.objective(expected);
                    let cost = found
                        .as_ref()
                        .map_or(f64::INFINITY, |plans| problem.objective(plans.iter().map(|plan| plan.cost)));
                    compared += 1;
                    assert_eq!(cost.is_finite(), expected.is_finite(), "{ranges:?} {placement:?} {sense:?} {scheme:?}");
                    let worth =
                        planner.objective(&placement, sense, scheme.as_ref().map(|s| &s[..]), &mut workspace).mean();
                    assert_eq!(worth.is_some(), cost.is_finite());
                    if let Ok(plans) = found {
                        feasible += 1;
                        assert!(
                            (cost - expected).abs() < 1e-12 * expected,
                            "{cost} {expected} {ranges:?} {placement:?}"
                        );
                        assert!((worth.unwrap() - cost).abs() < 1e-12 * cost);
                        assert_sound(&problem, &placement, &plans);
                    }
                }
            }
        }
    }
    assert!(compared == 512 && feasible > 60, "{compared} {feasible}");
}

#[test]
fn with_turns_to_spare_the_band_alone_is_exact() {
    let wide = [(-540.0, 540.0), (-125.0, 125.0), (-540.0, 540.0)];
    let mut compared = 0;
    for share in [1.0, 0.3] {
        let mut problem = with_wrist(with_prototype_steps(five_segments()), wide);
        problem.redundancy.beta_count = 60;
        problem = with_beta_rate(problem, 3.0);
        problem.redundancy.feed /= share;
        let planner = Planner::new(&problem);
        let mut workspace = planner.workspace();
        for k in 0..6 {
            let f = f64::from(k);
            let placement = Placement::from([-0.3 + 0.1 * f, -1.64 - 0.1 * f, -0.6 + 0.06 * f, -3.0 + 1.1 * f]);
            for span in problem.task.segments() {
                let evaluator = &planner.segments.evaluators[0];
                let pass =
                    Pass { evaluator, span, placement: &placement, sense: Sense::Min, only: None, is_by_knots: false };
                let forward_pass = planner.segments.forward_pass(pass, &mut workspace, false);
                for class in PostureClass::ALL {
                    let postures = class.postures();
                    let judge =
                        reference_dp::plan(&planner.segments, span, &placement, Sense::Min, &postures, &mut workspace);
                    let (found, expected) =
                        (forward_pass.ends[class.index()].map(|end| end.0), judge.map(|choice| choice.cost));
                    assert_eq!(found.is_some(), expected.is_some(), "{class:?} {span:?} {placement:?}");
                    if let (Some(found), Some(expected)) = (found, expected) {
                        compared += 1;
                        assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected} {class:?} {span:?}");
                    }
                }
            }
        }
    }
    assert!(compared > 40, "{compared}");
}

#[test]
fn refining_beta_keeps_every_rule_and_comes_near_to_a_fine_grid() {
    let problem = with_prototype_steps(five_segments());
    let placement = published_optimum();
    for sense in [Sense::Min, Sense::Max] {
        let planner = Planner::new(&problem);
        let mut plans = planner.plan(&placement, sense, None, &mut planner.workspace()).unwrap();
        let before: f64 = plans.iter().map(|p| p.cost).sum();
        for plan in &mut plans {
            let (full, unwatched) =
                (off_grid::Spacing::full(&problem.redundancy), vec![off_grid::Watch::default(); plan.points.len()]);
            let evaluators = BatchEvaluator::all(&problem, &problem.redundancy);
            let evaluator = BatchEvaluator::of_posture(&evaluators, plan.posture).unwrap();
            off_grid::refine(evaluator, &placement, sense, full, &unwatched, plan);
            let replayed = off_grid::replay(&problem, &placement, sense, plan).unwrap();
            assert!((replayed.cost - plan.cost).abs() < 1e-12 * plan.cost);
        }
        assert_sound(&problem, &placement, &plans);
        let after: f64 = plans.iter().map(|p| p.cost).sum();
        assert!(after * sense.sign() <= before * sense.sign());
        let mut fine_grid = problem.clone();
        fine_grid.redundancy.beta_count = 1440;
        let grid = objective(&fine_grid, &placement, sense).mean().unwrap() * 105.0;
        assert!(after * sense.sign() < grid * sense.sign() + 2e-4 * grid, "{before} {after} {grid}");
    }
}

#[test]
fn says_which_points_and_segments_have_no_plan() {
    let problem = five_segments();
    let planner = Planner::new(&problem);
    let far = Placement::from([0.0, -4.0, -0.4, 0.0]);
    let none = planner.plan(&far, Sense::Min, None, &mut planner.workspace()).unwrap_err();
    assert_eq!(none.blocked_points.len(), 105);
    assert_eq!(
        planner.objective(&far, Sense::Min, None, &mut planner.workspace()),
        Objective::Infeasible { points: 105, segments: 0 }
    );
    // With joints that may hardly move, points are allowed but no segment can be followed.
    let mut joints = problem.robot.joints().clone();
    joints.iter_mut().for_each(|j| j.max_speed = Some(1e-6));
    let stiff = problem.clone().with(|parts| parts.robot = Robot::new("slow", joints).unwrap());
    let planner = Planner::new(&stiff);
    let none = planner.plan(&published_optimum(), Sense::Min, None, &mut planner.workspace()).unwrap_err();
    assert!(none.blocked_points.is_empty());
    assert_eq!(none.broken_segments, [(0, 1), (1, 22), (2, 43), (3, 64), (4, 85)]);
}

/// A class that is stuck is evaluated no further; blocked points are those without a state in any class all the same.
#[test]
fn blocked_points_are_those_without_a_state_where_classes_were_stuck_before() {
    let problem = with_prototype_steps(five_segments());
    let planner = Planner::new(&problem);
    let (mut space, mut states) = (planner.workspace(), StateGrid::<f64>::new(planner.grid().beta_count, 0));
    let (mut free, mut blocked) = (0, 0);
    for k in 0..600 {
        let [x, y, z] = [k % 5, k / 5 % 10, k / 50].map(f64::from);
        let placement = Placement::from([0.3 * x - 0.6, -2.9 + 0.2 * y, -1.4 + 0.2 * z, 0.7 * f64::from(k)]);
        let is_blocked = |point: &usize| {
            planner.segments.evaluators.iter().all(|evaluator| {
                evaluator.evaluate(*point, &placement, &mut states);
                PostureClass::ALL.into_iter().all(|class| !states.is_alive(class))
            })
        };
        let expected: Vec<usize> = (0..problem.task.points().len()).filter(is_blocked).collect();
        let found = planner.objective(&placement, Sense::Min, None, &mut space);
        match planner.plan(&placement, Sense::Min, None, &mut space) {
            Ok(_) => {
                assert!(expected.is_empty() && found.mean().is_some());
                free += 1;
            }
            Err(none) => {
                assert_eq!(none.blocked_points, expected, "{placement:?}");
                let points = expected.len();
                assert!(matches!(found, Objective::Infeasible { points: said, .. } if said == points), "{found:?}");
                blocked += usize::from(points > 0);
            }
        }
    }
    assert!(free > 100 && blocked > 100, "{free} {blocked}");
}

#[test]
fn plans_of_blocks_are_those_of_whole_segments() {
    let mut problem = with_prototype_steps(five_segments());
    problem.redundancy.beta_count = 60;
    problem = with_beta_rate(problem, 3.0);
    let planner = Planner::new(&problem);
    let (placement, sense) = (published_optimum(), Sense::Max);
    let mut compared = 0;
    for evaluator in &planner.segments.evaluators {
        for span in problem.task.segments() {
            let pass = Pass { evaluator, span, placement: &placement, sense, only: None, is_by_knots: false };
            let mut whole = planner.workspace();
            let forward_pass = planner.segments.forward_pass(pass, &mut whole, false);
            // Blocks that end with the segment, that do not, and of the least length.
            for most in [5, 7, 1, 19, 20, 21].map(|steps| steps * 4 * 60) {
                let mut blocks = planner.workspace();
                blocks.record = record::Record::with_capacity_of(span.len(), 60, most);
                let again = planner.segments.forward_pass(pass, &mut blocks, false);
                assert_eq!(again.ends, forward_pass.ends);
                for class in PostureClass::ALL.into_iter().filter(|class| forward_pass.ends[class.index()].is_some()) {
                    compared += 1;
                    let betas = planner.segments.trace(pass, class, &forward_pass, &mut whole);
                    assert_eq!(
                        planner.segments.trace(pass, class, &again, &mut blocks),
                        betas,
                        "{span:?} {class:?} {most}"
                    );
                }
            }
            let posture = Posture::ALL[2];
            let search =
                reference_dp::Search { planner: &planner.segments, span, placement: &placement, sense, posture };
            let expected = search.plan(span.len(), &mut whole);
            assert!(expected.is_some());
            for block in [1, 4, 7, 20, 30] {
                assert_eq!(search.plan(block, &mut whole), expected, "{span:?} {block}");
            }
        }
    }
    assert!(compared >= 30, "{compared}");
}

/// The same path with so many points for each of its own.
fn denser(problem: &Problem, times: usize) -> Problem {
    let task = &problem.task;
    let (mut points, mut wrenches) = (Vec::new(), Vec::new());
    for (segment, span) in task.segments().iter().enumerate() {
        for point in span.clone() {
            let (here, wrench) = (task.points()[point], task.loads()[point].wrench);
            let parts = if point + 1 < span.end { times } else { 1 };
            for part in 0..parts {
                let next = task.points()[(point + 1).min(span.end - 1)].position;
                let position = here.position + (next - here.position) * (part as f64 / times as f64);
                points.push((segment as u32 + 1, PathPoint { position, ..here }));
                wrenches.push(wrench);
            }
        }
    }
    let path = ToolPath::new(points).unwrap();
    problem.clone().with(|parts| parts.task = Task::new(path, wrenches).unwrap())
}

#[test]
fn beta_keeps_its_pace_where_points_are_close() {
    // Near the best placement, where the rate of beta binds; steps of the path that are a third of a step of the grid.
    let placement = Placement::from([0.0, -1.64, -0.214, 1.378]);
    let dense = denser(&five_segments(), 10);
    let sense = Sense::Min;
    let planner = Planner::new(&dense);
    assert!(dense.task.segments().iter().all(|span| planner.segments.knots.is_spread(span)));
    let mut workspace = planner.workspace();
    let plans = planner.plan(&placement, sense, None, &mut workspace).unwrap();
    assert_sound(&dense, &placement, &plans);
    let found = plans.iter().map(|plan| plan.cost).sum::<f64>() / dense.task.points().len() as f64;
    let worth = planner.objective(&placement, sense, None, &mut workspace).mean().unwrap();
    assert!((found - worth).abs() < 1e-12 * found, "{found} {worth}");
    // A grid so fine that nothing is saved up, and beta held still.
    let mean = |beta_count: usize, share: f64| {
        let redundancy = Redundancy { beta_count, ..dense.redundancy };
        let slower = with_beta_rate(dense.clone().with(|parts| parts.redundancy = redundancy), share);
        super::tests::objective(&slower, &placement, sense).mean().unwrap()
    };
    let (fine, still) = (mean(1200, 1.0), mean(120, 0.0));
    // Spread steps leave the grid, so that they may come out a little below the finest.
    assert!((found - fine).abs() < 0.05 * (still - fine), "{fine} {found} {still}");
}

#[test]
fn planning_ends_without_a_plan_once_none_is_wanted() {
    let (problem, placement) = (five_segments(), published_optimum());
    for delay in [0, 200, 1000, 5000] {
        let stop = StopHandle::default();
        let planner = Planner::finer(&problem).unwanted_after(stop.clone());
        let mut workspace = planner.workspace();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(std::time::Duration::from_micros(delay));
                stop.stop();
            });
            // It ends, with whatever it has.
            let _ = planner.plan_fine(&placement, Sense::Min, None, &mut workspace);
        });
        for sense in [Sense::Min, Sense::Max] {
            let none = Err(NoFeasiblePlan::empty());
            assert_eq!(planner.plan_fine(&placement, sense, None, &mut workspace), none);
            assert_eq!(planner.plan(&placement, sense, None, &mut workspace), none);
        }
    }
}
