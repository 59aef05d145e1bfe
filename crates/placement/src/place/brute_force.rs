//! Every criterion against a search of all placements of a coarse grid: three arms, two paths.

use super::*;
use nalgebra::Vector3;
use stead_model::robot::Robot;
use stead_model::robot::testing::robot_from;
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_model::testing::{is_all, some};
use stead_problem::criterion::{Aggregate, Direction};
use stead_problem::problem::{Interval, Placement};
use stead_problem::testing::five_segments;

/// Three arms: that of the paper, a smaller one with other springs, and one with a lateral offset at the elbow.
fn arms() -> [Robot; 3] {
    let smaller = robot_from([
        (0.0, 0.0, 0.0, -170.0, 170.0, 1.2),
        (90.0, 0.26, 0.0, -5.0, 140.0, 1.6),
        (0.0, 1.05, 0.0, -230.0, 40.0, 1.1),
        (-90.0, 0.04, 0.95, -300.0, 300.0, 0.12),
        (90.0, 0.0, 0.0, -120.0, 120.0, 0.15),
        (-90.0, 0.0, 0.0, -350.0, 350.0, 0.1),
    ]);
    let offset = robot_from([
        (0.0, 0.0, 0.0, -185.0, 185.0, 0.6),
        (90.0, 0.35, 0.0, 0.0, 146.0, 2.0),
        (0.0, 1.25, 0.05, -245.0, 29.0, 2.0),
        (-90.0, 0.055, 1.1, -350.0, 350.0, 0.4),
        (90.0, 0.0, 0.0, -125.0, 125.0, 0.5),
        (-90.0, 0.0, 0.0, -350.0, 350.0, 0.3),
    ]);
    [five_segments().robot.clone(), smaller, offset]
}

/// A straight cut and a quarter of a circle with the tool tilted along the cut, each with the normal of its floor.
fn paths() -> [Task; 2] {
    let force =
        |feed: Vector3<f64>| Wrench { force: feed * -90.0 + Vector3::new(30.0, 10.0, 60.0), moment: Vector3::zeros() };
    let task = |points: Vec<(u32, PathPoint)>| {
        let wrenches = points.iter().map(|(_, point)| force(point.feed)).collect();
        let normals = points.iter().map(|(_, point)| point.axis).collect();
        Task::new(ToolPath::new(points).unwrap().with_surface_normals(normals).unwrap(), wrenches).unwrap()
    };
    let straight = (0..8).map(|k| {
        let position = Vector3::new(0.02 * f64::from(k), 0.03, 0.0);
        (1, PathPoint { position, feed: Vector3::x(), axis: Vector3::z() })
    });
    let bent = (0..8).map(|k| {
        let (s, c) = libm::sincos(0.2 * f64::from(k));
        let tilt = 0.04 * f64::from(k);
        let (position, feed) = (Vector3::new(0.15 * s, -0.15 * c, 0.02), Vector3::new(c, s, 0.0));
        (
            if k < 4 { 1 } else { 2 },
            PathPoint {
                position,
                feed,
                axis: Vector3::z() * libm::cos(tilt) + feed.cross(&Vector3::z()) * libm::sin(tilt),
            },
        )
    });
    [task(straight.collect()), task(bent.collect())]
}

/// Objectives below this are balanced to nothing. m
const FLAT: f64 = 1e-6;

#[test]
fn no_placement_of_a_grid_is_better_than_the_best_or_worse_than_the_worst() {
    let transfer = TransferSettings::default();
    let silent = Monitor::silent();
    let settings = SearchSettings { population: 24, generations: 10, basins: 2, ..SearchSettings::default() };
    let mut compared = 0;
    for (arm, robot) in arms().into_iter().enumerate() {
        for (path, task) in paths().into_iter().enumerate() {
            let mut problem = five_segments();
            (problem.robot, problem.task) = (robot.clone(), task);
            problem.redundancy.beta_count = 24;
            problem = stead_problem::testing::with_beta_rate(problem, 2.0);
            problem.cell.position =
                [(-0.15, 0.15), (-1.75, -1.45), (-0.3, 0.0)].map(|(min, max)| Interval { min, max });
            problem.cell.yaw = Interval { min: 0.0, max: 1.2 };
            // Every direction and every aggregate with every arm and path would take minutes: each pair in turn.
            let all = Direction::ALL.into_iter().enumerate();
            for (k, direction) in some(3, all.skip(if is_all() { 0 } else { path })) {
                problem.criterion.weights = direction.weights();
                problem.criterion.aggregate = [Aggregate::Mean, Aggregate::Rms, Aggregate::Max][(k + arm + path) % 3];
                let Ok(outcome) = place(&problem, &settings, &transfer, &silent) else { continue };
                let optima = outcome.cases.optima();
                let [best, worst] = [0, 1].map(|k| optima[k].plan.objective);
                for cell in 0..81 {
                    let share = |axis: u32| f64::from(cell / 3_i32.pow(axis) % 3) / 2.0;
                    let [x, y, z] = problem.cell.position;
                    let at = |bounds: Interval, axis: u32| bounds.min + share(axis) * bounds.width();
                    let placement = Placement { x: at(x, 0), y: at(y, 1), z: at(z, 2), yaw: at(problem.cell.yaw, 3) };
                    let Ok(scored) = score(&problem, &placement, &transfer, &silent) else { continue };
                    compared += 1;
                    let found = scored.plans.best.objective;
                    let name = format!("{arm} {path} {direction:?} {:?}", problem.criterion.aggregate);
                    assert!(found > best * (1.0 - 1e-3) - 1e-9, "{name}: {found} below {best} at {placement:?}");
                    // Where plans can balance the scored part to nothing, the worst placement is a spike in a flat
                    // landscape.
                    assert!(found < worst * (1.0 + 2e-2) + FLAT, "{name}: {found} above {worst} at {placement:?}");
                }
            }
        }
    }
    assert!(compared > if is_all() { 500 } else { 125 }, "{compared}");
}
