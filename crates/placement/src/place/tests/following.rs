//! Points that are followed but not scored, turns of the tool in place, and feeds of the task.

use super::{Placement, Problem, Score, published_optimum};
use crate::outcome::DeflectionFigures;
use crate::place::score;
use nalgebra::Rotation3;
use stead_model::robot::{Joint, Robot};
use stead_model::task::{PathPoint, Task, ToolPath};
use stead_numerics::mean_max::MeanAndMax;
use stead_numerics::monitor::Monitor;
use stead_problem::criterion::Aggregate;
use stead_problem::problem::MAX_JOINT_STEP;
use stead_problem::settings::TransferSettings;
use stead_problem::testing::five_segments;

fn scored(problem: &Problem) -> Result<Score, String> {
    let placement: Placement = published_optimum();
    score(problem, &placement, &TransferSettings::default(), &Monitor::silent()).map_err(|error| error.to_string())
}

/// The five segments with some points that are not scored; the wrenches of the file stay in what is given.
fn partly_scored(is_scored: impl Fn(usize) -> bool) -> Problem {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 40;
    let path = problem.task.path();
    let points: Vec<(u32, PathPoint, bool)> =
        (0..105).map(|k| (path.segment_of(k) as u32 + 1, problem.task.points()[k], is_scored(k))).collect();
    let path = ToolPath::partly_scored(points).unwrap();
    problem.task = Task::new(path, problem.task.wrenches().copied().collect()).unwrap();
    problem
}

/// The first and the last two of each segment are not scored.
fn is_inner(point: usize) -> bool {
    (2..19).contains(&(point % 21))
}

#[test]
fn points_that_are_not_scored_are_followed_and_have_no_part_in_any_figure() {
    let mut problem = partly_scored(is_inner);
    for aggregate in [Aggregate::Mean, Aggregate::Max] {
        problem.criterion.aggregate = aggregate;
        let found = scored(&problem).unwrap();
        for plan in [&found.plans.best, &found.plans.worst] {
            assert_eq!(plan.points.len(), 105, "all points are followed");
            for point in &plan.points {
                let arm = problem.at(&found.placement).state(point.point, point.beta, point.posture).unwrap();
                assert!(arm.inverse_condition >= problem.constraints.min_inverse_condition);
                let limits = problem.robot.joints().iter().zip(point.joints);
                assert!(limits.into_iter().all(|(joint, angle)| angle >= joint.min && angle <= joint.max));
                assert_eq!(point.score == 0.0, !is_inner(point.point));
            }
            let inner = plan.points.iter().filter(|point| is_inner(point.point));
            let scores: Vec<f64> = inner.clone().map(|point| point.score).collect();
            let mean = scores.iter().sum::<f64>() / 85.0;
            let max = scores.iter().copied().fold(0.0, f64::max);
            assert!((plan.mean - mean).abs() < 1e-15 && plan.max == max);
            let expected = if aggregate == Aggregate::Max { max } else { mean };
            assert!((plan.objective - expected).abs() < 1e-12);
            // Of 85 values half are up to the 43rd; with the 20 zeros it would be a lower one.
            let mut sorted = scores.clone();
            sorted.sort_by(f64::total_cmp);
            assert!(plan.percentiles[0] >= sorted[41] && plan.percentiles[1] <= max);
            assert_eq!(plan.deflection, DeflectionFigures::of(inner.clone()));
            let wall = MeanAndMax::of(inner.map(|point| point.normal_part.abs()));
            assert_eq!(plan.deflection.wall, wall);
        }
    }
}

#[test]
fn a_point_that_is_not_scored_must_be_reached_all_the_same() {
    let mut problem = partly_scored(is_inner);
    assert!(scored(&problem).is_ok());
    let path = problem.task.path();
    let far = |k: usize, point: PathPoint| match k {
        20 => PathPoint { position: point.position * 40.0, ..point },
        _ => point,
    };
    let points = (0..105).map(|k| (path.segment_of(k) as u32 + 1, far(k, problem.task.points()[k]), is_inner(k)));
    let path = ToolPath::partly_scored(points.collect::<Vec<_>>()).unwrap();
    problem.task = Task::new(path, problem.task.wrenches().copied().collect()).unwrap();
    let said = scored(&problem).unwrap_err();
    assert!(said.contains("point 20"), "{said}");
}

