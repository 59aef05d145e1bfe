//! Certificates as files and sentences.

mod json;
mod tables;
#[cfg(test)]
mod tests;
mod text;

pub use json::certificate_json;
pub use tables::open_region;
pub use text::certificate_text;

use super::output::{Folder, ReportError};
use super::picture;
use crate::document::bytes;
use crate::placement::{PLACE, SUMMARY};
use std::path::PathBuf;
use stead_format::input::InputFile;
use stead_placement::certify::Certificate;
use stead_placement::problem::Problem;

/// Writes everything that is known into a folder: `certificate.json`, `open-region.csv`, and `open-region.svg` and
/// `open-region-worst.svg` as far as there is a proof; pictures of an earlier one are removed. They join the results of
/// the run whose `summary.json` has the content `summary`. Returns the paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, or where results of another run are; no file is ever left half
/// written.
pub fn write_certificate(
    folder: &Folder,
    problem: &Problem,
    certificate: &Certificate,
    inputs: &[InputFile],
    summary: &[u8],
) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = vec![
        ("certificate.json", bytes(&certificate_json(certificate, inputs))),
        ("open-region.csv", open_region(problem, certificate)?),
    ];
    let mut outdated = Vec::new();
    for (name, proof) in [("open-region.svg", &certificate.best), ("open-region-worst.svg", &certificate.worst)] {
        match proof {
            Ok(proof) => files.push((name, picture::open_region(problem, proof).into_bytes())),
            Err(_) => outdated.push(name),
        }
    }
    folder.results(PLACE, inputs).joining(SUMMARY, summary).without(outdated).write(&files)
}
