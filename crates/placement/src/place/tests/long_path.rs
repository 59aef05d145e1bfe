//! Paths that are searched on subsets of their points.

use crate::outcome::{Case, Outcome};
use crate::path_subset::PathSubset;
use crate::place::{place, score};
use nalgebra::Vector3;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_model::testing::{is_all, some};
use stead_numerics::monitor::{Monitor, Progress};
use stead_problem::criterion::{Aggregate, Weights};
use stead_problem::problem::{Cell, Interval, Placement, Problem};
use stead_problem::settings::TransferSettings;
use stead_problem::settings::{LookupUse, SearchSettings};
use stead_problem::testing::five_segments;

/// Points between neighbours of the five segments, and their number then.
const PARTS: usize = 7;
/// See [`PARTS`].
const POINTS: usize = 5 * (20 * PARTS + 1);

/// The five segments with more points, in a part of their cell.
fn dense() -> Problem {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 24;
    problem.cell.position[0] = Interval { min: 0.0, max: 0.1 };
    problem.cell.position[1] = Interval { min: -1.9, max: -1.64 };
    problem.cell.yaw = Interval { min: 2.0, max: 2.6 };
    let task = problem.task.clone();
    let (mut points, mut wrenches) = (Vec::new(), Vec::new());
    for (segment, span) in task.segments().iter().enumerate() {
        for step in 0..=(span.len() - 1) * PARTS {
            let from = span.start + step / PARTS;
            let (to, share) = ((from + 1).min(span.end - 1), (step % PARTS) as f64 / PARTS as f64);
            let mixed = |a: Vector3<f64>, b: Vector3<f64>| a + (b - a) * share;
            let (a, b) = (task.points()[from], task.points()[to]);
            let position = mixed(a.position, b.position);
            points.push((segment as u32 + 1, PathPoint { position, feed: mixed(a.feed, b.feed).normalize(), ..a }));
            let force = mixed(task.loads()[from].wrench.force, task.loads()[to].wrench.force);
            wrenches.push(Wrench { force, moment: Vector3::zeros() });
        }
    }
    assert_eq!(points.len(), POINTS);
    problem.task = Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap();
    problem
}

/// The problem with a moment (N m) about the feed at ten points.
fn with_moment(mut problem: Problem, first: usize, moment: f64) -> Problem {
    let mut wrenches: Vec<_> = problem.task.wrenches().copied().collect();
    for point in first..first + 10 {
        wrenches[point].moment = problem.task.points()[point].feed * moment;
    }
    problem.task = Task::new(problem.task.path().clone(), wrenches).unwrap();
    problem
}

fn settings() -> SearchSettings {
    SearchSettings { population: 16, generations: 6, basins: 1, tables: LookupUse::Never, ..SearchSettings::default() }
}

fn placed(problem: &Problem, settings: &SearchSettings) -> Outcome {
    place(problem, settings, &TransferSettings::default(), &Monitor::silent()).unwrap()
}

/// The residual costs as much as many plans: it is stated of what was taken.
#[test]
fn residuals_are_stated_of_what_was_taken_alone() {
    let outcome = placed(&dense(), &SearchSettings { basins: 3, ..settings() });
    for case in outcome.cases.optima() {
        let of_sense = outcome.refinements.iter().filter(|refinement| refinement.sense == case.placement_sense);
        let known: Vec<_> = of_sense.filter(|refinement| refinement.kkt_residual.is_some()).collect();
        assert_eq!(known.len(), 1, "{:?}", outcome.refinements);
        assert!((known[0].end_mean / case.plan.objective - 1.0).abs() < 1e-3, "{known:?}");
    }
}

/// Every case covers all points, and the placement alone is scored as case 1.
fn assert_whole(problem: &Problem, outcome: &Outcome) {
    let points = problem.task.points().len();
    for case in outcome.cases.all() {
        assert_eq!(case.plan.points.len(), points);
        assert!(case.plan.points.iter().enumerate().all(|(k, point)| point.point == k));
    }
    let best = &outcome.cases.best;
    let scored = score(problem, &best.placement, &TransferSettings::default(), &Monitor::silent()).unwrap();
    let (stated, scored) = (best.plan.objective, scored.plans.best.objective);
    assert!((stated / scored - 1.0).abs() < 1e-9, "{stated} {scored}");
}

/// The best placement is as good as without subsets, to 0.5 %.
fn assert_as_good_as_without_subsets(problem: &Problem, outcome: &Outcome) {
    let points = problem.task.points().len();
    let all = placed(problem, &SearchSettings { path_points: Some(points), ..settings() });
    assert_eq!(all.path_levels, None);
    let best = |outcome: &Outcome| outcome.cases.best.plan.objective;
    assert!(best(outcome) <= best(&all) * 1.005, "{} {}", best(outcome), best(&all));
}

#[test]
fn a_long_path_gives_the_same_result_for_any_number_of_threads() {
    let problem = dense();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| placed(&problem, &settings()))
    };
    let one = run(1);
    assert_eq!([&run(2), &run(5)], [&one, &one]);
}

