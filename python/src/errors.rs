//! Errors of the facade as the exceptions of `stead._errors`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stead::Error;
use stead::report::ReportError;
use stead::study::StudyError;

/// The exception for an error.
pub fn raised(py: Python<'_>, error: Error) -> PyErr {
    raised_with(py, error, |_| None)
}

/// The exception for an error, with the JSON document that stands in place of a result, where there is one.
pub fn raised_with(py: Python<'_>, error: Error, document: impl FnOnce(&Error) -> Option<String>) -> PyErr {
    exception(py, &error, document(&error)).unwrap_or_else(|problem| problem)
}

fn exception(py: Python<'_>, error: &Error, document: Option<String>) -> PyResult<PyErr> {
    let fields = PyDict::new(py);
    let class = match error {
        Error::Input(input) if input.is_of_disk => "OutputError",
        Error::Input(input) => {
            fields.set_item("file", input.file.display().to_string())?;
            fields.set_item("line", input.line.map(std::num::NonZeroUsize::get))?;
            fields.set_item("field", input.field.as_deref())?;
            fields.set_item("problem", &*input.problem)?;
            fields.set_item("found", input.found.as_deref())?;
            fields.set_item("allowed", input.allowed.as_deref())?;
            "InputError"
        }
        Error::Argument(_) => "ArgumentError",
        Error::Output(ReportError::Locked { .. }) | Error::Study(StudyError::Locked { .. }) => "Locked",
        Error::Output(_) | Error::Study(StudyError::Folder { .. } | StudyError::File { .. } | StudyError::Keep(_)) => {
            "OutputError"
        }
        Error::Infeasible(_) => {
            fields.set_item("document", document)?;
            "Infeasible"
        }
        Error::NotCompensated(_) => {
            fields.set_item("document", document)?;
            "NotCompensated"
        }
        _ => "Error",
    };
    let class = py.import("stead._errors")?.getattr(class)?;
    let value = class.call((error.to_string(),), Some(&fields))?;
    value.setattr("is_bad_input", error.is_bad_input())?;
    Ok(PyErr::from_value(value))
}
