//! Locks of a study: gone with the process that holds them, however it ends.

use super::StudyError;
use std::path::Path;
use stead_disk::files::{self, TryLock};

/// A lock that is held until this is dropped, or none where the file system knows no locks.
#[derive(Debug)]
pub(super) struct Lock(files::Lock);

impl Lock {
    /// Takes a lock.
    ///
    /// # Errors
    /// [`StudyError::Locked`] where another process holds it, [`StudyError::File`] where there is none to be had.
    pub fn take(path: &Path, what: &str) -> Result<Self, StudyError> {
        match files::Lock::attempt(path).map_err(|cause| StudyError::write(path, cause))? {
            TryLock::Taken(lock) => Ok(Self(lock)),
            TryLock::Held(_) => Err(StudyError::Locked { path: path.to_owned(), what: what.to_owned() }),
        }
    }

    /// Takes a lock that nobody holds for long.
    ///
    /// # Errors
    /// [`StudyError::File`] where there is none to be had.
    pub fn wait(path: &Path) -> Result<Self, StudyError> {
        files::Lock::wait(path).map(Self).map_err(|cause| StudyError::write(path, cause))
    }

    /// Removes the temporary files that a killed process has left, by how their names begin: the process that writes
    /// such files holds the lock.
    pub fn clean(&self, folder: &Path, prefix: &str) {
        if self.0.is_locked {
            files::remove_stale(folder, prefix);
        }
    }

    /// Whether somebody holds a lock.
    pub fn is_held(path: &Path) -> bool {
        files::Lock::is_held(path)
    }
}
