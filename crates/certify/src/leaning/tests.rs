//! Tools that lean, layer by layer against the reference evaluator, and with parts broken on purpose.

use super::super::kind::Kind;
use super::super::part::certifiable;
use super::super::relaxed_value;
use super::super::tests::{Setting, hanging_arm, leaning, odd_arm, seeded, share};
use super::super::worst::certifiable_from_above;
use super::states::{Known, States, TURN, known_over};
use super::*;
use crate::interval_simd::WIDTH;
use crate::{KeepsOpen, Status};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use stead_model::robot::angles::wrap;
use stead_model::task::{Task, ToolPath};
use stead_planning::feasibility::explain;
use stead_problem::criterion::Weights;
use stead_problem::problem::{Interval, Placement};
use stead_problem::symmetry::Unsupported;
use stead_problem::testing::{five_segments, slanted};

const MEMORY: u64 = 1_000_000_000;

/// A problem with a tool that leans, and what is needed to hold its layers against the reference.
struct Leant {
    setting: Setting,
    arm: Arm,
    axis: Vector3<f64>,
}

/// An allowed state as bounds have it.
struct State {
    point: usize,
    class: PostureClass,
    /// Place about axis 1 in the directions of the workpiece (m), and turn of the spindle (rad).
    at: [f64; 4],
    inverse_condition: f64,
    /// Beta at turn zero, and which way it grows.
    beta: (f64, f64),
}

impl Leant {
    fn new(problem: Problem) -> Self {
        let robot = problem.robot.clone();
        let axis = axes_of(&problem)[0];
        let arm = Arm::leaning(&problem, &robot, extent(&problem).radius.0, axis);
        Self { setting: Setting::new(problem), arm, axis }
    }

    fn all() -> Vec<(&'static str, Self)> {
        let total = |mut problem: Problem, error| {
            (problem.criterion.weights, problem.criterion.force_uncertainty) = (Weights::TOTAL, error);
            problem
        };
        [
            ("wall", leaning(slanted(), 20.0)),
            ("upright", leaning(slanted(), 0.0)),
            ("total, hanging arm", total(leaning(hanging_arm(), 25.0), 0.0)),
            ("total, force errors, odd arm", total(leaning(odd_arm(), 35.0), 0.1)),
        ]
        .map(|(name, problem)| (name, Self::new(problem)))
        .into()
    }

    fn side(&self) -> f64 {
        side(&self.setting.problem)
    }

    /// The pose that has a point at a place about axis 1.
    fn pose(&self, point: usize, at: &[f64]) -> Placement {
        let p = seen(&self.setting.problem.task.points()[point].position, self.side());
        let (x, y) = (at[0] - p.x, at[1] - p.y);
        self.setting.pose([libm::hypot(x, y), at[2] - p.z, -libm::atan2(y, x)], 0.4)
    }

    /// Place of a point and turn of the spindle, by the task's own transforms.
    fn place(&self, pose: &Placement, point: usize, beta: f64) -> [f64; 4] {
        let problem = &self.setting.problem;
        let g = problem.robot.geometry();
        let workpiece = pose.base_from_workpiece();
        let tip = workpiece.point(&problem.task.points()[point].position);
        let flange = problem.at(pose).base_from_flange(point, beta);
        let axis6 = flange.rotation.column(2).into_owned();
        let lever = tip - (flange.translation - axis6 * g.flange);
        let into = |v: Vector3<f64>| seen(&(workpiece.rotation.transpose() * v), self.side());
        // Of two vectors that turn with the spindle, one is not along its axis.
        let off = |v: Vector3<f64>| v - self.axis * self.axis.dot(&v);
        let (from, to) = (off(self.arm.lever + self.arm.axis6), off(into(lever + axis6)));
        assert!((from.norm() - to.norm()).abs() < 1e-9, "the lever is the same at every turn");
        let turn = libm::atan2(self.axis.dot(&from.cross(&to)), from.dot(&to));
        let [x, y, z]: [f64; 3] = into(tip - g.root_in_base).into();
        [x, y, z, turn]
    }

    /// The score of a state of a point (m) and 1/kappa_F, where some posture of the class is allowed there.
    fn truth(&self, state: &State, at: [f64; 4]) -> Option<(f64, f64)> {
        let (from, sign) = state.beta;
        let pose = self.pose(state.point, &at);
        let all = explain(&self.setting.problem, &pose, state.point, from + sign * at[TURN]);
        let mut of_class = state.class.postures().into_iter().map(|p| &all[usize::from(p.number()) - 1]);
        let found = of_class.find(|e| e.is_allowed())?.state.as_ref()?;
        Some((self.setting.problem.point_cost(state.point, found.score()), found.inverse_condition))
    }

