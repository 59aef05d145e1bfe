//! The table against the reference evaluator and the planner, and with parts of the formula broken on purpose.

use super::*;
use crate::coordinate_search::{Directions, coordinate_search};
use crate::evaluator::Evaluator;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;
use stead_cell::testing::{kr270_shapes, scene_of, shape};
use stead_cell::{Attachment, Solid};
use stead_model::robot::{Joint, PostureClass, Robot};
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_numerics::monitor::Monitor;
use stead_planning::feasibility::explain;
use stead_planning::redundancy::Planner;
use stead_problem::candidate::Objective;
use stead_problem::candidate::rank;
use stead_problem::constraints::ConstraintKind;
use stead_problem::problem::{Interval, Placement, Redundancy};
use stead_problem::sense::Sense;
use stead_problem::table_shape::field;
use stead_problem::testing::{
    Beside, compensated, corners, five_segments, hanging, slanted, with_axes_2_3, with_beside, with_laws,
    with_turn_limits, with_uncertainty,
};

/// Errors in all directions counted.
fn robust() -> Problem {
    let mut problem = slanted();
    problem.criterion.force_uncertainty = 0.1;
    problem
}

/// Joint 1 cannot get all the way round, and turns with a compensator beside joint 2.
fn limited() -> Problem {
    let mut problem = with_laws(five_segments(), &[(1, compensated(0.2, 1e-6 / 3.32))]);
    let mut joints = problem.robot.joints().clone();
    (joints[0].min, joints[0].max) = (-1.75, 1.2);
    problem.robot = Robot::new("limited", joints).unwrap();
    problem
}

/// A force and a moment that differ at every point, in all directions.
fn twisted(problem: Problem) -> Problem {
    let wrenches = problem.task.wrenches().enumerate().map(|(k, wrench)| {
        let at = |phase: f64| libm::sin(0.37 * k as f64 + phase);
        let moment = Vector3::new(at(0.0), at(2.1), at(4.2)) * (0.4 * wrench.force.norm());
        Wrench { force: wrench.force * (1.0 + 0.3 * at(1.0)), moment }
    });
    let task = Task::new(problem.task.path().clone(), wrenches.collect()).unwrap();
    problem.with(|parts| parts.task = task)
}

/// What a table says of drawn states beside what the reference evaluator says: relative root mean square of the errors,
/// largest error, and share of disputes.
fn compared(table: &LookupTable<'_>, count: usize, draws: u64) -> Accuracy {
    let problem = table.problem();
    let redundancy = Redundancy { beta_count: count, ..problem.redundancy };
    let grid = BetaGrid::new(problem, count);
    let mut workspace = table.workspace(&grid);
    let mut random = ChaCha8Rng::seed_from_u64(99);
    let (mut states, mut disputed, mut squares, mut errors, mut largest) = (0, 0, 0.0, 0.0, 0.0_f64);
    for _ in 0..draws {
        let [x, y, z] = problem.cell.position;
        let placement: Placement =
            [x, y, z, problem.cell.yaw].map(|bounds| bounds.min + random.random::<f64>() * bounds.width()).into();
        let point = random.random_range(0..problem.task.points().len());
        let k = random.random_range(0..count);
        let all = explain(problem, &placement, point, redundancy.beta(k));
        for class in PostureClass::ALL {
            let mut scores = vec![f32::INFINITY; count];
            if let Some(polar) = table.polar_point(&table.place(&placement), point)
                && !table.interpolate(&polar, class.index(), &grid, &mut workspace.scratch, &mut scores)
            {
                scores.fill(f32::INFINITY);
            }
            let postures = class.postures().map(|posture| &all[usize::from(posture.number()) - 1]);
            let ordinary = postures.into_iter().find(|e| e.is_allowed()).and_then(|e| e.state.as_ref());
            match (ordinary.map(|s| s.score()), scores[k].is_finite()) {
                (None, false) => continue,
                (Some(score), true) => {
                    let error = f64::from(scores[k]) - score;
                    squares += score * score;
                    errors += error * error;
                    largest = largest.max(error.abs());
                }
                _ => disputed += 1,
            }
            states += 1;
        }
    }
    let mean = squares / f64::from(states);
    Accuracy {
        states: states as usize,
        rms: libm::sqrt(errors / squares),
        largest: largest / libm::sqrt(mean),
        disputed: f64::from(disputed) / f64::from(states),
    }
}

