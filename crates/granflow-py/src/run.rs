//! A case from its start to its end, in memory.

use crate::case::Case;
use crate::error::of_run;
use crate::interrupt::watched;
use crate::results::results;
use granflow::run::Run;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Where a run is.
#[derive(Clone, Copy, Default)]
struct Status {
    time: f64,
    steps: u64,
    wet: usize,
    speed: f64,
}

/// Computes a case on so many threads (0: all cores). `progress` is called now and then with time, end (None: not known), steps, wet cells and the largest
/// speed.
/// Returns coordinates, variables, attributes, the summary as JSON, the remarks of readers, and the seconds that all but arrays took.
#[pyfunction]
#[pyo3(signature = (case, threads, progress))]
pub fn run<'py>(
    py: Python<'py>,
    case: &Case,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let checked = case.checked(py)?;
    let (stop, status) = (AtomicBool::new(false), Mutex::new(None));
    let end = checked.plan().ends.time;
    let mut remarks = Vec::new();
    let work = || {
        let (mut first, begun) = (true, Instant::now());
        let result = checked.compute_in_memory(threads, &stop, &mut |run: &dyn Run| {
            if std::mem::take(&mut first) {
                remarks.extend(run.plane().domain.remarks());
            }
            // Whoever reads it holds it for no longer than a copy takes.
            *status.lock().unwrap_or_else(|broken| broken.into_inner()) = Some(Status {
                time: run.time(),
                steps: run.steps(),
                wet: run.record().wet_cells,
                speed: run.stepper().speed(),
            });
        });
        (result, begun.elapsed())
    };
    let look = |py: Python<'_>| {
        let now = *status.lock().unwrap_or_else(|broken| broken.into_inner());
        match (&progress, now) {
            (Some(progress), Some(Status { time, steps, wet, speed })) => {
                progress.call1(py, (time, end, steps, wet, speed)).map(drop)
            }
            _ => Ok(()),
        }
    };
    let ((result, taken), interrupt) = watched(py, work, || stop.store(true, Ordering::Relaxed), look);
    if let Some(interrupt) = interrupt {
        return Err(interrupt);
    }
    let kept = result.map_err(|error| of_run(py, &error))?;
    if kept.summary.stop_reason == granflow::output::summary::StopReason::Interrupted {
        return Err(PyKeyboardInterrupt::new_err(()));
    }
    let results = results(py, kept)?;
    results.set_item("remarks", remarks)?;
    results.set_item("seconds", taken.as_secs_f64())?;
    Ok(results)
}
