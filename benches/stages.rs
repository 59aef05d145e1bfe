//! Where the time of a placement goes: `cargo bench --bench stages -- RUN.toml` prints the reports of progress,
//! processor and wall seconds of every stage, what came before a report counted to its stage. Without a run file, that
//! of the shipped long path.
//!
//! Searches and refinements of the best and the worst placement run side by side and share their time.

#![allow(clippy::print_stdout, reason = "a benchmark prints")]

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use stead_numerics::monitor::{Monitor, Progress};
use stead_placement::place::place;
use stead_run_files::read_run;

/// The time of a stage.
struct Stage {
    name: &'static str,
    reports: usize,
    processor: f64,
    wall: f64,
}

/// The stages in the order in which they began, and when the last report was.
struct Stages {
    all: Vec<Stage>,
    last: (f64, Instant),
}

impl Stages {
    fn add(&mut self, name: &'static str) {
        let now = (processor_seconds(), Instant::now());
        let place = self.all.iter().position(|stage| stage.name == name).unwrap_or_else(|| {
            self.all.push(Stage { name, reports: 0, processor: 0.0, wall: 0.0 });
            self.all.len() - 1
        });
        let stage = &mut self.all[place];
        stage.reports += 1;
        stage.processor += now.0 - self.last.0;
        stage.wall += (now.1 - self.last.1).as_secs_f64();
        self.last = now;
    }
}

/// Of this process, by Linux in hundredths of a second; zero elsewhere.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn main() -> Result<(), Box<dyn Error>> {
    let given = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).map(PathBuf::from);
    let shipped = || Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/restricted-space.toml");
    let run = read_run(&given.unwrap_or_else(shipped))?;
    let start = (processor_seconds(), Instant::now());
    let stages = Arc::new(Mutex::new(Stages { all: Vec::new(), last: start }));
    let seen = Arc::clone(&stages);
    let monitor = Monitor::new(move |progress| match progress {
        Progress::Search { stage, .. } | Progress::Steps { stage, .. } | Progress::Bound { stage, .. } => {
            seen.lock().unwrap_or_else(PoisonError::into_inner).add(stage);
        }
        Progress::Note { .. } => {}
    });
    let outcome = place(&run.problem, &run.search, &run.transfer, &monitor)?;
    let mut stages = stages.lock().unwrap_or_else(PoisonError::into_inner);
    stages.add("what is stated");
    println!("{} points, best {:.6} mm", run.problem.task.points().len(), outcome.cases.best.plan.mean * 1e3);
    println!("stage                          reports  processor s  wall s");
    for Stage { name, reports, processor, wall } in &stages.all {
        println!("{name:<30} {reports:>7}  {processor:>11.2}  {wall:>6.2}");
    }
    println!("all {:>34.2}  {:>11.2}", processor_seconds() - start.0, start.1.elapsed().as_secs_f64());
    Ok(())
}