#[test]
fn errs_no_more_than_it_says() {
    for (name, problem) in [
        ("five segments", five_segments()),
        ("slanted", slanted()),
        ("robust", robust()),
        ("limited", limited()),
        ("linkage", with_axes_2_3(slanted(), true, [-150.0, -20.0])),
        ("hanging", hanging()),
        ("twisted", twisted(five_segments())),
        ("twisted and slanted", twisted(slanted())),
        ("twisted and limited", twisted(limited())),
        ("twisted and hanging", twisted(hanging())),
    ] {
        let table = LookupTable::new(&problem).unwrap();
        let stated = table.accuracy();
        assert!(stated.states > 200 && stated.rms < 2e-4 && stated.disputed < 0.02, "{name}: {stated:?}");
        // The grid of the headings, a finer one, one that shares little with it.
        for (count, draws) in [(120, 1500), (360, 500), (50, 500)] {
            let found = compared(&table, count, draws);
            assert!(found.states > 200, "{name} {count}: {found:?}");
            assert!(found.rms < 4.0 * stated.rms + 2e-6, "{name} {count}: {found:?} {stated:?}");
            assert!(found.largest < 8.0 * stated.largest + 1e-5, "{name} {count}: {found:?} {stated:?}");
            assert!(found.disputed < 0.02, "{name} {count}: {found:?}");
        }
    }
}

/// Pairs of springs everywhere on their axes, but for joint 5, off whose place the two flips of the wrist differ.
fn whole() -> Problem {
    let mut problem = with_beside(slanted(), Beside::Everything);
    let mut normal = *problem.robot.normal_springs().unwrap();
    normal[4].bearing = 0.0;
    problem.robot = problem.robot.clone().with_normal_springs(Some(normal)).unwrap();
    problem
}

#[test]
fn whatever_yields_is_in_the_table_or_added() {
    let with_errors = |mut problem: Problem| {
        problem.criterion.force_uncertainty = 0.1;
        problem
    };
    // A part that yields goes with the task: after its forces and moments.
    let twisted_whole = || {
        let mut problem = whole();
        let part = problem.task.clone();
        problem.task = twisted(slanted()).task.clone();
        let matrices = (0..105).map(|point| *part.part_compliance(point).unwrap()).collect();
        problem.task = problem.task.clone().with_part_compliances(matrices).unwrap();
        problem
    };
    for (name, problem) in [
        ("alike", with_beside(five_segments(), Beside::Alike)),
        ("matrices", with_beside(five_segments(), Beside::Matrices)),
        ("whole", whole()),
        ("linkage", with_axes_2_3(whole(), true, [-150.0, 0.0])),
        ("twisted", twisted_whole()),
        ("robust", with_errors(twisted_whole())),
    ] {
        let table = LookupTable::new(&problem).unwrap();
        let stated = table.accuracy();
        assert!(stated.states > 200 && stated.rms < 5e-4 && stated.disputed < 0.02, "{name}: {stated:?}");
        let found = compared(&table, 120, 1500);
        assert!(found.rms < 4.0 * stated.rms + 2e-6 && found.disputed < 0.02, "{name}: {found:?} {stated:?}");
        let mut broken = table.clone();
        broken.base = None;
        broken.points.iter_mut().for_each(polar::WorkpiecePoint::without_part);
        if name != "alike" {
            assert!(broken.accuracy().rms > 10.0 * stated.rms, "{name}: base and part are not seen");
        }
    }
    let pairs = with_beside(five_segments(), Beside::Pairs);
    assert_eq!(Shape::of(&pairs).unwrap_err(), Unsupported::UnlikeFlips);
}

