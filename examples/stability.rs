//! Will the cut chatter, and how deep may it be? `cargo run --release --example stability`

#![allow(clippy::print_stdout, reason = "an example prints what it finds")]

use stead::simulation::overrides;
use stead::{Monitor, StabilityRun};

fn main() -> Result<(), stead::Error> {
    for damping in [1.0, 20.0] {
        // The steel cut of the file, with the damping of the arm times a factor.
        let changed = overrides(None, Some(damping), None)?;
        let analysis = StabilityRun::read_with("configs/umons-steel.toml", &changed)?.analyse(&Monitor::silent())?;
        let cut = &analysis.analysis().cut_stability;
        let verdict = if cut.verdict.is_stable() { "calm" } else { "chatters" };
        match cut.semi_discretisation {
            Some(depth) => println!("damping x {damping}: {verdict}, from {:.2} mm on it chatters", depth * 1e3),
            None => println!("damping x {damping}: {verdict} at all depths"),
        }
    }
    Ok(())
}
