//! A case from its start to its end, in memory or in a folder.

use crate::case::Case;
use crate::error::{in_python, of_output, of_run};
use crate::interrupt::watched;
use crate::results::{of_files, results};
use granflow::output::summary::{StopReason, Summary};
use granflow::results::Finished;
use granflow::run::Run;
use granflow::session::{Options, RunError};
use granflow::sinks::{BeginError, Kept};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Where a run is.
#[derive(Clone, Copy, Default)]
struct Status {
    time: f64,
    steps: u64,
    wet: usize,
    speed: f64,
}

impl Status {
    fn of(run: &dyn Run) -> Status {
        let (wet, speed) = (run.record().wet_cells, run.stepper().speed());
        Status { time: run.time(), steps: run.steps(), wet, speed }
    }
}

/// What a run left.
enum Left {
    InMemory(Kept),
    InFolder(Finished),
}

/// Computes a case on so many threads (0: all cores), into a folder too where one is given. `progress` is called now and then with
/// time, end (None: not known), steps, wet cells and the largest speed.
/// Returns coordinates, variables, attributes, the summary as JSON, the remarks of readers, and the seconds that all but arrays took; of
/// a run in a folder that had ended before, only `ended`, how.
#[pyfunction]
#[pyo3(signature = (case, threads, progress, out, resume))]
pub fn run<'py>(
    py: Python<'py>,
    case: &Case,
    threads: usize,
    progress: Option<Py<PyAny>>,
    out: Option<PathBuf>,
    resume: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let checked = case.checked(py)?;
    let (stop, status) = (AtomicBool::new(false), Mutex::new(None));
    let end = checked.plan().ends.time;
    let heard = Mutex::new(Vec::new());
    let hear = |text: &str| of(&heard).push(text.to_owned());
    let work = || {
        let (mut first, begun) = (true, Instant::now());
        let mut report = |run: &dyn Run| {
            if std::mem::take(&mut first) {
                of(&heard).extend(run.plane().domain.remarks());
            }
            *of(&status) = Some(Status::of(run));
        };
        let left = match out {
            None => checked.compute_in_memory(threads, &stop, &mut report).map(Left::InMemory),
            Some(directory) => {
                let command = "granflow.run".to_owned();
                let options = Options { directory, threads, resume, command, notice: &hear };
                checked.compute(&options, &stop, &mut report).map(Left::InFolder)
            }
        };
        (left, begun.elapsed())
    };
    let look = |py: Python<'_>| {
        let now = *of(&status);
        match (&progress, now) {
            (Some(progress), Some(Status { time, steps, wet, speed })) => {
                progress.call1(py, (time, end, steps, wet, speed)).map(drop)
            }
            _ => Ok(()),
        }
    };
    let ((left, taken), interrupt) = watched(py, work, || stop.store(true, Ordering::Relaxed), look);
    let results = match left {
        Err(RunError::Begin(ended @ BeginError::Ended { .. })) => {
            interrupt.map_or(Ok(()), Err)?;
            let results = PyDict::new(py);
            results.set_item("ended", in_python(&ended.to_string()))?;
            return Ok(results);
        }
        Err(error) => return Err(interrupt.unwrap_or_else(|| of_run(py, &error))),
        Ok(Left::InMemory(kept)) => {
            interrupt.map_or(Ok(()), Err)?;
            of(&heard).extend(kept.notes.iter().cloned());
            results(py, kept)?
        }
        Ok(Left::InFolder(finished)) => {
            let results = of_files(py, &finished);
            let folder = finished.directory.clone();
            let summary = py.detach(|| finished.close()).map_err(|error| of_output(&error))?;
            if let Some(interrupt) = interrupt {
                return Err(stopped(py, interrupt, &summary, &folder));
            }
            results?
        }
    };
    results.set_item("remarks", std::mem::take(&mut *of(&heard)))?;
    results.set_item("seconds", taken.as_secs_f64())?;
    Ok(results)
}

/// What a lock guards: whoever holds it does so for no longer than a copy takes.
fn of<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The exception that stopped a run in a folder; Ctrl-C says how the run goes on.
fn stopped(py: Python<'_>, interrupt: PyErr, summary: &Summary, folder: &Path) -> PyErr {
    if summary.stop_reason != StopReason::Interrupted || !interrupt.is_instance_of::<PyKeyboardInterrupt>(py)
    {
        return interrupt;
    }
    let (time, folder) = (summary.time, folder.display());
    PyKeyboardInterrupt::new_err(format!("stopped at time {time}: {folder}; resume=True goes on from there"))
}
