//! Studies: many cases of one run, done side by side, in shards, and safe at any moment.
//!
//! A [`Plan`] is all cases of a study file in a fixed order, each with the digest of all that its result depends on. A
//! shard I of N does the cases I, I + N, and so on ([`run`]). Finished cases go into a journal of the shard, line by
//! line, so that a run that was killed goes on where it was. Rows are found again by the digest of their case: those
//! that an edit of the study has not touched are not computed anew. Once every case of the plan is done, the table of
//! results is written ([`merge`]); its bytes depend on nothing but the study.

mod journal;
mod keeping;
mod lock;
mod merge;
mod plan;
mod progress;
mod row;
mod shard;
mod slurm;
mod store;
mod table;
#[cfg(test)]
mod tests;

pub use keeping::Keeping;
pub use merge::{TABLE, merge, merged};
pub use plan::{Plan, PlannedCase};
pub use progress::{ShardStatus, StudyStatus, status};
pub use row::{CaseStatus, result_columns};
pub use shard::{Finished, RunSettings, run};
pub use slurm::slurm_script;
pub use store::Shard;
pub use table::{Column, ColumnKind, Table, TableCell};

use std::fmt::Display;
use std::path::{Path, PathBuf};
use stead_disk::input::InputError;
use stead_numerics::monitor::Stop;
use stead_runs::ReadError;

/// Why a study cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The study file, its base or a case is wrong.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The caller stopped it before the cases were read.
    #[error(transparent)]
    Stopped(#[from] Stop),
    /// Another process works on the same.
    #[error("{}: {what} is being worked on by another process; allowed: another folder, or wait until that has ended", path.display())]
    Locked {
        /// The file that is locked.
        path: PathBuf,
        /// What it stands for.
        what: String,
    },
    /// The folder holds something else.
    #[error("{}: {problem}; allowed: {allowed}", path.display())]
    Folder {
        /// The folder or the file in it.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// What would be accepted.
        allowed: String,
    },
    /// A file cannot be read or written.
    #[error("{}: cannot be {done}: {cause}; finished cases are kept", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What cannot be done with it.
        done: &'static str,
        /// What the system says.
        cause: std::io::Error,
    },
    /// A table could not be put into its format.
    #[error("{what} cannot be made: {cause}")]
    Format {
        /// What.
        what: &'static str,
        /// What the writer says.
        cause: String,
    },
    /// The files of a case, or the table, could not be written.
    #[error("{0}; finished cases are kept")]
    Keep(String),
}

impl From<ReadError> for StudyError {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Input(error) => Self::Input(error),
            ReadError::Stopped(stop) => Self::Stopped(stop),
        }
    }
}

impl StudyError {
    pub(crate) fn format(what: &'static str, cause: &dyn Display) -> Self {
        Self::Format { what, cause: cause.to_string() }
    }

    pub(crate) fn write(path: &Path, cause: std::io::Error) -> Self {
        Self::File { path: path.to_owned(), done: "written", cause }
    }

    pub(crate) fn read(path: &Path, cause: std::io::Error) -> Self {
        Self::File { path: path.to_owned(), done: "read", cause }
    }
}
