//! Locks of the system on files: held by one process at a time, and free again when that process ends, however it ends.

use super::options::options;
use std::fs::{File, TryLockError};
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// An open file with the lock on it, as long as it is open.
#[derive(Debug)]
pub struct Lock {
    /// The file.
    pub file: File,
    /// Whether others are kept out: not so where the file system knows no locks.
    pub is_locked: bool,
}

/// What comes of an attempt to lock a file.
#[derive(Debug)]
pub enum TryLock {
    /// It is ours, or there are no locks.
    Taken(Lock),
    /// Another process, or another [`Lock`] of this one, has it.
    Held(File),
}

impl Lock {
    /// Takes the lock on a file, which is made where there is none, unless somebody else has it. Does not wait.
    ///
    /// # Errors
    /// What the system says where the file cannot be opened or locked, or is a link.
    pub fn attempt(path: &Path) -> Result<TryLock> {
        let file = open(path)?;
        Ok(match file.try_lock() {
            Ok(()) => TryLock::Taken(Self { file, is_locked: true }),
            Err(TryLockError::WouldBlock) => TryLock::Held(file),
            Err(TryLockError::Error(cause)) if knows_no_locks(&cause) => {
                TryLock::Taken(Self { file, is_locked: false })
            }
            Err(TryLockError::Error(cause)) => return Err(cause),
        })
    }

    /// As [`Lock::attempt`], but waits until it is free.
    ///
    /// # Errors
    /// As [`Lock::attempt`].
    pub fn wait(path: &Path) -> Result<Self> {
        let file = open(path)?;
        match file.lock() {
            Ok(()) => Ok(Self { file, is_locked: true }),
            Err(cause) if knows_no_locks(&cause) => Ok(Self { file, is_locked: false }),
            Err(cause) => Err(cause),
        }
    }

    /// Whether somebody has the lock on a file.
    pub fn is_held(path: &Path) -> bool {
        let file = options().read(true).open(path);
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

fn open(path: &Path) -> Result<File> {
    options().read(true).write(true).create(true).truncate(false).open(path)
}

/// Whether the file system, or the server that it is on, has no locks to give.
fn knows_no_locks(cause: &Error) -> bool {
    #[cfg(unix)]
    if let Some(libc::ENOLCK | libc::ENOSYS | libc::EOPNOTSUPP) = cause.raw_os_error() {
        return true;
    }
    cause.kind() == ErrorKind::Unsupported
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_has_it_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        assert!(!Lock::is_held(&path));
        let TryLock::Taken(lock) = Lock::attempt(&path).unwrap() else { panic!("it is held") };
        assert!(lock.is_locked && Lock::is_held(&path));
        assert!(matches!(Lock::attempt(&path).unwrap(), TryLock::Held(_)));
        drop(lock);
        assert!(Lock::wait(&path).unwrap().is_locked);
    }

    #[cfg(unix)]
    #[test]
    fn file_systems_without_locks_are_told_from_those_that_fail() {
        for code in [libc::ENOLCK, libc::ENOSYS, libc::EOPNOTSUPP] {
            assert!(knows_no_locks(&Error::from_raw_os_error(code)), "{code}");
        }
        for code in [libc::EIO, libc::EBADF, libc::EWOULDBLOCK] {
            assert!(!knows_no_locks(&Error::from_raw_os_error(code)), "{code}");
        }
    }
}
