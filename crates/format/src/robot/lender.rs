//! The joint stiffness of a shipped arm, for another arm that states none.

use super::file::{JointRow, RobotFile};
use super::one_or_pair::OneOrRange;
use crate::shipped::{PREFIX, by_name, names_near};
use crate::toml_file::TomlFile;
use std::path::Path;
use stead_disk::input::{InputFile, input_file};

/// Why an arm lends no stiffness, and what does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct NoLender {
    pub problem: String,
    pub allowed: String,
}

/// The file of a shipped arm that states the stiffness of every joint, by its name with or without `name:`, and its
/// entry among inputs.
///
/// # Errors
/// [`NoLender`] where no shipped arm has this name, or that arm has no stiffness.
pub(crate) fn lender(name: &str) -> Result<(RobotFile, InputFile), NoLender> {
    let no = |problem: &str, allowed: String| NoLender { problem: problem.to_owned(), allowed };
    let bare = name.strip_prefix(PREFIX).unwrap_or(name);
    let text = by_name(bare).ok_or_else(|| no("is no shipped arm", names_near(bare)))?;
    let read = TomlFile::new(Path::new(name), text.as_bytes().to_vec()).and_then(|source| source.parse()?.read());
    let file: RobotFile = read.map_err(|error| no(&error.to_string(), names_near(bare)))?;
    let is_whole = file.joints.iter().all(JointRow::has_stiffness);
    let allowed = "an arm with a stiffness in `stead robots`";
    let input = input_file("stiffness", format!("{PREFIX}{bare}"), text.as_bytes());
    is_whole.then_some((file, input)).ok_or_else(|| no("is an arm without stiffness", allowed.to_owned()))
}

/// The compliance that a row lends: of a range, which belongs to the limits of its own arm, the middle. urad/(N m)
pub(crate) fn lent_urad_per_nm(row: &JointRow) -> Option<f64> {
    let stiffness = row.stiffness_mnm_per_rad.map(|stiffness| 1.0 / stiffness.written());
    stiffness.or_else(|| {
        Some(match row.compliance_urad_per_nm? {
            OneOrRange::One(compliance) => compliance.written(),
            OneOrRange::Pair(range) => {
                let [from, to] = range.0.map(|end| end.written());
                ((from + to) / 2.0 * 1e9).round() / 1e9
            }
        })
    })
}
