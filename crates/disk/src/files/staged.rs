//! Files written whole under temporary names, to be renamed when all of them are there.

use super::lock::{Lock, TryLock, mark, marked};
use std::fs::File;
use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::{Builder, NamedTempFile};

/// How the names of temporary files begin, unless the code that removes them knows its own by another name.
pub const PREFIX: &str = ".stead-";
/// What the names of temporary files end with.
const SUFFIX: &str = ".tmp";
/// Random characters between the two.
const RANDOM: usize = 6;

/// On Windows, where what somebody has open is not replaced: how long to wait for a scanner of viruses, or a program
/// that synchronises files, to let go of a file.
const PAUSES_MS: [u64; 5] = [10, 40, 150, 300, 500];

/// Whether a file cannot be replaced since another program has it open.
fn is_in_use(cause: &Error) -> bool {
    // `ERROR_ACCESS_DENIED`, `ERROR_SHARING_VIOLATION`, `ERROR_LOCK_VIOLATION`, `ERROR_USER_MAPPED_FILE`.
    cfg!(windows) && matches!(cause.raw_os_error(), Some(5 | 32 | 33 | 1224))
}

/// What a program has done with a file, or why not, for people.
fn told(cause: Error) -> Error {
    if !is_in_use(&cause) {
        return cause;
    }
    Error::new(cause.kind(), format!("another program has it open, such as a spreadsheet, or it is read-only: {cause}"))
}

/// A file with its content on disk under a temporary name. Gone again when it is dropped.
#[derive(Debug)]
pub struct Staged(NamedTempFile);

impl Staged {
    /// Writes a file into a folder, under a temporary name that begins with [`PREFIX`] or one's own.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(folder: &Path, prefix: &str, bytes: &[u8]) -> Result<Self> {
        let mut builder = builder(prefix);
        readable(&mut builder);
        let mut file = builder.tempfile_in(named(folder))?;
        mark(file.as_file());
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        Ok(Self(file))
    }

    /// Gives it its name, over an older file of that name.
    ///
    /// # Errors
    /// What the system says.
    pub fn put(self, path: &Path) -> Result<()> {
        let mut staged = self.0;
        for pause in PAUSES_MS.map(Duration::from_millis) {
            match staged.persist(path) {
                Ok(_) => return Ok(()),
                Err(error) if is_in_use(&error.error) => staged = error.file,
                Err(error) => return Err(error.error),
            }
            std::thread::sleep(pause);
        }
        staged.persist(path).map(drop).map_err(|error| told(error.error))
    }

    /// Gives it its name, unless there is a file of that name.
    ///
    /// # Errors
    /// What the system says; [`ErrorKind::AlreadyExists`] where there is one.
    pub fn put_new(self, path: &Path) -> Result<()> {
        match self.0.persist_noclobber(path) {
            Ok(_) => Ok(()),
            // A file system that cannot do both in one: it is looked for just before.
            Err(error) if error.error.kind() != ErrorKind::AlreadyExists && path.symlink_metadata().is_err() => {
                Self(error.file).put(path)
            }
            Err(error) => Err(error.error),
        }
    }

    /// Leaves it under its temporary name, as a process that is killed does.
    ///
    /// # Errors
    /// What the system says.
    pub fn abandon(self) -> Result<()> {
        self.0.keep().map(drop).map_err(|error| error.error)
    }
}

/// A file that is about to be replaced, under a temporary name.
#[derive(Debug)]
pub(super) struct Aside {
    file: PathBuf,
    temporary: PathBuf,
    /// Says that the process is alive.
    _lock: Option<File>,
}

impl Aside {
    /// Takes a file aside.
    ///
    /// # Errors
    /// What the system says; the file is then where it was.
    pub fn take(file: &Path) -> Result<Self> {
        let lock = marked(file);
        let folder = named(file.parent().unwrap_or(Path::new("")));
        let taken = builder(PREFIX).make_in(folder, |temporary| std::fs::rename(file, temporary))?;
        let temporary = taken.into_temp_path().keep().map_err(|error| error.error)?;
        Ok(Self { file: file.to_owned(), temporary, _lock: lock })
    }

