//! Stiffness to be identified, measurements to be chosen, and their errors at the entry of the file that is at fault.

use std::path::PathBuf;
use stead_calibration::identification::design::{DesignError, Request};
use stead_calibration::identification::{IdentifyError, Problem};
use stead_disk::input::{InputError, InputFile};
use stead_numerics::message::Note;

/// An identification file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyRun {
    /// What is to be identified.
    pub problem: Problem,
    /// Text of the robot file to start from.
    pub robot_text: String,
    /// The measurement sheet, to name it in messages.
    pub sheet_file: PathBuf,
    /// The files that were read: config, robot, sheet.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<Note>,
}

/// What `stead identify plan` reads.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanRun {
    /// What is to be planned.
    pub request: Request,
    /// The config, to name it in messages.
    pub file: PathBuf,
    /// Line of the number of configurations, from 1.
    pub configurations_line: usize,
    /// Line of the table, from 1.
    pub table_line: usize,
    /// The files that were read: config, robot.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<Note>,
}

/// Why a job on files gave no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LocatedError {
    /// An entry of a file is at fault.
    #[error(transparent)]
    Input(#[from] InputError),
    /// Sound files gave no result.
    #[error("{0}")]
    Job(String),
}

impl IdentifyRun {
    /// An error of the identification at the line and column of the sheet that is at fault, if one is; where it is the
    /// sheet as a whole, at its first reading.
    pub fn locate(&self, error: IdentifyError) -> LocatedError {
        let Some(fault) = error.fault() else { return LocatedError::Job(error.to_string()) };
        let first = || self.problem.sheet.readings.first().map_or(1, |reading| reading.line);
        let located = InputError::new(&self.sheet_file, error.to_string())
            .at_line(fault.line.unwrap_or_else(first))
            .allowed(fault.needed);
        match fault.column {
            Some(column) => located.in_field(column).into(),
            None => located.into(),
        }
    }
}

impl PlanRun {
    /// An error of the choice of measurements: at the number of configurations requested where that is at fault.
    pub fn locate(&self, error: DesignError) -> LocatedError {
        match error.needed() {
            Some(needed) => InputError::new(&self.file, error.to_string())
                .at_line(self.configurations_line)
                .in_field("plan.configurations")
                .found(self.request.configurations.to_string())
                .allowed(needed)
                .into(),
            None => LocatedError::Job(format!("{}:{}: plan: {error}", self.file.display(), self.table_line)),
        }
    }
}
