//! How often the search finds the optimum: runs the placement job with many seeds, with the posture scheme found
//! exactly and with the scheme in the genome as published.
//!
//! `cargo run --release -p stead-experiments --bin seeds -- configs/caro-2013.toml [number of seeds, 20] [best mm]
//! [worst mm] [exact or genetic] [robot file]`; best and worst are what to compare with, by default the best and the
//! worst of all runs; then the only way to try, and a robot in place of the run's. Plans are the best ones, without the
//! tie of `[postures]`, and means below 1e-6 mm count as the same.

#![allow(clippy::print_stdout, reason = "an experiment prints")]

use std::env;
use std::error::Error;
use std::path::Path;
use stead_format::read_robot;
use stead_numerics::monitor::Monitor;
use stead_placement::place::place;
use stead_problem::criterion::CANCELLATION;
use stead_problem::settings::{PostureSearch, SearchSettings};
use stead_run_files::read_run;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = env::args().skip(1).collect();
    let robot = arguments.pop_if(|last| last.ends_with(".toml") && env::args().len() > 2);
    let way = arguments.pop_if(|last| ["exact", "genetic"].contains(&last.as_str()));
    let config = arguments.first().ok_or("usage: seeds CONFIG [SEEDS] [BEST_MM] [WORST_MM] [exact|genetic] [ROBOT]")?;
    let seeds: u64 = arguments.get(1).map_or(Ok(20), |text| text.parse())?;
    let mut run = read_run(Path::new(config))?;
    run.problem.postures.tie = 0.0;
    if let Some(robot) = robot {
        run.problem.robot = read_robot(Path::new(&robot))?;
    }
    let ways: &[PostureSearch] = match way.as_deref() {
        None => &[PostureSearch::Exact, PostureSearch::Genetic],
        Some("genetic") => &[PostureSearch::Genetic],
        Some(_) => &[PostureSearch::Exact],
    };
    let mut results = Vec::new();
    for postures in ways.iter().copied() {
        for seed in 1..=seeds {
            let settings = SearchSettings { seed, postures, ..run.search };
            let outcome = place(&run.problem, &settings, &run.transfer, &Monitor::silent());
            let (best, worst) = match &outcome {
                Ok(outcome) => (outcome.cases.best.plan.mean * 1e3, outcome.cases.optima()[1].plan.mean * 1e3),
                Err(_) => (f64::INFINITY, 0.0),
            };
            println!("{postures:?} seed {seed}: best {best:.6} mm, worst {worst:.6} mm");
            results.push((postures, best, worst));
        }
    }
    let given = |index: usize| arguments.get(index).map(|text| text.parse::<f64>()).transpose();
    let best = given(2)?.unwrap_or_else(|| results.iter().map(|r| r.1).fold(f64::INFINITY, f64::min));
    let worst = given(3)?.unwrap_or_else(|| results.iter().map(|r| r.2).fold(0.0, f64::max));
    println!("compared with best {best:.6} mm and worst {worst:.6} mm:");
    for postures in ways.iter().copied() {
        for percent in [0.1, 0.5, 5.0] {
            let own = || results.iter().filter(|r| r.0 == postures);
            let good = own().filter(|r| r.1 <= best.max(CANCELLATION * 1e3) * (1.0 + percent / 100.0)).count();
            let bad = own().filter(|r| r.2 >= worst * (1.0 - percent / 100.0)).count();
            println!("  {postures:?}: within {percent} %: best {good} of {seeds}, worst {bad} of {seeds}");
        }
    }
    Ok(())
}
