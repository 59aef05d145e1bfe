//! Speed of simulated passes: `cargo bench --bench simulation`.
//!
//! Prints first, for each variant of the shipped aluminium pass at 90 steps a turn, how long it takes on one core, and
//! how many times as fast as the pass that is (the fastest of seven runs).

#![allow(clippy::expect_used, clippy::print_stdout, reason = "a benchmark of shipped files that prints its figures")]

use divan::{Bencher, black_box};
use std::path::Path;
use std::time::Instant;
use stead_numerics::monitor::Monitor;
use stead_run_files::{Overrides, read_simulation};
use stead_runs::SimulationRun;
use stead_simulation::arm::Variant;
use stead_simulation::coupled::{Job, Run};
use stead_simulation::milling::MaterialRemoval;
use stead_simulation::surface::Node;

fn main() {
    for &(_, variant) in Variant::WORDS {
        let run = shipped(variant);
        let times = (0..7).map(|_| {
            let start = Instant::now();
            let pass = simulated(&run);
            (start.elapsed().as_secs_f64(), pass.step * (pass.samples.len() - 1) as f64)
        });
        let (time, duration) = times.min_by(|a, b| a.0.total_cmp(&b.0)).expect("seven runs");
        let (word, factor) = (variant.word(), duration / time);
        println!("{word:10}: {time:.3} s for {duration:.2} s of motion, real-time factor {factor:.1}");
    }
    divan::main();
}

/// The aluminium pass at 90 steps a turn.
fn shipped(variant: Variant) -> SimulationRun {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/umons-aluminium.toml");
    let overrides = Overrides { variant: Some(variant), ..Overrides::default() };
    let mut run = read_simulation(&file, &overrides).expect("the shipped file is good");
    run.cut.steps_per_turn = 90;
    run
}

fn simulated(run: &SimulationRun) -> Run {
    let job = Job { setup: &run.setup, cutter: &run.cutter, cut: &run.cut, gap: run.gap };
    job.run(&Monitor::silent()).expect("the shipped pass can be started")
}

/// The milling alone, with a tool that does not yield: 32 slices, 90 steps a turn, a thousand turns in the work.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn milling_of_a_thousand_turns(bencher: Bencher) {
    let run = shipped(Variant::Springs);
    let radius = run.cutter.radius();
    let step = 0.05e-3 / 90.0;
    bencher.bench_local(|| {
        let mut milling = MaterialRemoval::with_room(&run.cutter, &run.cut, 0).expect("the shipped cut can be done");
        for index in 0..90_000 {
            let place = [step * f64::from(index), radius];
            black_box(milling.force(f64::from(index), place));
            milling.remember(Node { place, motion: [step, 0.0] });
        }
    });
}
