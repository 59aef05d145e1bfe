//! What the grid of beta costs: the printed plans against plans on a grid four times finer, on the shipped results.

use serde_json::Value;
use std::path::Path;
use stead_planning::redundancy::Planner;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;
use stead_run_files::read_run;

/// The mean of the final plan at a placement, m.
fn mean(planner: &Planner<'_>, placement: &Placement, sense: Sense) -> f64 {
    let plans = planner.plan_fine(placement, sense, None, &mut planner.workspace()).unwrap();
    plans.iter().map(|plan| plan.cost).sum::<f64>() / planner.problem().task.points().len() as f64
}

/// What the grid of final plans costs at a shipped case, relative to one four times finer.
fn cost_of_the_grid(run: &str, case: usize) -> f64 {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let problem = read_run(&root.join("configs").join(format!("{run}.toml"))).unwrap().problem;
    let summary = std::fs::read_to_string(root.join("results").join(run).join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let placement = &summary["cases"][case - 1]["placement"];
    let number = |key: &str| placement[key].as_f64().unwrap();
    let placement = Placement::from([
        number("x_mm") * 1e-3,
        number("y_mm") * 1e-3,
        number("z_mm") * 1e-3,
        number("yaw_deg").to_radians(),
    ]);
    let sense = if case % 2 == 1 { Sense::Min } else { Sense::Max };
    let planner = Planner::finer(&problem);
    let own = mean(&planner, &placement, sense);
    let step = planner.grid().beta_step() / 4.0;
    let finer = problem.changed(|parts| parts.redundancy = parts.redundancy.divided(step)).unwrap();
    let planner_of_finer = Planner::finer(&finer);
    assert_eq!(planner_of_finer.grid().beta_count, 4 * planner.grid().beta_count);
    let better = mean(&planner_of_finer, &placement, sense);
    sense.sign() * (own - better) / better
}

#[test]
fn the_grid_of_beta_costs_less_than_a_fiftieth_of_a_percent() {
    for run in ["caro-2013", "caro-2013-k1-0.8"] {
        for case in 1..=4 {
            let cost = cost_of_the_grid(run, case);
            println!("{run} case {case}: {:.5} %", cost * 100.0);
            assert!(cost.abs() < 2e-4, "{run} case {case}: {cost}");
        }
    }
}
