//! A study as its commands read it: its cases, its folder, and what is kept of it as it was before.

use crate::cli::Failure;
use crate::cli::output::say;
use crate::cli::progress::Terminal;
use std::path::{Path, PathBuf};
use stead::Study;
use stead::study::StudyStatus;

/// Reads a study and all its cases, whose forces may have to be computed, on so many threads.
pub(super) fn read(config: &Path, threads: Option<usize>, terminal: &Terminal) -> Result<Study, Failure> {
    Ok(terminal.on_threads(threads, |monitor| Study::read_with(config, monitor))??)
}

/// The folder requested, or `results/` and the name of the study.
pub(super) fn folder(requested: Option<&Path>, config: &Path) -> PathBuf {
    requested.map_or_else(|| Path::new("results").join(config.file_stem().unwrap_or_default()), Path::to_owned)
}

/// Says which kept cases are left of the study as it was before an edit.
pub(super) fn say_stale(status: &StudyStatus) {
    if !status.stale.is_empty() {
        let cases = counted_cases(status.stale.len());
        let names = status.stale.join(", ");
        say(&format!("note: {cases} not of the study as it is now: {names}; `stead study run --prune` removes them"));
    }
}

pub(super) fn counted_cases(count: usize) -> String {
    format!("{count} kept {}", if count == 1 { "case" } else { "cases" })
}
