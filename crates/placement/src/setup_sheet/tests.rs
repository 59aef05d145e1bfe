use super::tolerance::tolerances;
use super::*;
use crate::place::score;
use crate::refine::planned;
use nalgebra::Matrix3;
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_planning::redundancy::Planner;
use stead_planning::testing::five_segments;
use stead_planning::transfer::TransferSettings;

fn near_the_best() -> Placement {
    Placement::from([0.0, -1.64, -0.214, 1.3783])
}

fn sheet(problem: &Problem, monitor: &Monitor) -> SetupSheet {
    let found = score(problem, &near_the_best(), &TransferSettings::default(), &Monitor::silent()).unwrap();
    SetupSheet::new(problem, &found.cases().best, monitor)
}

/// A path of these places, all fed along x with the tool upright.
fn path_through(places: &[[f64; 3]]) -> Problem {
    let point = |place: &[f64; 3]| PathPoint { position: (*place).into(), feed: Vector3::x(), axis: Vector3::z() };
    let path = ToolPath::new(places.iter().map(|place| (1, point(place)))).unwrap();
    let wrenches = vec![Wrench { force: Vector3::x(), moment: Vector3::zeros() }; places.len()];
    five_segments().with(|parts| parts.task = Task::new(path, wrenches).unwrap())
}

/// At every offset that is stated a plan as fine as those of results keeps the rise, and a quarter farther it does not.
#[test]
fn stated_offsets_keep_the_rise_and_those_a_quarter_farther_do_not() {
    let problem = five_segments();
    let found = sheet(&problem, &Monitor::silent()).tolerances.unwrap();
    let planner = Planner::finer(&problem);
    let placed = near_the_best();
    let objective = |placement: &Placement| {
        planned(&planner, placement, None, &mut planner.workspace()).map_or(f64::INFINITY, |found| found.objective)
    };
    let here = objective(&placed);
    assert!((found.nominal / here - 1.0).abs() < 1e-3, "{} {here}", found.nominal);
    assert_eq!((found.directions.len(), found.points), (8, [105, 105]));
    let mut met = 0;
    for of in &found.directions {
        let off = |offset: f64| {
            let mut placement = placed;
            placement[of.direction.axis] += if of.direction.is_negative { -offset } else { offset };
            objective(&placement) / here - 1.0
        };
        for (allowed, rise) in of.rises.iter().zip(RISES) {
            assert!(off(allowed.offset) < rise + 1e-3, "{}: {}", of.direction, allowed.offset);
            if !allowed.is_more {
                met += 1;
                // Other postures may do better than those of the plan, hence the half.
                assert!(off(1.25 * allowed.offset) > 0.5 * rise, "{}: {}", of.direction, allowed.offset);
            }
        }
        assert!(of.rises[0].offset <= of.rises[1].offset);
    }
    assert!(met >= 6, "{met}");
}

#[test]
fn the_limit_that_is_met_first_is_named() {
    let placement = near_the_best();
    // The nearest point of the path may come nearer to axis 1 by 3 mm.
    let free = five_segments();
    let nearest = |problem: &Problem| {
        let distance = |point| problem.base_distance(&problem.placed(point, &placement).tip);
        (0..problem.task.points().len()).map(distance).fold(f64::INFINITY, f64::min)
    };
    let least = nearest(&free) - 3e-3;
    let problem = free.with(|parts| parts.constraints.min_base_distance = least);
    let plan = score(&problem, &placement, &TransferSettings::default(), &Monitor::silent()).unwrap().plans.best;
    let scheme = (&plan.postures[..], plan.objective);
    let found = tolerances(&problem, &placement, scheme, Matrix3::identity(), &Monitor::silent()).unwrap();
    // Towards the robot.
    let of = &found.directions[2];
    assert_eq!(of.direction.to_string(), "+y");
    let blocked = of.blocked.as_ref().unwrap();
    assert_eq!(blocked.by, "distance of the path from axis 1");
    assert!(blocked.offset < 6e-3 && of.rises[1].offset < 3.2e-3 && !of.rises[1].is_more, "{of:?}");
}

#[test]
fn a_stop_leaves_the_tolerances_out_and_says_so() {
    let monitor = Monitor::silent();
    monitor.stop_handle().stop();
    assert_eq!(sheet(&five_segments(), &monitor).tolerances.unwrap_err(), "interrupted");
}

#[test]
fn the_root_of_the_controller_is_the_frame_where_it_is_known() {
    let base = sheet(&five_segments(), &Monitor::silent());
    assert_eq!((base.frame, base.is_root, base.robot), (SheetFrame::Base, false, Pose::identity()));
    assert_eq!(<[f64; 3]>::from(base.part.translation), [0.0, -1.64, -0.214]);
    assert!(base.check_points.iter().all(|check| check.controller.is_none() && check.in_root.is_none()));
}

#[test]
fn check_points_are_far_from_each_other_and_two_on_a_line() {
    let square = path_through(&[[0.1, 0.0, 0.0], [0.0, 0.0, 0.0], [0.9, 0.1, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    let chosen = spread(&square);
    assert_eq!(chosen, [1, 3, 4]);
    assert_eq!(spread(&path_through(&[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]])).len(), 2);
    assert_eq!(spread(&path_through(&[[0.0, 0.0, 0.0]])), [0]);
}

#[test]
fn the_nearest_limit_is_that_of_the_arm_and_not_of_the_margin() {
    let problem = five_segments();
    let near = sheet(&problem, &Monitor::silent()).nearest_limit.unwrap();
    let plan = score(&problem, &near_the_best(), &TransferSettings::default(), &Monitor::silent()).unwrap().plans.best;
    let row = &problem.robot.joints()[near.joint.unwrap()];
    let angle = plan.points[near.point].joints[near.joint.unwrap()];
    let distance = if near.is_upper { row.max - angle } else { angle - row.min };
    assert!((distance - near.distance).abs() < 1e-12 && near.distance > 0.0, "{near:?}");
}
