//! A run: what `place`, `score`, `explain` and `certify` are asked.

use serde_json::Value;
use std::sync::Arc;
use stead_disk::input::InputFile;
use stead_model::published::Published;
use stead_numerics::message::{Note, Warning};
use stead_problem::problem::Problem;
use stead_problem::settings::{CertificateSettings, SearchSettings, TransferSettings};
use stead_removal::outcome::RemovalForces;
use stead_simulation::path_stability::PathStabilityAnalysis;

/// A run file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What is to be solved.
    pub problem: Problem,
    /// How hard to search.
    pub search: SearchSettings,
    /// Limits of the moves between segments.
    pub transfer: TransferSettings,
    /// The certificate, where one is requested.
    pub certificate: Option<CertificateSettings>,
    /// Whether deflection maps are made.
    pub maps: bool,
    /// Whether a page is left with the files.
    pub page: bool,
    /// The files that were read, in the order config, robot, task, and others that they name.
    pub inputs: Vec<InputFile>,
    /// The keys of the run file with their values as written there, those of `--set` among them.
    pub stated: Value,
    /// Published figures to print beside ours.
    pub reference: Option<Published<[f64; 4]>>,
    /// What is to be cut along the path, where its stability is requested.
    pub path_stability: Option<PathStabilityAnalysis>,
    /// What the path removes of a table `[stock]`, and the forces that the task has of it.
    pub removal: Option<Arc<RemovalForces>>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<Note>,
    /// What the user should see to in the input.
    pub warnings: Vec<Warning>,
}
