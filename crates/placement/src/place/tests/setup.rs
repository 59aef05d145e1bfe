//! What a mount, an axis or an orientation does is known from a problem without one.

use super::with_first_springs;
use crate::outcome::Case;
use crate::place::{Score, place, score, setup_at};
use crate::sensitivity::mean_by;
use nalgebra::{Vector3, vector};
use rayon::prelude::*;
use std::sync::Arc;
use stead_cell::Attachment;
use stead_cell::testing::{kr270_shapes, scene_of};
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_model::robot::{Joint, Pose, Robot};
use stead_model::task::lean::{ContactRule, CutterEnd, Lean, LeanForce, LeanRule};
use stead_model::testing::is_all;
use stead_numerics::monitor::Monitor;
use stead_numerics::rotation::rotation_from_zyx;
use stead_problem::cell::Cell;
use stead_problem::criterion::Over;
use stead_problem::lean::{LeanRange, LeanSpace};
use stead_problem::problem::{Interval, Placement, Problem};
use stead_problem::settings::TransferSettings;
use stead_problem::settings::{LookupUse, SearchSettings};
use stead_problem::setup::{AxisPositions, Orientation, Setup};
use stead_problem::symmetry::{Unsupported, Upright};
use stead_problem::testing::{five_segments, slanted};

fn scored(problem: &Problem, placement: &Placement) -> Score {
    score(problem, placement, &TransferSettings::default(), &Monitor::silent()).unwrap()
}

/// Objectives and joint angles of both plans agree.
fn assert_same(a: &Score, b: &Score) {
    for (a, b) in [(&a.plans.best, &b.plans.best), (&a.plans.worst, &b.plans.worst)] {
        assert!((a.objective / b.objective - 1.0).abs() < 1e-9, "{} {}", a.objective, b.objective);
        for (a, b) in a.points.iter().zip(&b.points) {
            let off = a.joints.iter().zip(b.joints).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-7 && (a.score - b.score).abs() < 1e-9 * a.score.max(1e-6), "{a:?} {b:?}");
        }
    }
}

fn rail(carries: Carried, direction: Vector3<f64>, [min, max]: [f64; 2], axis_use: AxisUse) -> ExternalAxis {
    let (name, kind, point) = ("rail".to_owned(), AxisKind::Rail, Vector3::zeros());
    ExternalAxis { name, kind, carries, direction, point, min, max, max_speed: Some(0.5), axis_use }
}

const AT: Placement = Placement { x: 0.0, y: -1.8, z: -0.5, yaw: 0.0 };

#[test]
fn on_a_wall_with_task_and_cell_turned_with_it_the_robot_does_the_same() {
    for angles in [[0.0, 0.0, 90.0], [20.0, -70.0, 150.0]] {
        let mount =
            Pose { rotation: rotation_from_zyx(angles.map(f64::to_radians)), translation: vector![0.4, -0.2, 1.7] };
        let mut floor = slanted();
        floor.constraints.min_base_distance = 0.3;
        let mut wall = floor.clone();
        wall.robot = wall.robot.clone().mounted(&mount);
        wall.task = wall.task.turned(&mount.rotation);
        let [x, y, z] = mount.point(&vector![AT.x, AT.y, AT.z]).into();
        let on_the_wall = Placement { x, y, z, yaw: 0.0 };
        assert_same(&scored(&floor, &AT), &scored(&wall, &on_the_wall));
        assert!(matches!(Upright::of(&wall), Err(Unsupported::BaseNotVertical { .. })));
    }
    // Under the ceiling axis 1 is vertical still.
    let mut ceiling = five_segments();
    let upside_down = rotation_from_zyx([0.3, 0.0, std::f64::consts::PI]);
    ceiling.robot = ceiling.robot.clone().mounted(&Pose { rotation: upside_down, translation: vector![0.0, 0.0, 2.0] });
    assert_eq!(Upright::of(&ceiling).unwrap(), Upright { side: -1.0, rotation_sign: -1.0 });
}

