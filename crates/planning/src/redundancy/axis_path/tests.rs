//! The plan over (beta, axis) against a reference: every pair of neighbouring states, with the limits asked one by one.

use super::*;
use crate::redundancy::motion::{MotionGrid, MotionPlanner};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis, carried};
use stead_model::robot::angles::wrap;
use stead_model::robot::{Joint, Robot};
use stead_model::task::{Task, ToolPath};
use stead_model::testing::tried;
use stead_numerics::rotation::rotation_vector;
use stead_problem::testing::slanted;

/// The cheapest cost of a segment over all postures: every state against every state of the point before.
fn plain(grid: &AxisGrid<'_>, placement: &Placement, span: &Span<usize>) -> Option<f64> {
    let problems: Vec<Problem> = (0..grid.count()).map(|number| grid.problem_at(number)).collect();
    let redundancy = &grid.problem.redundancy;
    let axis = &grid.problem.external_axes[grid.axis];
    let of = |posture: Posture| -> Option<f64> {
        let mut before: Vec<(Configuration, f64)> = Vec::new();
        for point in span.clone() {
            let mut layer = Vec::new();
            for (position, problem) in problems.iter().enumerate() {
                for beta in 0..redundancy.beta_count {
                    let Ok(state) = problem.at(placement).state(point, redundancy.beta(beta), posture) else {
                        continue;
                    };
                    let found = configurations(problem, point, &state).into_iter();
                    layer.extend(found.map(|found| (Configuration { position, beta, ..found }, f64::INFINITY)));
                }
            }
            for (node, cost) in &mut layer {
                if point == span.start {
                    *cost = node.score;
                    continue;
                }
                let time = grid.problem.step_time(point);
                let at = |point: usize, node: &Configuration| grid.positions[point][node.position];
                let is_edge = |(old, _): &&(Configuration, f64)| {
                    let change = redundancy.beta(node.beta) - redundancy.beta(old.beta);
                    if let Some(limit) = redundancy.max_spindle_turn {
                        // In the cell, by matrices.
                        let frame = |point: usize, of: &Configuration| {
                            let problem = &problems[of.position];
                            let flange = problem.at(placement).base_from_flange(point, redundancy.beta(of.beta));
                            carried(&problem.external_axes, problem.axis_positions(point), Carried::Robot)
                                .then(&flange)
                                .rotation
                        };
                        let [from, to] = [frame(point - 1, old), frame(point, node)];
                        let turned = rotation_vector(&(from.transpose() * to)).norm();
                        if turned > limit * grid.problem.step_length(point) + 1e-9 {
                            return false;
                        }
                    }
                    let is_allowed = redundancy
                        .max_beta_rate
                        .is_none_or(|rate| wrap(change).abs() <= rate * grid.problem.step_length(point) + 1e-9);
                    let speed = (at(point, node) - at(point - 1, old)).abs() / time;
                    is_allowed
                        && speed <= axis.max_speed.unwrap() * (1.0 + 1e-9)
                        && joint_steps_hold(
                            &grid.problem.robot,
                            &old.joints,
                            &node.joints,
                            &grid.problem.joint_steps(point),
                        )
                };
                let least = before.iter().filter(is_edge).map(|old| old.1).fold(f64::INFINITY, f64::min);
                *cost = least + node.score;
            }
            layer.retain(|(_, cost)| cost.is_finite());
            before = layer;
        }
        before.iter().map(|(_, cost)| *cost).reduce(f64::min)
    };
    Posture::ALL.into_iter().filter_map(of).reduce(f64::min)
}

/// A short path with an axis, drawn from a seed.
fn drawn(seed: u64) -> (Problem, Placement, Vec<Vec<f64>>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // Forces that turn from point to point make another position of the axis the best one at each.
    let mut problem = slanted();
    let first = random.random_range(0..15);
    let points = problem.task.points()[first..first + 5].iter().map(|point| (1, *point)).collect::<Vec<_>>();
    let wrenches = problem.task.wrenches().skip(first).take(5).copied().collect();
    problem.task = Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap();
    problem.redundancy.beta_count = 24;
    problem.redundancy.max_beta_rate = Some(random.random_range(0.8..4.0_f64).to_radians() * 1e3);
    let mut joints: [Joint; 6] = problem.robot.joints().clone();
    joints.iter_mut().for_each(|joint| joint.max_speed = Some(random.random_range(0.3..3.0)));
    problem.robot = Robot::new("slow", joints).unwrap();
    let is_rail = random.random_range(0..2) == 0;
    let width = if is_rail { 0.3 } else { 0.6 };
    let grid: Vec<f64> = (0..4).map(|k| width * (f64::from(k) / 3.0 - 0.5)).collect();
    let step_time = problem.step_time(1);
    problem.external_axes = vec![ExternalAxis {
        name: "axis".to_owned(),
        kind: if is_rail { AxisKind::Rail } else { AxisKind::Turntable },
        carries: if random.random_range(0..2) == 0 { Carried::Robot } else { Carried::Workpiece },
        direction: Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)).normalize(),
        point: Vector3::new(0.0, -1.9, -0.4),
        min: grid[0],
        max: grid[3],
        max_speed: Some(random.random_range(0.5..2.5) * width / 3.0 / step_time),
        axis_use: AxisUse::Continuous,
    }];
    problem.setup = Setup::at_rest(&problem.external_axes);
    let placement = Placement {
        x: random.random_range(-0.3..0.3),
        y: random.random_range(-2.1..-1.64),
        z: random.random_range(-0.6..-0.2),
        yaw: random.random_range(-3.0..3.0),
    };
    (problem, placement, vec![grid; 5])
}

