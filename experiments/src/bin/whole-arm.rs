//! Whole arms placed by a search that shares no code with `place`: random placements, then descents of their own from
//! the best (or worst) of them. Every placement is scored by the planner's best plan, beta off the grid, and that plan
//! by the reference evaluator; no lookup table, no genetic search, no derivatives.
//!
//! `cargo run --release -p stead-experiments --bin whole-arm [-- RANDOM DESCENTS ARM]` (default 600 6 and all) in the
//! root of the repository, with three arms along the path of `configs/whole-arm.toml`, each scored by the whole
//! deflection and by its part normal to the wall: KUKA KR 210-2 and Staubli TX200 with their full sets, and a made-up
//! arm of which everything yields that can. It prints the best and the worst mean of `place`, with a population of 24
//! over 8 generations, and of this search, and by how much the search is ahead (below 0: behind).

#![allow(clippy::print_stdout, reason = "an experiment prints")]

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::env;
use std::error::Error;
use std::fs;
use std::path::Path;
use stead_numerics::monitor::Monitor;
use stead_placement::place::place;
use stead_planning::redundancy::{Planner, Workspace};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_run_files::read_run;

/// The run that all are made of.
const RUN: &str = "configs/whole-arm.toml";
/// First step of a descent, as a share of the cell, and the step with which it ends.
const STEPS: [f64; 2] = [0.08, 2e-5];
/// Tries without success before the step is halved.
const TRIES: usize = 12;

/// What the made-up arm adds to the run.
const YIELDING: &str = "
[base_compliance]
point_mm = [80, -120, -400]
matrix = [[0.03, 0.004, 0, 0, 0.012, 0.003], [0.004, 0.02, 0.001, -0.01, 0, 0], [0, 0.001, 0.01, 0, 0.002, 0],
    [0, -0.01, 0, 0.05, 0.01, 0], [0.012, 0, 0.002, 0.01, 0.07, 0], [0.003, 0, 0, 0, 0, 0.04]]

[part_compliance]
um_per_n = [[0.05, 0.01, 0], [0.01, 0.03, 0.005], [0, 0.005, 0.08]]
";
const OF_SPINDLE: &str = "
mount_matrix = [[0.01, 0, 0, 0, 0.02, 0], [0, 0.012, 0, -0.02, 0, 0], [0, 0, 0.004, 0, 0, 0], [0, -0.02, 0, 0.2, 0.03, 0],
    [0.02, 0, 0, 0.03, 0.25, 0], [0, 0, 0, 0, 0, 0.3]]
tip_um_per_n = [[0.04, 0.003, 0], [0.003, 0.05, 0], [0, 0, 0.01]]
";
/// About x, about y (urad/(N m)) and place on the axis (mm) of the springs of the made-up arm.
const SPRINGS: [[f64; 3]; 6] = [
    [0.08, 0.05, -400.0],
    [0.05, 0.12, 60.0],
    [0.3, 0.15, -45.0],
    [0.6, 0.35, -500.0],
    [0.9, 0.5, 35.0],
    [0.7, 1.1, -90.0],
];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let mut count = |usual: usize| arguments.next().map_or(Ok(usual), |text| text.parse::<usize>());
    let (random, descents, only) = (count(600)?, count(6)?, count(0)?);
    let folder = tempfile::tempdir()?;
    println!("| arm | scored | sense | place, mm | this search, mm | ahead by, % |");
    println!("|---|---|---|---|---|---|");
    let runs = runs(folder.path())?.into_iter().zip(1..).filter(|(_, number)| only == 0 || only == *number);
    for ((name, run), _) in runs {
        for direction in ["total", "wall"] {
            let file = folder.path().join("run.toml");
            fs::write(&file, run.replace("direction = \"total\"", &format!("direction = \"{direction}\"")))?;
            let run = read_run(&file)?;
            let outcome = place(&run.problem, &run.search, &run.transfer, &Monitor::silent())?;
            let planner = Planner::finer(&run.problem);
            for (sense, case) in [Sense::Min, Sense::Max].into_iter().zip(outcome.cases.optima()) {
                let found = search(&planner, sense, random, descents);
                let (own, sign) = (case.plan.objective, sense.sign());
                let ahead = found.map_or(f64::NAN, |found| (own - found) * sign / own * 100.0);
                let found = found.map_or("none".to_owned(), |found| format!("{:.6}", found * 1e3));
                println!("| {name} | {direction} | {sense:?} | {:.6} | {found} | {ahead:.4} |", own * 1e3);
            }
        }
    }
    Ok(())
}

