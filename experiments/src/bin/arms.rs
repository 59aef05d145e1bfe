//! Compares arms at one task: each is placed by the run's criterion and by the total deflection, and the arms are
//! ranked by the mean total deflection at the latter.
//!
//! `cargo run --release -p stead-experiments --bin arms -- configs/raster.toml configs/robots/kuka-kr500.toml
//! configs/robots/kuka-kr270-r2700.toml`; the robot files take the place of the run's.

#![allow(clippy::print_stdout, reason = "an experiment prints")]

use std::env;
use std::error::Error;
use std::path::Path;
use stead_format::read_robot;
use stead_numerics::monitor::Monitor;
use stead_placement::outcome::DeflectionFigures;
use stead_placement::place::place;
use stead_problem::criterion::Weights;
use stead_problem::problem::Problem;
use stead_run_files::read_run;
use stead_runs::Run;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let run = read_run(Path::new(&arguments.next().ok_or("usage: arms CONFIG ROBOT...")?))?;
    let mut rows = Vec::new();
    for file in arguments {
        let robot = read_robot(Path::new(&file))?;
        let name = robot.name().to_owned();
        let problem = run.problem.changed(|parts| parts.robot = robot)?;
        let plain = deflection(&problem, &run)?;
        let whole = problem.changed(|parts| parts.criterion.weights = Weights::TOTAL)?;
        let whole = deflection(&whole, &run)?;
        rows.push((name, plain, whole));
    }
    rows.sort_by(|a, b| a.2.total.mean.total_cmp(&b.2.total.mean));
    println!("| arm | placed by the run: wall | total | placed by the whole: wall | total |");
    println!("|---|---|---|---|---|");
    for (name, plain, whole) in rows {
        let [plain, whole] = [plain, whole].map(|of| format!("{:.4} | {:.4}", of.wall.mean * 1e3, of.total.mean * 1e3));
        println!("| {name} | {plain} | {whole} |");
    }
    Ok(())
}

/// The means at the best placement.
fn deflection(problem: &Problem, run: &Run) -> Result<DeflectionFigures, Box<dyn Error>> {
    let outcome = place(problem, &run.search, &run.transfer, &Monitor::silent())?;
    Ok(outcome.cases.best.plan.deflection)
}
