//! Files on the disk: how they are read, put in place and locked.
//!
//! The one door through which files come in ([`read`]), so that none of them is a pipe or a device or fills the memory;
//! files written under temporary names and then renamed ([`Staged`]); locks ([`Lock`]). Files of this program beside
//! results, which anybody may have put a link in place of, are opened by [`open_own`].

mod lock;
mod name;
pub mod new;
mod options;
mod staged;

pub use lock::{Lock, TryLock};
pub use name::{below, check_name};
pub use options::open_own;
pub use staged::{PREFIX, Staged, remove, remove_abandoned, remove_stale, sync};

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The most bytes of a file that is read: a tool path of eight million points, a mesh of 20 million triangles.
pub const MAX_BYTES: u64 = 1_000_000_000;

/// Reads a file, whole.
///
/// # Errors
/// What the system says; [`ErrorKind::InvalidInput`] for what is no file, such as a pipe or a device,
/// [`ErrorKind::FileTooLarge`] for one of more than [`MAX_BYTES`], [`ErrorKind::InvalidData`] for text in UTF-16.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    whole(open(path)?)
}

/// Reads a file of this program's own, which is no link.
///
/// # Errors
/// Those of [`read`].
pub fn read_own(path: &Path) -> Result<Vec<u8>> {
    let file = open_own(File::options().read(true), path)?;
    check(&file.metadata()?)?;
    whole(file)
}

/// The bytes of a text without the mark of the order of its bytes, which editors of Windows put before it.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn whole(mut file: File) -> Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(file.metadata()?.len() as usize);
    // A file may grow while it is read, and some of the system do not state their size.
    Read::by_ref(&mut file).take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    check_size(bytes.len() as u64)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let problem = "it is text in UTF-16, which some editors call Unicode: save it as UTF-8";
        return Err(Error::new(ErrorKind::InvalidData, problem));
    }
    Ok(bytes)
}

/// Opens a file to be read.
///
/// # Errors
/// Those of [`read`].
pub fn open(path: &Path) -> Result<File> {
    check_name(path)?;
    // Before it is opened, too: that of a pipe waits for a writer, that of some devices does something.
    check(&std::fs::metadata(path)?)?;
    let file = File::open(path)?;
    check(&file.metadata()?)?;
    Ok(file)
}

fn check(found: &Metadata) -> Result<()> {
    if found.is_dir() {
        Err(Error::new(ErrorKind::IsADirectory, "it is a folder"))
    } else if !found.is_file() {
        Err(Error::new(ErrorKind::InvalidInput, "it is a pipe, a socket or a device, and no file"))
    } else {
        check_size(found.len())
    }
}

fn check_size(bytes: u64) -> Result<()> {
    let (size, most) = (bytes as f64 / 1e9, MAX_BYTES / 1_000_000_000);
    let problem = || format!("it is larger than the {most} GB of the largest file that is read: {size:.2} GB");
    if bytes <= MAX_BYTES { Ok(()) } else { Err(Error::new(ErrorKind::FileTooLarge, problem())) }
}

/// What the system says of a disk that fails.
#[cfg(unix)]
const FAILING: [i32; 1] = [libc::EIO];
/// What the system says of a disk that fails: `ERROR_CRC`, `ERROR_WRITE_FAULT`, `ERROR_IO_DEVICE`.
#[cfg(not(unix))]
const FAILING: [i32; 3] = [23, 29, 1117];

/// Whether a file could not be written though its name is right: for want of room on the disk, in the user's share of
/// it or under a limit on the size of files, or since the disk fails.
pub fn is_of_disk(cause: &Error) -> bool {
    // That of a temporary file is wrapped into one with its path.
    let wrapped = cause.get_ref().and_then(|inner| inner.source()?.downcast_ref::<Error>());
    let mut codes = [Some(cause), wrapped].into_iter().flatten().filter_map(Error::raw_os_error);
    if codes.any(|code| FAILING.contains(&code)) {
        return true;
    }
    matches!(cause.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_that_fails_is_told_within_an_error_that_names_the_file() {
        /// As `tempfile` wraps the errors of a file.
        #[derive(Debug)]
        struct AtPath(Error);
        impl std::fmt::Display for AtPath {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "{} at a path", self.0)
            }
        }
        impl std::error::Error for AtPath {
            fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
                Some(&self.0)
            }
        }
        let error = |code| Error::from_raw_os_error(code);
        let wrapped = |code| Error::new(error(code).kind(), AtPath(error(code)));
        #[cfg(unix)]
        let others = [(libc::ENOSPC, true), (libc::EACCES, false)];
        // `ERROR_DISK_FULL`, `ERROR_ACCESS_DENIED`.
        #[cfg(not(unix))]
        let others = [(112, true), (5, false)];
        for (code, expected) in [(FAILING[0], true)].into_iter().chain(others) {
            assert_eq!([is_of_disk(&error(code)), is_of_disk(&wrapped(code))], [expected; 2]);
        }
    }

    #[test]
    fn files_are_read_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.csv");
        std::fs::write(&file, "text").unwrap();
        assert_eq!(read(&file).unwrap(), b"text");
        assert_eq!(read(folder.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
        std::fs::write(&file, "\u{feff}text").unwrap();
        assert_eq!(without_mark(&read(&file).unwrap()), b"text");
        for bytes in [b"\xff\xfet\0", b"\xfe\xff\0t"] {
            std::fs::write(&file, bytes).unwrap();
            assert!(read(&file).unwrap_err().to_string().contains("UTF-16"));
        }
        assert_eq!(read(&folder.path().join("b.csv")).unwrap_err().kind(), ErrorKind::NotFound);
        // One without content: nothing is read of it.
        File::options().write(true).open(&file).unwrap().set_len(MAX_BYTES + 1).unwrap();
        let problem = read(&file).unwrap_err();
        assert_eq!(problem.to_string(), "it is larger than the 1 GB of the largest file that is read: 1.00 GB");
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero"), Path::new("/dev/null")] {
            let problem = read(path).unwrap_err();
            assert_eq!(problem.to_string(), "it is a pipe, a socket or a device, and no file", "{}", path.display());
        }
        // The system's own files state no size.
        assert!(!read(Path::new("/proc/self/status")).unwrap().is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn files_of_our_own_are_no_links() {
        let folder = tempfile::tempdir().unwrap();
        let [own, other] = ["own", "other"].map(|name| folder.path().join(name));
        std::fs::write(&other, "the user's own").unwrap();
        std::os::unix::fs::symlink(&other, &own).unwrap();
        assert!(read_own(&own).is_err() && read_own(&other).is_ok());
        assert!(open_own(File::options().create(true).write(true).truncate(true), &own).is_err());
        assert_eq!(std::fs::read(&other).unwrap(), b"the user's own");
    }
}
