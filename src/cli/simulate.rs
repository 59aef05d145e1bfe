//! `stead simulate`: a pass with an arm that yields, then files, then a text.

use super::Failure;
use super::given::ModelArguments;
use super::manual::{Manual, STOPPED};
use super::output::{out_folder, results_in, say_all};
use super::progress::Terminal;
use super::values::input_file;
use clap::Args;
use std::path::PathBuf;
use stead::SimulationRun;
use stead::simulation::Overrides;

#[derive(Debug, Args)]
pub(super) struct SimulateOptions {
    /// Simulation file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    #[command(flatten)]
    pub model: ModelArguments,
    /// Folder for the results [default: results/<name of the simulation file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of a text
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead simulate configs/umons-aluminium.toml",
        "stead simulate configs/umons-aluminium.toml --variant gravity",
        "stead simulate configs/umons-steel.toml --damping-scale 10 --out results/steel-damped",
    ],
    files: "\
series.csv: forces and tool positions over time
wall.csv, wall.svg: profile of the wall that is left, and its roughness
forces.svg, turns.svg: forces over the pass, and over three turns of the spindle
summary.json: all of it for programs
report.html: a page whose charts answer to the pointer",
    done: "done; an unstable cut is a result, too",
    failed: "the pass cannot be simulated, or a file could not be written",
    refused: "wrong usage, bad input, or a results folder that cannot be written to",
    interrupted: STOPPED,
    ..Manual::NEW
};

pub(super) fn run(options: &SimulateOptions) -> Result<(), Failure> {
    let run = SimulationRun::read_with(&options.config, &Overrides::from(&options.model))?;
    let out = out_folder(options.out.as_deref(), &options.config, &MANUAL)?;
    let pass = Terminal::start(Some(&out.folder)).during(|monitor| run.simulate(monitor))?;
    say_all(pass.notes(), pass.warnings());
    out.show(pass.write_in(&out.folder), &pass, options.json, results_in)
}
