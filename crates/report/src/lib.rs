//! Results to files: CSV tables, JSON, pictures, and a short table for people. This room only reads results.
//!
//! Every file is made in memory first and then written whole (see [`Folder`]). The same result gives the same bytes.
//!
//! ```
//! use stead_calibration::compensation::compensate;
//! use stead_numerics::monitor::Monitor;
//! use stead_report::compensation::compensation_files;
//! // A job gives figures in SI units; the files of its command are made of them, and the tables of these have units in
//! // their names.
//! let monitor = Monitor::silent();
//! let file = "../../configs/compensate-caro-2013.toml".as_ref();
//! let run = stead_run_files::read_compensation(file, None, &monitor)?;
//! let files = compensation_files(&run, &compensate(&run.job, &monitor)?)?;
//! let (name, table) = &files[0];
//! assert_eq!(name, "corrected-path.csv");
//! assert!(table.starts_with(b"point,segment,target_x_mm,target_y_mm,target_z_mm,"));
//! assert_eq!(*table, std::fs::read("../../results/compensate-caro-2013/corrected-path.csv")?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

#[macro_use]
extern crate stead_document;

pub mod assessment;
pub mod certificate;
pub mod check;
pub mod circularity;
pub mod compensation;
pub mod cutting;
pub mod document;
pub mod forces;
pub mod identification;
pub mod names;
pub mod page;
pub mod picture;
pub mod placement;
pub mod program;
pub mod robot;
pub mod schema;
pub mod simulation;
pub mod stability;
pub mod study;
mod word;

#[cfg(test)]
mod testing;

pub use stead_document::output::{self, Folder, ReportError};
use stead_document::{columns, csv_file};
pub use stead_document::{figure, units};

/// Result files in memory: the name and the content of each.
pub type Files = Vec<(String, Vec<u8>)>;

/// Files under fixed names.
fn named(files: impl IntoIterator<Item = (&'static str, Vec<u8>)>) -> Files {
    files.into_iter().map(|(name, bytes)| (name.to_owned(), bytes)).collect()
}
