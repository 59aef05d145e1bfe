//! What shapes cost: the whole job of a shipped cell, with its shapes and without, for the published path and for a
//! robot on a rail: `cargo bench --bench collision`.
//!
//! The two jobs of a cell are the same but for the surroundings: quote their ratio.

#![allow(clippy::expect_used, reason = "a benchmark of shipped files")]

use divan::{Bencher, black_box};
use std::path::Path;
use stead_numerics::monitor::Monitor;
use stead_placement::place::place;
use stead_run_files::read_run;

fn main() {
    divan::main();
}

#[divan::bench(args = [false, true], sample_count = 5, sample_size = 1)]
fn job(bencher: Bencher, with_shapes: bool) {
    bench_job(bencher, "configs/collision.toml", with_shapes);
}

#[divan::bench(args = [false, true], sample_count = 3, sample_size = 1)]
fn rail_job(bencher: Bencher, with_shapes: bool) {
    bench_job(bencher, "configs/rail-panel.toml", with_shapes);
}

fn bench_job(bencher: Bencher, file: &str, with_shapes: bool) {
    let run = read_run(&Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect("the shipped run is valid");
    let scene = run.problem.scene.clone().filter(|_| with_shapes);
    let problem = run.problem.changed(|parts| parts.scene = scene).expect("shapes left out");
    bencher.bench_local(|| place(black_box(&problem), &run.search, &run.transfer, &Monitor::silent()));
}
