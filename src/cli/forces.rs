//! `stead forces`: the forces of a tool path from the stock that it cuts.

use super::Failure;
use super::given::Force;
use super::manual::{Manual, STOPPED};
use super::output::{print, print_json, say_notes, say_warnings};
use super::progress::Terminal;
use super::values::{input_file, threads};
use clap::Args;
use std::path::PathBuf;
use stead::forces::ForcesRun;

#[derive(Debug, Args)]
pub(super) struct ForcesOptions {
    /// Forces file (TOML): path, stock, cutter
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Task file (CSV) to write; the other files go beside it
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    #[command(flatten)]
    pub force: Force,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead forces configs/forces-pocket.toml --out my/pocket.csv",
        "stead forces my/forces.toml --out my/part.csv --json",
    ],
    written: "as --out names them",
    files: "\
NAME.csv: the task: path points with force and moment, points added where the force is not straight between two
NAME-engagement.csv: chip and edge part, removed volume, heights and angles of the cut, largest force in a turn
NAME-forces.svg: force, moment, height, angles and chip along the path
NAME-forces.html: a page whose charts answer to the pointer
NAME-stock-before.stl, NAME-stock-after.stl: the stock before the path and what is left, thinned, in mm
NAME-forces.json: what --json prints",
    remarks: "A run file that names the task takes its forces from it. Forces are means over a turn at the programmed feed.",
    refused: "wrong usage, bad input, stock that the path does not touch, or a file that is there already (--force replaces it): nothing is written",
    interrupted: STOPPED,
    ..Manual::NEW
};

pub(super) fn run(options: &ForcesOptions) -> Result<(), Failure> {
    let run = ForcesRun::read(&options.config)?;
    // What is there and to be kept is found out before the long work.
    run.check_files(&options.out, options.force.existing())?;
    say_notes(run.notes());
    let forces = Terminal::start(None).on_threads(options.threads, |monitor| run.compute(monitor))??;
    say_notes(forces.notes().get(run.notes().len()..).unwrap_or_default());
    say_warnings(forces.warnings());
    let files = forces.write(&options.out, options.force.existing())?;
    if options.json {
        return print_json(&forces.to_json());
    }
    let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    print(format!("{forces}\nwritten: {}\n", files.join(", ")).as_bytes())
}
