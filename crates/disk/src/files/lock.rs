//! Locks of the system on files: held by one process at a time, and free again when that process ends, however it ends.

use super::options::open_own;
use std::fs::File;
use std::io::Result;
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
        system::attempt(path, false)
    }

    /// As [`Lock::attempt`], but waits until it is free.
    ///
    /// # Errors
    /// As [`Lock::attempt`].
    pub fn wait(path: &Path) -> Result<Self> {
        system::wait(path)
    }

    /// Whether somebody has the lock on a file.
    pub fn is_held(path: &Path) -> bool {
        system::is_held(path)
    }

    /// As [`Lock::attempt`], for a file that is there only as long as it is locked.
    ///
    /// # Errors
    /// As [`Lock::attempt`].
    pub fn attempt_passing(path: &Path) -> Result<TryLock> {
        system::attempt(path, true)
    }
}

/// Opens a file so that it is seen to be that of a process that is alive.
pub(super) use system::marked;

/// Marks a temporary file that is open for writing as that of a process that is alive, as long as it is open. A file
/// system without locks does not say so.
pub(super) fn mark(file: &File) {
    // Windows keeps others from locking a file that is open for writing.
    if cfg!(unix) {
        let _ = file.try_lock();
    }
}

/// Locks of files by `flock`.
#[cfg(unix)]
mod system {
    use super::{File, Lock, Path, Result, TryLock, open_own};
    use std::fs::TryLockError;
    use std::io::{Error, ErrorKind};

    /// One that passes is removed by who has it: the system does not.
    pub fn attempt(path: &Path, _passes: bool) -> Result<TryLock> {
        let file = open(path)?;
        Ok(match file.try_lock() {
            Ok(()) => TryLock::Taken(Lock { file, is_locked: true }),
            Err(TryLockError::WouldBlock) => TryLock::Held(file),
            Err(TryLockError::Error(cause)) if knows_no_locks(&cause) => {
                TryLock::Taken(Lock { file, is_locked: false })
            }
            Err(TryLockError::Error(cause)) => return Err(cause),
        })
    }

    pub fn wait(path: &Path) -> Result<Lock> {
        let file = open(path)?;
        match file.lock() {
            Ok(()) => Ok(Lock { file, is_locked: true }),
            Err(cause) if knows_no_locks(&cause) => Ok(Lock { file, is_locked: false }),
            Err(cause) => Err(cause),
        }
    }

    pub fn is_held(path: &Path) -> bool {
        let file = open_own(File::options().read(true), path);
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }

    pub fn marked(path: &Path) -> Option<File> {
        open_own(File::options().read(true), path).ok().filter(|open| open.try_lock().is_ok())
    }

    fn open(path: &Path) -> Result<File> {
        open_own(File::options().read(true).write(true).create(true).truncate(false), path)
    }

    /// Whether the file system, or the server that it is on, has no locks to give.
    pub fn knows_no_locks(cause: &Error) -> bool {
        matches!(cause.raw_os_error(), Some(libc::ENOLCK | libc::ENOSYS | libc::EOPNOTSUPP))
            || cause.kind() == ErrorKind::Unsupported
    }
}

/// Locks of files by what others may do with a file that is open: read it, and no more. Servers of mapped drives know
/// them; the locks of `LockFileEx` keep others from reading, too, and not every server has them.
#[cfg(windows)]
mod system {
    use super::{File, Lock, Path, Result, TryLock, open_own};
    use std::fs::OpenOptions;
    use std::os::windows::fs::OpenOptionsExt;
    use std::time::Duration;

    /// `GENERIC_READ | GENERIC_WRITE | DELETE`, `FILE_SHARE_READ`, `FILE_SHARE_READ | FILE_SHARE_DELETE`,
    /// `FILE_FLAG_DELETE_ON_CLOSE`, `ERROR_SHARING_VIOLATION`.
    const ALL_ACCESS: u32 = 0xc001_0000;
    const OTHERS_READ: u32 = 1;
    const OTHERS_READ_OR_RENAME: u32 = 5;
    const GONE_WHEN_CLOSED: u32 = 0x0400_0000;
    const IN_USE: i32 = 32;
    /// Between two attempts to take what is held.
    const BETWEEN: Duration = Duration::from_millis(10);

    /// One that passes is removed by the system when it is closed, or its process ends.
    pub fn attempt(path: &Path, passes: bool) -> Result<TryLock> {
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false).share_mode(OTHERS_READ);
        if passes {
            options.access_mode(ALL_ACCESS).custom_flags(GONE_WHEN_CLOSED);
        }
        match open_own(&mut options, path) {
            Ok(file) => Ok(TryLock::Taken(Lock { file, is_locked: true })),
            // It may have gone by now.
            Err(cause) if cause.raw_os_error() == Some(IN_USE) => match open_own(File::options().read(true), path) {
                Ok(file) => Ok(TryLock::Held(file)),
                Err(_) => Err(cause),
            },
            Err(cause) => Err(cause),
        }
    }

    pub fn wait(path: &Path) -> Result<Lock> {
        loop {
            match attempt(path, false) {
                Ok(TryLock::Taken(lock)) => return Ok(lock),
                Err(cause) if cause.raw_os_error() != Some(IN_USE) => return Err(cause),
                _ => std::thread::sleep(BETWEEN),
            }
        }
    }

    pub fn is_held(path: &Path) -> bool {
        let file = open_own(OpenOptions::new().write(true), path);
        file.is_err_and(|cause| cause.raw_os_error() == Some(IN_USE))
    }

    pub fn marked(path: &Path) -> Option<File> {
        open_own(File::options().read(true).share_mode(OTHERS_READ_OR_RENAME), path).ok()
    }
}

#[cfg(test)]
mod tests {
    #[cfg(unix)]
    use super::system::knows_no_locks;
    use super::*;
    #[cfg(unix)]
    use std::io::Error;

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

    /// The text of a lock can be read while it is held, and one that passes has gone with its process.
    #[test]
    fn who_has_it_can_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let TryLock::Taken(lock) = Lock::attempt_passing(&path).unwrap() else { panic!("it is held") };
        std::io::Write::write_all(&mut &lock.file, b"17").unwrap();
        let TryLock::Held(file) = Lock::attempt_passing(&path).unwrap() else { panic!("it is free") };
        assert_eq!(std::io::read_to_string(file).unwrap(), "17");
        drop(lock);
        assert_eq!(path.exists(), cfg!(unix));
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