#[test]
fn a_pedestal_is_a_cell_that_is_lower() {
    let problem = five_segments();
    let mut raised = problem.clone();
    raised.robot = raised.robot.clone().mounted(&Pose { translation: vector![0.1, 0.2, 0.5], ..Pose::identity() });
    for (bounds, by) in raised.cell.position.iter_mut().zip([0.1, 0.2, 0.5]) {
        (bounds.min, bounds.max) = (bounds.min + by, bounds.max + by);
    }
    let settings = SearchSettings { population: 12, generations: 2, basins: 1, ..SearchSettings::default() };
    let found = [&problem, &raised].map(|problem| {
        let outcome = place(problem, &settings, &TransferSettings::default(), &Monitor::silent()).unwrap();
        assert!(matches!(outcome.lookup_summary, Some(Ok(_))));
        outcome.cases.best
    });
    let [a, b] = found.each_ref().map(|case| case.plan.objective);
    assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
    assert!((found[1].placement.z - found[0].placement.z - 0.5).abs() < 0.05);
}

#[test]
fn a_turntable_that_turns_by_the_yaw_gives_what_the_yaw_gives() {
    let point = vector![0.05, -1.75, 0.3];
    for (position, carries) in [(0.7, Carried::Workpiece), (-1.9, Carried::Robot)] {
        let mut turned = five_segments();
        turned.external_axes = vec![ExternalAxis {
            kind: AxisKind::Turntable,
            point,
            max_speed: None,
            ..rail(carries, Vector3::z(), [-3.0, 3.0], AxisUse::Fixed)
        }];
        turned.setup.positions = AxisPositions::Same(vec![position]);
        let yaw = if carries == Carried::Workpiece { position } else { -position };
        let (s, c) = libm::sincos(yaw);
        let away = vector![AT.x - point.x, AT.y - point.y];
        let x = point.x + c * away.x - s * away.y;
        let y = point.y + s * away.x + c * away.y;
        let expected = Placement { x, y, yaw, ..AT };
        assert_same(&scored(&turned, &AT), &scored(&five_segments(), &expected));
    }
}

#[test]
fn a_rail_under_the_robot_moves_the_workpiece_the_other_way() {
    let direction = vector![0.6, 0.0, 0.8];
    let mut problem = five_segments();
    problem.external_axes = vec![rail(Carried::Robot, direction, [-1.0, 1.0], AxisUse::Fixed)];
    problem.setup.positions = AxisPositions::PerSegment((0..5).map(|_| vec![0.1]).collect());
    let expected = Placement { x: AT.x - 0.06, z: AT.z - 0.08, ..AT };
    assert_same(&scored(&problem, &AT), &scored(&five_segments(), &expected));
}

fn small() -> SearchSettings {
    SearchSettings { population: 8, generations: 1, basins: 1, ..SearchSettings::default() }
}

#[test]
fn a_rail_of_zero_length_changes_no_bit() {
    let problem = five_segments();
    let mut railed = problem.clone();
    railed.external_axes = vec![rail(Carried::Robot, Vector3::x(), [0.0, 0.0], AxisUse::Continuous)];
    railed.setup = Setup::at_rest(&railed.external_axes);
    let [plain, with] = [&problem, &railed]
        .map(|problem| place(problem, &small(), &TransferSettings::default(), &Monitor::silent()).unwrap());
    for (a, b) in plain.cases.all().into_iter().zip(with.cases.all()) {
        assert_eq!(b.plan.axes[0].positions, vec![0.0; 105]);
        let mut without = b.clone();
        without.plan.axes.clear();
        without.setup = Setup::default();
        assert_eq!(*a, Case { ..without });
    }
    assert_eq!(plain.refinements, with.refinements);
}

