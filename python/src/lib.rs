//! The compiled half of the Python package `stead`: the facade of the crate `stead`, input by input and result by
//! result.
//!
//! Nothing is computed here. Documents cross over as JSON, tables and pictures as the bytes of their files; the package
//! `stead` beside it (`package/stead/`) makes typed objects of them, and is what users see.

mod errors;
mod inputs;
mod jobs;
mod results;
mod study;

use errors::raised;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// Writes a commented starter set of files for a command and returns their paths, the one to begin with first.
#[pyfunction]
fn init(py: Python<'_>, kind: &str, folder: PathBuf, force: bool) -> PyResult<Vec<PathBuf>> {
    let set = match kind {
        "place" => stead::files::StarterSet::Place,
        "assess" => stead::files::StarterSet::Assess,
        "identify" => stead::files::StarterSet::Identify,
        "simulate" => stead::files::StarterSet::Simulate,
        "study" => stead::files::StarterSet::Study,
        "compensate" => stead::files::StarterSet::Compensate,
        "forces" => stead::files::StarterSet::Forces,
        _ => {
            let problem = format!(
                "no such starter set, found {kind}; allowed: place, assess, identify, simulate, study, compensate, forces"
            );
            return Err(raised(py, stead::Error::Argument(problem)));
        }
    };
    let existing = if force { stead::files::Existing::Replaced } else { stead::files::Existing::Kept };
    stead::files::init(set, &folder, existing).map_err(|error| raised(py, error.into()))
}

/// The JSON Schema of a kind of file.
#[pyfunction]
fn schema(py: Python<'_>, kind: &str) -> PyResult<String> {
    stead::files::schema(kind).map_err(|error| raised(py, stead::Error::Argument(error.to_string())))
}

/// Runs a command line, the first argument of which is the program itself, and returns its exit code.
#[pyfunction]
fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| stead::cli::run(arguments))
}

/// The native classes and functions, see `_stead.pyi`.
#[pymodule]
fn _stead(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("MAX_THREADS", stead::MAX_THREADS)?;
    module.add_class::<inputs::Run>()?;
    module.add_class::<inputs::AssessmentRun>()?;
    module.add_class::<inputs::FitRun>()?;
    module.add_class::<inputs::DesignRun>()?;
    module.add_class::<inputs::CompensationRun>()?;
    module.add_class::<inputs::SimulationRun>()?;
    module.add_class::<inputs::StabilityRun>()?;
    module.add_class::<inputs::Profile>()?;
    module.add_class::<study::Study>()?;
    module.add_class::<results::Outcome>()?;
    module.add_class::<results::Folder>()?;
    module.add_function(wrap_pyfunction!(init, module)?)?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(run_command, module)?)
}
