//! Paths corrected so that the loaded tool follows the path that is wanted.

use crate::monitor::Warning;
use crate::result::result;
use crate::{Error, Monitor};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;
use stead_calibration::compensation::{self, CompensatedPath as Outcome, NotCompensated};
use stead_numerics::message::Note;
use stead_report::compensation::{compensation_files, compensation_json, compensation_text, not_compensated_json};
use stead_run_files as run_files;

/// A compensation file with the run and the plan that it names, read and checked.
#[derive(Debug, Clone)]
pub struct CompensationRun {
    run: Arc<stead_runs::CompensateRun>,
}

impl CompensationRun {
    /// Reads a compensation file and the files that it names.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_with(file, None, &Monitor::silent())
    }

    /// As [`CompensationRun::read`], with another robot file on which the corrected path is played.
    ///
    /// # Errors
    /// As [`CompensationRun::read`]; [`Error::Stopped`] when the monitor asked to stop before the forces of a run with
    /// a table `[stock]` were computed.
    pub fn read_with(file: impl AsRef<Path>, reality: Option<&Path>, monitor: &Monitor) -> Result<Self, Error> {
        Ok(Self { run: Arc::new(run_files::read_compensation(file.as_ref(), reality, monitor)?) })
    }

    /// What the user should see to in the run.
    pub fn warnings(&self) -> &[Warning] {
        &self.run.warnings
    }

    /// What the user should know about the input though it is not wrong, in sentences.
    pub fn notes(&self) -> &[Note] {
        &self.run.notes
    }

    /// The JSON document in place of a result where some points cannot be compensated: which, and why.
    pub fn not_compensated_json(&self, failure: &NotCompensated) -> Value {
        not_compensated_json(&self.run, failure)
    }

    /// Finds for every point the pose to command. A point that cannot be compensated keeps its target, and a warning
    /// says so.
    ///
    /// # Errors
    /// [`Error::NotCompensated`] where not one point can be compensated, with the reasons;
    /// [`Error::Stopped`] when the monitor asked to stop before the last.
    pub fn compensate(&self, monitor: &Monitor) -> Result<CompensatedPath, Error> {
        let outcome = compensation::compensate(&self.run.job, monitor)?;
        match outcome.not_corrected().filter(NotCompensated::is_all) {
            Some(all) => Err(all.into()),
            None => Ok(self.path(outcome)),
        }
    }

    /// As [`CompensationRun::compensate`], but every point or none.
    ///
    /// # Errors
    /// [`Error::NotCompensated`] with the points that cannot be compensated, and why; [`Error::Stopped`] when the
    /// monitor asked to stop before the last.
    pub fn compensate_all(&self, monitor: &Monitor) -> Result<CompensatedPath, Error> {
        let outcome = compensation::compensate(&self.run.job, monitor)?.complete()?;
        Ok(self.path(outcome))
    }

    fn path(&self, outcome: Outcome) -> CompensatedPath {
        let notes = self.run.notes.iter().chain(&outcome.notes).cloned().collect();
        let warnings = self.run.warnings.iter().chain(&outcome.warnings).cloned().collect();
        CompensatedPath { run: Arc::clone(&self.run), outcome, notes, warnings }
    }
}

/// A corrected path, with what remains of the deflection.
#[derive(Debug, Clone)]
pub struct CompensatedPath {
    run: Arc<stead_runs::CompensateRun>,
    outcome: Outcome,
    notes: Vec<Note>,
    warnings: Vec<Warning>,
}

impl CompensatedPath {
    /// Point by point, in SI units.
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }
}

result! { CompensatedPath, self {
    write(folder) = folder.results("compensate", &self.run.inputs).write(&self.files()?);
    files = compensation_files(&self.run, &self.outcome);
    document = compensation_json(&self.run, &self.outcome);
    table = compensation_text(&self.run, &self.outcome);
    notes = self.notes;
    warnings = self.warnings;
} }
