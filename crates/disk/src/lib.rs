//! Files read and written, whatever is in them: the one error for input ([`input::InputError`]), digests of what was
//! read, CSV tables, output that is there whole or not at all ([`files`]), and the manifests that vouch for results.
//!
//! ```
//! use stead_disk::input::InputError;
//! let error = InputError::new("cell.toml".as_ref(), "is below the floor").in_field("cell.z_mm").found("-20");
//! let line = "cell.toml: cell.z_mm: is below the floor, found -20; allowed: 0 or above";
//! assert_eq!(error.allowed("0 or above").to_string(), line);
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod files;
pub mod input;
pub mod manifest;
pub mod quote;
pub mod template;

pub use files::new::Existing;
