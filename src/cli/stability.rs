//! `stead stability`: whether a cut chatters, then files, then a text.

use super::Failure;
use super::given::ModelArguments;
use super::manual::{Manual, STOPPED};
use super::output::{out_folder_named, results_in, say_all};
use super::progress::Terminal;
use super::values::{input_file, threads};
use clap::Args;
use std::path::PathBuf;
use stead::StabilityRun;
use stead::simulation::Overrides;

#[derive(Debug, Args)]
pub(super) struct StabilityOptions {
    /// Simulation file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    #[command(flatten)]
    pub model: ModelArguments,
    /// Folder for the results [default: results/<name of the simulation file>-stability]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document instead of a text
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead stability configs/umons-steel.toml",
        "stead stability configs/umons-steel.toml --damping-scale 10 --spindle-rpm 5000 --out results/steel-5000",
    ],
    files: "\
lobes.{csv,svg}: critical depth over spindle speed, by semi-discretisation and by the zero-order solution
frequency-response.{csv,svg}: frequency response function of the tool tip: along the feed, along the wall normal, and \
    cross
modes.csv: natural frequencies, damping ratios and mode shapes
summary.json: all of it for programs, with the verdict on the given cut
report.html: a page whose charts answer to the pointer",
    done: "done, whether the cut is stable or not",
    failed: "the small motions of the arm cannot be computed there, or a file could not be written",
    refused: "wrong usage, bad input, or a results folder that cannot be written to",
    interrupted: STOPPED,
    ..Manual::NEW
};

pub(super) fn run(options: &StabilityOptions) -> Result<(), Failure> {
    let run = StabilityRun::read_with(&options.config, &Overrides::from(&options.model))?;
    let out = out_folder_named(options.out.as_deref(), &options.config, "-stability", &MANUAL)?;
    let analysis = Terminal::start(Some(&out.folder)).on_threads(options.threads, |monitor| run.analyse(monitor))??;
    say_all(analysis.notes(), analysis.warnings());
    out.show(analysis.write_in(&out.folder), &analysis, options.json, results_in)
}
