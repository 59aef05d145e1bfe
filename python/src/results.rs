//! Results: one class for all of them, as text, JSON document and files.

use crate::errors::raised;
use crate::jobs::{Options, run_stoppable};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::Mutex;

/// A result of the facade.
#[derive(Clone)]
pub enum Kind {
    Placements(stead::Placements),
    Score(stead::PlacementScore),
    Explanations(stead::Explanations),
    Assessment(stead::RobotAssessment),
    Identified(stead::IdentifiedRobot),
    Design(stead::MeasurementPlan),
    Compensated(stead::CompensatedPath),
    Simulated(stead::SimulatedPass),
    Stability(stead::StabilityAnalysis),
    Circularity(stead::circularity::Circularity),
    Study(stead::study::StudyReport),
}

/// The same expression for whichever result it is: they have their methods in common.
macro_rules! each {
    ($kind:expr, $result:ident => $value:expr) => {
        match $kind {
            Kind::Placements($result) => $value,
            Kind::Score($result) => $value,
            Kind::Explanations($result) => $value,
            Kind::Assessment($result) => $value,
            Kind::Identified($result) => $value,
            Kind::Design($result) => $value,
            Kind::Compensated($result) => $value,
            Kind::Simulated($result) => $value,
            Kind::Stability($result) => $value,
            Kind::Circularity($result) => $value,
            Kind::Study($result) => $value,
        }
    };
}

/// A result, which never changes: what adds to it makes a new one.
#[pyclass(frozen, module = "stead._stead")]
pub struct Outcome(pub Kind);

#[pymethods]
impl Outcome {
    /// The JSON document, as the command prints it.
    fn json(&self, py: Python<'_>) -> String {
        py.detach(|| each!(&self.0, result => format!("{:#}\n", result.to_json())))
    }

    /// The text that the command prints.
    fn text(&self) -> String {
        each!(&self.0, result => result.to_string())
    }

    /// What the user should know about the input.
    fn notes(&self) -> Vec<String> {
        each!(&self.0, result => result.notes().iter().map(ToString::to_string).collect())
    }

    /// Kind and message of each warning.
    fn warnings(&self) -> Vec<(&'static str, String)> {
        let warnings = each!(&self.0, result => result.warnings());
        warnings.iter().map(|warning| (warning.kind, warning.message.clone())).collect()
    }

    /// Names and contents of the files.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Bound<'py, PyBytes>)>> {
        let files = py.detach(|| each!(&self.0, result => result.to_files())).map_err(|error| raised(py, error))?;
        Ok(files.into_iter().map(|(name, bytes)| (name, PyBytes::new(py, &bytes))).collect())
    }

    /// Writes the files into a folder.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Vec<PathBuf>> {
        py.detach(|| each!(&self.0, result => result.write(&folder))).map_err(|error| raised(py, error))
    }

    /// Writes the files into a folder that is held.
    fn write_in(&self, py: Python<'_>, folder: &Folder) -> PyResult<Vec<PathBuf>> {
        let written = py.detach(|| folder.with(|folder| each!(&self.0, result => result.write_in(folder))));
        written.map_err(|error| raised(py, error))
    }

    /// Placements with the certificate that their run asks for; everything else as it is. And whether Ctrl-C stopped
    /// it.
    fn certified(&self, py: Python<'_>, options: Options) -> PyResult<(Self, bool)> {
        self.extended(py, &options, |kind, monitor| {
            if let Kind::Placements(placements) = kind {
                placements.certify(monitor);
            }
        })
    }

    /// A score with its maps; everything else as it is. And whether Ctrl-C stopped it.
    fn mapped(&self, py: Python<'_>, options: Options) -> PyResult<(Self, bool)> {
        self.extended(py, &options, |kind, monitor| {
            if let Kind::Score(score) = kind {
                score.map(monitor);
                score.make_sheet(monitor);
            }
        })
    }
}

impl Outcome {
    fn extended(
        &self,
        py: Python<'_>,
        options: &Options,
        job: impl FnOnce(&mut Kind, &stead::Monitor) + Send + 'static,
    ) -> PyResult<(Self, bool)> {
        let mut kind = self.0.clone();
        let run = move |monitor: &stead::Monitor| {
            job(&mut kind, monitor);
            kind
        };
        run_stoppable(py, options, run).map(|(kind, was_stopped)| (Self(kind), was_stopped))
    }
}

/// A results folder, held until it is released.
#[pyclass(frozen, module = "stead._stead")]
pub struct Folder(Mutex<Option<stead::report::Folder>>);

#[pymethods]
impl Folder {
    /// Takes a folder.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let folder = stead::report::Folder::create(&path).map_err(|error| raised(py, error.into()))?;
        Ok(Self(Mutex::new(Some(folder))))
    }

    /// Lets other runs write to it.
    fn release(&self) {
        drop(self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take());
    }
}

impl Folder {
    fn with<T>(
        &self,
        write: impl FnOnce(&stead::report::Folder) -> Result<T, stead::Error>,
    ) -> Result<T, stead::Error> {
        match &*self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner) {
            Some(folder) => write(folder),
            None => Err(stead::Error::Argument("the folder has been released".to_owned())),
        }
    }
}
