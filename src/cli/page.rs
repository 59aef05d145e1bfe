//! `stead page`: the page of a results folder once more.

use super::Failure;
use super::manual::Manual;
use super::output::print;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct PageOptions {
    /// Folder with the results of `stead place` or `stead score --out`
    #[arg(value_name = "RESULTS")]
    folder: PathBuf,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &["stead page results/caro-2013"],
    files: "report.html, cell.glb: the page and the scene, the same as the run has left them",
    failed: "a file could not be written",
    refused: "wrong usage, or a folder that lacks a file, mixes two runs, is of another format or was changed since",
    ..Manual::NEW
};

pub(super) fn run(options: &PageOptions) -> Result<(), Failure> {
    let written = stead::report::write_page(&options.folder)?;
    print(written.iter().map(|path| format!("{}\n", path.display())).collect::<String>().as_bytes())
}