/// The first segment with its tool tilted by 12 deg at its middle, in three turns in place, and upright again.
fn turning() -> Problem {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 40;
    let joints = problem.robot.joints().clone().map(|joint| Joint { max_speed: Some(1.5), ..joint });
    problem.robot = Robot::new("timed", joints).unwrap();
    let (points, wrench) = (problem.task.points(), problem.task.loads()[0].wrench);
    let axis = points[10].feed;
    let tilted = |deg: f64| PathPoint {
        axis: Rotation3::from_scaled_axis(axis * deg.to_radians()) * points[10].axis,
        ..points[10]
    };
    let turned = [4.0, 8.0, 12.0, 8.0, 4.0, 0.0].map(|deg| (1, tilted(deg), false));
    let cut = |k: usize| (1, points[k], true);
    let all: Vec<_> = (0..11).map(cut).chain(turned).chain((11..21).map(cut)).collect();
    let count = all.len();
    problem.task = Task::new(ToolPath::partly_scored(all).unwrap(), vec![wrench; count]).unwrap();
    problem
}

#[test]
fn a_turn_in_place_keeps_beta_within_the_rate_and_takes_its_own_time() {
    let problem = turning();
    let found = scored(&problem).unwrap();
    let points = &found.plans.best.points;
    assert_eq!(points.len(), 27);
    for place in 11..17 {
        assert!(problem.task.path().turns_in_place(place));
        // No way, so the rate of beta leaves it where it is; the joints may move as they need.
        assert!((points[place].beta - points[place - 1].beta).abs() < 1e-8);
        assert!((points[place].position - points[10].position).norm() < 1e-9 && points[place].score == 0.0);
        let widest = (0..6).map(|j| (points[place].joints[j] - points[place - 1].joints[j]).abs());
        assert!(widest.fold(0.0, f64::max) > 1e-3);
    }
    let without = five_segments();
    let lengths: f64 = without.task.path().segment_length(0);
    let cutting = found.cycles.best.cutting;
    let at_feed = lengths / found.cycles.best.feed.held(0);
    assert!(cutting > at_feed + 0.5 && cutting.is_finite(), "{cutting} {at_feed}");
    assert!(found.cycles.best.feed.highest().unwrap().feed > 1e-3, "turns in place do not hold the feed");
}

#[test]
fn feeds_of_the_task_bound_the_joint_steps_and_give_the_time() {
    let mut problem = turning();
    problem.task = Task::new(
        five_segments().task.path().clone().with_feeds((0..105).map(|k| 0.01 + 1e-4 * k as f64).collect()).unwrap(),
        five_segments().task.wrenches().copied().collect(),
    )
    .unwrap();
    let found = scored(&problem).unwrap();
    let path = problem.task.path();
    let inner = path.segments().iter().flat_map(|span| span.clone().skip(1));
    let time: f64 = inner.clone().map(|k| path.step_length(k) / (0.01 + 1e-4 * k as f64)).sum();
    assert_eq!(found.cycles.best.feed.slowed(), 0);
    assert!((found.cycles.best.cutting / time - 1.0).abs() < 1e-12);
    assert_eq!(found.cycles.best.feed.programmed, 0.01 + 1e-4 * 104.0);
    for k in inner {
        let step = 1.5 * path.step_length(k) / (0.01 + 1e-4 * k as f64);
        assert!(problem.joint_steps(k).iter().all(|allowed| (allowed / step.min(MAX_JOINT_STEP) - 1.0).abs() < 1e-12));
    }
    // One move faster than any joint follows: no plan, and the segment and the reason are named.
    let mut feeds: Vec<f64> = (0..105).map(|k| 0.01 + 1e-4 * k as f64).collect();
    feeds[50] = 50.0;
    let fast = five_segments().task.path().clone().with_feeds(feeds).unwrap();
    problem.task = Task::new(fast, five_segments().task.wrenches().copied().collect()).unwrap();
    let said = scored(&problem).unwrap_err();
    assert!(said.contains("segment 3") && said.contains("steps of the joints"), "{said}");
}
