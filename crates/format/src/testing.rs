//! Folders and assertions for the tests of this crate and of those above.
#![allow(clippy::unwrap_used, reason = "for tests alone")]

use std::path::{Path, PathBuf};

/// The folder of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Asserts that a message names file, line and field, and holds some parts.
pub fn assert_parts<T: std::fmt::Debug>(result: Result<T, String>, place: &str, parts: &[&str]) {
    let message = result.unwrap_err();
    assert!(message.starts_with(&format!("f.toml:{place}: ")), "{place} at the start of {message}");
    for part in parts.iter().chain(&["; allowed: "]) {
        assert!(message.contains(part), "{part} in {message}");
    }
}
