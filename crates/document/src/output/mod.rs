//! The folder that results go to, and the error of this room.
//!
//! One process at a time writes to a [`Folder`] (`lock`). The files of a run are put in place as one set
//! (`transaction`), with `manifest.json` ([`stead_disk::manifest`]) last: a run that is killed leaves the results of
//! the run before, or a folder that every reader refuses, and the next run clears up what it has left.

mod folder;
mod lock;
mod transaction;

pub use folder::Folder;
pub use lock::{Lock, LockError};
pub use transaction::Transaction;

use std::path::PathBuf;
use stead_disk::files::is_of_disk;

/// Why a result could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The output folder is not there and cannot be made, something else stands in its place, or nothing can be written
    /// to it.
    #[error("{}: results cannot be written here: {cause}; allowed: a folder that can be made or written to", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// Another run writes to the folder.
    #[error(
        "{}: results cannot be written here: another run of stead{} writes to this folder; allowed: another folder, or wait until the other \
         run has ended",
        path.display(),
        process.map_or_else(String::new, |id| format!(" (process {id})"))
    )]
    Locked {
        /// The folder.
        path: PathBuf,
        /// The number of the other process, where it is known.
        process: Option<u32>,
    },
    /// There is a file that stead has not written, and that it would have to replace.
    #[error("{}: is none of stead and is left as it is: {problem}; allowed: another folder", path.display())]
    OtherManifest {
        /// The file.
        path: PathBuf,
        /// Why it is none.
        problem: String,
    },
    /// Files would join results of another run.
    #[error(
        "{}: is not from the run that these files belong to; allowed: the folder with the results of that run, or one without results",
        path.display()
    )]
    OtherRun {
        /// The file by which the runs were distinguished.
        path: PathBuf,
    },
    /// A file cannot be written. What stood at the path before is left as it was, or the folder is marked as
    /// incomplete.
    #[error("{}: cannot be written: {cause}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// A result could not be put into its format.
    #[error("{what} cannot be made: {cause}")]
    Format {
        /// Which result.
        what: &'static str,
        /// What the writer of the format says.
        cause: String,
    },
}

impl ReportError {
    /// Whether there was no room on the disk, so that nothing is wrong with the place.
    pub fn is_of_disk(&self) -> bool {
        matches!(self, Self::Folder { cause, .. } | Self::File { cause, .. } if is_of_disk(cause))
    }
}
