//! What is chosen of several refined basins, and of several plans that are as good.

use super::{Over, small, with_first_springs};
use crate::outcome::Case;
use crate::place::{place, score};
use nalgebra::Vector3;
use stead_model::robot::{Joint, Robot};
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_numerics::monitor::Monitor;
use stead_problem::postures::PostureRules;
use stead_problem::problem::{Interval, Placement, Problem};
use stead_problem::settings::TransferSettings;
use stead_problem::settings::{LookupUse, SearchSettings};
use stead_problem::testing::five_segments;

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

/// Ten lines there and back, each a segment, at a given placement.
fn zigzag(placement: &Placement) -> Problem {
    let mut problem = five_segments();
    let joints = problem.robot.joints().clone().map(|joint| Joint { max_speed: Some(1.5), ..joint });
    problem.robot = Robot::new("timed", joints).unwrap();
    let (first, wrench) = (problem.task.points()[0], problem.task.loads()[0].wrench);
    let side = |line: u32| if line.is_multiple_of(2) { 1.0 } else { -1.0 };
    let line = |line: u32| {
        (0..6).map(move |k| {
            let along = if line.is_multiple_of(2) { k } else { 5 - k };
            let position = Vector3::new(0.02 * f64::from(along), 0.01 * f64::from(line), 0.0);
            (line + 1, PathPoint { position, feed: Vector3::x() * side(line), ..first })
        })
    };
    let path = ToolPath::new((0..10).flat_map(line).collect::<Vec<_>>()).unwrap();
    let wrenches = (0..60).map(|k| Wrench { force: wrench.force * side(k / 6), ..wrench });
    problem.task = Task::new(path, wrenches.collect()).unwrap();
    problem.redundancy.beta_count = 60;
    let fixed = |value: f64| Interval { min: value, max: value };
    problem.cell.position = [fixed(placement.x), fixed(placement.y), fixed(placement.z)];
    problem.cell.yaw = fixed(placement.yaw);
    problem
}

#[test]
fn a_tie_changes_the_plans_that_are_stated_and_nothing_else() {
    let (transfer, silent) = (TransferSettings::default(), Monitor::silent());
    let mut moved = [0.0; 3];
    for k in 0..6 {
        let placement = Placement::from([-0.1, -1.9 + 0.05 * f64::from(k), -0.4, 0.9 * f64::from(k)]);
        let run = |tie: f64| {
            let problem = zigzag(&placement).with(|parts| parts.postures = PostureRules { tie, ..PostureRules::NONE });
            let outcome = place(&problem, &small(), &transfer, &silent).ok()?;
            let score = score(&problem, &outcome.cases.best.placement, &transfer, &silent).unwrap();
            let cases = &outcome.cases;
            assert_eq!([&cases.best.plan, &cases.best_worst_plan.plan], [&score.plans.best, &score.plans.worst]);
            Some(outcome)
        };
        let Some(free) = run(0.0) else { continue };
        moved[0] += moves(&free.cases.best);
        for (tie, moved) in [PostureRules::default().tie, 0.05].into_iter().zip(&mut moved[1..]) {
            let tied = run(tie).unwrap();
            assert_eq!(free.refinements, tied.refinements);
            for (free, tied) in free.cases.all().into_iter().zip(tied.cases.all()) {
                assert_eq!(free.placement, tied.placement);
                let (free, tied) = (free.plan.objective, tied.plan.objective);
                assert!((tied / free - 1.0).abs() <= tie * (1.0 + 1e-6), "{free} {tied}");
            }
            *moved += moves(&tied.cases.best);
        }
    }
    // Moves get shorter, with 5 % by more than a radian.
    assert!(moved.is_sorted_by(|a, b| *a >= *b - 1e-5) && moved[2] < moved[0] - 1.0, "{moved:?}");
}

/// The largest joint travel of every move, all together; every joint of this arm is as fast. rad
fn moves(case: &Case) -> f64 {
    case.cycle.transfers.iter().map(|transfer| transfer.travel).sum()
}
