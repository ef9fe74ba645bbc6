//! Many runs of one case: members computed here or elsewhere, and added up.

use crate::case::Case;
use crate::error::of_ensemble;
use crate::interrupt::watched;
use crate::results::of_dataset;
use granflow::ensemble::{Progress, Reduced};
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A value drawn for a key: its column, and the number or the text of a choice.
type Value = (String, Option<f64>, Option<String>);

/// An ensemble that is ready to be computed.
#[pyclass(module = "granflow._native", frozen)]
pub struct Ensemble(granflow::ensemble::Ensemble);

/// Members added up.
#[pyclass(module = "granflow._native")]
pub struct Members(Reduced);

impl Ensemble {
    /// Adds the members of a range to those that were added before, and gives the exception that ended it.
    fn run(
        &self,
        py: Python<'_>,
        members: Range<u32>,
        begun: Reduced,
        workers: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Reduced, Option<PyErr>)> {
        let count = self.0.plan().members;
        if members.is_empty() || members.end > count {
            return Err(PyIndexError::new_err(format!("members {members:?}: the case has {count}")));
        }
        let (stop, done) = (AtomicBool::new(false), AtomicUsize::new(0));
        let work = || {
            let keep = |_: &Reduced| Ok(());
            let mut hear = |progress: Progress, _: Option<&_>| done.store(progress.done, Ordering::Relaxed);
            self.0.run(members, begun, workers, &stop, &keep, &mut hear)
        };
        let look = |py: Python<'_>| match &progress {
            Some(progress) => progress.call1(py, (done.load(Ordering::Relaxed),)).map(drop),
            None => Ok(()),
        };
        let (result, interrupt) = watched(py, work, || stop.store(true, Ordering::Relaxed), look);
        Ok((result.map_err(|error| of_ensemble(py, &error))?, interrupt))
    }
}

#[pymethods]
impl Ensemble {
    /// Of a case with a table `[ensemble]`, set up once.
    #[new]
    fn new(py: Python<'_>, case: &Case) -> PyResult<Self> {
        let (case, inputs) = case.parts(py)?;
        let made = py.detach(|| granflow::ensemble::Ensemble::with(&case, &inputs));
        made.map(Self).map_err(|error| of_ensemble(py, &error))
    }

    /// How many members the case asks for.
    #[getter]
    fn count(&self) -> u32 {
        self.0.plan().members
    }

    /// What the ensemble is, in one line.
    #[getter]
    fn text(&self) -> String {
        self.0.plan().to_string()
    }

    /// What readers say of its files.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.0.plane().domain.remarks()
    }

    /// The values of a member, and the overrides that make its case.
    fn sample(&self, number: u32) -> PyResult<(Vec<Value>, Vec<String>)> {
        let count = self.count();
        if number >= count {
            return Err(PyIndexError::new_err(format!("member {number}: the case has {count} members")));
        }
        let member = self.0.sample(number);
        let columns = self.0.plan().columns();
        let value = |(column, value): (granflow::ensemble::Column, f64)| match column.choices {
            Some(choices) => (column.name, None, choices.get(value as usize).cloned()),
            None => (column.name, Some(value), None),
        };
        let values = member.values.iter().map(|drawn| drawn.value());
        Ok((columns.into_iter().zip(values).map(value).collect(), member.overrides))
    }

    /// Computes the members of a range, so many at a time (0: as many as there are cores), and gives them added up as bytes.
    fn compute<'py>(
        &self,
        py: Python<'py>,
        first: u32,
        end: u32,
        workers: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let (result, interrupt) = self.run(py, first..end, self.0.empty(), workers, None)?;
        interrupt.map_or(Ok(()), Err)?;
        Ok(PyBytes::new(py, &self.0.to_bytes(&result)))
    }

    /// Computes the members of a range that are not there yet and adds them; what is done is kept when Ctrl-C ends it. `progress` is
    /// called now and then with the members of the range that are done.
    fn compute_here(
        &self,
        py: Python<'_>,
        members: &mut Members,
        range: [u32; 2],
        workers: usize,
        progress: Py<PyAny>,
    ) -> PyResult<()> {
        let begun = std::mem::replace(&mut members.0, self.0.empty());
        let (result, interrupt) = self.run(py, range[0]..range[1], begun, workers, Some(progress))?;
        members.0 = result;
        interrupt.map_or(Ok(()), Err)
    }

    /// Of no member yet.
    fn empty(&self) -> Members {
        Members(self.0.empty())
    }

    /// Adds what [`Ensemble::compute`] gave, here or elsewhere; each member once.
    fn add(&self, py: Python<'_>, members: &mut Members, bytes: &[u8]) -> PyResult<()> {
        let part = py.detach(|| self.0.from_bytes(bytes, Path::new("<part>")));
        let part = part.map_err(|error| of_ensemble(py, &error))?;
        let twice = |number| PyValueError::new_err(format!("member {number} is added twice"));
        members.0.merge(part).map_err(twice)
    }

    /// What `result.nc` holds, as [`crate::run::run`] gives it, without a summary.
    fn results<'py>(&self, py: Python<'py>, members: &Members) -> PyResult<Bound<'py, PyDict>> {
        let maps = self.0.maps(&members.0);
        of_dataset(py, &self.0.dataset(&maps, "granflow.Ensemble.run"))
    }

    /// `members.csv`.
    fn table(&self, members: &Members) -> PyResult<String> {
        let mut text = Vec::new();
        self.0.table(&members.0, &mut text)?;
        String::from_utf8(text).map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }

    /// All as one part, for files.
    fn part<'py>(&self, py: Python<'py>, members: &Members) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.to_bytes(&members.0))
    }
}

#[pymethods]
impl Members {
    /// The numbers of all members that were added.
    #[getter]
    fn numbers(&self) -> Vec<u32> {
        self.0.members().collect()
    }

    /// How many came to their end.
    #[getter]
    fn computed(&self) -> u32 {
        self.0.computed()
    }

    /// The members that failed, and why.
    #[getter]
    fn failures(&self) -> Vec<(u32, String)> {
        self.0.failures().map(|(number, failure)| (number, failure.to_owned())).collect()
    }
}
