//! Locks of the system on files: gone with the process that holds them, however it ends.

use super::StudyError;
use std::fs::{File, TryLockError};
use std::path::Path;

/// A lock that is held until this is dropped.
#[derive(Debug)]
pub(super) struct Lock(#[allow(dead_code, reason = "held, not used")] File);

impl Lock {
    /// Takes a lock.
    ///
    /// # Errors
    /// [`StudyError::Locked`] where another process holds it, [`StudyError::File`] where there is none to be had.
    pub fn take(path: &Path, what: &str) -> Result<Self, StudyError> {
        let file = open(path)?;
        match file.try_lock() {
            Ok(()) => Ok(Self(file)),
            Err(TryLockError::WouldBlock) => Err(StudyError::Locked { path: path.to_owned(), what: what.to_owned() }),
            Err(TryLockError::Error(cause)) => Err(StudyError::write(path, cause)),
        }
    }

    /// Takes a lock that nobody holds for long.
    ///
    /// # Errors
    /// [`StudyError::File`] where there is none to be had.
    pub fn wait(path: &Path) -> Result<Self, StudyError> {
        let file = open(path)?;
        file.lock().map_err(|cause| StudyError::write(path, cause))?;
        Ok(Self(file))
    }

    /// Whether somebody holds a lock.
    pub fn is_held(path: &Path) -> bool {
        File::open(path).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

fn open(path: &Path) -> Result<File, StudyError> {
    let file = File::options().create(true).truncate(false).read(true).write(true).open(path);
    file.map_err(|cause| StudyError::write(path, cause))
}
