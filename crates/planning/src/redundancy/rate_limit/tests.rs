//! Whole steps of the grid within intervals, and steps saved up and spread again.

use super::super::knots::{Knots, Place, StepBudget};
use super::*;
use proptest::prelude::*;
use stead_model::task::{PathPoint, Task, ToolPath};
use stead_problem::testing::five_segments;

/// An arc of a circle (radius in m) that is turned by `turn` per point, the tool upright.
fn arc(radius: f64, turn: f64, count: usize) -> Problem {
    let mut problem = five_segments();
    let first = problem.task.points()[0];
    let points = (0..count).map(|k| {
        let (sine, cosine) = libm::sincos(turn * k as f64);
        let position = first.position + nalgebra::Vector3::new(radius * sine, radius * (1.0 - cosine), 0.0);
        (1, PathPoint { position, feed: nalgebra::Vector3::new(cosine, sine, 0.0), ..first })
    });
    let path = ToolPath::new(points.collect::<Vec<_>>()).unwrap();
    problem.task = Task::new(path, vec![problem.task.loads()[0].wrench; count]).unwrap();
    problem
}

/// The knots of a path whose joints may step as they like.
fn knots(problem: &Problem, room: f64) -> Knots {
    let grid = problem.redundancy;
    let direct = direct_changes(problem, &grid);
    let joints = vec![[std::f64::consts::PI; 6]; problem.task.points().len()];
    Knots::new(problem, &grid, &joints, &direct, StepBudget { neighbours: 1.0, knots: room })
}

proptest! {
    #[test]
    fn whole_steps_are_those_within(middle in -60.0..60.0_f64, half in 0.0..40.0_f64, count in 6..80_usize) {
        let change = BetaChange::within(middle, half, count);
        let is_within = |k: i32| {
            let off = f64::from(k) - middle;
            let off = off - count as f64 * (off / count as f64).round();
            off.abs() <= half + STEP_ROUNDING
        };
        let found: std::collections::BTreeSet<i32> =
            (change.min..=change.max).map(|k| k.rem_euclid(count as i32)).collect();
        let expected: std::collections::BTreeSet<i32> = (0..count as i32).filter(|k| is_within(*k)).collect();
        prop_assert_eq!(found, expected);
        prop_assert!(change.widest() <= count);
        let shifts: Vec<isize> = change.shifts().collect();
        let mut sorted = shifts.clone();
        sorted.sort_unstable();
        prop_assert_eq!(sorted, (-change.max..=-change.min).map(|k| k as isize).collect::<Vec<_>>());
        prop_assert_eq!(shifts.first().copied(), (!change.is_none()).then(|| change.middle_shift()));
        prop_assert!(shifts.windows(2).all(|pair| (pair[0] - change.middle_shift()).abs() <= (pair[1] - change.middle_shift()).abs()));
    }

    #[test]
    fn what_is_saved_up_is_spread_within_the_limits(
        (size, side) in (1e-3..0.4_f64, prop::bool::ANY), share in 0.05..3.0_f64, beta_count in 20..400_usize,
        room in 1.0..6.0_f64, picks in prop::collection::vec(0.0..1.0_f64, 60)
    ) {
        let turn = if side { size } else { -size };
        let mut problem = arc(0.002, turn, 60);
        problem.redundancy.beta_count = beta_count;
        // In steps of the grid.
        let limit = share * problem.redundancy.beta_step() / problem.step_length(1);
        (problem.redundancy.max_beta_rate, problem.redundancy.max_spindle_turn) = (None, Some(limit));
        let grid = problem.redundancy;
        let knots = knots(&problem, room);
        let span = problem.task.segments()[0].clone();
        prop_assert_eq!(knots.of(&span).first().zip(knots.of(&span).last()), Some((&0, &59)));
        let mut number = 7;
        let mut betas = vec![grid.beta(number as usize % beta_count); 60];
        for point in span.clone().skip(1) {
            let Place::Knot(knot) = knots.at(point) else { continue };
            prop_assert!(!knot.change.is_none(), "{knot:?}");
            let pick = (picks[point] * knot.change.count() as f64) as i32;
            number = (number + knot.change.min + pick).rem_euclid(beta_count as i32);
            betas[point] = grid.beta(number as usize);
        }
        knots.spread(&span, &mut betas);
        for point in span.skip(1) {
            let (step, change) = (problem.beta_step(point), betas[point] - betas[point - 1]);
            prop_assert!(step.off_middle(change).abs() <= step.half + 1e-7, "{point} {change} {step:?}");
        }
    }
}

#[test]
fn steps_about_zero_are_saved_up_as_before() {
    let mut problem = five_segments();
    // A third of a step of the grid between neighbours.
    problem.redundancy.max_beta_rate = Some(problem.redundancy.beta_step() / 3.0 / problem.step_length(1));
    let grid = problem.redundancy;
    let saved: Vec<i32> = saved_changes(&problem, &grid)[1..8].iter().map(|change| change.max).collect();
    assert_eq!(saved, [0, 0, 1, 0, 0, 1, 0]);
    assert!(direct_changes(&problem, &grid)[1..8].iter().all(|change| *change == BetaChange::only(0)));
    let knots = knots(&problem, 1.0);
    let runs: Vec<(i32, usize)> = (1..8)
        .map(|point| match knots.at(point) {
            Place::Knot(knot) => (knot.change.max, knot.points),
            Place::Between { .. } => (0, 1),
        })
        .collect();
    assert_eq!(runs, [(0, 1), (0, 1), (1, 3), (0, 1), (0, 1), (1, 3), (0, 1)]);
}
