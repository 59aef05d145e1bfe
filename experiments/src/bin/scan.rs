//! Scans a cell exhaustively on a grid of placements and refines from the best and the worst of it: what the genetic
//! search is measured against. Where the task allows it, the scan looks through a table.
//!
//! `cargo run --release -p stead-experiments --bin scan -- configs/caro-2013.toml [x y z yaw]` with the numbers of grid
//! values (default 7 7 7 72).

#![allow(clippy::too_many_lines, reason = "an experiment is read from top to bottom")]
#![allow(clippy::print_stdout, reason = "an experiment prints")]

use rayon::prelude::*;
use std::env;
use std::error::Error;
use std::path::Path;
use stead_numerics::monitor::Monitor;
use stead_placement::evaluator::Evaluator;
use stead_placement::lookup::LookupTable;
use stead_placement::refine::refine;
use stead_placement::search::distinct;
use stead_planning::redundancy::Planner;
use stead_problem::candidate::{Candidate, rank};
use stead_problem::problem::Interval;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;
use stead_run_files::read_run;

/// Basins of the grid that are refined, for each sense.
const REFINED: usize = 16;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let config = arguments.first().ok_or("usage: scan CONFIG [NX NY NZ NYAW]")?;
    let mut counts = [7, 7, 7, 72];
    for (count, text) in counts.iter_mut().zip(&arguments[1..]) {
        *count = text.parse::<usize>()?.max(1);
    }
    let run = read_run(Path::new(config))?;
    let planner = Planner::new(&run.problem);
    let table = LookupTable::new(&run.problem);
    match &table {
        Ok(table) => println!("through a table of {} states", table.shape().states()),
        Err(unsuited) => println!("without a table: {unsuited}"),
    }
    let evaluator = Evaluator::new(&planner, table.as_ref().ok());
    let cell = &run.problem.cell;
    let [x, y, z] = cell.position;
    let axes = [axis(x, counts[0]), axis(y, counts[1]), axis(z, counts[2]), axis(cell.yaw, counts[3])];
    let poses: Vec<Placement> = (0..counts.iter().product())
        .map(|mut index| {
            Placement::from(std::array::from_fn(|k| {
                let value = axes[k][index % counts[k]];
                index /= counts[k];
                value
            }))
        })
        .collect();
    let scanned: Vec<Candidate> = poses
        .par_iter()
        .map_init(
            || evaluator.workspace(),
            |workspace, placement| Candidate {
                placement: *placement,
                scheme: None,
                objective: evaluator.objective(placement, None, workspace),
            },
        )
        .collect();
    let feasible = scanned.iter().filter(|i| i.objective.mean().is_some()).count();
    println!("{} placements scanned, {feasible} of them feasible", scanned.len());
    for sense in Sense::BOTH {
        let mut sorted: Vec<Candidate> = scanned.iter().filter(|i| i.objective.mean().is_some()).cloned().collect();
        sorted.sort_by(|a, b| rank(sense, a.objective, b.objective));
        let basins = distinct(&run.problem, &sorted, REFINED);
        let refined =
            basins.par_iter().filter_map(|basin| refine(&evaluator, &basin.placement, sense, None, &Monitor::silent()));
        let mut reports: Vec<_> = refined.map(|(_, report)| report).collect();
        reports.sort_by(|a, b| match sense {
            Sense::Min => a.end_mean.total_cmp(&b.end_mean),
            Sense::Max => b.end_mean.total_cmp(&a.end_mean),
        });
        println!("{sense:?}: the first three of {} refined basins", reports.len());
        for report in reports.iter().take(3) {
            println!(
                "  {:.7} mm at x {:.1} y {:.1} z {:.1} mm, Q4 {:.4} (grid {:.7} mm)",
                report.end_mean * 1e3,
                report.end.x * 1e3,
                report.end.y * 1e3,
                report.end.z * 1e3,
                report.end.q4(),
                report.start_mean * 1e3
            );
        }
    }
    Ok(())
}

/// Grid values from end to end; the middle of the interval when there is one value.
fn axis(bounds: Interval, count: usize) -> Vec<f64> {
    let share = |k: usize| if count == 1 { 0.5 } else { k as f64 / (count - 1) as f64 };
    (0..count).map(|k| bounds.min + share(k) * bounds.width()).collect()
}