#[test]
fn the_best_orientation_is_taken_and_named() {
    let mut problem = five_segments();
    let task = Arc::new(problem.task.clone());
    let lying = |name: &str, angles: [f64; 3]| {
        let rotation = rotation_from_zyx(angles.map(f64::to_radians));
        Orientation { name: name.to_owned(), rotation, task: Arc::new(task.turned(&rotation)) }
    };
    // With the yaw held, the part turned by a right angle is another problem.
    problem.cell.yaw = stead_problem::problem::Interval { min: 0.0, max: 0.0 };
    problem.orientations = [lying("as drawn", [0.0; 3]), lying("on its side", [90.0, 0.0, 0.0])].into();
    let outcome = place(&problem, &small(), &TransferSettings::default(), &Monitor::silent()).unwrap();
    let alone = [0, 1].map(|orientation| {
        let setup = Setup { orientation, ..problem.setup.clone() };
        let mut one = problem.in_setup(&setup).into_owned();
        one.orientations = [].into();
        one.setup = Setup::default();
        place(&one, &small(), &TransferSettings::default(), &Monitor::silent()).unwrap().cases
    });
    let best = alone.each_ref().map(|cases| cases.best.plan.objective);
    let chosen = usize::from(best[1] < best[0]);
    let found = &outcome.cases.best;
    assert_eq!(found.setup.orientation, chosen);
    assert_eq!(found.orientation.as_deref(), Some(["as drawn", "on its side"][chosen]));
    assert_eq!(found.plan.objective, best[chosen]);
    let worst = alone.each_ref().map(|cases| cases.optima()[1].plan.objective);
    assert_eq!(outcome.cases.optima()[1].plan.objective, worst[0].max(worst[1]));
    assert_eq!(outcome.tried_setups.len(), 2);
    // The part itself lies where the turned task is.
    let set_up = problem.in_setup(&found.setup);
    let part = set_up.base_from_part(7, &found.placement).point(&task.points()[7].position);
    assert!((part - found.plan.points[7].position).norm() < 1e-12);
}

/// The five segments with joint speeds, which bind an axis that moves along the path.
fn with_speeds() -> Problem {
    let mut problem = five_segments();
    let mut joints: [Joint; 6] = problem.robot.joints().clone();
    joints.iter_mut().for_each(|joint| joint.max_speed = Some(1.8));
    problem.robot = Robot::new("speeds", joints).unwrap();
    problem.redundancy.beta_count = 60;
    problem
}

#[test]
fn a_richer_use_is_never_worse_and_keeps_to_speed_and_range() {
    let problem = with_speeds();
    let monitor = Monitor::silent();
    let [fixed, indexed, continuous] = [AxisUse::Fixed, AxisUse::Indexed, AxisUse::Continuous].map(|axis_use| {
        let mut problem = problem.clone();
        problem.external_axes = vec![rail(Carried::Workpiece, vector![0.0, 1.0, 0.0], [-0.3, 0.6], axis_use)];
        problem.setup = Setup::at_rest(&problem.external_axes);
        let setup = setup_at(&problem, &AT, &monitor);
        let found = scored(&problem.in_setup(&setup), &AT);
        let positions = &found.plans.best.axes[0].positions;
        assert!(positions.iter().all(|at| (-0.3..=0.6).contains(at)), "{positions:?}");
        for span in problem.task.segments() {
            for point in span.clone().skip(1) {
                let step = (positions[point] - positions[point - 1]).abs();
                assert!(step <= 0.5 * problem.step_time(point) * (1.0 + 1e-6), "{point}: {step}");
            }
        }
        (found.plans.best.objective, found)
    });
    let at_rest = scored(&problem, &AT).plans.best.objective;
    assert!(fixed.0 < at_rest * 0.999, "{} {at_rest}", fixed.0);
    assert!(indexed.0 < fixed.0 * (1.0 - 1e-6), "{} {}", indexed.0, fixed.0);
    assert!(continuous.0 < indexed.0 * (1.0 - 1e-6), "{} {}", continuous.0, indexed.0);
    // Between segments the indexed axis moves, which takes its time: 0.5 m/s at the most.
    let positions = &indexed.1.plans.best.axes[0].positions;
    let moves =
        problem.task.segments().windows(2).map(|pair| (positions[pair[1].start] - positions[pair[0].end - 1]).abs());
    let moves: Vec<f64> = moves.collect();
    assert!(moves.iter().any(|length| *length > 0.01), "{moves:?}");
    for (transfer, length) in indexed.1.cycles.best.transfers.iter().zip(moves) {
        assert!(transfer.duration.unwrap() >= length / 0.5, "{transfer:?} {length}");
    }
}

