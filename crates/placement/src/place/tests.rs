//! The job as a whole: cases, refusals, stopping, and how the mean of a plan errs.

use super::*;
use crate::evaluator::Evaluator;
use crate::lookup::LookupTable;
use crate::outcome::{Case, Plan, PlanPoint};
use crate::search;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_model::robot::angles::yaw_from_q4;
use stead_model::testing;
use stead_planning::redundancy::Planner;
use stead_problem::criterion::{Over, StiffnessSets, Weights};
use stead_problem::problem::{Cell, Interval, Placement};
use stead_problem::sense::Sense;
use stead_problem::settings::{LookupUse, PostureSearch};
use stead_problem::symmetry::Unsupported;
use stead_problem::testing::{five_segments, with_uncertainty};

mod choice;
mod following;
mod held_feed;
mod long_path;
mod setup;
pub(crate) mod whole_arm;

fn small() -> SearchSettings {
    SearchSettings { population: 16, generations: 4, basins: 1, ..SearchSettings::default() }
}

#[test]
fn four_cases_are_ordered_and_complete() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 40;
    for postures in [PostureSearch::Exact, PostureSearch::Genetic] {
        // A random scheme is rarely feasible, so the published way needs more candidates to find any.
        let population = if postures == PostureSearch::Genetic { 80 } else { 16 };
        let settings = SearchSettings { postures, population, ..small() };
        let outcome = place(&problem, &settings, &TransferSettings::default(), &Monitor::silent()).unwrap();
        let cases = outcome.cases.all();
        let means: Vec<f64> = cases.iter().map(|case| case.plan.mean).collect();
        assert_eq!(cases.iter().map(|case| case.number()).collect::<Vec<_>>(), [1, 2, 3, 4]);
        assert!(means[0] <= means[1] && means[2] <= means[3] && means[0] <= means[2], "{means:?}");
        assert!(cases.iter().all(|c| c.plan.points.len() == 105 && c.plan.postures.len() == 5));
        assert_eq!(outcome.cases.best.placement, outcome.cases.best_worst_plan.placement);
        assert!(outcome.refinements.iter().all(|r| match r.sense {
            Sense::Min => r.end_mean <= r.start_mean,
            Sense::Max => r.end_mean >= r.start_mean,
        }));
        assert!(!outcome.interrupted);
    }
}

/// The best placement is what it is beside the worst one, bit for bit; all else that is stated of the worst is left
/// out.
#[test]
fn the_best_placement_is_found_without_the_worst() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 36;
    let both = place(&problem, &small(), &TransferSettings::default(), &Monitor::silent()).unwrap();
    let alone = SearchSettings { worst: false, ..small() };
    let mut alone = place(&problem, &alone, &TransferSettings::default(), &Monitor::silent()).unwrap();
    assert_eq!((&alone.cases.best, &alone.cases.best_worst_plan), (&both.cases.best, &both.cases.best_worst_plan));
    assert!(alone.cases.worst.is_none() && alone.cases.all().len() == 2 && alone.evaluations < both.evaluations);
    assert!(alone.convergence.iter().all(|generation| generation.sense == Sense::Min));
    assert!(alone.refinements.iter().all(|refinement| refinement.sense == Sense::Min));
    assert!(alone.notes.iter().any(|note| note.starts_with("the worst placement was not looked for")));
    assert!(both.notes.iter().all(|note| !note.contains("not looked for")));
    alone.map(&problem, &Monitor::silent());
    assert_eq!(alone.maps.unwrap().len(), 1);
}

#[test]
fn a_cell_out_of_reach_says_why() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 24;
    problem.cell.position[1] = stead_problem::problem::Interval { min: -6.0, max: -5.0 };
    let nothing = place(&problem, &small(), &TransferSettings::default(), &Monitor::silent()).unwrap_err();
    assert!(nothing.searched && !nothing.findings.is_empty());
    assert!(nothing.to_string().contains("beyond the stretched arm"), "{nothing}");
}