#[test]
fn every_broken_part_of_the_formula_is_seen() {
    type Mutation = (&'static str, fn(&mut LookupTable<'_>));
    fn scale(table: &mut LookupTable<'_>, wanted: usize, change: impl Fn(f32) -> f32) {
        let headings = table.shape.headings;
        let (block, range) = (table.shape.block(), wanted * headings..(wanted + 1) * headings);
        for row in table.data.chunks_mut(block) {
            row[range.clone()].iter_mut().for_each(|value| *value = change(*value));
        }
    }
    let mutations: [Mutation; 16] = [
        ("r^2 / k1 left out", |table| table.first_compliance = 0.0),
        ("sign of m", |table| scale(table, field::MEAN, |v| -v)),
        ("sign of d1", |table| scale(table, field::DIFFERENCE, |v| -v)),
        ("sign of d2", |table| scale(table, field::MIXED, |v| -v)),
        ("sign of c_rz", |table| scale(table, field::VERTICAL, |v| -v)),
        ("sign of c_tz", |table| scale(table, field::VERTICAL + 1, |v| -v)),
        ("sign of g_rr", |table| scale(table, table.shape.moment(), |v| -v)),
        ("sign of g_rt", |table| scale(table, table.shape.moment() + 1, |v| -v)),
        ("sign of g_rz", |table| scale(table, table.shape.moment() + 2, |v| -v)),
        ("sign of g_tr", |table| scale(table, table.shape.moment() + 3, |v| -v)),
        ("sign of g_tt", |table| scale(table, table.shape.moment() + 4, |v| -v)),
        ("sign of g_tz", |table| scale(table, table.shape.moment() + 5, |v| -v)),
        ("sense of the heading against the azimuth", |table| table.rotation_sign = -table.rotation_sign),
        ("axis 1 elsewhere by a step", |table| table.shape.radius.first += table.shape.radius.step),
        ("heights off by a step", |table| table.shape.height.first -= table.shape.height.step),
        ("no limits", |table| scale(table, field::ROOM, |_| 1.0)),
    ];
    let problem = twisted(slanted());
    let sound = LookupTable::new(&problem).unwrap();
    let stated = sound.accuracy();
    let is_fine = |found: &Accuracy| found.rms < 4.0 * stated.rms + 2e-6 && found.disputed < 0.02;
    assert!(is_fine(&compared(&sound, 120, 300)));
    for (name, mutate) in mutations {
        let mut broken = sound.clone();
        mutate(&mut broken);
        if name == "no limits" {
            broken.alive.fill(true);
        }
        let found = compared(&broken, 120, 300);
        assert!(!is_fine(&found), "{name} is not seen: {found:?}");
        assert!(!is_fine(&broken.accuracy()), "{name} is not reported");
    }
}

fn drawn_poses(problem: &Problem, count: usize) -> Vec<Placement> {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let [x, y, z] = problem.cell.position;
    let bounds = [x, y, z, problem.cell.yaw];
    (0..count).map(|_| bounds.map(|b| b.min + random.random::<f64>() * b.width()).into()).collect()
}

