//! What the reports of a run state besides its problem and its result.

use crate::document::Document;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use std::sync::Arc;
use stead_disk::input::InputFile;
use stead_model::published::Published;
use stead_numerics::message::{Note, Warning};
use stead_problem::settings::{SearchSettings, TransferSettings};
use stead_removal::outcome::RemovalForces;
use stead_runs::Run;
use stead_study::PathStability;

/// A case of a study whose files are kept.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CaseOfStudy {
    /// The name of the study.
    pub study: String,
    /// The number of the case, from 1.
    pub number: usize,
    /// For each axis of the study its name and the value of the case.
    pub values: Vec<[String; 2]>,
    /// Where the page of the study will be, from the folder of the case.
    pub report: &'static str,
}

/// What the reports state besides the problem and its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Context {
    /// The files the result depends on.
    pub inputs: Vec<InputFile>,
    /// What the run file states, key by key.
    pub stated: Value,
    /// What the result rests on: assumptions made and values left at their defaults.
    pub notes: Vec<Note>,
    /// Why the result may not be what was wanted.
    pub warnings: Vec<Warning>,
    /// How hard the search was, and its seed.
    pub search: SearchSettings,
    /// The assumptions behind the times of the moves.
    pub transfer: TransferSettings,
    /// Figures to compare with, where there are any.
    pub reference: Option<Published<[f64; 4]>>,
    /// How deep may be cut along the path, where that was requested.
    pub stability: Option<PathStability>,
    /// What the path removes of a table `[stock]`.
    pub removal: Option<Arc<RemovalForces>>,
    /// Which case of a study the run is, where it is one.
    pub study_case: Option<CaseOfStudy>,
    /// Whether a page is left with the files.
    pub page: bool,
}

impl Context {
    /// What a run file says.
    pub fn new(run: &Run) -> Self {
        Self {
            inputs: run.inputs.clone(),
            stated: run.stated.clone(),
            notes: run.notes.clone(),
            warnings: run.warnings.clone(),
            search: run.search,
            transfer: run.transfer,
            reference: run.reference.clone(),
            stability: None,
            removal: run.removal.clone(),
            study_case: None,
            page: run.page,
        }
    }

    /// A JSON document on what was computed from the run file.
    pub fn document(&self) -> Document {
        Document::new(&self.inputs).notes(&self.notes).warnings(&self.warnings)
    }
}