    /// An allowed state somewhere in the cell.
    fn drawn(&self, random: &mut ChaCha8Rng) -> Option<State> {
        let problem = &self.setting.problem;
        let point = random.random_range(0..problem.task.points().len());
        let [x, y, z] = problem.cell.position.map(|i| random.random_range(i.min..=i.max));
        let pose = Placement { x, y, z, yaw: random.random_range(0.0..TAU) };
        let beta = random.random_range(0.0..TAU);
        let (at, next) = (self.place(&pose, point, beta), self.place(&pose, point, beta + 0.1));
        let sign = wrap(next[TURN] - at[TURN]).signum();
        let class = PostureClass::ALL[random.random_range(0..4)];
        let state = State { point, class, at, inverse_condition: 0.0, beta: (beta - sign * at[TURN], sign) };
        let (_, inverse_condition) = self.truth(&state, at)?;
        Some(State { inverse_condition, ..state })
    }

    fn kind(&self, point: usize) -> Kind {
        let load = Load::seen(&self.setting.problem, point, 0.0, self.side()).signed();
        Kind { load, force_spread: 0.0, moment_spread: 0.0, part_spread: 0.0 }
    }
}

#[test]
fn points_are_where_bounds_have_them() {
    for (name, leant) in Leant::all() {
        let mut random = seeded(90);
        for _ in 0..300 {
            let point = random.random_range(0..105);
            let at: [f64; 3] = std::array::from_fn(|k| random.random_range(-1.0..1.0) + f64::from(k as u8 == 0));
            let place = leant.place(&leant.pose(point, &at), point, random.random_range(0.0..TAU));
            assert!((0..3).all(|k| (place[k] - at[k]).abs() < 1e-9), "{name}: {place:?} {at:?}");
        }
    }
}

