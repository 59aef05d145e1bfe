//! Plans at the feed that the arm holds, with the forces of that feed.

use super::*;
use stead_model::robot::Robot;
use stead_model::robot::testing::kr270;
use stead_model::task::{Task, Wrench};
use stead_problem::testing::five_segments;

/// A quarter of every force is of the edges.
const EDGE: f64 = 0.25;

/// The published case with joints of this acceleration (rad/s2).
fn problem(acceleration: f64) -> Problem {
    let mut problem = five_segments();
    let mut joints = kr270().joints().clone();
    joints.iter_mut().for_each(|joint| joint.max_acceleration = Some(acceleration));
    problem.robot = Robot::new("slow", joints).unwrap();
    problem.redundancy.beta_count = 40;
    problem
}

fn with_edges(mut problem: Problem) -> Problem {
    let (path, wrenches): (_, Vec<_>) = (problem.task.path().clone(), problem.task.wrenches().copied().collect());
    let edge = |wrench: &Wrench| Wrench { force: wrench.force * EDGE, moment: wrench.moment * EDGE };
    let edges = wrenches.iter().map(edge).collect();
    problem.task = Task::new(path, wrenches).unwrap().with_edge_parts(edges).unwrap();
    problem
}

#[test]
fn where_the_feed_is_not_held_the_chips_take_less_force() {
    let scored = scored_at_published_optimum(&with_edges(problem(0.3)));
    for (plan, cycle) in [(&scored.plans.best, &scored.cycles.best), (&scored.plans.worst, &scored.cycles.worst)] {
        let held = plan.held.unwrap();
        assert!(held.slowed > 0 && held.slowed == cycle.feed.slowed());
        // The deflection is in proportion to the force, all of which falls alike here.
        let share = |point: &PlanPoint| {
            let share = cycle.feed.held(point.segment - 1) / cycle.feed.programmed;
            EDGE + share.min(1.0) * (1.0 - EDGE)
        };
        let total = |point: &PlanPoint| point.deflection.norm() * share(point);
        let mean = plan.points.iter().map(total).sum::<f64>() / plan.points.len() as f64;
        let max = plan.points.iter().map(total).fold(0.0, f64::max);
        let found = held.deflection.total;
        assert!((found.mean / mean - 1.0).abs() < 1e-9 && (found.max / max - 1.0).abs() < 1e-9, "{found:?} {mean}");
        assert!(held.mean < plan.mean && held.max <= plan.max && found.mean < plan.deflection.total.mean * 0.99);
    }
}

#[test]
fn where_the_feed_is_held_nothing_changes_and_forces_of_other_sources_say_nothing() {
    let plan = scored_at_published_optimum(&with_edges(problem(1e4))).plans.best;
    let held = plan.held.unwrap();
    assert_eq!((held.slowed, held.mean, held.max), (0, plan.mean, plan.max));
    assert_eq!(held.deflection, plan.deflection);
    assert_eq!(scored_at_published_optimum(&problem(0.3)).plans.best.held, None);
}
