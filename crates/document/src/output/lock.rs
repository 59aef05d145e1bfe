//! A lock file that states who holds it, and goes with the lock.

use std::fs::File;
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use stead_disk::files::{self, TryLock};

/// A lock file that this process holds. It is removed when this is dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    lock: files::Lock,
}

/// Why a lock was not taken.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another process holds it.
    #[error("another process holds the lock")]
    Held {
        /// The number of that process, where it is known.
        process: Option<u32>,
    },
    /// The file cannot be made or locked.
    #[error(transparent)]
    System(#[from] std::io::Error),
}

/// How often a lock file that vanishes while it is taken is made anew. Each time another process has ended in between.
const ATTEMPTS: usize = 100;

impl Lock {
    /// Takes the lock on a file, which is made where there is none. Does not wait. On a file system that knows no locks
    /// nothing is locked: see [`Lock::is_locked`].
    ///
    /// # Errors
    /// [`LockError::Held`] when another process, or another `Lock` of this one, has it; [`LockError::System`] when the
    /// file cannot be made.
    pub fn take(path: &Path) -> Result<Self, LockError> {
        for _ in 0..ATTEMPTS {
            let mut lock = match files::Lock::attempt_passing(path)? {
                TryLock::Taken(lock) => lock,
                TryLock::Held(mut file) => return Err(LockError::Held { process: holder(&mut file) }),
            };
            // The holder before may have removed the file between the two: a lock on a file without a name keeps nobody
            // out.
            if is_at(&lock.file, path) {
                // For the message of whoever comes next: a disk without room for it is no reason to stop.
                let _ = lock.file.set_len(0).and_then(|()| write!(lock.file, "{}", std::process::id()));
                return Ok(Self { path: path.to_owned(), lock });
            }
        }
        Err(LockError::Held { process: None })
    }

    /// Whether other processes are kept out: not so where the file system knows no locks.
    pub fn is_locked(&self) -> bool {
        self.lock.is_locked
    }

    /// The lock file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is locked still. One that stays keeps nobody out. Windows does it itself, when it is closed.
        if cfg!(unix) && self.lock.is_locked && is_at(&self.lock.file, &self.path) {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// The number of the process that holds a lock file, as it stands in there.
fn holder(file: &mut File) -> Option<u32> {
    let mut text = String::new();
    file.rewind().ok()?;
    file.take(20).read_to_string(&mut text).ok()?;
    text.trim().parse().ok()
}

/// Whether an open file is the one that has this name.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(open), Ok(named)) => (open.dev(), open.ino()) == (named.dev(), named.ino()),
        _ => false,
    }
}

/// Where the system removes a lock file, nobody can lock one that has no name.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn one_has_it_at_a_time_and_says_who_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        std::fs::write(&path, "left by a process that was killed").unwrap();
        let lock = Lock::take(&path).unwrap();
        assert!(lock.is_locked());
        match Lock::take(&path) {
            Err(LockError::Held { process }) => assert_eq!(process, Some(std::process::id())),
            other => panic!("{other:?}"),
        }
        drop(lock);
        assert!(!path.exists());
        Lock::take(&path).unwrap();
        assert!(matches!(Lock::take(&path.join("below")), Err(LockError::System(_))));
    }

    /// The file goes and comes all the time; nobody is let in twice.
    #[test]
    fn removing_the_file_lets_no_two_in() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let (inside, taken) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..2000 {
                        if let Ok(lock) = Lock::take(&path) {
                            assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0);
                            taken.fetch_add(1, Ordering::SeqCst);
                            inside.fetch_sub(1, Ordering::SeqCst);
                            drop(lock);
                        }
                    }
                });
            }
        });
        assert!(taken.into_inner() > 0);
    }
}
