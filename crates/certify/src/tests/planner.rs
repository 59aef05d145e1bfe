//! Steps of beta, least values of neighbours, and the sum along the path.

use super::super::active_cells::ActiveCells;
use super::super::cost::{CORNERS, PointCost, Without};
use super::super::sliding_min::{INFINITE, SlidingMin, min_into};
use super::minorants::local;
use super::*;
use crate::compliance_table::Steps;
use std::sync::Arc;
use stead_model::task::{PathPoint, ToolPath};
use stead_model::testing::some;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::beta_step::BetaStep;
use stead_problem::criterion::{Over, StiffnessSets};
use stead_problem::sense::Sense;
use stead_problem::testing::corners;

#[test]
fn windows_hold_the_least_of_their_neighbours() {
    let mut random = seeded(41);
    let count = 64;
    let some = |random: &mut ChaCha8Rng| -> Vec<u16> {
        let share = random.random_range(0..5);
        (0..count as u16).filter(|_| random.random_range(0..4) < share).collect()
    };
    let mut sliding = SlidingMin::default();
    for _ in 0..1000 {
        let (cells, targets) = (some(&mut random), some(&mut random));
        let values: Vec<[f64; CORNERS]> = cells.iter().map(|_| std::array::from_fn(|_| random.random())).collect();
        let low = random.random_range(-90..90_i32) as isize;
        let high = low + random.random_range(-1..70_i32) as isize;
        sliding.compute(&cells, &values, (low, high), count, &targets);
        assert_eq!(sliding.out.len(), targets.len());
        for (target, out) in targets.iter().zip(&sliding.out) {
            let is_near = |cell: u16| {
                (low..=high)
                    .any(|d| (isize::try_from(*target).unwrap() + d).rem_euclid(count as isize) == cell as isize)
            };
            let mut least = INFINITE;
            for (_, value) in cells.iter().zip(&values).filter(|(cell, _)| is_near(**cell)) {
                min_into(&mut least, value);
            }
            assert_eq!(*out, least);
        }
    }
}

type Change = fn(isize, isize) -> (isize, isize);

/// Steps within the rate of beta that are forbidden, between random placements' headings, at the ends of cells and of
/// the rate.
fn forbidden(setting: &Setting, change: Change, is_unsure: bool) -> usize {
    let mut random = seeded(42);
    let mut wrong = 0;
    for k in 0..4000 {
        let count = [128, 256, 1024][k % 3];
        let width = TAU / count as f64;
        let middle =
            std::array::from_fn(|k| setting.whole.middle[k] + setting.whole.half[k] * random.random_range(-0.9..0.9));
        let size = [1e-6, 0.003, 0.015][random.random_range(0..3)];
        let region = Region { middle, half: [size; 3] };
        let span = &setting.model.segments[random.random_range(0..setting.model.segments.len())];
        let point = random.random_range(span.start + 1..span.end);
        let pair: Option<Vec<Option<PointCost>>> = [point - 1, point]
            .iter()
            .map(|p| {
                let mut placed = setting.model.points[*p].over(&region)?;
                if !is_unsure {
                    (placed.slope_chi, placed.remainder_chi) = ([0.0; 2], 0.0);
                }
                Some(Some(PointCost::new(&setting.model.points[*p], placed, 1e-6)))
            })
            .collect();
        let Some(pair) = pair else { continue };
        // `steps` looks at two neighbours by their numbers.
        let mut all = vec![pair[0]; point];
        all.push(pair[1]);
        let (low, high) = setting.model.steps(&region, &all, point, width);
        let (low, high) = change(low, high);
        for _ in 0..8 {
            let s = shares(&mut random);
            let placement = std::array::from_fn(|k| region.middle[k] + s[k] * region.half[k]);
            let (before, here) = (setting.place(placement, point - 1)[2], setting.place(placement, point)[2]);
            let from = random.random_range(0..count);
            let heading = width * (from as f64 + 0.5 + share(&mut random) * 0.499_999);
            let BetaStep { middle, half } = setting.problem.beta_step(point);
            let step = setting.rotation_sign * (middle + share(&mut random) * half);
            let heading = heading - before + here + step;
            let to = (heading / width).floor() as isize;
            let steps = to - from as isize;
            wrong += usize::from(!(low..=high).any(|step| (step - steps).rem_euclid(count as isize) == 0));
        }
    }
    wrong
}

