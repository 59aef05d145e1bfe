//! Certificates as files and sentences.

mod json;
pub(crate) mod tables;
#[cfg(test)]
mod tests;
mod text;

use json::certificate_content;
pub use json::{CertificateFigures, certificate_json};
pub use tables::open_region;
pub use text::certificate_text;

use super::output::{Folder, ReportError};
use super::{Files, named, picture};
use crate::document::bytes;
use crate::page::{PAGE, put_page};
use crate::placement::{PLACE, SUMMARY};
use std::path::PathBuf;
use stead_certify::{Certificate, NoProof, Proof};
use stead_disk::input::InputFile;
use stead_problem::problem::Problem;

/// The file that states what is proved.
const CERTIFICATE: &str = "certificate.json";

/// Whether a folder has finished results with a certificate, which an interrupted certificate shall not replace.
///
/// # Errors
/// [`ReportError`] for a manifest that cannot be read.
pub fn has_certificate(folder: &Folder) -> Result<bool, ReportError> {
    folder.has_finished(PLACE, CERTIFICATE)
}

/// Writes everything that is known into a folder: `certificate.json`, `open-region.csv`, and `open-region.svg` and
/// `open-region-worst.svg` as far as there is a proof; pictures of an earlier one are removed. They join the results of
/// the run that has left the files `run`, and its page, if it has one, is made again with them. Returns the paths in
/// that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, or where results of another run are; no file is ever
/// left half written.
pub fn write_certificate(
    folder: &Folder,
    problem: &Problem,
    certificate: &Certificate,
    inputs: &[InputFile],
    (run, is_interrupted): (Files, bool),
) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = certificate_files(problem, certificate, inputs)?;
    let mut all = run;
    all.extend(files.iter().cloned());
    put_page(&mut all)?;
    let find = |name: &str| all.iter().find(|(file, _)| file == name).cloned();
    files.extend(find(PAGE));
    let summary = find(SUMMARY).map(|(_, bytes)| bytes).unwrap_or_default();
    let outdated = proofs(certificate).into_iter().filter(|(_, proof)| proof.is_err()).map(|(name, _)| name);
    let beside = folder.beside_finished(PLACE, is_interrupted)?;
    let folder = beside.as_ref().unwrap_or(folder);
    folder.results(PLACE, inputs).interrupted(is_interrupted).joining(SUMMARY, &summary).without(outdated).write(&files)
}

/// The pictures of the proofs with what they show.
fn proofs(certificate: &Certificate) -> [(&'static str, &Result<Proof, NoProof>); 2] {
    [("open-region.svg", &certificate.best), ("open-region-worst.svg", &certificate.worst)]
}

/// The files that [`write_certificate`] writes.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn certificate_files(
    problem: &Problem,
    certificate: &Certificate,
    inputs: &[InputFile],
) -> Result<Files, ReportError> {
    let mut files = vec![
        (CERTIFICATE, bytes(&certificate_content(certificate, inputs))),
        ("open-region.csv", open_region(problem, certificate)?),
    ];
    for (name, proof) in proofs(certificate) {
        if let Ok(proof) = proof {
            files.push((name, picture::open_region(problem, proof).into_bytes()));
        }
    }
    Ok(named(files))
}