/// A rail that moves along the path changes the best placement after the search: all that is stated is of the plan at
/// the end.
#[test]
fn sets_force_errors_and_warnings_belong_to_the_plans_that_are_stated() {
    let mut problem = with_first_springs(&with_speeds(), &[1.0, 0.3], Over::Mean);
    problem.redundancy.beta_count = 24;
    problem.external_axes = vec![rail(Carried::Workpiece, Vector3::y(), [-0.1, 0.1], AxisUse::Continuous)];
    problem.setup = Setup::at_rest(&problem.external_axes);
    problem.cell.position = [0.0, -1.8, -0.5].map(|at| Interval { min: at - 0.05, max: at + 0.05 });
    problem.postures.tie = 0.01;
    let settings = SearchSettings { population: 4, sensitivity: Some(0.1), worst: false, ..small() };
    let outcome = place(&problem, &settings, &TransferSettings::default(), &Monitor::silent()).unwrap();
    let best = &outcome.cases.best;
    assert!(matches!(best.setup.positions, AxisPositions::PerPoint(_)), "the rail does not move");
    let sensitivity = outcome.sensitivity.as_ref().unwrap();
    assert_eq!(sensitivity.nominal[0], best.plan.objective);
    assert!(sensitivity.nominal[1] > sensitivity.nominal[0] && sensitivity.robust[1] <= sensitivity.nominal[1]);
    let set_up = problem.in_setup(&best.setup);
    let robots = &problem.criterion.stiffness.as_ref().unwrap().robots;
    for (set, robot) in outcome.sets.iter().zip(robots) {
        assert_eq!(set.mean, mean_by(&set_up.with_stiffness_alone(robot), &best.placement, &best.plan));
        assert!(set.regret().unwrap() > -0.011, "{set:?}");
    }
    assert_eq!(outcome.sets.len(), 2);
    assert_eq!(outcome.set_basins.len(), 1);
    assert!(
        outcome
            .notes
            .iter()
            .any(|note| String::from(note.clone()).contains("external axes where they stand in the best plan"))
    );
    for case in outcome.cases.all() {
        let is_named =
            outcome.warnings.iter().any(|warning| warning.message.contains(&format!("case {} to", case.number())));
        assert_eq!(is_named, !case.cycle.unfollowed.is_empty(), "case {}", case.number());
    }
}

