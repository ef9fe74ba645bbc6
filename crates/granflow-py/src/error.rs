//! Errors of the engine as those of Python.

use granflow::StartError;
use granflow::case::{CaseError, CaseErrorKind};
use granflow::ensemble::EnsembleError;
use granflow::output::Error as OutputError;
use granflow::raster::RasterError;
use granflow::release::ReleaseError;
use granflow::results::FilesError;
use granflow::session::RunError;
use granflow::sinks::BeginError;
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
        given.set_item("text", set_in_python(&error.to_string()))?;
        given.set_item("file", error.source_name())?;
        given.set_item("line", line)?;
        given.set_item("column", column)?;
        given.set_item("key", error.key())?;
        given.set_item("message", error.message())?;
        given.set_item("help", set_in_python(&error.help_lines().join("\n")))
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

/// A file of the results that cannot be read or written, or is not what it should be.
pub fn of_output(error: &OutputError) -> PyErr {
    output_as(error, in_python(&error.to_string()))
}

/// A state that cannot be gone on from.
pub fn of_restore(error: &BeginError) -> PyErr {
    let text = restoring(&error.to_string());
    match error {
        BeginError::Output(error) => output_as(error, text),
        _ => PyValueError::new_err(text),
    }
}

fn output_as(error: &OutputError, text: String) -> PyErr {
    match error {
        OutputError::Io { source, .. } => of_file(text, Some(source.kind())),
        OutputError::Busy { .. } => PyOSError::new_err(text),
        OutputError::Damaged { .. } | OutputError::Mismatch { .. } | OutputError::Invalid { .. } => {
            PyValueError::new_err(text)
        }
    }
}

/// Why the files of a run could not be begun, or gone on with.
fn of_begin(error: &BeginError) -> PyErr {
    let text = in_python(&error.to_string());
    match error {
        BeginError::Output(error) => of_output(error),
        BeginError::Thread(_) => PyOSError::new_err(text),
        BeginError::Resume { .. } | BeginError::Ended { .. } | BeginError::Lost { .. } => {
            PyValueError::new_err(text)
        }
    }
}

/// A sentence of the program in which its options have the names that they have here.
pub fn in_python(text: &str) -> String {
    let text = set_in_python(text).replace("--set ", "Case.set ");
    text.replace("--resume", "resume=True").replace("--out", "out")
}

fn set_in_python(text: &str) -> String {
    text.replace("with --set, replace the whole choice: --set '", "Case.set replaces the whole choice: '")
}

/// A sentence of the program about a folder, where there is only a state.
pub fn restoring(text: &str) -> String {
    let without = [
        ", another --out, or start again without --resume",
        ", or start again without --resume",
        "; start the run again without --resume",
    ];
    in_python(&without.iter().fold(text.to_owned(), |text, part| text.replace(part, "")))
}

/// Commands by which messages mend a file, and what mends what is in memory.
const CURES: [(&str, &str); 4] = [
    ("gdal_edit.py -a_nodata", "numpy.where(values == nodata, numpy.nan, values)"),
    ("gdalwarp -t_srs", "array.rio.reproject(crs)"),
    ("ogr2ogr -t_srs", "geodataframe.to_crs(crs)"),
    ("ogr2ogr -makevalid", "shapely.make_valid(geometry)"),
];

/// A message on an input; of one in memory, whose name stands in angle brackets, with the cure in Python.
fn of_input(text: String) -> String {
    let cure = CURES.iter().find(|(command, _)| text.starts_with('<') && text.contains(command));
    cure.map_or(text.clone(), |(_, cure)| format!("{text}\n(in Python: {cure})"))
}

/// Why a run did not begin.
pub fn of_start(py: Python<'_>, error: &StartError) -> PyErr {
    let text = of_input(error.to_string());
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
        EnsembleError::Output(error) => of_output(error),
        EnsembleError::Parts(_) | EnsembleError::Threads(_) => PyValueError::new_err(error.to_string()),
    }
}

/// Why a run did not end.
pub fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    match error {
        RunError::Start(error) => of_start(py, error),
        RunError::Failed { failure, time } => of_computation(py, failure.to_string(), *time),
        RunError::Computation { time, .. } => of_computation(py, error.to_string(), *time),
        RunError::Threads(_) => PyValueError::new_err(error.to_string()),
        RunError::Begin(error) => of_begin(error),
        RunError::Output(error) => of_output(error),
        RunError::Files(FilesError::Kind { .. }) => PyValueError::new_err(error.to_string()),
        RunError::Files(FilesError::Output(error)) => of_output(error),
        RunError::Files(error) => PyOSError::new_err(in_python(&error.to_string())),
    }
}
