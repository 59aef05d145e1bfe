//! `stead study`: many cases of one run.

mod report;
mod run;
mod slurm;
mod status;

use super::arguments::StudyCommand;
use super::{Failure, say};
use std::path::{Path, PathBuf};
use stead::StudyStatus;

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

/// Says which kept cases are left of the study as it was before an edit.
fn say_stale(status: &StudyStatus) {
    if !status.stale.is_empty() {
        let cases = counted_cases(status.stale.len());
        let names = status.stale.join(", ");
        say(&format!("note: {cases} not of the study as it is now: {names}; `stead study run --prune` removes them"));
    }
}

fn counted_cases(count: usize) -> String {
    format!("{count} kept {}", if count == 1 { "case" } else { "cases" })
}
