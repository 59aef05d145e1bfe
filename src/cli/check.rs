//! `stead check`: what was understood of a file, and what looks wrong.

use super::{Failure, files_written, print, print_json, say_notes};
use clap::Args;
use std::path::PathBuf;
use stead::Checked;
use stead_report::output::Folder;

#[derive(Debug, Args)]
pub(super) struct CheckOptions {
    /// Run file or robot file (TOML), or a shipped arm as name:kuka-kr270-2
    file: PathBuf,
    /// Folder for check.svg: the arm as it was understood, with cell and tool path
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print what was understood as one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn run(options: &CheckOptions) -> Result<(), Failure> {
    let checked = Checked::read(&options.file)?;
    say_notes(checked.notes());
    if let Some(out) = &options.out {
        let folder = Folder::create(out).map_err(Failure::Output)?;
        files_written(checked.write_in(&folder))?;
    }
    if options.json { print_json(&checked) } else { print(checked.to_string().as_bytes()) }
}
