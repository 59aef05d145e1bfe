//! The plan over (beta, lead, tilt, external axes) against a reference: every pair of neighbouring states, with the
//! limits tested one by one, and every state with the tool leaning there and nowhere else.

use super::*;
use crate::redundancy::joint_turns::is_allowed;
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;
use stead_cell::testing::{kr270_shapes, scene_of, shape};
use stead_cell::{Attachment, Solid};
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_model::robot::angles::wrap;
use stead_model::task::lean::{ContactRule, CutterEnd, LeanForce, LeanRule, between};
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_problem::cell::Interval;
use stead_problem::lean::{LeanRange, LeanSpace, lean_between};
use stead_problem::problem::ProblemParts;
use stead_problem::setup::{AxisPositions, Setup};
use stead_problem::testing::five_segments;

const BALL: LeanRule =
    LeanRule { end: CutterEnd { radius: 0.008, corner: 0.008 }, contact: ContactRule::Centre, force: LeanForce::Feed };

fn range(lead: [f64; 2], tilt: [f64; 2]) -> LeanRange {
    let of = |[min, max]: [f64; 2]| Interval { min: min.to_radians(), max: max.to_radians() };
    LeanRange { lead: of(lead), tilt: of(tilt) }
}

/// Positions of external axes that are planned on, by the numbers of the axes.
type Axes = Vec<(usize, Vec<f64>)>;

/// A rail under the robot and a turntable under the part with few positions of each, drawn from a seed, in a problem.
fn with_axes(problem: &Problem, seed: u64) -> (Problem, Axes) {
    let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
    let time = problem.step_time(1);
    let mut axis = |kind: AxisKind, carries: Carried, half: f64| ExternalAxis {
        name: format!("{kind:?}"),
        kind,
        carries,
        direction: if kind == AxisKind::Rail { Vector3::x() } else { Vector3::z() },
        point: Vector3::new(0.0, -1.9, 0.0),
        min: -half,
        max: half,
        max_speed: Some(half * random.random_range(0.6..1.6) / time),
        axis_use: AxisUse::Continuous,
    };
    let axes = [axis(AxisKind::Rail, Carried::Robot, 0.02), axis(AxisKind::Turntable, Carried::Workpiece, 0.03)];
    let positions = axes.iter().map(|axis| axis.grid(3)).enumerate().collect();
    let with = problem.changed(|parts| {
        parts.setup = Setup::at_rest(&axes);
        parts.external_axes = axes.to_vec();
    });
    (with.unwrap(), positions)
}

/// A short curved path with few values of beta, drawn from a seed, and where its tool may lean.
fn drawn(seed: u64) -> (Problem, Placement) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut points, mut wrenches) = (Vec::new(), Vec::new());
    let mut heading: f64 = random.random_range(-3.0..3.0);
    let mut position = Vector3::new(0.1, 0.05, 0.02);
    let axis = Vector3::new(random.random_range(-0.2..0.2), random.random_range(-0.2..0.2), 1.0).normalize();
    for number in 0..7 {
        let feed = Vector3::new(libm::cos(heading), libm::sin(heading), 0.0);
        points.push((1, PathPoint { position, feed, axis }, number != 3));
        let force = Vector3::from_fn(|_, _| random.random_range(-150.0..150.0));
        let moment = Vector3::from_fn(|_, _| random.random_range(-2.0..2.0));
        wrenches.push(Wrench { force, moment });
        heading += random.random_range(-0.3..0.3);
        position += feed * 0.012;
    }
    let task = Task::new(ToolPath::partly_scored(points).unwrap(), wrenches).unwrap();
    let mut ranges = vec![range([-9.0, 12.0], [-8.0, 8.0]); 7];
    ranges[3] = LeanRange::NONE;
    ranges[5] = range([2.0, 9.0], [-8.0, 3.0]);
    let space = LeanSpace {
        rule: LeanRule { force: if seed.is_multiple_of(2) { LeanForce::Feed } else { LeanForce::Tool }, ..BALL },
        ranges,
        max_lean: Some(11.0_f64.to_radians()),
        steps: [6.0_f64.to_radians(), 4.0_f64.to_radians()],
        step_over: None,
        scallop: None,
        contact_tolerance: random.random_range(1e-5..1e-4),
    };
    let mut parts: ProblemParts = five_segments().into_parts();
    parts.task = task;
    parts.redundancy.beta_count = 36;
    parts.redundancy.max_beta_rate = Some(random.random_range(900.0..2500.0_f64).to_radians());
    parts.redundancy.max_spindle_turn = seed.is_multiple_of(3).then_some(1800.0_f64.to_radians());
    parts.lean = Some(Arc::new(space));
    parts.constraints.min_inverse_condition = 0.17;
    let cell = &parts.cell;
    let within = |range: &Interval, share: f64| range.min + share * (range.max - range.min);
    let mut share = || random.random_range(0.3..1.0);
    let [x, y, z] = std::array::from_fn(|k| within(&cell.position[k], share()));
    let placement = Placement { x, y, z, yaw: share() * 6.0 };
    (parts.build().unwrap(), placement)
}

