//! Limits on beta against rotation matrices.

use super::*;
use crate::constraints::Measured;
use crate::problem::Placement;
use crate::testing::five_segments;
use nalgebra::{Rotation3, Unit, Vector3};
use proptest::prelude::*;
use stead_model::robot::point_from_tool;
use stead_model::task::{PathPoint, Task, ToolPath};
use stead_numerics::rotation;

impl Problem {
    /// The constraints on the change of beta (rad) from path point `point - 1` to `point` that are in force.
    fn on_beta_step(&self, point: usize, change: f64) -> impl Iterator<Item = Measured> + use<> {
        let rate = self
            .redundancy
            .max_beta_rate
            .map(|rate| Measured::BetaRate { step: wrap(change).abs(), limit: rate * self.step_length(point) });
        let limit = self.spindle_turn_limit(point);
        let turn = limit.map(|limit| Measured::SpindleTurn { turn: self.spindle_turn(point, change), limit });
        [rate, turn].into_iter().flatten()
    }
}

/// Two points 10 mm apart with the axes of two rotations.
fn two_points(rotations: [Rotation3<f64>; 2]) -> Problem {
    let mut problem = five_segments();
    let points = rotations.iter().enumerate().map(|(k, rotation)| {
        let [feed, axis] = [0, 2].map(|column| rotation.matrix().column(column).into_owned());
        (1, PathPoint { position: Vector3::new(0.01 * k as f64, 0.0, 0.0), feed, axis })
    });
    let wrenches = vec![problem.task.loads()[0].wrench; 2];
    problem.task = Task::new(ToolPath::new(points.collect::<Vec<_>>()).unwrap(), wrenches).unwrap();
    problem
}

fn turned(axis: [f64; 3], angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::from(axis)), angle)
}

/// The angle between the tool frames, by matrices.
fn angle(problem: &Problem, from: f64, to: f64) -> f64 {
    let frame = |point: usize, beta: f64| problem.task.points()[point].workpiece_from_point() * point_from_tool(beta);
    rotation::rotation_vector(&(frame(0, from).transpose() * frame(1, to))).norm()
}

fn directions() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |v| Vector3::from(*v).norm() > 0.1)
}

proptest! {
    #[test]
    fn the_turn_of_the_spindle_is_that_of_the_matrices(
        axes in [directions(), directions()], angles in [-3.1..3.1_f64, -3.1..3.1_f64], from in -4.0..4.0_f64, to in -4.0..4.0_f64
    ) {
        let first = turned(axes[0], angles[0]);
        let problem = two_points([first, first * turned(axes[1], angles[1])]);
        let expected = angle(&problem, from, to);
        prop_assert!((problem.spindle_turn(1, to - from) - expected).abs() < 1e-7);
    }

    #[test]
    fn a_change_is_allowed_where_every_limit_holds(
        axes in [directions(), directions()], angles in [-3.1..3.1_f64, -1.0..1.0_f64], change in -3.1..3.1_f64,
        limits in [0.01..3.3_f64, 0.01..3.3_f64, 0.01..3.3_f64], given in 1..8_u8
    ) {
        let first = turned(axes[0], angles[0]);
        let mut problem = two_points([first, first * turned(axes[1], angles[1])]);
        let limit = |k: usize, unit: f64| Some(limits[k] / unit).filter(|_| given >> k & 1 == 1);
        let redundancy = &mut problem.redundancy;
        (redundancy.max_beta_rate, redundancy.max_spindle_turn) = (limit(0, 0.01), limit(1, 0.01));
        redundancy.max_spindle_speed = limit(2, 0.01 / redundancy.feed);
        let by_turn = [1, 2].into_iter().filter(|k| given >> k & 1 == 1).map(|k| limits[k]).fold(f64::INFINITY, f64::min);
        let most = std::f64::consts::FRAC_PI_2.max(problem.axis_turn(1) + std::f64::consts::FRAC_PI_6);
        let by_turn = if by_turn.is_finite() { by_turn.min(most) } else { by_turn };
        let by_rate = if given & 1 == 1 { limits[0] } else { f64::INFINITY };
        let margin = (by_turn - angle(&problem, 0.3, 0.3 + change)).min(by_rate - change.abs());
        let measured = problem.on_beta_step(1, change).map(|m| m.margin()).fold(f64::INFINITY, f64::min);
        prop_assert!((measured - margin).abs() < 1e-7 || measured == margin);
        prop_assume!(margin.abs() > 1e-6);
        let step = problem.beta_step(1);
        if margin < 0.0 {
            prop_assert!(!step.allows(change), "{step:?} {margin}");
        } else {
            // Of two intervals the wider one is taken.
            let middle = problem.turn(1).middle;
            let overlaps = by_rate + step.half > std::f64::consts::PI || middle.abs() + by_rate > std::f64::consts::PI;
            prop_assert!(step.allows(change) || overlaps && by_rate < std::f64::consts::PI, "{step:?} {margin}");
        }
    }
}

#[test]
fn a_spindle_that_stands_still_takes_back_the_turn_of_the_feed() {
    for turn in [-3.0, -1.0, 0.2, 2.5_f64] {
        let mut problem = two_points([turned([0.0, 0.0, 1.0], 0.4), turned([0.0, 0.0, 1.0], 0.4 + turn)]);
        problem.redundancy.max_beta_rate = None;
        problem.redundancy.max_spindle_turn = Some(5.0);
        let step = problem.beta_step(1);
        assert!((step.middle + turn).abs() < 1e-12 && (step.half - 0.05).abs() < 1e-12, "{step:?}");
        assert!(problem.spindle_turn(1, -turn) < 1e-12 && problem.axis_turn(1) < 1e-12);
        // Also against the pose of the flange in the cell.
        let placement = Placement::from([0.1, -1.8, -0.4, 0.7]);
        let [a, b] =
            [(0, 0.9), (1, 0.9 - turn + 0.05)].map(|(k, beta)| problem.at(&placement).base_from_flange(k, beta));
        assert!((rotation::rotation_vector(&(a.rotation.transpose() * b.rotation)).norm() - 0.05).abs() < 1e-9);
    }
}

#[test]
fn an_axis_that_turns_too_fast_leaves_no_change() {
    let mut problem = two_points([Rotation3::identity(), turned([1.0, 0.0, 0.0], 0.2)]);
    (problem.redundancy.max_beta_rate, problem.redundancy.max_spindle_turn) = (None, Some(19.0));
    assert!((problem.axis_turn(1) - 0.2).abs() < 1e-12);
    assert!(problem.beta_step(1).half < 0.0 && !problem.beta_step(1).allows(0.0));
    problem.redundancy.max_spindle_turn = Some(20.0);
    assert!(problem.beta_step(1).allows(0.0) && problem.beta_step(1).half < 1e-4);
}

#[test]
fn a_beta_that_stays_is_held_against_the_limits_on_its_changes() {
    // The spindle turns with the feed, over 10 mm.
    let mut problem = two_points([Rotation3::identity(), turned([0.0, 0.0, 1.0], 0.2)]);
    problem.redundancy.beta = BetaPlan::ConstantPerSegment;
    for (limit, is_allowed) in [(0.21, true), (0.19, false)] {
        (problem.redundancy.max_beta_rate, problem.redundancy.max_spindle_turn) = (None, Some(limit / 0.01));
        assert_eq!(problem.beta_step(1).allows(0.0), is_allowed, "{limit}");
        assert!(!problem.beta_step(1).allows(0.01) && !problem.beta_step(1).allows(-0.2));
    }
}
