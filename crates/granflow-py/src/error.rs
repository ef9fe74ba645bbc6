//! Errors of the engine as those of Python.

use granflow::StartError;
use granflow::case::{CaseError, CaseErrorKind};
use granflow::ensemble::EnsembleError;
use granflow::raster::RasterError;
use granflow::release::ReleaseError;
use granflow::session::RunError;
use pyo3::exceptions::{PyFileNotFoundError, PyMemoryError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::io::ErrorKind;

/// An exception of `granflow._errors`, made with keywords.
fn made(py: Python<'_>, class: &str, keywords: impl FnOnce(&Bound<'_, PyDict>) -> PyResult<()>) -> PyErr {
    let make = || {
        let given = PyDict::new(py);
        keywords(&given)?;
        py.import("granflow._errors")?.getattr(class)?.call((), Some(&given))
    };
    make().map_or_else(|error: PyErr| error, PyErr::from_value)
}

/// A `CaseError` with its place, key and cure; one that is a `FileNotFoundError` too where a file is missing.
pub fn of_case(py: Python<'_>, error: &CaseError) -> PyErr {
    let missing = error.kind() == CaseErrorKind::File && error.message().contains("(os error 2)");
    made(py, if missing { "MissingFileError" } else { "CaseError" }, |given| {
        let (line, column) = error.line_column().unzip();
        given.set_item("text", error.to_string())?;
        given.set_item("file", error.source_name())?;
        given.set_item("line", line)?;
        given.set_item("column", column)?;
        given.set_item("key", error.key())?;
        given.set_item("message", error.message())?;
        given.set_item("help", error.help_lines().join("\n"))
    })
}

/// A computation that failed.
pub fn of_computation(py: Python<'_>, text: String, time: f64) -> PyErr {
    made(py, "ComputationError", |given| {
        given.set_item("text", text)?;
        given.set_item("time", time)
    })
}

fn of_file(text: String, kind: Option<ErrorKind>) -> PyErr {
    match kind {
        Some(ErrorKind::NotFound) => PyFileNotFoundError::new_err(text),
        Some(_) => PyOSError::new_err(text),
        None => PyValueError::new_err(text),
    }
}

/// Why a run did not begin.
pub fn of_start(py: Python<'_>, error: &StartError) -> PyErr {
    let text = error.to_string();
    match error {
        StartError::Case(error) => of_case(py, error),
        StartError::Raster(error) => match &**error {
            RasterError::Io { source, .. } => of_file(text, Some(source.kind())),
            _ => of_file(text, None),
        },
        StartError::Release(error) => match &**error {
            ReleaseError::Io { source, .. } => of_file(text, Some(source.kind())),
            _ => of_file(text, None),
        },
        StartError::Memory { .. } => PyMemoryError::new_err(text),
        StartError::Build(_) | StartError::Feature { .. } | StartError::Result { .. } => {
            PyValueError::new_err(text)
        }
    }
}

/// Why an ensemble could not be computed or put together.
pub fn of_ensemble(py: Python<'_>, error: &EnsembleError) -> PyErr {
    match error {
        EnsembleError::Case(error) => of_case(py, error),
        EnsembleError::Start(error) => of_start(py, error),
        EnsembleError::AllFailed { .. } => of_computation(py, error.to_string(), f64::NAN),
        EnsembleError::Raster(_) | EnsembleError::Figure(_) => PyOSError::new_err(error.to_string()),
        EnsembleError::Output(_) | EnsembleError::Parts(_) | EnsembleError::Threads(_) => {
            PyValueError::new_err(error.to_string())
        }
    }
}

/// Why a run did not end.
pub fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    match error {
        RunError::Start(error) => of_start(py, error),
        RunError::Failed { failure, time } => of_computation(py, failure.to_string(), *time),
        RunError::Computation { time, .. } => of_computation(py, error.to_string(), *time),
        RunError::Threads(_) => PyValueError::new_err(error.to_string()),
        RunError::Begin(_) | RunError::Output(_) | RunError::Files(_) => {
            PyOSError::new_err(error.to_string())
        }
    }
}