#[test]
fn no_step_within_the_rate_is_forbidden_and_broken_steps_are_seen() {
    let turning = |mut problem: Problem| {
        (problem.redundancy.max_beta_rate, problem.redundancy.max_spindle_turn) = (None, Some(9.0));
        problem
    };
    let upside_down = || {
        let (hanging, mut problem) = (hanging_arm(), corners(0.0));
        (problem.robot, problem.cell) = (hanging.robot.clone(), hanging.cell);
        problem
    };
    let spindle = [("spindle", corners(0.0)), ("spindle, hanging arm", upside_down())];
    let spindle = spindle.map(|(name, problem)| (name, Setting::new(turning(problem))));
    for (name, setting) in Setting::all().into_iter().chain(spindle) {
        assert_eq!(forbidden(&setting, |low, high| (low, high), true), 0, "{name}");
    }
    let mut turned = Setting::new(turning(upside_down()));
    turned.model.changes.iter_mut().for_each(|change| change.middle = -change.middle);
    assert!(forbidden(&turned, |low, high| (low, high), true) > 0, "the spindle turned the other way is not seen");
    let setting = Setting::new(five_segments());
    let mutations: [(&str, Change, bool); 4] = [
        ("one step up too short", |low, high| (low, high - 1), true),
        ("one step down too short", |low, high| (low + 1, high), true),
        ("heading turned the other way", |low, high| (-high, -low), true),
        ("spread of the direction over the box left out", |low, high| (low, high), false),
    ];
    for (name, change, is_unsure) in mutations {
        assert!(forbidden(&setting, change, is_unsure) > 0, "{name} is not seen");
    }
}

/// A placement near the best, whose plan is known to exist.
const GOOD: [f64; 3] = [1.6435, -0.5564, 2.24];

/// The bound of a box about it, going down the levels as the search does; and the least that the planner finds inside.
fn bound_and_value(setting: &Setting, half: [f64; 3]) -> (f64, f64, ActiveCells) {
    let region = Region { middle: good(setting), half };
    let model = &setting.model;
    let planner = Planner::finer(&setting.problem);
    let mut space = planner.workspace();
    let mut random = seeded(43);
    let mut value = f64::INFINITY;
    for _ in 0..8 {
        let s = shares(&mut random);
        let inside = std::array::from_fn(|k| region.middle[k] + s[k] * half[k]);
        if let Some(mean) = planner.objective(&setting.pose(inside, -PI / 2.0), Sense::Min, None, &mut space).mean() {
            value = value.min(model.objective.sum(mean));
        }
    }
    let level = model.level(&region).unwrap();
    let mut active = ActiveCells::full(model.points.len(), model.table.headings(0));
    let mut found = model.lower_bound(&region, &active, 1.1 * value, &Monitor::silent());
    while active.level < level {
        active = found.active.halved();
        found = model.lower_bound(&region, &active, 1.1 * value, &Monitor::silent());
    }
    (found.sum, value, found.active)
}

/// The best yaw there, by the planner.
fn good(setting: &Setting) -> [f64; 3] {
    let planner = Planner::new(&setting.problem);
    let mut space = planner.workspace();
    let at = |k: usize| [GOOD[0], GOOD[1], TAU / 60.0 * k as f64];
    let mut worth = |k: usize| {
        let pose = setting.pose(at(k), -PI / 2.0);
        planner.objective(&pose, Sense::Min, None, &mut space).mean().unwrap_or(f64::INFINITY)
    };
    let all: Vec<f64> = (0..60).map(&mut worth).collect();
    at((0..60).min_by(|a, b| all[*a].total_cmp(&all[*b])).unwrap())
}