/// What is done to a region before it is held against the truth.
type Change = (&'static str, fn([f64; 4]) -> [f64; 4], fn(&mut States), f64);
const SOUND: Change = ("sound", |half| half, |_| {}, 1.0);

/// Allowed states of regions that are said to hold none, or to cost more; and how many states there were, and how many
/// of the bounds were within a tenth of the score.
fn violations(leant: &Leant, (_, judged, change, turn): Change) -> [usize; 3] {
    let mut random = seeded(91);
    let (mut wrong, mut states, mut near) = (0, 0, 0);
    for k in 0..3000 {
        let Some(state) = leant.drawn(&mut random) else { continue };
        let scale = [2.0, 1.0, 0.5, 0.25, 1e-4][k % 5];
        let half: [f64; 4] = [scale * 0.025; 4];
        let corner: [f64; 4] = std::array::from_fn(|_| share(&mut random));
        let middle: [f64; 4] = std::array::from_fn(|k| state.at[k] - corner[k] * half[k]);
        let [known, ..] = known_over(&leant.arm, &[middle; WIDTH], judged(half), state.class);
        let kind = leant.kind(state.point);
        for shot in 0..8 {
            let by: [f64; 4] =
                std::array::from_fn(|k| if shot == 0 { corner[k] } else { share(&mut random) } * half[k]);
            let at = std::array::from_fn(|k| middle[k] + by[k]);
            let Some((score, _)) = leant.truth(&state, at) else { continue };
            states += 1;
            match known {
                Known::Empty => wrong += 1,
                Known::Unknown => {}
                Known::Yields(mut states) => {
                    change(&mut states);
                    let half = [half[0], half[1], half[2], half[TURN] * turn];
                    let below = states.below(&kind, half).affine;
                    let value = f64::from(below.value) + (0..3).map(|k| f64::from(below.slope[k]) * by[k]).sum::<f64>();
                    wrong += usize::from(value > score * (1.0 + 1e-6) + 1e-12);
                    near += usize::from(value > 0.9 * score);
                }
            }
        }
    }
    [wrong, states, near]
}

#[test]
fn regions_hold_every_allowed_state_and_broken_ones_are_seen() {
    for (name, leant) in Leant::all() {
        let [wrong, states, near] = violations(&leant, SOUND);
        assert!(wrong == 0, "{name}: {wrong} of {states}");
        assert!(states > 1500 && near > states / 4, "{name}: {states} {near}");
    }
    let leant = Leant::new(leaning(slanted(), 20.0));
    let mutations: [Change; 6] = [
        ("remainder zero", |half| half, |s| s.remainder = [0.0; 4], 1.0),
        ("remainder times 0.3", |half| half, |s| s.remainder = s.remainder.map(|r| 0.3 * r), 1.0),
        ("judged at the middle alone", |_| [1e-9; 4], |_| {}, 1.0),
        ("turn taken to be in the middle", |half| half, |_| {}, 0.0),
        ("without joint 1 by y", |half| half, |s| s.values[1].1[1] = 0.0, 1.0),
        ("slope by height the other way", |half| half, |s| s.values[0].1[2] *= -1.0, 1.0),
    ];
    for change in mutations {
        assert!(violations(&leant, change)[0] > 0, "{} is not seen", change.0);
    }
}

/// How many states that just meet a limit on conditioning are lost by an arm that needs `times` as much, of how many.
fn lost_at_the_limit(times: f64) -> [usize; 2] {
    let mut random = seeded(92);
    let mut counts = [0; 2];
    for problem in [leaning(slanted(), 20.0), leaning(odd_arm(), 35.0)] {
        let mut problem = problem;
        problem.constraints.min_inverse_condition = 0.04;
        let leant = Leant::new(problem.clone());
        for _ in 0..3000 {
            let Some(state) = leant.drawn(&mut random) else { continue };
            counts[1] += 1;
            problem.constraints.min_inverse_condition = state.inverse_condition * 0.9999 * times;
            let arm = Arm::leaning(&problem, &problem.robot, extent(&problem).radius.0, leant.axis);
            for size in [1.0, 0.1, 1e-3] {
                let corner: [f64; 4] = std::array::from_fn(|_| share(&mut random));
                let middle = std::array::from_fn(|k| state.at[k] - corner[k] * 0.025 * size);
                let [known, ..] = known_over(&arm, &[middle; WIDTH], [0.025 * size; 4], state.class);
                counts[0] += usize::from(known == Known::Empty);
            }
        }
    }
    counts
}

#[test]
fn states_at_the_limit_of_conditioning_are_kept() {
    let [lost, states] = lost_at_the_limit(1.0);
    assert!(lost == 0 && states > 500, "{lost} of {states}");
    assert!(lost_at_the_limit(1.02)[0] > 0, "a limit that is 2 % higher is not seen");
}

/// Allowed states at which a cell says that more is lost than is; how many there were, and for how many cells the bound
/// is within a tenth of the least score over the turn at the middle.
fn cell_violations(leant: &Leant, model: &Leaning, times: f64) -> [usize; 3] {
    let mut random = seeded(93);
    let (mut wrong, mut states, mut near) = (0, 0, 0);
    for k in 0..160 {
        let Some(state) = leant.drawn(&mut random) else { continue };
        let level = k % 4;
        let Some((kind, size)) = model.points[state.point].kind else { continue };
        let cells = &model.axes[0];
        let number = |side: usize| cells.between(level, side, state.at[side], state.at[side]).0;
        let at = [number(0), number(1), number(2)];
        let below = cells.below(level, at, state.class)[kind];
        let mut least = f64::INFINITY;
        for turn in 0..120 {
            let turned = [state.at[0], state.at[1], state.at[2], state.at[TURN] + TAU / 120.0 * f64::from(turn)];
            let Some((score, _)) = leant.truth(&state, turned) else { continue };
            least = least.min(score);
            states += 1;
        }
        let off = |side: usize| state.at[side] - cells.middle(level, side, at[side]);
        let value = f64::from(below.value) + (0..3).map(|k| f64::from(below.slope[k]) * off(k)).sum::<f64>();
        wrong += usize::from(times * size * value > least * (1.0 + 1e-6) + 1e-12);
        near += usize::from(times * size * value > 0.9 * least);
    }
    [wrong, states, near]
}

#[test]
fn cells_are_below_every_turn_and_broken_ones_are_seen() {
    let mut problem = leaning(five_segments(), 20.0);
    (problem.criterion.weights, problem.criterion.force_uncertainty) = (Weights::TOTAL, 0.1);
    let leant = Leant::new(problem.clone());
    let model = Leaning::new(&problem, f64::INFINITY);
    let [wrong, states, near] = cell_violations(&leant, &model, 1.0);
    assert!(wrong == 0 && states > 500 && near > 5, "{wrong} {states} {near}");
    assert!(cell_violations(&leant, &model, 1.15)[0] > 0, "bounds that are 15 % too high are not seen");
    problem.constraints.min_inverse_condition = 0.4;
    let strict = Leaning::new(&problem, f64::INFINITY);
    assert!(cell_violations(&leant, &strict, 1.0)[0] > 0, "states lost by another limit are not seen");
}

/// Four points of a path.
fn few(mut problem: Problem) -> Problem {
    let path = problem.task.path();
    let some = [10, 40, 60, 90];
    let points = some.map(|k| (k as u32 / 50 + 1, path.points()[k]));
    let wrenches = some.map(|k| problem.task.loads()[k].wrench).to_vec();
    problem.task = Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap();
    problem
}

#[test]
fn an_optimum_planted_in_a_small_cell_is_not_passed() {
    let mut problem = few(leaning(five_segments(), 20.0));
    (problem.criterion.weights, problem.criterion.force_uncertainty) = (Weights::TOTAL, 0.1);
    let monitor = Monitor::silent();
    let range = |middle: f64, half: f64| Interval { min: middle - half, max: middle + half };
    let mut tried = 0;
    for yaw in [0.3, 1.4, 2.5, 3.6] {
        problem.cell.position = [range(0.1, 2.5e-3), range(-1.8, 2.5e-3), range(-0.4, 2.5e-3)];
        problem.cell.yaw = range(yaw, 0.003);
        let ends = |i: Interval| [i.min, 0.5 * (i.min + i.max), i.max];
        let [x, y, z] = problem.cell.position.map(ends);
        let mut least = f64::INFINITY;
        for k in 0..81 {
            let at = [x[k % 3], y[k / 3 % 3], z[k / 9 % 3], ends(problem.cell.yaw)[k / 27]];
            least = least.min(relaxed_value(&problem, &Placement::from(at), &monitor).unwrap_or(f64::INFINITY));
        }
        if least == f64::INFINITY {
            continue;
        }
        tried += 1;
        let settings = CertificateSettings::new(0.01);
        let bound = crate::best(&problem, least, &settings, &monitor).unwrap();
        assert!(bound.bound <= least && bound.bound > 0.98 * least, "{yaw}: {} {least}", bound.bound);
    }
    assert!(tried > 1);
}

#[test]
fn what_keeps_boxes_open_is_counted() {
    let mut problem = few(leaning(five_segments(), 20.0));
    problem.criterion.weights = Weights::TOTAL;
    problem.constraints.min_inverse_condition = 0.3;
    let until = std::time::Instant::now() + std::time::Duration::from_secs(4);
    let monitor = Monitor::silent().with_deadline(Some(until));
    let bound = crate::best(&problem, 1e-4, &CertificateSettings::new(0.001), &monitor).unwrap();
    assert_eq!(bound.status, Status::TimeLimit);
    let KeepsOpen { states, unknown, undecided, by, .. } = bound.keeps_open.unwrap();
    assert!(undecided > 0 && unknown + undecided <= states, "{:?}", bound.keeps_open);
    // The wrist's share of conditioning, or conditioning itself.
    assert!(by[1] + by[2] > 0 && by.into_iter().all(|count| count <= undecided), "{by:?}");
}

#[test]
fn every_placement_is_in_a_box_to_begin_with() {
    let mut random = seeded(94);
    for yaw in [TAU, 1.0] {
        let mut problem = leaning(hanging_arm(), 20.0);
        problem.cell.yaw = Interval { min: 0.7, max: 0.7 + yaw };
        let leant = Leant::new(problem.clone());
        let model = Leaning::new(&problem, f64::INFINITY);
        let start = model.start(&whole(&problem));
        let origin = seen(&problem.task.points()[0].position, leant.side());
        let holds = |region: &Box3, at: &[f64; 3], turned: bool| {
            let off = |k: usize| at[k] - region.middle[k];
            let off = |k: usize| if turned && k == 2 { wrap(off(k)) } else { off(k) };
            (0..3).all(|k| off(k).abs() <= region.half[k] + 1e-9)
        };
        for _ in 0..300 {
            let [x, y, z] = problem.cell.position.map(|i| i.min + i.width() * 0.5 * (1.0 + share(&mut random)));
            let yaw = problem.cell.yaw.min + problem.cell.yaw.width() * 0.5 * (1.0 + share(&mut random));
            let pose = Placement { x, y, z, yaw };
            let [x, y, z, _] = leant.place(&pose, 0, 0.0);
            let at = [x - origin.x, y - origin.y, z - origin.z];
            let found = start.iter().find(|region| holds(region, &at, false)).expect("a box");
            let about = [libm::hypot(at[0], at[1]), at[2], -libm::atan2(at[1], at[0])];
            assert!(holds(&about_axis_1(found), &about, true), "{about:?}");
        }
    }
}

#[test]
fn what_is_not_covered_is_refused_by_name() {
    let problem = leaning(five_segments(), 20.0);
    assert_eq!(certifiable(&problem, MEMORY), Ok(()));
    assert!(matches!(certifiable_from_above(&problem, MEMORY), Err(Unsupported::TiltedTool { point: 0, .. })));
    assert!(matches!(certifiable(&problem, 1000), Err(Unsupported::TooLarge { .. })));
    let mut turning = problem.clone();
    let path = problem.task.path();
    let points = path.points().iter().enumerate().map(|(k, p)| {
        let other = leaning(five_segments(), 10.0 * (k % 4) as f64).task.points()[k];
        (path.segment_of(k) as u32 + 1, stead_model::task::PathPoint { axis: other.axis, feed: other.feed, ..*p })
    });
    let turned = ToolPath::new(points.collect::<Vec<_>>()).unwrap();
    turning.task = Task::new(turned, problem.task.wrenches().copied().collect()).unwrap();
    assert_eq!(certifiable(&turning, MEMORY), Err(Unsupported::ManyToolAxes { axes: 4, max: MOST_AXES }));
}
