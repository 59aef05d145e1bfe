//! Files written whole under temporary names, to be renamed when all of them are there.

use std::io::{ErrorKind, Write};
use std::path::Path;
use tempfile::{Builder, NamedTempFile};

const PREFIX: &str = ".stead-";
const SUFFIX: &str = ".tmp";
/// Random characters between the two.
const RANDOM: usize = 6;

/// A file with its content on disk under a temporary name. Gone again when it is dropped.
#[derive(Debug)]
pub(super) struct Staged(NamedTempFile);

impl Staged {
    /// Writes a file under a temporary name.
    pub(super) fn write(folder: &Path, bytes: &[u8]) -> std::io::Result<Self> {
        let mut builder = Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM);
        readable(&mut builder);
        let mut file = builder.tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        Ok(Self(file))
    }

    /// Gives it its name, over an older file of that name.
    pub(super) fn put(self, path: &Path) -> std::io::Result<()> {
        self.0.persist(path).map(drop).map_err(|error| error.error)
    }

    /// Leaves it under its temporary name, as a process that is killed does.
    #[cfg(test)]
    pub(super) fn abandon(self) {
        self.0.keep().unwrap();
    }
}

/// Removes the temporary files of a process that is gone. What cannot be removed stays.
pub(super) fn remove_stale(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && entry.file_name().to_str().is_some_and(is_temporary) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Whether a name is one that [`Staged::write`] gives.
fn is_temporary(name: &str) -> bool {
    let random = name.strip_prefix(PREFIX).and_then(|rest| rest.strip_suffix(SUFFIX));
    random.is_some_and(|random| random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric()))
}

/// Puts the names in a folder on disk, in the order in which they were given. A file system that cannot do so is none to wait for.
#[cfg(unix)]
pub(super) fn sync(folder: &Path) -> std::io::Result<()> {
    match std::fs::File::open(folder)?.sync_all() {
        Err(cause) if matches!(cause.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        result => result,
    }
}

#[cfg(not(unix))]
pub(super) fn sync(_: &Path) -> std::io::Result<()> {
    Ok(())
}

/// Removes a file, if it is there.
pub(super) fn remove(path: &Path) -> std::io::Result<()> {
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
        Staged::write(folder.path(), b"stale").unwrap().abandon();
        remove_stale(folder.path());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1 + foreign.len());
        remove_stale(Path::new("nowhere"));
    }
}
