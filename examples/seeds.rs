//! How often the search finds the optimum: runs the placement job with many seeds, with the posture scheme found exactly
//! and with the scheme in the genome as published.
//!
//! `cargo run --release --example seeds -- configs/caro-2013.toml [number of seeds, 20] [best mm] [worst mm] [exact or genetic]`;
//! best and worst are what to compare with, by default the best and the worst of all runs; the last is the only way to try.

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::env;
use std::error::Error;
use std::path::Path;
use stead_format::read_run;
use stead_numerics::monitor::Monitor;
use stead_placement::place::place;
use stead_placement::settings::{PostureSearch, SearchSettings};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let config = arguments.first().ok_or("usage: seeds CONFIG [SEEDS] [BEST_MM] [WORST_MM] [exact|genetic]")?;
    let seeds: u64 = arguments.get(1).map_or(Ok(20), |text| text.parse())?;
    let run = read_run(Path::new(config))?;
    let ways: &[PostureSearch] = match arguments.get(4).map(String::as_str) {
        None => &[PostureSearch::Exact, PostureSearch::Genetic],
        Some("exact") => &[PostureSearch::Exact],
        Some("genetic") => &[PostureSearch::Genetic],
        Some(_) => return Err("the last argument must be exact or genetic".into()),
    };
    let mut results = Vec::new();
    for postures in ways.iter().copied() {
        for seed in 1..=seeds {
            let settings = SearchSettings { seed, postures, ..run.search };
            let outcome = place(&run.problem, &settings, &run.transfer, &Monitor::silent());
            let (best, worst) = match &outcome {
                Ok(outcome) => (outcome.cases.best.plan.mean * 1e3, outcome.cases.worst.plan.mean * 1e3),
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
            let good = own().filter(|r| r.1 <= best * (1.0 + percent / 100.0)).count();
            let bad = own().filter(|r| r.2 >= worst * (1.0 - percent / 100.0)).count();
            println!("  {postures:?}: within {percent} %: best {good} of {seeds}, worst {bad} of {seeds}");
        }
    }
    Ok(())
}