#[test]
fn objective_agrees_with_the_planner() {
    // The workpiece that hangs is where limits bind all over: there the table errs at their edges.
    for (problem, close_share, most_above) in
        [(five_segments(), 8, 0), (robust(), 8, 0), (hanging(), 6, 5), (twisted(slanted()), 8, 0)]
    {
        let planner = Planner::new(&problem);
        let table = LookupTable::new(&problem).unwrap();
        let grid = BetaGrid::of(&planner);
        let (mut space, mut looking) = (planner.workspace(), table.workspace(&grid));
        let (mut close, mut above, mut feasible, mut disputed) = (0, 0, 0, 0);
        for (k, placement) in drawn_poses(&problem, 40).iter().enumerate() {
            let planned = planner.objective(placement, Sense::Min, None, &mut space);
            let looked = table.objective(placement, &grid, None, CollisionEffort::ALL, &mut looking);
            // A fresh workspace, with nothing kept from the placement before, says the same.
            assert_eq!(
                table.objective(placement, &grid, None, CollisionEffort::ALL, &mut table.workspace(&grid)),
                looked
            );
            let (Some(planned), Some(looked)) = (planned.mean(), looked.mean()) else {
                disputed += usize::from(planned.mean().is_some() || looked.mean().is_some());
                continue;
            };
            // What the table relaxes can only make it find less.
            assert_eq!(table.relaxed(), [ConstraintKind::JointStep, ConstraintKind::JointTurn]);
            let error = (looked / planned - 1.0).abs();
            assert!(error < 0.02, "{k}: {planned} {looked}");
            close += usize::from(error < 1e-4);
            above += usize::from(looked > planned * (1.0 + 1e-4));
            feasible += 1;
            if error < 1e-4
                && let Ok(plans) = planner.plan(placement, Sense::Min, None, &mut space)
            {
                let mut scheme: Vec<_> = plans.iter().map(|plan| plan.posture).collect();
                let held = table
                    .objective(placement, &grid, Some(&scheme), CollisionEffort::ALL, &mut looking)
                    .mean()
                    .unwrap();
                assert!((held / looked - 1.0).abs() < 1e-3);
                scheme[2] = stead_model::robot::Posture::ALL[(usize::from(scheme[2].number()) + 3) % 8];
                let other = table.objective(placement, &grid, Some(&scheme), CollisionEffort::ALL, &mut looking);
                assert!(rank(Sense::Min, other, Objective::Feasible(held * (1.0 - 1e-6))).is_gt());
            }
        }
        assert!(feasible > 12 && close * 10 >= feasible * close_share, "{close} of {feasible}");
        assert!(above <= most_above, "{above} of {feasible}");
        assert!(disputed < 4, "{disputed}");
    }
}

#[test]
fn what_nothing_reaches_is_counted_as_the_planner_counts_it() {
    let mut problem = five_segments();
    problem.cell.position[1] = Interval { min: -3.4, max: -2.2 };
    let planner = Planner::new(&problem);
    let table = LookupTable::new(&problem).unwrap();
    let grid = BetaGrid::of(&planner);
    let (mut space, mut looking) = (planner.workspace(), table.workspace(&grid));
    let (mut blocked, mut apart) = (0, 0);
    for placement in drawn_poses(&problem, 30) {
        let planned = planner.objective(&placement, Sense::Min, None, &mut space);
        let looked = table.objective(&placement, &grid, None, CollisionEffort::ALL, &mut looking);
        if let (Objective::Infeasible { points: a, .. }, Objective::Infeasible { points: b, .. }) = (planned, looked) {
            blocked += a;
            apart += a.abs_diff(b);
        }
    }
    assert!(blocked > 300 && apart * 20 < blocked, "{blocked} {apart}");
}

#[test]
fn a_long_path_keeps_its_digits() {
    let mut problem = five_segments();
    let first = problem.task.points()[0];
    let count = 20_000;
    let points = (0..count).map(|k| {
        let along = 0.3 * f64::from(k) / f64::from(count);
        (1, PathPoint { position: first.position + first.feed * along, ..first })
    });
    let path = ToolPath::new(points.collect::<Vec<_>>()).unwrap();
    let wrenches = vec![problem.task.loads()[0].wrench; count as usize];
    problem.task = Task::new(path, wrenches).unwrap();
    // Beta stays: between points this close the planner saves its steps up, which the table does not.
    problem.redundancy.max_beta_rate = Some(0.0);
    let planner = Planner::new(&problem);
    let table = LookupTable::new(&problem).unwrap();
    let grid = BetaGrid::of(&planner);
    let placement = Placement::from([0.0, -1.8, -0.4, 0.7]);
    let planned = planner.objective(&placement, Sense::Min, None, &mut planner.workspace()).mean().unwrap();
    let looked =
        table.objective(&placement, &grid, None, CollisionEffort::ALL, &mut table.workspace(&grid)).mean().unwrap();
    assert!((looked / planned - 1.0).abs() < 2e-5, "{looked} {planned}");
}