#[test]
fn sums_along_the_path_are_below_plans_and_close() {
    let setting = Setting::new(five_segments());
    for (half, close) in [([1e-4; 3], 0.97), ([0.002; 3], 0.8), ([0.006; 3], 0.0)] {
        let (bound, value, _) = bound_and_value(&setting, half);
        assert!(value.is_finite() && bound <= value, "{bound} {value}");
        assert!(bound >= close * value, "no power: {bound} of {value}");
    }
}

#[test]
fn a_broken_sum_is_seen() {
    let half = [1e-4; 3];
    let mutations: [Breaking<Setting>; 3] = [
        ("a segment counted twice", |setting| {
            let again = setting.model.segments[2].clone();
            setting.model.segments.push(again);
        }),
        ("forces a tenth larger", |setting| {
            setting.model.points.iter_mut().for_each(|p| p.load.force = p.load.force.map(|f| 1.1 * f));
        }),
        ("joint 1 twice", |setting| Arc::make_mut(&mut setting.model.arm).joint1 *= 2.0),
    ];
    let mut last = None;
    for (name, change) in mutations {
        let mut setting = Setting::new(five_segments());
        setting.take_table(last);
        change(&mut setting);
        let (bound, value, _) = bound_and_value(&setting, half);
        assert!(bound > value, "{name} is not seen: {bound} {value}");
        last = Some(setting);
    }
}

/// The recommended criterion, and one figure or another, on the path of the paper.
fn with_criterion(change: &dyn Fn(&mut Problem)) -> Setting {
    let mut problem = five_segments();
    let limits = &mut problem.redundancy;
    (limits.max_beta_rate, limits.max_spindle_turn) = (None, Some(0.9_f64.to_radians() * 1e3));
    let criterion = &mut problem.criterion;
    (criterion.weights, criterion.force_uncertainty) = (Weights::TOTAL, 0.1);
    change(&mut problem);
    Setting::new(problem)
}

/// Two sets of stiffness, the second with joints 1 and 3 twice as soft.
fn with_sets(problem: &mut Problem, over: Over) {
    let mut soft = problem.robot.compliances_at(&[0.0; 6]);
    (soft[0], soft[2]) = (2.0 * soft[0], 2.0 * soft[2]);
    let robots = vec![problem.robot.clone(), problem.robot.with_compliances(soft).unwrap()];
    problem.criterion.stiffness = Some(StiffnessSets { robots, over });
}

/// Every third point counts for nothing.
fn partly_scored(problem: &mut Problem) {
    let path = problem.task.path();
    let point = |(k, point): (usize, &PathPoint)| (path.segment_of(k) as u32 + 1, *point, k % 3 != 0);
    let path = ToolPath::partly_scored(path.points().iter().enumerate().map(point).collect::<Vec<_>>()).unwrap();
    problem.task = Task::new(path, problem.task.wrenches().copied().collect()).unwrap();
}