/// A rail and a turntable that both move along the path, with a tool that may lean and without.
#[test]
fn axes_that_move_together_are_never_worse_than_one_alone() {
    let problem = with_speeds();
    let monitor = Monitor::silent();
    let turntable = |axis_use: AxisUse| ExternalAxis {
        name: "table".to_owned(),
        kind: AxisKind::Turntable,
        direction: Vector3::z(),
        point: vector![0.0, -1.9, 0.0],
        min: -0.5,
        max: 0.5,
        max_speed: Some(0.4),
        axis_use,
        ..rail(Carried::Workpiece, Vector3::x(), [0.0, 0.0], axis_use)
    };
    let set_up = |uses: [AxisUse; 2], is_leaning: bool| {
        let axes = vec![rail(Carried::Robot, vector![0.0, 1.0, 0.0], [-0.3, 0.3], uses[0]), turntable(uses[1])];
        let problem = problem.clone().with(|parts| {
            parts.setup = Setup::at_rest(&axes);
            parts.external_axes = axes;
            parts.lean = is_leaning.then(|| Arc::new(leaning(5.0)));
        });
        let setup = setup_at(&problem, &AT, &monitor);
        let found = scored(&problem.in_setup(&setup), &AT).plans.best;
        for (axis, path) in problem.external_axes.iter().zip(&found.axes) {
            for point in problem.task.segments().iter().flat_map(|span| span.clone().skip(1)) {
                let step = (path.positions[point] - path.positions[point - 1]).abs();
                let most = axis.max_speed.unwrap() * problem.step_time(point);
                assert!(step <= most * (1.0 + 1e-6), "{} {point}: {step} {most}", axis.name);
            }
        }
        (found.objective, setup)
    };
    let (moves, stays) = (AxisUse::Continuous, AxisUse::Fixed);
    let mut all = vec![([moves, moves], false), ([moves, stays], false), ([stays, moves], false)];
    all.extend(is_all().then_some(([moves, moves], true)));
    let found: Vec<_> = all.into_par_iter().map(|(uses, is_leaning)| set_up(uses, is_leaning)).collect();
    let [both, rail, table] = [0, 1, 2].map(|k| found[k].0);
    assert!(both < rail.min(table) * (1.0 - 1e-4), "{both} {rail} {table}");
    if let Some((leaning, setup)) = found.get(3) {
        let leaning = *leaning;
        assert!(leaning < both * (1.0 - 1e-3), "{leaning} {both}");
        assert!(setup.leans.iter().any(|lean| *lean != Lean::NONE));
    }
}

/// A ball cutter that leans by so many degrees to every side.
fn leaning(reach_deg: f64) -> LeanSpace {
    let reach = Interval { min: -reach_deg.to_radians(), max: reach_deg.to_radians() };
    LeanSpace {
        rule: LeanRule {
            end: CutterEnd { radius: 0.008, corner: 0.008 },
            contact: ContactRule::Centre,
            force: LeanForce::Feed,
        },
        ranges: vec![LeanRange { lead: reach, tilt: reach }; 105],
        max_lean: None,
        steps: [2.5_f64.to_radians(); 2],
        step_over: None,
        scallop: None,
        contact_tolerance: 5e-6,
    }
}

#[test]
fn axes_and_orientations_are_refused_by_the_table() {
    let mut problem = five_segments();
    problem.external_axes = vec![rail(Carried::Robot, Vector3::x(), [0.0, 1.0], AxisUse::Fixed)];
    problem.setup = Setup::at_rest(&problem.external_axes);
    assert_eq!(Upright::of(&problem), Err(Unsupported::ExternalAxes));
    // A rail that stands still only shifts the cell, so the search has its table.
    problem.cell = Cell {
        position: problem.cell.position.map(|mut b| {
            b.max = b.min + 0.1;
            b
        }),
        ..problem.cell
    };
    let settings = SearchSettings { tables: LookupUse::Auto, ..small() };
    problem.external_axes[0].max = 0.0;
    let outcome = place(&problem, &settings, &TransferSettings::default(), &Monitor::silent()).unwrap();
    assert!(matches!(outcome.lookup_summary, Some(Ok(_))));
}

#[test]
fn what_stands_in_the_cell_stays_there_when_a_rail_moves_the_robot() {
    let with_rail = |at: f64| {
        let mut problem = five_segments();
        problem.scene = Some(Arc::new(scene_of(kr270_shapes(), 0.02)));
        problem.external_axes = vec![rail(Carried::Robot, Vector3::x(), [at, at], AxisUse::Fixed)];
        problem.setup = Setup::at_rest(&problem.external_axes);
        problem
    };
    let problem = with_rail(0.5);
    let scene = problem.scene.as_deref().unwrap();
    let poses = problem.poses(scene, 0, &AT, &[0.0; 6]);
    assert_eq!(poses.of(Attachment::Base).translation, vector![-0.5, 0.0, 0.0]);
    // So the cell may not be shifted to where the robot sees it, which would leave the shapes behind.
    assert!(problem.without_shifting_axes().is_none());
    assert!(with_rail(0.0).without_shifting_axes().is_some());
    assert!(problem.clone().with(|parts| parts.scene = None).without_shifting_axes().is_some());
}
