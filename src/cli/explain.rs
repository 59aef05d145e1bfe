//! `stead explain`: one placement, one path point, one beta, eight postures.

use super::Failure;
use super::given::{GivenPlacement, GivenRun};
use super::manual::Manual;
use super::output::{say_all, show};
use super::progress::Terminal;
use super::values::{finite, point};
use clap::Args;

#[derive(Debug, Args)]
pub(super) struct ExplainOptions {
    #[command(flatten)]
    pub run: GivenRun,
    #[command(flatten)]
    pub place: GivenPlacement,
    /// Path point, counted from 0 in the order of the task file
    #[arg(long, value_name = "I", value_parser = point, allow_negative_numbers = true)]
    pub point: usize,
    /// Free angle beta about the tool axis in degrees
    #[arg(long, value_name = "B", value_parser = finite, allow_hyphen_values = true)]
    pub beta_deg: f64,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead explain configs/caro-2013.toml --x-mm 2.2 --y-mm -1643.5 --z-mm -556.4 --q4 0.9258 --point 30 --beta-deg 40",
        "stead explain configs/caro-2013.toml --placement-of results/caro-2013 --point 30 --beta-deg 40",
    ],
    written: "none",
    done: "done, whether or not any posture is feasible",
    ..Manual::NEW
};

pub(super) fn run(options: &ExplainOptions) -> Result<(), Failure> {
    let run = options.run.read(&Terminal::start(None), None)?;
    let (run, placement) = options.place.of(run)?;
    let beta = options.beta_deg.to_radians();
    let explanations = run.explain(&placement, options.point, beta).map_err(|error| Failure::at("--point", error))?;
    say_all(explanations.notes(), explanations.warnings());
    show(&explanations, options.json)
}
