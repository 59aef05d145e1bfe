use super::*;
use crate::place::score;
use stead_model::robot::Robot;
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_problem::settings::TransferSettings;
use stead_problem::testing::five_segments;

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

/// At every offset that is stated the program keeps the rise, and a quarter farther it does not.
#[test]
fn stated_offsets_keep_the_rise_and_those_a_quarter_farther_do_not() {
    let problem = five_segments();
    let scored = score(&problem, &near_the_best(), &TransferSettings::default(), &Monitor::silent()).unwrap();
    let case = &scored.cases().best;
    let found = SetupSheet::new(&problem, case, &Monitor::silent()).tolerances.unwrap();
    let placed = near_the_best();
    // The same free angles and postures, with the part elsewhere.
    let objective = |placement: &Placement| {
        let score = |of: &crate::outcome::PlanPoint| {
            problem.at(placement).state(of.point, of.beta, of.posture).map_or(f64::INFINITY, |state| state.score())
        };
        case.plan.points.iter().map(score).sum::<f64>() / case.plan.points.len() as f64
    };
    let here = objective(&placed);
    assert!((found.nominal / here - 1.0).abs() < 1e-9 && (found.nominal / case.plan.objective - 1.0).abs() < 1e-6);
    assert_eq!((found.directions.len(), found.points), (8, [105, 105]));
    let mut met = 0;
    for of in &found.directions {
        let off = |offset: f64| {
            let mut placement = placed;
            placement[of.direction.axis] += if of.direction.is_negative { -offset } else { offset };
            objective(&placement) / here - 1.0
        };
        for (allowed, rise) in of.rises.iter().zip(RISES) {
            assert!(off(allowed.offset) <= rise + 1e-9, "{}: {}", of.direction, allowed.offset);
            let is_stopped = of.blocked.as_ref().is_some_and(|blocked| blocked.offset <= 1.25 * allowed.offset + 1e-4);
            if !allowed.is_more && !is_stopped {
                met += 1;
                assert!(off(1.25 * allowed.offset + 1e-4) > rise, "{}: {}", of.direction, allowed.offset);
            }
        }
        assert!(of.rises[0].offset <= of.rises[1].offset);
    }
    assert!(met >= 4, "{met}");
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
    let found = sheet(&problem, &Monitor::silent()).tolerances.unwrap();
    // Towards the robot.
    let of = &found.directions[2];
    assert_eq!(of.direction.to_string(), "+y");
    let blocked = of.blocked.as_ref().unwrap();
    assert!(blocked.by.starts_with("distance of the path from axis 1 at point "), "{}", blocked.by);
    assert!(blocked.offset < 6e-3 && of.rises[1].offset < 3.2e-3 && !of.rises[1].is_more, "{of:?}");
}

#[test]
fn what_the_arm_cannot_do_with_the_part_elsewhere_is_found_by_its_own_limits() {
    // The arm may turn joint 5 by a hundredth of a degree beyond what the plan needs, in either direction.
    let problem = five_segments();
    let scored = score(&problem, &near_the_best(), &TransferSettings::default(), &Monitor::silent()).unwrap();
    let angles = scored.plans.best.points.iter().map(|of| of.joints[1]);
    let [least, most] = [angles.clone().fold(f64::INFINITY, f64::min), angles.fold(f64::NEG_INFINITY, f64::max)];
    let room = 1e-2_f64.to_radians();
    let case = scored.cases().best;
    let narrow = |margin: f64| {
        let mut joints = problem.robot.joints().clone();
        (joints[1].min, joints[1].max) = (least - margin, most + margin);
        let narrowed = Robot::new("narrow", joints).unwrap();
        problem.clone().with(|parts| parts.robot = narrowed)
    };
    let found = SetupSheet::new(&narrow(room), &case, &Monitor::silent()).tolerances.unwrap();
    let is_beyond = |of: &Tolerance, offset: f64| {
        let mut placement = near_the_best();
        placement[of.direction.axis] += if of.direction.is_negative { -offset } else { offset };
        case.plan.points.iter().any(|of| {
            let state = problem.at(&placement).state(of.point, of.beta, of.posture).unwrap();
            !(least - room - 1e-9..=most + room + 1e-9).contains(&state.joints[1])
        })
    };
    let mut met = 0;
    for of in found.directions.iter().filter(|of| !of.direction.is_turn()) {
        assert!(!is_beyond(of, of.rises[1].offset), "{}", of.direction);
        let Some(blocked) = of.blocked.as_ref().filter(|blocked| blocked.by.starts_with("limits of joint 2 ")) else {
            continue;
        };
        met += 1;
        assert!(is_beyond(of, blocked.offset), "{}: {blocked:?}", of.direction);
    }
    assert!(met >= 4, "{met}");
    // A plan that does not keep its own limits has no tolerances, and says why.
    let why = SetupSheet::new(&narrow(-room), &case, &Monitor::silent()).tolerances.unwrap_err();
    assert!(why.starts_with("the plan itself does not keep "), "{why}");
}

#[test]
fn places_on_the_flange_are_from_the_mounting_flange() {
    let problem = five_segments();
    let beyond = problem.clone().with(|parts| parts.robot = parts.robot.clone().with_flange(0.23));
    let [here, there] = [&problem, &beyond].map(|of| sheet(of, &Monitor::silent()));
    let expected = here.flange_from_tool.translation - Vector3::z() * 0.23;
    assert_eq!(there.flange_from_tool, Pose { translation: expected, ..here.flange_from_tool });
    // All else is the same.
    assert_eq!(SetupSheet { flange_from_tool: here.flange_from_tool, ..there }, here);
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