#[test]
fn a_table_is_used_where_the_task_allows_it_and_finds_what_the_planner_finds() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 40;
    let run = |problem: &Problem, tables: LookupUse| {
        let settings = SearchSettings { tables, population: 24, generations: 8, basins: 2, ..small() };
        place(problem, &settings, &TransferSettings::default(), &Monitor::silent()).unwrap()
    };
    let (with, without) = (run(&problem, LookupUse::Auto), run(&problem, LookupUse::Never));
    assert!(
        matches!(with.lookup_summary, Some(Ok(lookup_summary)) if lookup_summary.accuracy.rms < 1e-3),
        "{:?}",
        with.lookup_summary
    );
    assert_eq!(without.lookup_summary, None);
    // The reference evaluator has the last word, and the table never costs more than it finds.
    assert!(with.cases.best.plan.mean <= without.cases.best.plan.mean * 1.001);
    assert!(with.cases.optima()[1].plan.mean >= without.cases.optima()[1].plan.mean * 0.999);
    let mut wrenches: Vec<_> = problem.task.wrenches().copied().collect();
    wrenches[3].moment.x = 0.5;
    let task = stead_model::task::Task::new(problem.task.path().clone(), wrenches).unwrap();
    let twisted = problem.clone().with(|parts| parts.task = task);
    assert!(matches!(run(&twisted, LookupUse::Auto).lookup_summary, Some(Ok(_))));
    problem.criterion.joint_travel_weight = 1e-6;
    assert_eq!(run(&problem, LookupUse::Auto).lookup_summary, Some(Err(Unsupported::JointTravel)));
}

#[test]
fn a_search_notices_that_its_table_misleads() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 40;
    let sound = LookupTable::new(&problem).unwrap();
    // A table that knows nothing of a third of the force.
    let weaker = problem.task.wrenches().map(|w| stead_model::task::Wrench { force: w.force / 1.5, ..*w });
    let weaker = stead_model::task::Task::new(problem.task.path().clone(), weaker.collect()).unwrap();
    let weaker = problem.clone().with(|parts| parts.task = weaker);
    let wrong = LookupTable::new(&weaker).unwrap();
    let planner = Planner::new(&problem);
    let is_rejected = |table: Option<&LookupTable<'_>>| {
        let found = search::search(&Evaluator::new(&planner, table), &small(), Sense::Min, &Monitor::silent());
        assert_eq!(found.basins[0].objective.mean(), {
            let (placement, scheme) = (&found.basins[0].placement, found.basins[0].scheme.as_deref());
            planner.objective(placement, Sense::Min, scheme, &mut planner.workspace()).mean()
        });
        found.lookup_rejected
    };
    assert_eq!([is_rejected(None), is_rejected(Some(&sound)), is_rejected(Some(&wrong))], [false, false, true]);
}

#[test]
fn stopping_early_still_returns_a_result() {
    let stopped = Monitor::silent();
    stopped.stop_handle().stop();
    let mut problem = five_segments();
    problem.redundancy.beta_count = 24;
    let outcome = place(&problem, &small(), &TransferSettings::default(), &stopped).unwrap();
    assert!(outcome.interrupted && outcome.refinements.is_empty());
    // Of two populations of 16 the search stops at the first that is feasible; nothing else is planned to rank them.
    assert!((2..=32).contains(&outcome.evaluations), "{}", outcome.evaluations);
    let mean = |case: &Case| case.plan.mean;
    let [best, best_worst_plan, worst, _] = outcome.cases.all()[..] else { panic!("four cases") };
    assert!(mean(best) <= mean(best_worst_plan) && mean(best) <= mean(worst) * (1.0 + 1e-9));
    assert_eq!(best.plan.points.len(), 105);
}

/// Mean of |normal part| over a plan, with other compliances.
fn mean_with(problem: &Problem, placement: &Placement, plan: &Plan, compliances: [f64; 6]) -> f64 {
    let problem = problem.clone().with(|parts| parts.robot = problem.robot.with_compliances(compliances).unwrap());
    let normal_part = |p: &PlanPoint| problem.at(placement).state(p.point, p.beta, p.posture).unwrap().normal_part;
    plan.points.iter().map(|p| normal_part(p).abs()).sum::<f64>() / plan.points.len() as f64
}

fn published_optimum() -> Placement {
    [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)].into()
}

fn scored_at_published_optimum(problem: &Problem) -> Score {
    score(problem, &published_optimum(), &TransferSettings::default(), &Monitor::silent()).unwrap()
}

