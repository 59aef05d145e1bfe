//! What is chosen of several refined basins, and of several plans that are as good.

use super::{Over, small, with_first_springs};
use crate::outcome::Case;
use crate::place::{Score, place, score};
use crate::postures::PostureRules;
use crate::problem::{Placement, Problem};
use crate::settings::{LookupUse, SearchSettings, TransferSettings};
use crate::testing::five_segments;
use nalgebra::Vector3;
use stead_model::robot::{Joint, Robot};
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_numerics::monitor::Monitor;

#[test]
fn of_the_refined_basins_the_one_of_least_regret_is_taken() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 40;
    let settings = SearchSettings { tables: LookupUse::Never, population: 24, generations: 8, basins: 4, ..small() };
    let run = |over: Over| {
        let problem = with_first_springs(&problem, &[1.0, 0.3, 0.05], over);
        place(&problem, &settings, &TransferSettings::default(), &Monitor::silent()).unwrap()
    };
    let (by_mean, by_regret) = (run(Over::Mean), run(Over::Regret));
    assert_eq!(by_mean.set_basins, by_regret.set_basins);
    let basins = &by_regret.set_basins;
    let taken = |best: &Placement| basins.iter().find(|basin| basin.placement == *best).unwrap();
    let [least_mean, least_regret] = [&by_mean, &by_regret].map(|outcome| taken(&outcome.cases.best.placement));
    assert!(basins.iter().all(|basin| least_regret.regret.unwrap() <= basin.regret.unwrap() * (1.0 + 1e-5)));
    assert!(basins.iter().all(|basin| least_mean.objective <= basin.objective * (1.0 + 1e-5)));
    // What is stated of the sets is the regret that decided.
    let stated = by_regret.sets.iter().filter_map(|set| set.regret()).reduce(f64::max);
    assert!((stated.unwrap() - least_regret.regret.unwrap()).abs() < 1e-9, "{stated:?} {least_regret:?}");
    assert!(least_regret.regret < least_mean.regret, "the two choices are the same: {basins:?}");
}

/// A raster of 12 lines there and back, each a segment; the force is against the feed and to its right.
fn raster() -> Problem {
    let mut problem = five_segments();
    let joints = problem.robot.joints().clone().map(|joint| Joint { max_speed: Some(1.5), ..joint });
    problem.robot = Robot::new("timed", joints).unwrap();
    let first = problem.task.points()[0];
    let side = |line: u32| if line.is_multiple_of(2) { 1.0 } else { -1.0 };
    let line = |line: u32| {
        (0..8).map(move |k| {
            let along = if line.is_multiple_of(2) { k } else { 7 - k };
            let position = Vector3::new(0.02 * f64::from(along), 0.01 * f64::from(line), 0.0);
            (line + 1, PathPoint { position, feed: Vector3::x() * side(line), ..first })
        })
    };
    let wrench = |k: u32| {
        let force = Vector3::new(-120.0 * side(k / 8), -80.0 * side(k / 8), -40.0);
        Wrench { force, moment: Vector3::zeros() }
    };
    let path = ToolPath::new((0..12).flat_map(line).collect::<Vec<_>>()).unwrap();
    problem.task = Task::new(path, (0..96).map(wrench).collect()).unwrap();
    problem.redundancy.beta_count = 60;
    problem
}

#[test]
fn a_tie_changes_the_plans_that_are_stated_and_nothing_else() {
    let mut problem = raster();
    let (transfer, silent) = (TransferSettings::default(), Monitor::silent());
    let settings = SearchSettings { population: 16, generations: 3, ..small() };
    let mut run = |postures: PostureRules| {
        problem.postures = postures;
        let outcome = place(&problem, &settings, &transfer, &silent).unwrap();
        let Score { best: again, worst, .. } =
            score(&problem, &outcome.cases.best.placement, &transfer, &silent).unwrap();
        assert_eq!([&outcome.cases.best.plan, &outcome.cases.best_worst_plan.plan], [&again, &worst]);
        outcome
    };
    let free = run(PostureRules::NONE);
    let mut moved = vec![moves(&free.cases.best)];
    for tie in [PostureRules::default().tie, 0.1] {
        let tied = run(PostureRules { tie, ..PostureRules::NONE });
        assert_eq!(free.refinements, tied.refinements);
        for (free, tied) in free.cases.all().into_iter().zip(tied.cases.all()) {
            assert_eq!(free.placement, tied.placement);
            let (free, tied) = (free.plan.objective, tied.plan.objective);
            assert!((tied / free - 1.0).abs() <= tie * (1.0 + 1e-6), "{free} {tied}");
        }
        moved.push(moves(&tied.cases.best));
    }
    assert!(moved.is_sorted_by(|a, b| *a >= *b - 1e-5) && moved[2] < moved[0] - 0.1, "{moved:?}");
}

/// The largest joint travel of every move, all together; every joint of this arm is as fast. rad
fn moves(case: &Case) -> f64 {
    case.cycle.transfers.iter().map(|transfer| transfer.travel).sum()
}