#[test]
fn sums_of_every_criterion_are_below_plans_and_close() {
    type Of = (&'static str, fn(&mut Problem), f64);
    let all: [Of; 7] = [
        ("total with force errors", |_| {}, 0.97),
        ("root of the mean of squares", |problem| problem.criterion.aggregate = Aggregate::Rms, 0.95),
        ("largest", |problem| problem.criterion.aggregate = Aggregate::Max, 0.95),
        ("weights of segments", |problem| problem.criterion.segment_weights = vec![1.0, 3.0, 0.5, 1.0, 2.0], 0.97),
        ("mean over sets", |problem| with_sets(problem, Over::Mean), 0.97),
        ("worst of sets", |problem| with_sets(problem, Over::Worst), 0.97),
        ("points that are not scored", partly_scored, 0.97),
    ];
    let mut last = None;
    for (name, change, close) in some(4, all) {
        let mut setting = with_criterion(&change);
        setting.take_table(last);
        let (bound, value, _) = bound_and_value(&setting, [1e-4; 3]);
        assert!(value.is_finite() && bound <= value, "{name}: {bound} {value}");
        assert!(bound >= close * value, "{name}, no power: {bound} of {value}");
        last = Some(setting);
    }
}

#[test]
fn a_broken_criterion_is_seen() {
    type Mutation = (&'static str, fn(&mut Problem), fn(&mut Setting));
    let mutations: [Mutation; 4] = [
        ("worst of sets for their mean", |p| with_sets(p, Over::Mean), |setting| setting.model.over = Over::Worst),
        (
            "squares as they are",
            |p| p.criterion.aggregate = Aggregate::Rms,
            |setting| {
                setting.model.objective.weight = 1.0;
                setting.model.objective.aggregate = Aggregate::Mean;
            },
        ),
        ("errors twice as large", |_| {}, |s| s.model.points.iter_mut().for_each(|p| p.load.error *= 2.0)),
        ("points that are not scored scored", partly_scored, |setting| {
            let load = setting.model.points[1].load;
            setting.model.points.iter_mut().for_each(|point| point.load = load);
        }),
    ];
    let mut last = None;
    for (name, change, broken) in some(4, mutations) {
        let mut setting = with_criterion(&change);
        setting.take_table(last);
        let truth = bound_and_value(&setting, [1e-4; 3]).1;
        broken(&mut setting);
        let bound = bound_and_value(&setting, [1e-4; 3]).0;
        assert!(bound > truth, "{name} is not seen: {bound} {truth}");
        last = Some(setting);
    }
}

/// Without remainders, and without the width of cells of heading, a box comes to more, and a small one to no more than
/// it is worth.
#[test]
fn what_takes_a_bound_down_is_told_apart() {
    let setting = Setting::new(slanted());
    let model = &setting.model;
    let at = good(&setting);
    let sums = |half: [f64; 3]| {
        let region = Region { middle: at, half };
        let level = model.level(&region).unwrap();
        let mut active = ActiveCells::full(model.points.len(), model.table.headings(0));
        (0..level).for_each(|_| active = active.halved());
        [Without::Nothing, Without::Remainders, Without::Headings]
            .map(|without| model.lower_bound_without(without, &region, &active, f64::INFINITY, &Monitor::silent()).sum)
    };
    let [bound, models, headings] = sums([0.002, 0.002, 0.004]);
    assert!(1.001 * bound < models && 1.001 * models < headings, "{bound} {models} {headings}");
    let [bound, models, headings] = sums([1e-5; 3]);
    assert!(bound < models && models < headings && headings < 1.02 * bound, "{bound} {models} {headings}");
}

#[test]
fn boxes_that_tables_do_not_answer_for_are_never_infeasible() {
    let setting = Setting::new(five_segments());
    let at = good(&setting);
    let full = |model: &Model| ActiveCells::full(105, model.table.headings(0));
    // Too large for the coarsest level.
    let wide = Region { middle: at, half: [0.3, 0.0, 0.0] };
    let found = setting.model.lower_bound(&wide, &full(&setting.model), f64::INFINITY, &Monitor::silent());
    assert_eq!(found.sum, 0.0);
    assert_eq!(found.active, full(&setting.model));
    // Outside a table, on every side.
    let steps = Steps { length: 0.025, headings: 128 };
    for (radius, height) in
        [((0.5, 0.9), (-0.7, 0.0)), ((3.0, 3.4), (-0.7, 0.0)), ((1.2, 2.4), (1.0, 2.0)), ((1.2, 2.4), (-4.0, -3.0))]
    {
        let model = local(&setting, radius, height, steps, 1);
        let region = Region { middle: at, half: [1e-3; 3] };
        let found = model.lower_bound(&region, &full(&model), f64::INFINITY, &Monitor::silent());
        assert_eq!(found.sum, 0.0);
        assert_eq!(found.active, full(&model));
    }
    // About axis 1.
    let region = Region { middle: [0.1, -0.5, 0.0], half: [0.1, 0.01, 3.0] };
    assert_eq!(setting.model.lower_bound(&region, &full(&setting.model), f64::INFINITY, &Monitor::silent()).sum, 0.0);
}
