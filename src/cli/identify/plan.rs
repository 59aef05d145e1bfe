//! `stead identify plan`: the measurements to take.

use super::super::Failure;
use super::super::output::{out_folder, say_notes};
use super::super::progress::Terminal;
use crate::cli::manual::{Manual, STOPPED};
use crate::cli::values::{input_file, seed, threads};
use clap::Args;
use std::path::PathBuf;
use stead::DesignRun;
use stead_report::identification::plan::SHEET;

#[derive(Debug, Args)]
pub(in crate::cli) struct IdentifyPlanOptions {
    /// Identification file (TOML) with a table [plan]
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Folder for the results [default: results/<name of the identification file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Seed of the random numbers, instead of the file's
    #[arg(long, value_name = "S", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(in crate::cli) const MANUAL: Manual = Manual {
    examples: &[
        "stead identify plan configs/identify-plan-example.toml",
        "stead identify plan configs/identify-plan-example.toml --seed 2 --out results/plan-2",
    ],
    files: "\
sheet.csv: the measurement sheet to be filled in; never overwritten once it holds a reading
expected.csv, plan.svg: the standard deviations that `identify fit` will report, and the same for random sets
plan.json: all of it for programs",
    failed: "too few configurations or test poses are within the limits, or no compliance is identifiable",
    refused: "wrong usage, bad input, or a sheet with readings in the results folder",
    interrupted: STOPPED,
    ..Manual::NEW
};

pub(super) fn run(options: &IdentifyPlanOptions) -> Result<(), Failure> {
    let run = DesignRun::read_with(&options.config, options.seed)?;
    let out = out_folder(options.out.as_deref(), &options.config, &MANUAL)?;
    run.check_folder(out.folder.path())?;
    say_notes(run.notes());
    let plan = Terminal::start(Some(&out.folder)).on_threads(options.threads, |monitor| run.plan(monitor))??;
    out.show(plan.write_in(&out.folder), &plan, options.json, |folder| {
        if folder.is_empty() {
            folder
        } else {
            format!("\n{SHEET} to be filled in, and what it will tell, in {folder}\n")
        }
    })
}