#[test]
fn the_mean_errs_as_all_its_points_together() {
    let mut problem = with_uncertainty(five_segments(), 0.1);
    problem.redundancy.beta_count = 40;
    let scored = scored_at_published_optimum(&problem);
    let nominal = problem.robot.constant_compliances().unwrap();
    for plan in [&scored.plans.best, &scored.plans.worst] {
        // The mean moved along each independent error; small steps, so that no normal part changes its sign.
        let h = 1e-4;
        let changes = problem.robot.uncertainty().unwrap().directions().iter().map(|direction| {
            let at = |h: f64| std::array::from_fn(|j| nominal[j] + h * direction[j]);
            let placement = published_optimum();
            (mean_with(&problem, &placement, plan, at(h)) - mean_with(&problem, &placement, plan, at(-h))) / (2.0 * h)
        });
        let expected = libm::sqrt(changes.map(|change| change * change).sum());
        let found = plan.mean_deviation.unwrap();
        assert!((found / expected - 1.0).abs() < 1e-7, "{found} {expected}");
        // Points err together: far more than independent ones would, and no more than fully correlated ones.
        let deviations = || plan.points.iter().map(|p| p.deviation.unwrap());
        let count = plan.points.len() as f64;
        assert!(found <= deviations().sum::<f64>() / count);
        assert!(found > 3.0 * libm::sqrt(deviations().map(|d| d * d).sum()) / count);
    }
}

#[test]
fn score_agrees_with_the_prototype() {
    let problem = five_segments();
    let scored = scored_at_published_optimum(&problem);
    assert!((scored.plans.best.mean * 1e3 / 0.5357 - 1.0).abs() < 0.01);
    assert!((scored.plans.worst.mean * 1e3 / 0.594 - 1.0).abs() < 0.01);
}

/// A problem drawn by number: its cell, its arm's speeds, and its rate of beta against the spacing of its points.
fn drawn(number: u64) -> Problem {
    let mut random = ChaCha8Rng::seed_from_u64(number);
    let mut problem = five_segments();
    problem.redundancy.beta_count = [18, 24, 36][random.random_range(0..3)];
    // From a quarter of a step of the grid between neighbours to four steps.
    let spacing = problem.step_length(1);
    let steps = [0.25, 0.6, 1.0, 1.7, 4.0][random.random_range(0..5)];
    problem.redundancy.max_beta_rate = Some(steps * problem.redundancy.beta_step() / spacing);
    let speed = random.random_range(0.02..0.6);
    let joints =
        problem.robot.joints().clone().map(|joint| stead_model::robot::Joint { max_speed: Some(speed), ..joint });
    problem.robot = stead_model::robot::Robot::new("drawn", joints).unwrap();
    problem.constraints.min_inverse_condition = random.random_range(0.1..0.25);
    problem.cell = Cell::at(&Placement {
        x: random.random_range(-0.4..0.4),
        y: random.random_range(-2.5..-1.4),
        z: random.random_range(-0.9..0.6),
        yaw: random.random_range(-3.1..3.1),
    });
    problem
}

#[test]
fn what_score_finds_feasible_place_finds_in_a_pinned_cell() {
    let (mut feasible, all) = (0, testing::tried(60));
    for number in 0..all as u64 {
        let problem = drawn(number);
        let placement = problem.cell.pinned().unwrap();
        let (transfer, silent) = (TransferSettings::default(), Monitor::silent());
        let scored = score(&problem, &placement, &transfer, &silent);
        let placed = place(&problem, &small(), &transfer, &silent);
        match (scored, placed) {
            (Ok(scored), Ok(placed)) => {
                feasible += 1;
                assert_eq!(placed.evaluations, 1);
                assert_eq!(placed.cases.best.placement, placement);
                let difference = (placed.cases.best.plan.mean - scored.plans.best.mean).abs();
                assert!(difference < 1e-9 * 1e-3 + 1e-10, "{number}: {difference}");
            }
            (Err(scored), Err(placed)) => assert_eq!(scored.findings, placed.findings),
            (scored, placed) => panic!("{number}: {} {}", scored.is_ok(), placed.is_ok()),
        }
    }
    // From 10 up to 54 of 60.
    assert!((10 * all..55 * all).contains(&(60 * feasible)), "{feasible} of {all}");
}

#[test]
fn score_agrees_with_place_at_every_placement() {
    for (number, weights) in testing::some(3, [(0, Weights::WALL), (1, Weights::TOTAL), (2, Weights::AXIS)]) {
        let mut problem = five_segments();
        problem.redundancy.beta_count = 36;
        problem.criterion.weights = weights;
        let settings = SearchSettings { seed: number, ..small() };
        let (transfer, silent) = (TransferSettings::default(), Monitor::silent());
        let placed = place(&problem, &settings, &transfer, &silent).unwrap().cases;
        for plans in placed.all().chunks(2) {
            let [best, worst] = *plans else { panic!("two plans of each placement") };
            let scored = score(&problem, &best.placement, &transfer, &silent).unwrap();
            for (case, plan) in [(best, &scored.plans.best), (worst, &scored.plans.worst)] {
                // To the digits of the files, in mm.
                let printed = |mean: f64| (mean * 1e10).round();
                assert_eq!(printed(case.plan.mean), printed(plan.mean), "{weights:?} case {}", case.number());
            }
        }
    }
}

