//! `stead compensate`: correct a path, then files, then a table.

use super::Failure;
use super::manual::{Manual, STOPPED};
use super::output::{out_folder, print_json, say_all, say_notes, say_warnings};
use super::progress::Terminal;
use super::values::input_file;
use clap::Args;
use std::path::PathBuf;
use stead::{CompensationRun, Error};

#[derive(Debug, Args)]
pub(super) struct CompensateOptions {
    /// Compensation file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Robot file (TOML) of the same geometry on which the corrected path is evaluated, instead of the file's `reality`
    #[arg(long, value_name = "ROBOT")]
    pub reality: Option<PathBuf>,
    /// Fail where a point cannot be corrected, instead of keeping its target
    #[arg(long)]
    pub all_or_nothing: bool,
    /// Folder for the results [default: results/<name of the compensation file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead compensate configs/compensate-caro-2013.toml",
        "stead compensate configs/compensate-caro-2013.toml --reality configs/robots/kuka-kr270-2-k1-0.8.toml --out results/check",
    ],
    files: "\
corrected-path.csv: target and commanded pose, joint angles, deflection before and after, status
compensation.svg: deflection before and after along the path
summary.json: all of it for programs
report.html: a page whose charts answer to the pointer",
    done: "done; points that cannot be compensated keep their target, and a warning says so",
    failed: "no point can be compensated, or with --all-or-nothing some cannot; nothing is written, the message names them with the reason",
    refused: "wrong usage, bad input, a plan that does not fit its run, or a results folder that cannot be written to",
    interrupted: STOPPED,
    ..Manual::NEW
};

pub(super) fn run(options: &CompensateOptions) -> Result<(), Failure> {
    let terminal = Terminal::start(None);
    let run =
        terminal.during(|monitor| CompensationRun::read_with(&options.config, options.reality.as_deref(), monitor))?;
    let out = out_folder(options.out.as_deref(), &options.config, &MANUAL)?;
    terminal.holds(&out.folder);
    say_all(run.notes(), run.warnings());
    let path = terminal
        .during(|monitor| if options.all_or_nothing { run.compensate_all(monitor) } else { run.compensate(monitor) });
    let path = path.inspect_err(|error| {
        if let (true, Error::NotCompensated(failure)) = (options.json, error) {
            // What cannot be printed is said as the error all the same.
            let _ = print_json(&run.not_compensated_json(failure));
        }
    })?;
    say_notes(path.notes().get(run.notes().len()..).unwrap_or_default());
    say_warnings(path.warnings().get(run.warnings().len()..).unwrap_or_default());
    out.show(path.write_in(&out.folder), &path, options.json, |folder| {
        if folder.is_empty() { folder } else { format!("results in {folder}\n") }
    })
}