/// The three arms with their run files.
fn runs(folder: &Path) -> Result<[(&'static str, String); 3], Box<dyn Error>> {
    let root = fs::canonicalize(".")?;
    let at = |name: &str| root.join("configs").join(name).display().to_string();
    let text = fs::read_to_string(RUN)?.replace("../tasks", &at("../tasks"));
    let text = text.replace("population = 120", "population = 24").replace("generations = 51", "generations = 8");
    let robot = "robots/kuka-kr210-2-full.toml";
    let of = |file: &str| text.replace(robot, file);
    // The smaller arm reaches less far, and its rows begin 642 mm below axis 2.
    let tx200 = of(&at("robots/staubli-tx200-huynh.toml"))
        .replace("y_mm = [-2240.0, -1640.0]", "y_mm = [-1700.0, -1250.0]")
        .replace("z_mm = [148.0, 536.0]", "z_mm = [0.0, 350.0]");
    let made_up = folder.join("made-up.toml");
    fs::write(&made_up, made_up_arm(&fs::read_to_string(at("robots/kuka-kr210-2.toml"))?)?)?;
    let everything = of(&made_up.display().to_string())
        .replace("xyz_mm = [0.0, 0.0, 454.0]", &format!("xyz_mm = [0.0, 0.0, 454.0]{OF_SPINDLE}"));
    Ok([
        ("KUKA KR 210-2, full set", of(&at(robot))),
        ("Staubli TX200, full set", tx200),
        ("made-up arm, everything", format!("{everything}{YIELDING}")),
    ])
}

/// An arm with springs of our own normal to its axes.
fn made_up_arm(text: &str) -> Result<String, Box<dyn Error>> {
    let mut table: toml::Table = text.parse()?;
    table.insert("stiffness_model".to_owned(), "full".into());
    let rows = table.get_mut("joints").and_then(toml::Value::as_array_mut).ok_or("no joints")?;
    for (row, [x, y, bearing]) in rows.iter_mut().filter_map(toml::Value::as_table_mut).zip(SPRINGS) {
        row.insert("orthogonal_compliance_urad_per_nm".to_owned(), vec![x, y].into());
        row.insert("bearing_mm".to_owned(), bearing.into());
    }
    Ok(toml::to_string(&table)?)
}

/// The best (in the given sense) mean over the cell.
fn search(planner: &Planner<'_>, sense: Sense, random: usize, descents: usize) -> Option<f64> {
    let problem = planner.problem();
    let mut starts: Vec<(f64, Placement)> = (0..random as u64)
        .into_par_iter()
        .filter_map(|number| {
            let mut numbers = ChaCha8Rng::seed_from_u64(number);
            let placement = at(problem, std::array::from_fn(|_| numbers.random_range(0.0..1.0)));
            Some((mean(planner, &placement, &mut planner.workspace())? * sense.sign(), placement))
        })
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Starts that lie near a better one lead where that leads.
    let mut apart: Vec<(f64, Placement)> = Vec::new();
    for start in starts {
        let is_near = |other: &(f64, Placement)| {
            let [a, b] = [&start.1, &other.1].map(|placement| shares(problem, placement));
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.12)
        };
        if !apart.iter().any(is_near) {
            apart.push(start);
        }
    }
    apart.truncate(descents);
    let ends = apart.par_iter().enumerate().map(|(number, start)| descent(planner, sense, number as u64, start));
    ends.collect::<Vec<f64>>().into_iter().reduce(f64::min).map(|best| best * sense.sign())
}

/// From a placement downhill: steps in random directions, each tried both ways, smaller after some without success.
fn descent(planner: &Planner<'_>, sense: Sense, seed: u64, (value, start): &(f64, Placement)) -> f64 {
    let problem = planner.problem();
    let mut numbers = ChaCha8Rng::seed_from_u64(1_000_000 + seed);
    let mut workspace = planner.workspace();
    let (mut best, mut here, mut step, mut failed) = (*value, shares(problem, start), STEPS[0], 0);
    while step > STEPS[1] {
        let direction: [f64; 4] = std::array::from_fn(|_| numbers.random_range(-1.0..1.0));
        let found = [step, -step].into_iter().find_map(|step| {
            let there: [f64; 4] = std::array::from_fn(|k| (here[k] + direction[k] * step).clamp(0.0, 1.0));
            let value = mean(planner, &at(problem, there), &mut workspace)? * sense.sign();
            (value < best).then_some((value, there))
        });
        match found {
            Some((value, there)) => {
                (best, here, failed) = (value, there, 0);
                step *= 1.3;
            }
            None => failed += 1,
        }
        if failed == TRIES {
            (step, failed) = (step / 2.0, 0);
        }
    }
    best
}

/// A placement by its shares of the cell.
fn at(problem: &Problem, share: [f64; 4]) -> Placement {
    let [x, y, z] = problem.cell.position;
    let ends = [x, y, z, problem.cell.yaw];
    Placement::from(std::array::from_fn(|k| ends[k].min + share[k] * (ends[k].max - ends[k].min)))
}

/// The shares of the cell at which a placement is.
fn shares(problem: &Problem, placement: &Placement) -> [f64; 4] {
    let [x, y, z] = problem.cell.position;
    let ends = [(x, placement.x), (y, placement.y), (z, placement.z), (problem.cell.yaw, placement.yaw)];
    ends.map(|(ends, value)| if ends.max > ends.min { (value - ends.min) / (ends.max - ends.min) } else { 0.0 })
}

/// The mean of the scores under the best plan at a placement, by the reference evaluator. m
fn mean(planner: &Planner<'_>, placement: &Placement, workspace: &mut Workspace) -> Option<f64> {
    let problem = planner.problem();
    let plans = planner.plan_fine(placement, Sense::Min, None, workspace).ok()?;
    let mut sum = 0.0;
    for plan in &plans {
        for (point, beta) in plan.points.clone().zip(&plan.betas) {
            sum += problem.at(placement).state(point, *beta, plan.posture).ok()?.score();
        }
    }
    Some(sum / problem.task.path().scored_count() as f64)
}
