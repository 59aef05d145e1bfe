//! A study: a run, what is varied of it, and the cases that this makes.

use crate::{ReadError, Run};
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;
use stead_disk::input::InputFile;
use stead_numerics::monitor::Monitor;

/// Which cases leave their files in a folder of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// None.
    None,
    /// Those with the smallest objective, so many.
    Best(usize),
    /// All that have a placement.
    All,
}

/// A study: its cases, each a run that can be read.
#[derive(Debug, Clone)]
pub struct Study {
    /// The study file as the user named it.
    pub file: PathBuf,
    /// Whether cases are certified.
    pub is_certified: bool,
    /// Which cases leave their files.
    pub keep: Keep,
    /// Names of the axes, the tasks last where the file has tasks.
    pub axes: Vec<String>,
    /// All cases, in the order of their numbers.
    pub cases: Vec<StudyCase>,
    /// The study file and its base.
    pub inputs: Vec<InputFile>,
    /// What reads the runs of the cases.
    pub reader: Arc<dyn ReadCase>,
}

impl Study {
    /// Reads the run of a case.
    ///
    /// # Errors
    /// What is wrong in the files of the case, with the values that make it; or that the monitor stopped it.
    pub fn case(&self, case: &StudyCase, monitor: &Monitor) -> Result<CaseRun, ReadError> {
        self.reader.read(case, monitor).map_err(|error| {
            let name = self.file.file_name().unwrap_or_default().to_string_lossy();
            error.set_by(format!("case {} of {name}{}", case.number, case.combination(&self.axes)))
        })
    }
}

/// Reads the runs of the cases of a study.
pub trait ReadCase: std::fmt::Debug + Send + Sync {
    /// The run of a case.
    ///
    /// # Errors
    /// What is wrong in the files of the case, or that the monitor stopped it.
    fn read(&self, case: &StudyCase, monitor: &Monitor) -> Result<CaseRun, ReadError>;
}

/// A case of a study as a run, with its digest.
#[derive(Debug, Clone)]
pub struct CaseRun {
    /// What is to be done.
    pub run: Run,
    /// SHA-256 digest, in lower-case hexadecimal, of all that the result depends on: the run file with the values of
    /// the case in place, the bytes of every file that it names, whether it is certified, and the version of the
    /// results.
    pub id: String,
    /// The task, as the run file or the study file names it.
    pub task: String,
}

/// What stands for the value of an axis in the table of results.
#[derive(Debug, Clone, PartialEq)]
pub enum AxisValue {
    /// A number, in the unit of the field.
    Number(f64),
    /// A label, the name of a file, an array, a word.
    Text(String),
}

impl fmt::Display for AxisValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

/// A case of a study: values that take the place of those of its base.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyCase {
    /// Its number, from 1, in the order of the study.
    pub number: usize,
    /// What stands for them, one for each axis.
    pub values: Vec<AxisValue>,
    /// The task, where the study has tasks.
    pub task: Option<String>,
    /// What the task counts beside the others, where each has its own placement.
    pub weight: f64,
}

impl StudyCase {
    /// The values of the axes, in words; nothing without axes.
    fn combination(&self, axes: &[String]) -> String {
        let all: Vec<String> = axes.iter().zip(&self.values).map(|(axis, value)| format!("{axis} = {value}")).collect();
        if all.is_empty() { String::new() } else { format!(" ({})", all.join(", ")) }
    }
}