/// Real joints of the class modulo a turn: a step of joint 1 to 3 as it is, of the wrist by the short way.
fn steps_hold(problem: &Problem, from: &[f64; 6], to: &[f64; 6], limits: &[f64; 6]) -> bool {
    (0..6).all(|j| {
        let joint = &problem.robot.joints()[j];
        let is_narrow = j < 3 && !stead_model::robot::turns::Range::of(joint).has_turns();
        let step = if is_narrow { to[j] - from[j] } else { wrap(to[j] - from[j]) };
        step.abs() <= limits[j] + 1e-9
    })
}

/// A state with the tool leaning at its point.
struct Node {
    cost: f64,
    beta: f64,
    joints: [f64; 6],
    axis: Vector3<f64>,
    flange: Matrix3<f64>,
    positions: Vec<f64>,
}

/// The cheapest cost in one class, all states and all edges, without external axes or with two of them.
fn plain(problem: &Problem, axes: &Axes, placement: &Placement, class: PostureClass) -> Option<f64> {
    let rows: Vec<Vec<f64>> = match axes.as_slice() {
        [(_, first), (_, second)] => first.iter().flat_map(|a| second.iter().map(|b| vec![*a, *b])).collect(),
        _ => vec![Vec::new()],
    };
    let space = problem.lean.as_deref().unwrap();
    let (half, path, limits) = (space.half_counts(), problem.task.path(), &problem.redundancy);
    let posture = class.postures().into_iter().find(|posture| !posture.is_flipped()).unwrap();
    let mut before: Vec<Node> = Vec::new();
    for point in 0..7 {
        let mut layer = Vec::new();
        let mut seen = Vec::new();
        for lean in space.grid(point, half) {
            if seen.contains(&lean) || !space.ranges[point].contains(&lean) || lean.angle() > 11.0_f64.to_radians() {
                continue;
            }
            seen.push(lean);
            // The tool leans at this point alone.
            let mut leans = vec![Lean::NONE; 7];
            leans[point] = lean;
            let states = rows.iter().flat_map(|row| (0..limits.beta_count).map(move |k| (row, k)));
            let at = |row: &Vec<f64>| {
                let positions = AxisPositions::Same(row.clone());
                problem.in_setup(&Setup { leans: leans.clone().into(), positions, ..Setup::default() })
            };
            for (row, k) in states {
                let set_up = at(row);
                let beta = limits.beta(k);
                let Ok(state) = set_up.at(placement).state(point, beta, posture) else { continue };
                // Limits of the joints count joint by joint, in either flip of the wrist.
                let flips: Vec<[f64; 6]> = class
                    .postures()
                    .into_iter()
                    .map(|posture| set_up.at(placement).state(point, beta, posture).unwrap().joints)
                    .collect();
                let is_within = |j: usize| {
                    let (min, max) = (problem.robot.joints()[j].min, problem.robot.joints()[j].max);
                    let turns = |angle: f64| (-2..=2).map(move |k| angle + f64::from(k) * std::f64::consts::TAU);
                    flips.iter().any(|flip| turns(flip[j]).any(|angle| angle >= min && angle <= max))
                };
                if !is_allowed(&set_up, &state) || !(0..6).all(is_within) {
                    continue;
                }
                layer.push(Node {
                    cost: set_up.point_cost(point, state.score()),
                    beta,
                    joints: state.joints,
                    axis: set_up.task.points()[point].axis,
                    flange: set_up.at(placement).base_from_flange(point, beta).rotation,
                    positions: row.clone(),
                });
            }
        }
        for node in &mut layer {
            if point == 0 {
                continue;
            }
            let steps = problem.joint_steps(point);
            let is_edge = |old: &&Node| {
                let length = path.step_length(point);
                let turned =
                    || stead_numerics::rotation::rotation_vector(&(old.flange.transpose() * node.flange)).norm();
                let turns = || {
                    limits
                        .max_spindle_turn
                        .is_none_or(|limit| turned() <= (limit * length).min(std::f64::consts::FRAC_PI_2) + 1e-9)
                };
                let rate = wrap(node.beta - old.beta).abs() <= limits.max_beta_rate.unwrap() * length + 1e-9;
                // A ball leaves its line by r d^2 / 6.
                let d = libm::acos(old.axis.dot(&node.axis).min(1.0));
                let contact = d * d * 0.008 / 6.0 <= space.contact_tolerance && d <= 15.0_f64.to_radians() + 1e-9;
                let time = problem.step_time(point);
                let reaches = problem.external_axes.iter().enumerate().all(|(number, axis)| {
                    let way = (node.positions[number] - old.positions[number]).abs();
                    way <= axis.max_speed.unwrap() * time * (1.0 + 1e-9)
                });
                rate && reaches && contact && turns() && steps_hold(problem, &old.joints, &node.joints, &steps)
            };
            let least = before.iter().filter(is_edge).map(|old| old.cost).fold(f64::INFINITY, f64::min);
            node.cost += least;
        }
        layer.retain(|node| node.cost.is_finite());
        before = layer;
    }
    before.iter().map(|node| node.cost).reduce(f64::min)
}

