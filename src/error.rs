//! The one error of the facade.

use stead_assessment::comparison::AssessError;
use stead_calibration::compensation::NotCompensated;
use stead_disk::input::InputError;
use stead_numerics::monitor::Stop;
use stead_placement::place::Infeasible;
use stead_report::ReportError;
use stead_study::cases::StudyError;

/// Why a file could not be read, a job gave no result, or a result could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Something in a file is wrong: file, line, field, value found and what is allowed.
    #[error(transparent)]
    Input(#[from] InputError),
    /// An argument of a call is out of range.
    #[error("{0}")]
    Argument(String),
    /// A result could not be written.
    #[error(transparent)]
    Output(#[from] ReportError),
    /// No placement, or not the given one, satisfies the constraints.
    #[error(transparent)]
    Infeasible(Box<Infeasible>),
    /// No robot can mill the benchmark, or the assessment was stopped.
    #[error(transparent)]
    Assessment(#[from] AssessError),
    /// Some points of a path cannot be compensated.
    #[error(transparent)]
    NotCompensated(#[from] NotCompensated),
    /// A study cannot go on; finished cases are kept.
    #[error(transparent)]
    Study(StudyError),
    /// The caller stopped a job that has nothing to return before it is done.
    #[error(transparent)]
    Stopped(#[from] Stop),
    /// The job itself failed.
    #[error("{0}")]
    Failed(String),
}

impl Error {
    /// Whether the input or an argument is at fault, and not the job.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Input(error) => !error.is_of_disk,
            Self::Argument(_) | Self::Study(StudyError::Folder { .. }) => true,
            _ => false,
        }
    }

    /// Whether the caller stopped the job before it had a result.
    pub fn is_interrupted(&self) -> bool {
        match self {
            Self::Stopped(_) | Self::Assessment(AssessError::Interrupted) => true,
            Self::Infeasible(nothing) => nothing.interrupted,
            _ => false,
        }
    }

    /// A job that failed, in its own words.
    pub(crate) fn failed(error: impl std::fmt::Display) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<stead_runs::LocatedError> for Error {
    fn from(error: stead_runs::LocatedError) -> Self {
        match error {
            stead_runs::LocatedError::Input(error) => Self::Input(error),
            stead_runs::LocatedError::Job(error) => Self::Failed(error),
        }
    }
}

impl From<stead_runs::ReadError> for Error {
    fn from(error: stead_runs::ReadError) -> Self {
        match error {
            stead_runs::ReadError::Input(error) => Self::Input(error),
            stead_runs::ReadError::Stopped(stop) => Self::Stopped(stop),
        }
    }
}

impl From<stead_study::RunError> for Error {
    fn from(error: stead_study::RunError) -> Self {
        match error {
            stead_study::RunError::Infeasible(nothing) => Self::Infeasible(Box::new(nothing)),
            stead_study::RunError::Stability(error) => Self::failed(error),
        }
    }
}

impl From<StudyError> for Error {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Input(error) => Self::Input(error),
            StudyError::Stopped(stop) => Self::Stopped(stop),
            error => Self::Study(error),
        }
    }
}
