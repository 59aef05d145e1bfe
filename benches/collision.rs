//! What shapes cost: the whole job of the published path in the shipped cell, with its shapes and without: `cargo bench --bench collision`.
//!
//! Both jobs are the same but for the surroundings: quote their ratio.

#![allow(clippy::expect_used, reason = "a benchmark of shipped files")]

use divan::{Bencher, black_box};
use std::path::Path;
use stead_format::read_run;
use stead_numerics::monitor::Monitor;
use stead_placement::place::place;
use stead_placement::problem::Problem;

fn main() {
    divan::main();
}

#[divan::bench(args = [false, true], sample_count = 5, sample_size = 1)]
fn job(bencher: Bencher, with_shapes: bool) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/collision.toml");
    let run = read_run(&file).expect("the shipped run is valid");
    let scene = run.problem.scene.clone().filter(|_| with_shapes);
    let problem = Problem { scene, ..run.problem };
    bencher.bench_local(|| place(black_box(&problem), &run.search, &run.transfer, &Monitor::silent()));
}