#[test]
fn the_cheapest_way_is_found_among_all_states_and_steps() {
    let found: usize = (0..20).map(|seed| as_cheap_as_plain(seed, &drawn(seed), &Vec::new())).sum();
    assert!(found > 25, "{found} ways");
}

/// With a rail and a turntable that both move along the path, the tool leaning or not.
#[test]
fn the_cheapest_way_of_tool_and_axes_is_found_among_all_states_and_steps() {
    let mut found = 0;
    for seed in 0..16 {
        let (problem, placement) = drawn(seed);
        let problem = problem.changed(|parts| {
            parts.redundancy.beta_count = 24;
            parts.redundancy.max_beta_rate = parts.redundancy.max_beta_rate.map(|rate| 1.5 * rate);
            let space = Arc::make_mut(parts.lean.as_mut().unwrap());
            space.steps = if seed % 2 == 0 { [12.0_f64.to_radians(); 2] } else { space.steps };
            if seed % 2 == 1 {
                space.ranges = vec![LeanRange::NONE; 7];
            }
        });
        let (problem, axes) = with_axes(&problem.unwrap(), seed);
        found += as_cheap_as_plain(seed, &(problem, placement), &axes);
    }
    assert!(found > 20, "{found} ways");
}

/// In how many classes of a problem there is a way, each as cheap as that over all states and steps.
fn as_cheap_as_plain(seed: u64, (problem, placement): &(Problem, Placement), axes: &Axes) -> usize {
    let mut found = 0;
    let half = problem.lean.as_deref().map(LeanSpace::half_counts);
    let grid = MotionGrid::product(problem, half, axes);
    let problems = grid.problems();
    let planner = MotionPlanner::new(&grid, &problems);
    let ways = planner.segment(&(0..7), placement, &vec![StateSet::default(); problems.len()]).unwrap_or_default();
    for class in PostureClass::ALL {
        let (own, plain) = (ways.iter().find(|way| way.class == class), plain(problem, axes, placement, class));
        assert_eq!(own.is_some(), plain.is_some(), "seed {seed} {class:?}");
        if let (Some(own), Some(plain)) = (own, plain) {
            assert!((own.cost / plain - 1.0).abs() < 1e-9, "seed {seed} {class:?}: {} {plain}", own.cost);
            found += 1;
        }
    }
    found
}

/// A wider cone is never worse, and a tool that may not lean is as before.
#[test]
fn a_wider_cone_is_never_worse() {
    let mut gains = 0;
    for seed in 0..12 {
        let (problem, placement) = drawn(seed);
        let mut last: Option<f64> = None;
        // Nested grids: twice the range in twice the steps.
        for half in [0, 1, 2, 4] {
            let mut space = (**problem.lean.as_ref().unwrap()).clone();
            let reach = 3.0 * f64::from(half);
            space.ranges = vec![range([-reach, reach], [-reach, reach]); 7];
            (space.max_lean, space.steps) = (None, [3.0_f64.to_radians(); 2]);
            let problem = problem.changed(|parts| parts.lean = Some(Arc::new(space))).unwrap();
            let grid = MotionGrid::new(&problem).unwrap();
            let problems = grid.problems();
            let found = MotionPlanner::new(&grid, &problems).path(&placement).map(|path| path.objective);
            if let Some(last) = last {
                let found = found.expect("a wider cone has what a narrower one has");
                assert!(found <= last * (1.0 + 1e-12), "seed {seed}: {found} {last}");
                gains += usize::from(found < last * 0.99);
            }
            last = found.or(last);
        }
    }
    assert!(gains > 10, "{gains}");
}