#[test]
fn equal_to_the_reference_beside_a_limit_on_the_turn_of_the_spindle() {
    // Whether there is a way, and whether the part that turns changes what beta has to do.
    let of_seed = |seed| {
        let (mut problem, placement, positions) = drawn(seed);
        let step_time = problem.step_time(1);
        let axis = &mut problem.external_axes[0];
        (axis.kind, axis.direction) = (AxisKind::Turntable, Vector3::z() * if seed % 4 < 2 { 1.0 } else { -1.0 });
        axis.max_speed = Some(2.2 * (axis.max - axis.min) / 3.0 / step_time);
        // Less than a step of the grid of beta: against a part that stands still beta cannot change.
        let limit = Some(1.2_f64.to_radians() * 1e3);
        (problem.redundancy.max_beta_rate, problem.redundancy.max_spindle_turn) = (None, limit);
        assert!(!problem.turns_part_otherwise());
        let found = AxisGrid { problem: &problem, axis: 0, positions: positions.clone() }.paths(&placement);
        let grid = AxisGrid { problem: &problem, axis: 0, positions };
        let expected = plain(&grid, &placement, &(0..5));
        let cost = found.as_ref().map(|found| found[0].cost);
        assert_eq!(cost.is_some(), expected.is_some(), "{seed}: {found:?} {expected:?}");
        let (Some(cost), Some(expected)) = (cost, expected) else { return [false; 2] };
        assert!((cost - expected).abs() <= 1e-12 * expected, "{seed}: {cost} {expected}");
        let mut still = problem.clone();
        (still.redundancy.max_beta_rate, still.redundancy.max_spindle_turn) = (limit, None);
        let other = AxisGrid { problem: &still, ..grid }.paths(&placement).map(|found| found[0].cost);
        [true, other.is_none_or(|other| (other - cost).abs() > 1e-9 * cost)]
    };
    let all = tried(60);
    let found: Vec<[bool; 2]> = (0..all as u64).into_par_iter().map(of_seed).collect();
    let [feasible, bound] = [0, 1].map(|k| found.iter().filter(|found| found[k]).count());
    assert!(feasible > all / 3 && bound > 0, "{feasible} {bound}");
}

#[test]
fn equal_to_the_reference_on_fifty_small_problems() {
    let (mut feasible, mut moving) = (0, 0);
    let all = tried(100).min(50);
    for seed in 0..all as u64 {
        let (problem, placement, positions) = drawn(seed);
        let grid = AxisGrid { problem: &problem, axis: 0, positions };
        let found = grid.paths(&placement);
        let expected = plain(&grid, &placement, &(0..5));
        match (&found, expected) {
            (None, None) => {}
            (Some(found), Some(expected)) => {
                assert!((found[0].cost - expected).abs() <= 1e-12 * expected, "{seed}: {found:?} {expected}");
                feasible += 1;
                moving += usize::from(found[0].positions.windows(2).any(|pair| pair[0] != pair[1]));
            }
            _ => panic!("{seed}: {found:?} {expected:?}"),
        }
    }
    assert!(feasible > all * 2 / 5 && moving > all / 10, "{feasible} {moving}");
}

/// Joint angles modulo a turn allow no less; where the turns decide nothing, the ways cost the same.
#[test]
fn the_planner_of_motions_leads_one_axis_as_cheaply() {
    let of_seed = |seed| {
        let (problem, placement, positions) = drawn(seed);
        let own = AxisGrid { problem: &problem, axis: 0, positions: positions.clone() }.paths(&placement);
        let grid = MotionGrid::product(&problem, None, &[(0, positions[0].clone())]);
        let problems = grid.problems();
        let motion = MotionPlanner::new(&grid, &problems).path(&placement);
        let own = own.map_or(f64::INFINITY, |paths| problem.objective(paths.iter().map(|path| path.cost)));
        let motion = motion.map_or(f64::INFINITY, |motion| motion.objective);
        assert!(motion <= own * (1.0 + 1e-9), "{seed}: {motion} {own}");
        [own.is_finite(), own.is_finite() && motion >= own * (1.0 - 1e-9)]
    };
    let found: Vec<[bool; 2]> = (0..50).into_par_iter().map(of_seed).collect();
    let [feasible, equal] = [0, 1].map(|k| found.iter().filter(|found| found[k]).count());
    assert!(feasible > 20 && 10 * equal >= 9 * feasible, "{feasible} {equal}");
}
