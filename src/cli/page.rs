//! `stead page`: the page of a results folder once more.

use super::{Failure, print};
use clap::Args;
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Example:
  stead page results/caro-2013

Files written to the results folder:
  report.html, cell.glb              the page and the scene, the same as the run has left them

Exit codes:
  0  done
  1  a file could not be written
  2  wrong usage, or a folder that lacks a file, mixes two runs, is of another format or was changed since";

#[derive(Debug, Args)]
pub(super) struct PageOptions {
    /// Folder with the results of `stead place` or `stead score --out`
    #[arg(value_name = "RESULTS")]
    folder: PathBuf,
}

pub(super) fn run(options: &PageOptions) -> Result<(), Failure> {
    let written = stead::write_page(&options.folder)?;
    print(written.iter().map(|path| format!("{}\n", path.display())).collect::<String>().as_bytes())
}
