//! `stead identify`: which measurements to take, and joint compliances from them.

pub(super) mod plan;

use super::Failure;
use super::output::{out_folder, results_in, say_notes};
use super::progress::Terminal;
use super::values::input_file;
use crate::cli::manual::{Manual, STOPPED};
use clap::{Args, Subcommand};
use std::path::PathBuf;
use stead::FitRun;

#[derive(Debug, Subcommand)]
pub(super) enum IdentifyCommand {
    /// Fit compliances, compensator and covariance to a filled measurement sheet; writes a robot file
    Fit(IdentifyFitOptions),
    /// Choose the configurations and loads to measure; writes the sheet to fill in
    Plan(plan::IdentifyPlanOptions),
}

#[derive(Debug, Args)]
pub(super) struct IdentifyFitOptions {
    /// Identification file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Folder for the results [default: results/<name of the identification file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(in crate::cli) const MANUAL: Manual = Manual {
    examples: &[
        "stead identify fit configs/identify-example.toml",
        "stead identify fit configs/identify-example.toml --json --out results/arm-17",
    ],
    files: "\
robot-identified.toml: the robot file with the identified values and a table [covariance]; all else, comments \
    included, is unchanged
compliances.csv: every estimate with standard deviation and 95 % interval
residuals.csv, deflections.svg: every reading beside what the identified arm gives
report.json: all of it for programs, with tracker position and reference points
report.html: a page whose charts answer to the pointer",
    failed: "sound readings for which no spring or no positive compliance is found",
    refused: "wrong usage, bad input, or readings from which the parameters are not identifiable",
    interrupted: STOPPED,
    ..Manual::NEW
};

pub(super) fn run(command: &IdentifyCommand) -> Result<(), Failure> {
    match command {
        IdentifyCommand::Fit(options) => fit(options),
        IdentifyCommand::Plan(options) => plan::run(options),
    }
}

fn fit(options: &IdentifyFitOptions) -> Result<(), Failure> {
    let run = FitRun::read(&options.config)?;
    let out = out_folder(options.out.as_deref(), &options.config, &MANUAL)?;
    say_notes(run.notes());
    let robot = Terminal::start(Some(&out.folder)).during(|monitor| run.fit(monitor))?;
    out.show(robot.write_in(&out.folder), &robot, options.json, results_in)
}