    /// Puts it back. Where the system does not let it, it stays under its temporary name.
    pub fn put_back(self) {
        let _ = std::fs::rename(&self.temporary, &self.file);
    }

    /// Removes it, as it was replaced. Where the system does not let it, the next command does.
    pub fn remove(self) {
        let _ = std::fs::remove_file(&self.temporary);
    }
}

/// What gives temporary names.
fn builder(prefix: &str) -> Builder<'_, 'static> {
    let mut builder = Builder::new();
    builder.prefix(prefix).suffix(SUFFIX).rand_bytes(RANDOM);
    builder
}

/// The name of a file in this folder has no folder of its own.
fn named(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// Removes the temporary files of a process that is gone, by how their names begin, in a folder that this process alone
/// writes to. What cannot be removed stays.
pub fn remove_stale(folder: &Path, prefix: &str) {
    temporary_in(folder, prefix).for_each(|path| drop(std::fs::remove_file(path)));
}

/// The same in a folder that others may write to: a file that a process has open is kept, and so is every one on a file
/// system without locks.
pub fn remove_abandoned(folder: &Path, prefix: &str) {
    for path in temporary_in(named(folder), prefix) {
        if matches!(Lock::attempt(&path), Ok(TryLock::Taken(Lock { is_locked: true, .. }))) {
            let _ = std::fs::remove_file(path);
        }
    }
}

/// The files in a folder with temporary names.
fn temporary_in<'a>(folder: &Path, prefix: &'a str) -> impl Iterator<Item = PathBuf> + 'a {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_ours = |name: &std::ffi::OsStr| name.to_str().is_some_and(|name| is_temporary(name, prefix));
    entries
        .filter(move |entry| entry.file_type().is_ok_and(|kind| kind.is_file()) && is_ours(&entry.file_name()))
        .map(|entry| entry.path())
}

/// Whether a name is one that [`Staged::write`] gives.
fn is_temporary(name: &str, prefix: &str) -> bool {
    let random = name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(SUFFIX));
    random.is_some_and(|random| random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric()))
}

/// Puts the names in a folder on disk, in the order in which they were given. A file system that cannot do so is none
/// to wait for.
///
/// # Errors
/// What the system says.
#[cfg(unix)]
pub fn sync(folder: &Path) -> Result<()> {
    match std::fs::File::open(folder)?.sync_all() {
        Err(cause) if matches!(cause.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        result => result,
    }
}

/// Names are on disk as soon as they are given.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn sync(_: &Path) -> Result<()> {
    Ok(())
}

/// Removes a file, if it is there.
///
/// # Errors
/// What the system says.
pub fn remove(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => Ok(()),
        result => result,
    }
}

/// Temporary files are private by default; results get the permissions of any new file.
#[cfg(unix)]
fn readable(builder: &mut Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(std::fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn readable(_: &mut Builder<'_, '_>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_own_temporary_files_are_cleared_up() {
        let folder = tempfile::tempdir().unwrap();
        let foreign =
            [".stead-.tmp", ".stead-notes.tmp2", ".stead-ab cd1.tmp", "x.stead-abcdef.tmp", ".stead-abcdefg.tmp"];
        for name in foreign {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join(".stead-folder.tmp")).unwrap();
        Staged::write(folder.path(), PREFIX, b"stale").unwrap().abandon().unwrap();
        remove_stale(folder.path(), PREFIX);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1 + foreign.len());
        remove_stale(Path::new("nowhere"), PREFIX);
    }

    /// As a spreadsheet opens one: others may read it.
    #[cfg(windows)]
    #[test]
    fn a_file_that_another_program_has_open_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("best.csv");
        std::fs::write(&path, "old").unwrap();
        let open = std::os::windows::fs::OpenOptionsExt::share_mode(File::options().read(true), 1).open(&path).unwrap();
        let put = || Staged::write(folder.path(), PREFIX, b"new").unwrap().put(&path);
        assert!(put().unwrap_err().to_string().starts_with("another program has it open, such as a spreadsheet"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        drop(open);
        put().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn a_new_file_takes_the_place_of_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let staged = || Staged::write(folder.path(), PREFIX, b"new").unwrap();
        staged().put_new(&path).unwrap();
        assert_eq!(staged().put_new(&path).unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
