//! `stead study`: many cases of one run.

pub(super) mod report;
pub(super) mod run;
pub(super) mod slurm;
pub(super) mod status;

use super::progress::Terminal;
use super::{Failure, on_threads, say};
use clap::Subcommand;
use std::path::{Path, PathBuf};
use stead::Study;
use stead::study::StudyStatus;

#[derive(Debug, Subcommand)]
pub(super) enum StudyCommand {
    /// Do what is left to do of a study, or of a shard of it; goes on where it was after a crash
    Run(run::StudyRunOptions),
    /// Print the script of a Slurm array that does a study, one shard an element
    Slurm(slurm::StudySlurmOptions),
    /// Show how far a study is, shard by shard
    Status(status::StudyStatusOptions),
    /// Rank the layouts of a study that is done, with fronts, effects and pictures
    Report(report::StudyReportOptions),
}

pub(super) fn run(command: &StudyCommand, program: &Path) -> Result<(), Failure> {
    match command {
        StudyCommand::Run(options) => run::run(options),
        StudyCommand::Slurm(options) => slurm::run(options, program),
        StudyCommand::Status(options) => status::run(options),
        StudyCommand::Report(options) => report::run(options),
    }
}

/// Reads a study and all its cases, whose forces may have to be computed, on so many threads.
fn read(config: &Path, threads: Option<usize>, terminal: &Terminal) -> Result<Study, Failure> {
    let shown = terminal.show(None);
    Ok(on_threads(threads, || Study::read_with(config, &shown.monitor))??)
}

/// The folder requested, or `results/` and the name of the study.
fn folder(requested: Option<&Path>, config: &Path) -> PathBuf {
    requested.map_or_else(|| Path::new("results").join(config.file_stem().unwrap_or_default()), Path::to_owned)
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
