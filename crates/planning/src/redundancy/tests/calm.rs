//! Joint travel in the cost of plans, and plans in which beta stays.

use super::*;
use stead_problem::joint_travel::joint_distance;
use stead_problem::problem::BetaPlan;

/// Placements of the five segments at which most of them can be followed.
fn placements() -> impl Iterator<Item = Placement> {
    (0..6).map(f64::from).map(|f| [0.02 * f, -1.65 - 0.02 * f, -0.56 + 0.03 * f, 0.4 + 0.3 * f].into())
}

fn travelled(plans: &[SegmentPlan]) -> f64 {
    plans.iter().flat_map(|plan| plan.joints.windows(2)).map(|pair| joint_distance(&pair[0], &pair[1])).sum()
}

/// The mean score of plans. m
fn mean(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) -> f64 {
    let costs = plans
        .iter()
        .flat_map(|plan| plan.points.clone().zip(&plan.betas).map(move |(point, beta)| (point, beta, plan)));
    let score = |(point, beta, plan): (usize, &f64, &SegmentPlan)| {
        problem.point_cost(point, problem.at(placement).state(point, *beta, plan.posture).unwrap().score())
    };
    problem.objective(costs.map(score))
}

#[test]
fn plans_with_joint_travel_agree_with_plain_dynamic_programming() {
    let mut feasible = 0;
    for (ranges, weight) in [
        ([(-350.0, 350.0), (-125.0, 125.0), (-350.0, 350.0)], 1e-4),
        ([(-185.0, 185.0), (-125.0, 125.0), (-181.0, 200.0)], 2e-3),
        ([(-100.0, 80.0), (-125.0, 125.0), (-80.0, 110.0)], 2e-4),
    ] {
        let mut problem = with_beta_rate(with_wrist(five_segments(), ranges), 4.0);
        problem.redundancy.beta_count = 40;
        problem.criterion.joint_travel_weight = weight;
        let planner = Planner::new(&problem);
        let mut workspace = planner.workspace();
        for placement in placements() {
            for sense in Sense::BOTH {
                let Ok(plans) = planner.plan(&placement, sense, None, &mut workspace) else { continue };
                feasible += 1;
                let expected = problem.task.segments().iter().map(|span| {
                    reference_dp::plan(&planner.segments, span, &placement, sense, &Posture::ALL, &mut workspace)
                        .unwrap()
                        .cost
                });
                let expected = problem.objective(expected.collect::<Vec<_>>());
                let cost = problem.objective(plans.iter().map(|plan| plan.cost));
                assert!((cost - expected).abs() < 1e-12 * expected, "{cost} {expected} {sense:?} {weight}");
                let counted = if sense == Sense::Min { problem.travel_weight() * travelled(&plans) } else { 0.0 };
                assert!((mean(&problem, &placement, &plans) + counted - cost).abs() < 1e-12 * cost);
                let worth = planner.objective(&placement, sense, None, &mut workspace).mean().unwrap();
                assert!((worth - cost).abs() < 1e-12 * cost);
            }
        }
    }
    assert!(feasible > 16, "{feasible}");
}

#[test]
fn with_a_weight_joints_travel_less_and_off_the_grid_too() {
    let mut problem = five_segments();
    for placement in placements() {
        let mut last: Option<(f64, f64)> = None;
        for weight in [0.0, 1e-5, 1e-4, 1e-3] {
            problem.criterion.joint_travel_weight = weight;
            let planner = Planner::new(&problem);
            let plans = planner.plan_fine(&placement, Sense::Min, None, &mut planner.workspace()).unwrap();
            let (mean, travel) = (mean(&problem, &placement, &plans), travelled(&plans));
            for plan in &plans {
                let replayed = off_grid::replay(&problem, &placement, Sense::Min, plan).unwrap();
                assert!((replayed.cost - plan.cost).abs() < 1e-10 * plan.cost);
            }
            // 101 stretches of 10 mm: five lines of 200 mm and more.
            let objective = problem.objective(plans.iter().map(|plan| plan.cost));
            let stretches = problem.stretches();
            assert!((100.0..110.0).contains(&stretches), "{stretches}");
            assert!((objective - mean - weight * travel / stretches).abs() < 1e-12 * objective);
            if let Some((less, more)) = last {
                assert!(travel < more * 1.001 && mean > less * 0.999, "{travel} {more} {mean} {less}");
            }
            last = Some((mean, travel));
        }
    }
}

