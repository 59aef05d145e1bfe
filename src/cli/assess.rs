//! `stead assess`: maps of circularity, then files, then tables.

use super::Failure;
use super::manual::{Manual, STOPPED};
use super::output::{out_folder, say_notes};
use super::progress::Terminal;
use super::values::{input_file, positive, threads};
use clap::Args;
use std::path::PathBuf;
use stead::AssessmentRun;

#[derive(Debug, Args)]
pub(super) struct AssessOptions {
    /// Assessment file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Folder for the results [default: results/<name of the assessment file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Wanted accuracy in mm, instead of the list in the file
    #[arg(long, value_name = "A", value_parser = positive, allow_hyphen_values = true)]
    pub accuracy_mm: Option<f64>,
    /// Cutting force in N for the wanted accuracy, instead of the list in the file
    #[arg(long, value_name = "F", value_parser = positive, allow_hyphen_values = true)]
    pub force_n: Option<f64>,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead assess configs/klimchik-2017.toml",
        "stead assess configs/horizontal-slot.toml --accuracy-mm 0.2 --force-n 500",
    ],
    files: "\
map-<robot>.{csv,svg}: circularity over the plane under the test load; the table has every circle under both loads
circularity.csv: smallest, largest and middle circularity of each robot and where, beside published values
optimal-zones.csv, middle-zones.csv: largest circularity in square zones
accuracy.csv: with forces: circularity at the best place without compensation
selection.csv: with forces and accuracies: which robots reach which accuracy
indicators.svg: accuracy, reach, payload and price side by side, as far as given
cutting.svg, cutting-*.csv: with a cutter and a cut: force and torque over a turn
summary.json: all of it for programs
report.html: a page whose charts answer to the pointer",
    failed: "no robot can mill the circle anywhere on the map",
    refused: "wrong usage, bad input, or a results folder that cannot be written to",
    interrupted: STOPPED,
    ..Manual::NEW
};

pub(super) fn run(options: &AssessOptions) -> Result<(), Failure> {
    let accuracy = options.accuracy_mm.map(|accuracy| accuracy / 1e3);
    let run = AssessmentRun::read(&options.config)?
        .selecting(accuracy, options.force_n)
        .map_err(|error| Failure::at("--accuracy-mm and --force-n", error))?;
    let out = out_folder(options.out.as_deref(), &options.config, &MANUAL)?;
    say_notes(run.notes());
    let assessment =
        Terminal::start(Some(&out.folder)).on_threads(options.threads, |monitor| run.assess(monitor))??;
    let timing = assessment.timing();
    out.show(assessment.write_in(&out.folder), &assessment, options.json, |folder| {
        let folder = if folder.is_empty() { folder } else { format!("; results in {folder}") };
        format!("in {:.1} s on {} threads{folder}\n", timing.wall, timing.threads)
    })
}
