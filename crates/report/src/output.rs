//! The folder that results go to, and the error of this room.

use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::Builder;

/// Why a result could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The output folder is not there and cannot be made, something else stands in its place, or nothing can be written to
    /// it.
    #[error("{}: results cannot be written here: {cause}; allowed: a folder that can be made or written to", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// A file cannot be written. What stood at the path before is left as it was.
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

/// An output folder whose files appear whole or not at all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Takes a folder, making it and its parents where they are missing, and tries whether a file can be written to it.
    ///
    /// # Errors
    /// [`ReportError::Folder`] when there is none and none can be made, or when no file can be written to it.
    pub fn create(path: &Path) -> Result<Self, ReportError> {
        let fail = |cause| ReportError::Folder { path: path.to_owned(), cause };
        if path.exists() && !path.is_dir() {
            return Err(fail(std::io::Error::new(std::io::ErrorKind::NotADirectory, "a file of that name is there")));
        }
        std::fs::create_dir_all(path).map_err(fail)?;
        // Gone again as soon as it is dropped.
        temporary().tempfile_in(path).map_err(fail)?;
        Ok(Self { path: path.to_owned() })
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes one file, over an older one of that name: first whole under a temporary name in the same folder, then
    /// renamed. Returns its path.
    ///
    /// # Errors
    /// [`ReportError::File`] with the path of the file; the temporary file is removed.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, ReportError> {
        let path = self.path.join(name);
        match self.write_whole(&path, bytes) {
            Ok(()) => Ok(path),
            Err(cause) => Err(ReportError::File { path, cause }),
        }
    }

    /// Removes a file of an earlier run that would contradict this one, if it is there.
    ///
    /// # Errors
    /// [`ReportError::File`] with the path of the file.
    pub fn remove(&self, name: &str) -> Result<(), ReportError> {
        let path = self.path.join(name);
        match std::fs::remove_file(&path) {
            Err(cause) if cause.kind() != std::io::ErrorKind::NotFound => Err(ReportError::File { path, cause }),
            _ => Ok(()),
        }
    }

    fn write_whole(&self, path: &Path, bytes: &[u8]) -> std::io::Result<()> {
        let mut builder = temporary();
        readable(&mut builder);
        let mut file = builder.tempfile_in(&self.path)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    }
}

/// What temporary files are called.
fn temporary() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(".stead-").suffix(".tmp");
    builder
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
    fn files_appear_whole_and_nothing_else_does() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::create(&place.path().join("a/b")).unwrap();
        assert_eq!(folder.path(), place.path().join("a/b"));
        folder.write("x.csv", b"old and longer").unwrap();
        let path = folder.write("x.csv", b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn errors_name_the_path_and_leave_no_temporary_file() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("file");
        std::fs::write(&file, "").unwrap();
        let error = Folder::create(&file).unwrap_err();
        assert!(matches!(error, ReportError::Folder { .. }));
        let start = format!("{}: results cannot be written here: a file of that name", file.display());
        assert!(error.to_string().starts_with(&start), "{error}");

        let folder = Folder::create(&place.path().join("out")).unwrap();
        std::fs::create_dir(folder.path().join("best.csv")).unwrap();
        let error = folder.write("best.csv", b"1").unwrap_err();
        assert!(error.to_string().contains(&folder.path().join("best.csv").display().to_string()), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);

        std::fs::remove_dir_all(folder.path()).unwrap();
        assert!(matches!(folder.write("best.csv", b"1"), Err(ReportError::File { .. })));
    }
}
