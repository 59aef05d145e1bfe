//! `stead circularity`: roundness of measured points.

use super::Failure;
use super::manual::Manual;
use super::output::{files_written, print, print_json, results_in, say_warnings};
use super::values::{input_file, sector};
use clap::Args;
use std::path::PathBuf;
use stead::circularity::Profile;
use stead_assessment::roundness::Sector;
use stead_report::output::Folder;

#[derive(Debug, Args)]
pub(super) struct CircularityOptions {
    /// Measured points (CSV with x_mm,y_mm or x_mm,y_mm,z_mm)
    #[arg(value_parser = input_file())]
    pub points: PathBuf,
    /// Exclude points from angle A to B in degrees about the least-squares centre; may be repeated
    #[arg(long, value_name = "A:B", value_parser = sector, allow_hyphen_values = true)]
    pub exclude_deg: Vec<Sector>,
    /// Folder for circularity.json, deviations.csv, polar.svg and report.html [default: nothing is written]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead circularity tasks/measured-groove.csv",
        "stead circularity tasks/measured-groove.csv --exclude-deg 354:7 --out results/measured-groove",
    ],
    written: "with --out",
    files: "\
circularity.json: the four reference circles with their circularity
deviations.csv: angle, radii and deviations from each circle of every point
polar.svg: the profile between its zone circles, the deviation magnified as stated
report.html: a page whose charts answer to the pointer",
    failed: "a file could not be written",
    refused: "wrong usage, bad input, points that lie on no circle, or a folder that cannot be written to",
    ..Manual::NEW
};

pub(super) fn run(options: &CircularityOptions) -> Result<(), Failure> {
    let circularity = Profile::read(&options.points)?.circularity(&options.exclude_deg)?;
    say_warnings(circularity.warnings());
    let mut folder = String::new();
    if let Some(out) = &options.out {
        let out = Folder::create(out)?;
        out.has_no_other(MANUAL.file_names())?;
        files_written(circularity.write_in(&out))?;
        folder = out.path().display().to_string();
    }
    if options.json {
        return print_json(&circularity);
    }
    print(format!("{circularity}{}", results_in(folder)).as_bytes())
}
