//! `stead study`: many cases of one run.

mod read;
pub(super) mod report;
pub(super) mod run;
pub(super) mod slurm;
pub(super) mod status;

use super::Failure;
use clap::Subcommand;
use std::path::Path;

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