#[test]
fn steps_of_beta_are_the_planners() {
    let problem = five_segments();
    for planner in [Planner::new(&problem), Planner::finer(&problem)] {
        let grid = BetaGrid::of(&planner);
        for (point, change) in grid.changes.iter().enumerate() {
            assert_eq!(*change, planner.step(point, Sense::Min).change);
        }
    }
}

#[test]
fn coordinate_search_gets_better_inside_the_cell() {
    let mut problem = five_segments();
    problem.cell.yaw = Interval { min: 0.2, max: 2.4 };
    let table = LookupTable::new(&problem).unwrap();
    let grid = BetaGrid::new(&problem, 120);
    let mut workspace = table.workspace(&grid);
    for (sense, start) in [(Sense::Min, [0.1, -1.8, -0.4, 1.0]), (Sense::Max, [-0.1, -2.0, -0.4, 0.6])] {
        let start = Placement::from(start);
        let before = table.objective(&start, &grid, None, CollisionEffort::ALL, &mut workspace);
        for directions in [Directions::WithoutAzimuth, Directions::All] {
            let mut evaluate =
                |placement: &Placement| table.objective(placement, &grid, None, CollisionEffort::ALL, &mut workspace);
            let (end, objective, evaluations) =
                coordinate_search(&problem, &start, sense, directions, &mut evaluate, &Monitor::silent());
            assert!(rank(sense, objective, before).is_lt() && evaluations > 20, "{sense:?} {before:?} {objective:?}");
            assert_eq!(objective, evaluate(&end));
            assert!(problem.cell.contains(&end), "{end:?}");
        }
    }
}

#[test]
fn the_same_table_for_any_number_of_threads() {
    let problem = slanted();
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let table = LookupTable::new(&problem).unwrap();
            (table.data.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), table.accuracy())
        })
    };
    let one = build(1);
    assert!(one == build(2) && one == build(5));
}

#[test]
fn what_a_table_cannot_hold_is_refused_with_the_reason() {
    let refused = |problem: &Problem| Shape::of(problem).unwrap_err();
    let with_axes = |axis_of: &dyn Fn(usize) -> Vector3<f64>| {
        let mut problem = five_segments();
        let path = problem.task.path();
        let points = path.points().iter().enumerate();
        let points = points.map(|(k, point)| (path.segment_of(k) as u32 + 1, PathPoint { axis: axis_of(k), ..*point }));
        let path = ToolPath::new(points.collect::<Vec<_>>()).unwrap();
        problem.task = Task::new(path, problem.task.wrenches().copied().collect()).unwrap();
        refused(&problem)
    };
    let (sine, cosine) = libm::sincos(0.01);
    let (tilted, upright) = (Vector3::new(sine, 0.0, cosine), Vector3::z());
    // One point that leans, and a constant tilt, whose first point leans as well.
    for first in [40, 0] {
        let axis_of = |k: usize| if first == 0 || k == first { tilted } else { upright };
        let Unsupported::TiltedTool { point, angle } = with_axes(&axis_of) else { panic!("the tool leans") };
        assert!(point == first && (angle - 0.01).abs() < 1e-12, "{point} {angle}");
    }
    assert_eq!(
        with_axes(&|_| tilted).to_string(),
        "the tool is not upright: its axis is 0.573 deg from the vertical at point 0"
    );
    assert_eq!(with_axes(&|k| if k < 40 { upright } else { -upright }), Unsupported::UpsideDown { point: 40 });

    for joint in [0, 3, 5] {
        let mut joints = five_segments().robot.joints().clone();
        (joints[joint].min, joints[joint].max) = (-2.0, 2.0);
        joints[joint].compliance = stead_model::robot::Compliance::Range { at_min: 1e-6, at_max: 2e-6 };
        let problem = five_segments().with(|parts| parts.robot = Robot::new("law", joints).unwrap());
        assert_eq!(refused(&problem), Unsupported::VaryingCompliance { joint: joint + 1 });
    }

    let mut uncertain = with_uncertainty(five_segments(), 0.1);
    assert!(Shape::of(&uncertain).is_ok());
    uncertain.criterion.confidence = 2.0;
    assert_eq!(refused(&uncertain), Unsupported::UncertainCompliances);

    let mut leaning = five_segments();
    let mut joints = leaning.robot.joints().clone();
    joints[0].alpha = 0.1;
    leaning.robot = Robot::new("leaning", joints).unwrap();
    let Unsupported::BaseNotVertical { angle } = refused(&leaning) else { panic!("axis 1 leans") };
    assert!((angle - 0.1).abs() < 1e-12);

    let mut huge = five_segments();
    let mut joints = huge.robot.joints().clone();
    (joints[2].a, joints[3].d) = (120.0, 120.0);
    huge.robot = Robot::new("crane", joints).unwrap();
    huge.cell.position = [Interval { min: -1e3, max: 1e3 }; 3];
    let Unsupported::TooLarge { bytes, max } = refused(&huge) else { panic!("a crane's table does not fit") };
    assert!(bytes > max && max == MAX_BYTES);
    assert!(refused(&huge).to_string().contains(" GB, and at most 1.074 GB are allowed"), "{}", refused(&huge));
}

