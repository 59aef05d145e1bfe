//! How long certificates of the shipped runs take, beside what they may take on two cores:
//! `cargo bench --bench certify` (about three minutes), or `-- NAME` for the runs whose name holds NAME.
//!
//! Each run is placed first, and its own mean deflection is then certified with the rate of beta.

#![allow(clippy::print_stdout, reason = "a benchmark prints")]

use std::error::Error;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Instant;
use stead_certify::best;
use stead_numerics::monitor::{Monitor, Progress};
use stead_placement::place::place;
use stead_problem::settings::CertificateSettings;
use stead_run_files::read_run;

/// Run, gap in per cent, and the time allowed for the certificate on two cores. s
const FLOORS: [(&str, f64, f64); 4] = [
    ("caro-2013", 0.5, 40.0),
    ("caro-2013", 0.2, 120.0),
    ("caro-2013-k1-0.8", 2.0, 60.0),
    ("caro-2013-k1-0.8", 0.75, 240.0),
];

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench`.
    let wanted = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    println!("{} threads", rayon::current_num_threads());
    println!("run               gap %  allowed s  taken s  of it tables s  value mm   bound mm   boxes");
    for (name, percent, allowed) in FLOORS.into_iter().filter(|(name, ..)| name.contains(&wanted)) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("configs/{name}.toml"));
        let run = read_run(&file)?;
        let outcome = place(&run.problem, &run.search, &run.transfer, &Monitor::silent())?;
        let value = outcome.cases.best.plan.mean;
        let started = Instant::now();
        // Time until the tables were there. s
        let tables = Arc::new(OnceLock::new());
        let first = Arc::clone(&tables);
        let monitor = Monitor::new(move |progress| {
            if matches!(progress, Progress::Bound { nodes: 1.., .. }) {
                first.get_or_init(|| started.elapsed().as_secs_f64());
            }
        });
        let bound = best(&run.problem, value, &CertificateSettings::new(percent / 100.0), &monitor)?;
        println!(
            "{name:<16}  {percent:>5}  {allowed:>9}  {:>7.1}  {:>14.1}  {:.7}  {:.7}  {} ({:?})",
            started.elapsed().as_secs_f64(),
            tables.get().copied().unwrap_or_default(),
            value * 1e3,
            bound.bound * 1e3,
            bound.nodes,
            bound.status
        );
    }
    Ok(())
}
