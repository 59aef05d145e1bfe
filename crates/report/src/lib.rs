//! Results to files: CSV tables, JSON, pictures, and a short table for people. This room only reads results.
//!
//! Every file is made in memory first and then written whole (see [`Folder`]). The same result gives the same bytes.

pub mod assessment;
pub mod certificate;
pub mod check;
pub mod circularity;
mod columns;
pub mod compensation;
mod csv_file;
pub mod cutting;
pub mod document;
pub mod identification;
pub mod names;
pub mod output;
pub mod page;
pub mod picture;
pub mod placement;
pub mod program;
pub mod robot;
pub mod simulation;
pub mod stability;
pub mod study;
pub mod units;

#[cfg(test)]
mod testing;

pub use output::{Folder, ReportError};

/// Result files in memory: the name and the content of each.
pub type Files = Vec<(String, Vec<u8>)>;

/// Files under fixed names.
fn named(files: impl IntoIterator<Item = (&'static str, Vec<u8>)>) -> Files {
    files.into_iter().map(|(name, bytes)| (name.to_owned(), bytes)).collect()
}
