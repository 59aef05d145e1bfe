//! How files of this program's own are opened.

use std::fs::{File, OpenOptions};
use std::io::Result;
use std::path::Path;

/// Opens a file of this program's own: a link of its name is not followed, and no pipe is waited for.
///
/// # Errors
/// What the system says; where the name is that of a link, that.
#[cfg(unix)]
pub fn open_own(options: &mut OpenOptions, path: &Path) -> Result<File> {
    std::os::unix::fs::OpenOptionsExt::custom_flags(options, libc::O_NOFOLLOW | libc::O_NONBLOCK).open(path)
}

/// Opens a file of this program's own: a link of its name is not followed. Its name is looked up just before: the flag
/// of Windows that opens a link itself would open a file that is kept elsewhere, such as one of a cloud, without what
/// is in it.
///
/// # Errors
/// What the system says; where the name is that of a link, that.
#[cfg(not(unix))]
pub fn open_own(options: &mut OpenOptions, path: &Path) -> Result<File> {
    if path.symlink_metadata().is_ok_and(|found| found.is_symlink()) {
        return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, "it is a link"));
    }
    options.open(path)
}
