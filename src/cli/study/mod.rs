//! `stead study`: many cases of one run.

mod report;
mod run;
mod slurm;
mod status;

use super::Failure;
use super::arguments::StudyCommand;
use std::path::{Path, PathBuf};

pub(super) fn run(command: &StudyCommand) -> Result<(), Failure> {
    match command {
        StudyCommand::Run(options) => run::run(options),
        StudyCommand::Slurm(options) => slurm::run(options),
        StudyCommand::Status(options) => status::run(options),
        StudyCommand::Report(options) => report::run(options),
    }
}

/// The folder asked for, or `results/` and the name of the study.
fn folder(asked: Option<&Path>, config: &Path) -> PathBuf {
    asked.map_or_else(|| Path::new("results").join(config.file_stem().unwrap_or_default()), Path::to_owned)
}