#[test]
fn the_lookup_table_keeps_the_turn_of_the_spindle() {
    let mut problem = with_turn_limits(corners(0.0), 120, None, 3.0);
    let joints = problem.robot.joints().clone().map(|joint| Joint { max_speed: None, ..joint });
    problem.robot = Robot::new("unbounded", joints).unwrap();
    let planner = Planner::new(&problem);
    let table = LookupTable::new(&problem).unwrap();
    let grid = BetaGrid::of(&planner);
    let mut compared = 0;
    for k in 0..12 {
        let f = f64::from(k);
        let placement = Placement::from([-0.2 + 0.04 * f, -1.6 - 0.04 * f, -0.5 + 0.02 * f, -3.0 + 0.5 * f]);
        let planned = planner.objective(&placement, Sense::Min, None, &mut planner.workspace()).mean();
        let looked = table.objective(&placement, &grid, None, CollisionEffort::ALL, &mut table.workspace(&grid)).mean();
        if let Some((planned, looked)) = planned.zip(looked) {
            compared += 1;
            assert!((looked / planned - 1.0).abs() < 5e-3, "{looked} {planned}");
        }
    }
    assert!(compared > 4, "{compared}");
}

#[test]
fn table_and_planner_agree_among_shapes() {
    let post = shape("post", Attachment::Base, Solid::Cylinder { radius: 0.12, length: 2.5 }, [0.55, -1.35, 0.3]);
    let shapes = kr270_shapes().into_iter().filter(|shape| shape.name != "pillar").chain([post]).collect();
    let mut problem = five_segments();
    problem.redundancy.beta_count = 60;
    problem.scene = Some(Arc::new(scene_of(shapes, 0.02)));
    let planner = Planner::new(&problem);
    let table = LookupTable::new(&problem).unwrap();
    let evaluator = Evaluator::new(&planner, Some(&table));
    let mut space = evaluator.workspace();
    for placement in [[0.1, -1.9, -0.4, 1.0], [-0.05, -1.75, -0.3, -0.6], [0.2, -1.7, -0.45, 2.4]].map(Placement::from)
    {
        let by_table = evaluator.objective(&placement, None, &mut space).mean();
        let planned = planner.objective(&placement, Sense::Min, None, &mut planner.workspace()).mean();
        match (by_table, planned) {
            (Some(by_table), Some(planned)) => assert!((by_table / planned - 1.0).abs() < 0.01, "{by_table} {planned}"),
            (by_table, planned) => assert_eq!(by_table.is_some(), planned.is_some()),
        }
    }
}

#[test]
fn the_table_declares_what_it_relaxes() {
    let mut problem = five_segments();
    problem.constraints.max_deflection = Some(1e-3);
    problem.constraints.min_base_distance = 0.3;
    problem.redundancy.max_spindle_turn = Some(1.0);
    let relaxed = [ConstraintKind::JointStep, ConstraintKind::JointTurn];
    assert_eq!(LookupTable::new(&problem).unwrap().relaxed(), relaxed);
}
