//! How files of this program's own are opened.

use std::fs::{File, OpenOptions};

/// How files of this program's own are opened: a link of their name is not followed, and no pipe is waited for.
#[must_use]
pub fn options() -> OpenOptions {
    #[cfg_attr(not(unix), expect(unused_mut, reason = "as it is where there are no such links"))]
    let mut options = File::options();
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NOFOLLOW | libc::O_NONBLOCK);
    options
}
