//! How much better could any other placement be? `cargo run --release --example certify`

#![allow(clippy::print_stdout, reason = "an example prints what it finds")]

use stead::{Monitor, Progress, Run};

fn main() -> Result<(), stead::Error> {
    // Within 5 per cent, and for the best placement alone: a second or two.
    let run = Run::read("configs/caro-2013.toml")?.without_worst().with_certificate(Run::gap(5.0)?);
    if let Some(warning) = run.certificate_warning() {
        println!("this run has no certificate: {warning}");
    }
    let mut placements = run.search(&Monitor::silent())?;
    let found = placements.cases().best.plan.mean;

    // Meanwhile it says how near the bound is.
    let monitor = Monitor::new(|progress| {
        if let Progress::Bound { value, bound, open, .. } = progress
            && *bound > 0.0
        {
            println!("{:.2} % with {open} boxes open", (value / bound - 1.0) * 100.0);
        }
    });
    if let Some(Ok(proof)) = placements.certify(&monitor).map(|certificate| &certificate.best) {
        println!("found {:.4} mm; no placement is below {:.4} mm", found * 1e3, proof.bound.bound * 1e3);
    }
    println!("{}", placements.certificate_text().unwrap_or_default());
    Ok(())
}