#[test]
fn subsets_cost_less_than_half_a_per_cent_and_what_is_stated_covers_the_whole_path() {
    let problem = dense();
    let outcome = placed(&problem, &settings());
    let levels = outcome.path_levels.unwrap();
    let (search, refinement) = (levels.search, levels.refinement);
    assert!(levels.points == POINTS && (60..=65).contains(&search.points), "{levels:?}");
    assert!(search.points < refinement.points && refinement.points < POINTS && levels.whole >= 39, "{levels:?}");
    assert!(search.error.unwrap() < 0.05 && refinement.error.unwrap() < 0.015, "{levels:?}");
    assert!(outcome.cases.best.plan.objective < outcome.cases.optima()[1].plan.objective);
    assert_whole(&problem, &outcome);
    assert_as_good_as_without_subsets(&problem, &outcome);
    if !is_all() {
        return;
    }
    assert_whole(&problem, &placed(&problem, &SearchSettings { tables: LookupUse::Auto, ..settings() }));
    let alone = placed(&problem, &SearchSettings { worst: false, ..settings() });
    assert!(alone.cases.worst.is_none());
    assert_as_good_as_without_subsets(&problem, &alone);
}

#[test]
fn other_figures_of_a_long_path_are_searched_on_subsets_too() {
    for (aggregate, weights) in some(2, [(Aggregate::Rms, Weights::TOTAL), (Aggregate::Max, Weights::WALL)]) {
        let mut problem = dense();
        problem.criterion.aggregate = aggregate;
        problem.criterion.weights = weights;
        problem.criterion.segment_weights = vec![1.0, 2.0, 0.5, 1.0, 3.0];
        let outcome = placed(&problem, &settings());
        assert!(outcome.path_levels.is_some());
        assert_whole(&problem, &outcome);
        assert_as_good_as_without_subsets(&problem, &outcome);
    }
}

/// The first of ten neighbours that neither a subset of so many points nor one three times as large has.
fn unseen(problem: &Problem, count: usize) -> usize {
    let has = |count: usize, first: usize| {
        PathSubset::new(&problem.task, count).points().iter().any(|point| (first..first + 10).contains(point))
    };
    (0..POINTS - 10).find(|first| !has(count, *first) && !has(3 * count, *first)).unwrap()
}

#[test]
fn ten_points_that_no_subset_has_forbid_placements() {
    let mut problem = dense();
    problem.criterion.weights = Weights::TOTAL;
    let requested = SearchSettings { path_points: Some(15), ..settings() };
    let first = unseen(&problem, 15);
    let free = placed(&problem, &requested);
    // What the ten points allow is not where the others would have the workpiece.
    let mut problem = with_moment(problem, first, 20_000.0);
    let at = |placement: &Placement| {
        let scored = score(&problem, placement, &TransferSettings::default(), &Monitor::silent()).ok()?;
        Some(scored.plans.best.points[first..first + 10].iter().map(|point| point.score).fold(0.0, f64::max))
    };
    let corner = |k: usize| {
        let end = |axis: usize, bounds: &Interval| if k >> axis & 1 == 0 { bounds.min } else { bounds.max };
        let Cell { position: [x, y, z], yaw } = &problem.cell;
        Placement { x: end(0, x), y: end(1, y), z: end(2, z), yaw: end(3, yaw) }
    };
    let least = (0..16).filter_map(|k| at(&corner(k))).fold(f64::INFINITY, f64::min);
    let limit = 0.3 * least + 0.7 * at(&free.cases.best.placement).unwrap();
    problem.constraints.max_deflection = Some(limit);
    let outcome = placed(&problem, &requested);
    assert!(outcome.path_levels.unwrap().deciding > 0, "{:?}", outcome.path_levels);
    let largest = |case: &Case| case.plan.points.iter().map(|point| point.score).fold(0.0, f64::max);
    assert!(largest(&outcome.cases.best) <= limit * (1.0 + 1e-9));
    assert_whole(&problem, &outcome);
    assert_as_good_as_without_subsets(&problem, &outcome);
}

#[test]
fn ten_points_that_no_subset_has_cost_more_than_all_others() {
    let problem = dense();
    let first = (0..POINTS - 10)
        .find(|first| PathSubset::new(&problem.task, 65).points().iter().all(|p| !(*first..first + 10).contains(p)));
    let problem = with_moment(problem, first.unwrap(), 3000.0);
    let outcome = placed(&problem, &settings());
    assert_whole(&problem, &outcome);
    assert_as_good_as_without_subsets(&problem, &outcome);
}

#[test]
fn a_long_path_that_is_stopped_is_planned_whole() {
    let problem = dense();
    // While the subsets are measured, in the search, and while basins are refined.
    for stage in some(2, ["long path", "best placement", "refining", "worst placement"]) {
        let seen = std::sync::Arc::new(AtomicUsize::new(0));
        let silent = Monitor::silent();
        let (stop, counted) = (silent.stop_handle(), seen.clone());
        let observer = move |progress: &Progress| {
            let (Progress::Search { stage: now, .. } | Progress::Steps { stage: now, .. }) = progress else { return };
            if *now == stage && counted.fetch_add(1, Ordering::Relaxed) == 0 {
                stop.stop();
            }
        };
        let monitor = Monitor::new(observer).with_stop(silent.stop_handle());
        let outcome = place(&problem, &settings(), &TransferSettings::default(), &monitor).unwrap();
        assert!(outcome.interrupted && seen.load(Ordering::Relaxed) > 0, "{stage}");
        assert_whole(&problem, &outcome);
    }
}