/// The published path with a ball cutter that may lean, the shapes of the arm and a post of a radius (m).
fn among_a_post(radius: f64) -> Problem {
    let post = shape("post", Attachment::Base, Solid::Cylinder { radius, length: 2.5 }, [0.55, -1.35, 0.3]);
    let shapes = kr270_shapes().into_iter().filter(|shape| shape.name != "pillar").chain([post]).collect();
    let problem = five_segments().with(|parts| {
        parts.redundancy.beta_count = 30;
        parts.scene = Some(Arc::new(scene_of(shapes, 0.02)));
        parts.lean = Some(Arc::new(LeanSpace {
            rule: BALL,
            ranges: vec![range([-6.0, 6.0], [-6.0, 6.0]); 105],
            max_lean: None,
            steps: [6.0_f64.to_radians(); 2],
            step_over: None,
            scallop: None,
            contact_tolerance: 2e-5,
        }));
    });
    problem.changed(|_| {}).unwrap()
}

/// What is found state by state where something hits is the cheapest of all states that do not hit.
#[test]
fn ways_made_lazily_are_those_over_all_free_states() {
    let problem = among_a_post(0.12);
    let free = problem.clone().with(|parts| parts.scene = None);
    let grids = [&problem, &free].map(|problem| MotionGrid::new(problem).unwrap());
    let problems = grids.each_ref().map(MotionGrid::problems);
    let [lazy, plain] = [0, 1].map(|k| MotionPlanner::new(&grids[k], &problems[k]));
    let mut changed = 0;
    for placement in [[0.1, -1.9, -0.4, 1.0], [-0.05, -1.75, -0.3, -0.6], [0.2, -1.7, -0.45, 2.4]].map(Placement::from)
    {
        let mut forbidden = vec![StateSet::default(); problems[0].len()];
        for (lean, problem) in problems[0].iter().enumerate() {
            for point in 0..105 {
                for posture in Posture::ALL.into_iter().filter(|posture| !posture.is_flipped()) {
                    for beta in 0..30 {
                        let angle = problem.redundancy.beta(beta);
                        if problem.posture_hit(point, &placement, angle, posture).is_some() {
                            forbidden[lean].add(point, posture.class(), beta);
                        }
                    }
                }
            }
        }
        let segments = free.task.segments();
        let dense: Option<Vec<Vec<Found>>> =
            segments.iter().map(|span| plain.segment(span, &placement, &forbidden).ok()).collect();
        let dense = dense.and_then(|found| plain.chosen(&found));
        let dense = dense.map(|ways| free.objective(ways.iter().map(|way| way.cost)));
        let found = lazy.path(&placement);
        match (&found, dense) {
            (Some(found), Some(dense)) => {
                assert!((found.objective - dense).abs() < 1e-15, "{} {dense}", found.objective)
            }
            (found, dense) => assert_eq!(found.is_some(), dense.is_some()),
        }
        let relaxed = plain.path(&placement);
        changed += usize::from(relaxed.map(|way| way.objective) != found.map(|way| way.objective));
    }
    assert!(changed > 0);
}

/// Where there is no way, the points that no state reaches from the one before are counted.
#[test]
fn points_out_of_reach_are_counted() {
    let (problem, placement) = drawn(1);
    let grid = MotionGrid::new(&problem).unwrap();
    let problems = grid.problems();
    let far = Placement { x: placement.x + 20.0, ..placement };
    let found = MotionPlanner::new(&grid, &problems).path_or_unreached(&far);
    assert_eq!(found, Err(Unreached { points: 7, segments: 1 }));
}

/// Between points on which leads and tilts are planned the axis turns evenly, on one great circle.
#[test]
fn between_two_leans_the_axis_turns_evenly() {
    let (problem, _) = drawn(4);
    let path = problem.task.upright().path();
    let ends = [(0, Lean { lead: 0.15, tilt: -0.1 }), (3, Lean { lead: -0.05, tilt: 0.12 })];
    let axis = |(point, lean): (usize, Lean)| lean.axis(&path.points()[point]);
    let [from, to] = ends.map(axis);
    let whole = between(&from, &to);
    for (point, share) in [(1, 0.2), (2, 0.7)] {
        let found = axis((point, lean_between(path, ends, point, share)));
        let off = [between(&from, &found) - share * whole, between(&found, &to) - (1.0 - share) * whole];
        assert!(off.iter().all(|off| off.abs() < 1e-7), "{off:?}");
    }
}
