//! The table for upright tools on the published case: `cargo bench --bench table`.
//!
//! First how far it is from the ordinary evaluator and from the planner; then what it takes to build, and what a
//! placement takes through it and without it.

#![allow(clippy::expect_used, clippy::print_stdout, reason = "a benchmark of shipped files")]

mod published;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use published::{poses, problem};
use stead_placement::lookup::{BetaGrid, CollisionEffort, LookupTable};
use stead_planning::redundancy::Planner;
use stead_problem::sense::Sense;

fn main() {
    let problem = problem();
    let planner = Planner::new(&problem);
    let table = LookupTable::new(&problem).expect("the published case suits a table");
    println!("table: {} states, {} bytes, {:?}", table.shape().states(), table.shape().bytes(), table.accuracy());
    let grid = BetaGrid::of(&planner);
    let (mut looking, mut space) = (table.workspace(&grid), planner.workspace());
    let mut errors: Vec<f64> = poses(40)
        .iter()
        .filter_map(|pose| {
            let looked = table.objective(pose, &grid, None, CollisionEffort::ALL, &mut looking).mean()?;
            Some((looked / planner.objective(pose, Sense::Min, None, &mut space).mean()? - 1.0).abs())
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    println!(
        "mean deflection against the planner, relative: median {:.1e}, largest {:.1e}, {} placements",
        errors[errors.len() / 2],
        errors[errors.len() - 1],
        errors.len()
    );
    divan::main();
}

#[divan::bench]
fn build(bencher: Bencher) {
    let problem = problem();
    bencher.bench_local(|| black_box(LookupTable::new(&problem)));
}

/// A placement through the table, on a grid of beta of so many values.
#[divan::bench(args = [120, 360, 720])]
fn objective(bencher: Bencher, count: usize) {
    let problem = problem();
    let table = LookupTable::new(&problem).expect("the published case suits a table");
    let grid = BetaGrid::new(&problem, count);
    let mut workspace = table.workspace(&grid);
    let poses = poses(40);
    bencher.counter(ItemsCount::new(poses.len())).bench_local(|| {
        for pose in &poses {
            black_box(table.objective(black_box(pose), &grid, None, CollisionEffort::ALL, &mut workspace));
        }
    });
}

/// The same by the planner.
#[divan::bench]
fn planned(bencher: Bencher) {
    let problem = problem();
    let planner = Planner::new(&problem);
    let mut workspace = planner.workspace();
    let poses = poses(40);
    bencher.counter(ItemsCount::new(poses.len())).bench_local(|| {
        for pose in &poses {
            black_box(planner.objective(pose, Sense::Min, None, &mut workspace));
        }
    });
}
