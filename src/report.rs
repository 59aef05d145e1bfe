//! The page of a results folder.

pub use stead_report::document::Timing;
pub use stead_report::placement::{NOTES, Summary, SummaryLine, summary_line, summary_text};
pub use stead_report::{Folder, ReportError};

use crate::Error;
use std::path::{Path, PathBuf};
use stead_report::page::{RewriteError, rewrite};

/// Writes `report.html` in a results folder of `stead place` or `stead score --out` again, from its files alone: the
/// same bytes as the run has left. Returns the paths of the files written.
///
/// # Errors
/// [`Error::Input`] for a folder that lacks a file, mixes two runs, is of another format or was changed since;
/// [`Error::Output`] where the page cannot be written.
pub fn write_page(folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
    rewrite(folder.as_ref()).map_err(|error| match error {
        RewriteError::Input(error) => Error::Input(error),
        RewriteError::Output(error) => Error::Output(error),
    })
}
