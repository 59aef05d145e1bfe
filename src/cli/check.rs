//! `stead check`: what was understood of a file, and what looks wrong.

use super::Failure;
use super::environment::environment;
use super::manual::Manual;
use super::output::{files_written, print, say_all, show};
use super::progress::Terminal;
use super::values::input_file;
use clap::Args;
use std::path::PathBuf;
use stead::Checked;
use stead_report::output::Folder;

#[derive(Debug, Args)]
pub(super) struct CheckOptions {
    /// Run file or robot file (TOML), or a shipped arm as name:kuka-kr270-2
    #[arg(value_parser = input_file(), required_unless_present = "environment")]
    file: Option<PathBuf>,
    /// Say in place of it what a report of a fault has to state: version, commit, system, folders
    #[arg(long, conflicts_with_all = ["file", "out", "json"])]
    environment: bool,
    /// Folder for check.svg: the arm as it was understood, with cell and tool path
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print what was understood as one JSON document
    #[arg(long)]
    json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead check my/run.toml",
        "stead check my/run.toml --out results/check",
        "stead check my/kr210.toml --json",
        "stead check --environment",
    ],
    written: "with --out",
    files: "check.svg: the arm from its rows, from the side and from above, with cell and tool path",
    done: "done; what looks wrong is noted",
    failed: "the picture could not be written",
    refused: "wrong usage, bad input, or a folder that cannot be written to",
    ..Manual::NEW
};

pub(super) fn run(options: &CheckOptions) -> Result<(), Failure> {
    let Some(file) = &options.file else { return print(environment().as_bytes()) };
    let checked = Terminal::start(None).during(|monitor| Checked::read_with(file, monitor))?;
    say_all(checked.notes(), checked.warnings());
    if let Some(out) = &options.out {
        let folder = Folder::create(out)?;
        folder.has_no_other(MANUAL.file_names())?;
        files_written(checked.write_in(&folder))?;
    }
    show(&checked, options.json)
}