#[test]
fn a_coarse_grid_does_not_refuse_what_is_feasible() {
    let (transfer, silent) = (TransferSettings::default(), Monitor::silent());
    let mut met = 0;
    for number in 0..testing::tried(120) as u64 {
        let mut problem = drawn(number);
        problem.redundancy.beta_count = 6;
        let placement = problem.cell.pinned().unwrap();
        let coarse = Planner::new(&problem);
        let is_refused = coarse.objective(&placement, Sense::Min, None, &mut coarse.workspace()).mean().is_none();
        if !is_refused || score(&problem, &placement, &transfer, &silent).is_err() {
            continue;
        }
        met += 1;
        // A cell that leaves a tenth of a millimetre around it.
        for bounds in &mut problem.cell.position {
            *bounds = Interval { min: bounds.min - 5e-5, max: bounds.max + 5e-5 };
        }
        let outcome = place(&problem, &SearchSettings { population: 4, generations: 1, ..small() }, &transfer, &silent);
        assert!(outcome.is_ok(), "{number}: {}", outcome.unwrap_err());
    }
    assert!(met > 0);
}

/// Stiffness sets of the paper's arm with other springs at joint 1.
fn with_first_springs(problem: &Problem, factors: &[f64], over: Over) -> Problem {
    let compliances = problem.robot.constant_compliances().unwrap();
    let robot = |factor: &f64| {
        let mut compliances = compliances;
        compliances[0] *= factor;
        problem.robot.with_compliances(compliances).unwrap()
    };
    let mut problem = problem.clone();
    problem.criterion.stiffness = Some(StiffnessSets { robots: factors.iter().map(robot).collect(), over });
    problem
}

#[test]
fn the_worst_over_sets_is_never_above_the_plain_placements_and_one_set_gives_the_plain_answer() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 40;
    let (transfer, silent) = (TransferSettings::default(), Monitor::silent());
    let settings = SearchSettings { tables: LookupUse::Never, population: 24, generations: 8, ..small() };
    let plain = place(&problem, &settings, &transfer, &silent).unwrap();
    for over in [Over::Mean, Over::Worst] {
        let one = place(&with_first_springs(&problem, &[1.0], over), &settings, &transfer, &silent).unwrap();
        assert_eq!(one.cases, plain.cases);
        assert_eq!(one.sets.len(), 1);
        assert!((one.sets[0].mean - plain.cases.best.plan.mean).abs() < 1e-15);
    }
    let several = with_first_springs(&problem, &[1.0, 0.3, 0.05], Over::Worst);
    let worst = place(&several, &settings, &transfer, &silent).unwrap();
    // One plan has to do for all sets, so that the bound over the plain plan is what it may cost.
    let plain_plan: f64 = plain
        .cases
        .best
        .plan
        .points
        .iter()
        .map(|p| several.at(&plain.cases.best.placement).state(p.point, p.beta, p.posture).unwrap().score())
        .sum::<f64>()
        / 105.0;
    assert!(worst.cases.best.plan.mean <= plain_plan * (1.0 + 1e-6), "{} {plain_plan}", worst.cases.best.plan.mean);
    let means = worst.sets.iter().map(|set| set.mean);
    assert!(means.fold(0.0, f64::max) <= worst.cases.best.plan.mean * (1.0 + 1e-12));
    assert!(worst.sets.iter().all(|set| set.regret().unwrap() > -1e-3), "{:?}", worst.sets);
}

#[test]
fn a_score_of_which_nothing_is_wanted_once_it_is_stopped_has_no_plans() {
    let problem = five_segments();
    let placement = [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)].into();
    let score = |monitor: &Monitor| score(&problem, &placement, &TransferSettings::default(), monitor);
    let stopped = Monitor::silent();
    stopped.stop_handle().stop();
    assert!(score(&stopped).is_ok_and(|score| score.interrupted));
    let none = score(&stopped.for_all_or_nothing()).unwrap_err();
    assert!(none.interrupted && none.findings.is_empty(), "{none}");
    assert!(score(&Monitor::silent().for_all_or_nothing()).is_ok_and(|score| !score.interrupted));
}