/// What the path costs in one posture per segment at one beta of the grid each: for every segment and beta the least.
fn by_hand(planner: &Planner<'_>, placement: &Placement, sense: Sense) -> Vec<Vec<Option<f64>>> {
    let problem = planner.problem;
    let cost = |span: &std::ops::Range<usize>, posture: Posture, k: usize| {
        let beta = planner.grid().beta(k);
        let mut sum = 0.0;
        for point in span.clone() {
            let found = problem.at(placement).state(point, beta, posture).ok()?;
            if !joint_turns::is_allowed(problem, &found) {
                return None;
            }
            sum += problem.point_cost(point, found.score());
        }
        let betas = vec![beta; span.len()];
        planner.segments.unwind(span, placement, &betas, &[posture], sum)?;
        Some(sum)
    };
    let best = |span: &std::ops::Range<usize>, k: usize| {
        let costs = Posture::ALL.into_iter().filter_map(|posture| cost(span, posture, k));
        costs.min_by(|a, b| (a * sense.sign()).total_cmp(&(b * sense.sign())))
    };
    let spans = problem.task.segments();
    (0..planner.grid().beta_count).map(|k| spans.iter().map(|span| best(span, k)).collect()).collect()
}

#[test]
fn a_beta_that_stays_is_the_best_of_all() {
    let mut problem = with_wrist(five_segments(), [(-150.0, 150.0), (-125.0, 125.0), (-170.0, 120.0)]);
    problem.redundancy.beta_count = 24;
    let mut feasible = 0;
    for placement in placements() {
        for sense in Sense::BOTH {
            let least = |costs: &mut dyn Iterator<Item = f64>| {
                costs.min_by(|a, b| (a * sense.sign()).total_cmp(&(b * sense.sign())))
            };
            for beta in [BetaPlan::ConstantPerSegment, BetaPlan::Constant] {
                problem.redundancy.beta = beta;
                let planner = Planner::new(&problem);
                let costs = by_hand(&planner, &placement, sense);
                let expected: Option<f64> = match beta {
                    BetaPlan::Constant => {
                        let sums = costs.iter().filter_map(|row| row.iter().copied().sum::<Option<f64>>());
                        least(&mut sums.collect::<Vec<_>>().into_iter())
                    }
                    _ => (0..5).map(|segment| least(&mut costs.iter().filter_map(|row| row[segment]))).sum(),
                };
                let expected = expected.map(|sum| problem.objective([sum]));
                let mut workspace = planner.workspace();
                let worth = planner.objective(&placement, sense, None, &mut workspace).mean();
                assert_eq!(worth.is_some(), expected.is_some(), "{placement:?} {beta:?}");
                let plans = planner.plan(&placement, sense, None, &mut workspace);
                assert_eq!(plans.is_ok(), expected.is_some());
                let (Some(worth), Some(expected), Ok(plans)) = (worth, expected, plans) else { continue };
                feasible += 1;
                let cost = problem.objective(plans.iter().map(|plan| plan.cost));
                assert!((worth - expected).abs() < 1e-12 * expected, "{worth} {expected} {beta:?} {sense:?}");
                assert!((cost - expected).abs() < 1e-12 * expected, "{cost} {expected} {beta:?} {sense:?}");
                // Off the grid it stays too, and is no worse.
                let fine = planner.plan_fine(&placement, sense, None, &mut workspace).unwrap();
                let refined = problem.objective(fine.iter().map(|plan| plan.cost));
                assert!(refined * sense.sign() <= cost * sense.sign() * (1.0 + 1e-12));
                for plans in [&plans, &fine] {
                    assert_sound(&problem, &placement, plans);
                    assert!(plans.iter().all(|plan| plan.betas.iter().all(|beta| *beta == plan.betas[0])));
                    let is_one = plans.iter().all(|plan| plan.betas[0] == plans[0].betas[0]);
                    assert!(is_one || beta == BetaPlan::ConstantPerSegment);
                }
            }
        }
    }
    assert!(feasible > 12, "{feasible}");
}
