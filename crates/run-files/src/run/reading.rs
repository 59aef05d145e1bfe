//! A run file with all that its stages read.

use super::RunFile;
use stead_format::place::Place;
use stead_format::toml_file::TomlFile;
use stead_numerics::monitor::Monitor;
use stead_problem::problem::Redundancy;

/// A run file with all that reading it needs.
pub(super) struct Reading<'r> {
    pub source: &'r TomlFile,
    pub run: &'r RunFile,
    pub at: Place<'r>,
    pub monitor: &'r Monitor,
    pub redundancy: Redundancy,
}
