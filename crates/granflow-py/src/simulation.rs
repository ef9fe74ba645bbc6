//! A run that Python holds: stepped, looked into, saved.

use crate::case::Case;
use crate::error::{of_computation, of_output, of_restore, of_run, of_start, restoring};
use crate::interrupt::PAUSE;
use granflow::output::checkpoint::Origin;
use granflow::run::{Ends, Failure, FrameClock, Run, Saved, reached, watch_for};
use granflow::session::{Change, origin, restore, save, threads};
use numpy::ndarray::{ArrayView, IxDyn, ShapeBuilder};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyKeyError, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::time::Instant;

/// A run under way.
#[pyclass(module = "granflow._native")]
pub struct Simulation {
    run: Box<dyn Run>,
    /// What it was made of.
    origin: Origin,
    ends: Ends,
    pool: ThreadPool,
    /// The last frame was the end of the run.
    ended: bool,
}

/// A state to go on from.
#[pyclass(module = "granflow._native", frozen)]
pub struct Checkpoint {
    state: Saved<'static>,
    /// What the run was made of.
    origin: Origin,
}

impl Checkpoint {
    /// Has a run go on from it; returns what differs in the case.
    fn restored(&self, run: &mut dyn Run, now: &Origin) -> PyResult<Vec<Change>> {
        let refused = |problem: String| PyValueError::new_err(restoring(&problem));
        let changes = self.origin.changes(now).map_err(refused)?;
        run.restore(self.state.clone())
            .map_err(|problem| refused(format!("another checkpoint: {problem}")))?;
        Ok(changes)
    }
}

/// How far a piece of work has come.
enum Came {
    /// There is more to do.
    OnTheWay,
    /// All is done.
    There,
}

impl Simulation {
    /// Does steps until `step` says that it is there, without Python's lock; Ctrl-C is looked at now and then.
    fn work(
        &mut self,
        py: Python<'_>,
        mut step: impl FnMut(&mut dyn Run) -> Result<Came, Failure> + Send,
    ) -> PyResult<()> {
        loop {
            let Simulation { run, pool, .. } = self;
            let done = py.detach(|| {
                pool.install(|| {
                    let begun = Instant::now();
                    loop {
                        match step(&mut **run)? {
                            Came::There => return Ok(true),
                            Came::OnTheWay if begun.elapsed() > PAUSE => return Ok(false),
                            Came::OnTheWay => {}
                        }
                    }
                })
            });
            let failed = |failure: Failure| of_computation(py, failure.to_string(), self.run.time());
            if done.map_err(failed)? {
                return Ok(());
            }
            py.check_signals()?;
        }
    }
}

/// Says whether a step of this length was the last that there is.
fn came(dt: f64) -> Came {
    if dt.is_finite() { Came::OnTheWay } else { Came::There }
}

/// Numbers of a simulation, a row every `row` of them, as an array without a copy that cannot be written.
fn lent<'py>(
    owner: &Bound<'py, Simulation>,
    values: &[f64],
    [rows, columns]: [usize; 2],
    row: usize,
    flat: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let (shape, strides) = if flat { (vec![columns], vec![1]) } else { (vec![rows, columns], vec![row, 1]) };
    let cells = ArrayView::from_shape(IxDyn(&shape).strides(IxDyn(&strides)), values)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    // SAFETY: the array keeps the simulation alive, and while that lives the memory of its state does: steps exchange the arrays of
    // the state, and none is given back before the end.
    let array = unsafe { PyArrayDyn::borrow_from_array(&cells, owner.clone().into_any()) };
    array.readwrite().make_nonwriteable();
    Ok(array.into_any())
}

#[pymethods]
impl Simulation {
    /// The run of a case on so many threads (0: all cores), from its start, from a checkpoint or from one in a file; and what differs in
    /// the case since then.
    #[staticmethod]
    #[pyo3(signature = (case, number, checkpoint, file))]
    fn begin(
        py: Python<'_>,
        case: &Case,
        number: usize,
        checkpoint: Option<&Checkpoint>,
        file: Option<PathBuf>,
    ) -> PyResult<(Self, Vec<String>)> {
        let (checked, inputs) = (case.checked(py)?, case.inputs());
        let ends = checked.plan().ends;
        let origin = py.detach(|| origin(checked.plan(), inputs));
        let origin = origin.map_err(|error| of_output(&error))?;
        let pool = threads(number).map_err(|error| of_run(py, &error))?;
        let started = py.detach(|| pool.install(|| checked.start()));
        let mut run = started.map_err(|error| of_start(py, &error))?;
        let changes = match (checkpoint, file) {
            (Some(saved), _) => saved.restored(&mut *run, &origin)?,
            (None, Some(file)) => restore(&mut *run, &origin, &file).map_err(|error| of_restore(&error))?,
            (None, None) => Vec::new(),
        };
        watch_for(&mut *run, &ends);
        py.detach(|| pool.install(|| run.bring()));
        let changes = changes.iter().map(ToString::to_string).collect();
        Ok((Simulation { run, origin, ends, pool, ended: false }, changes))
    }

    /// So many steps; fewer where nothing can move any more.
    fn step(&mut self, py: Python<'_>, count: u64) -> PyResult<()> {
        let mut left = count;
        self.run.stepper_mut().show_end();
        self.work(py, |run| {
            if left == 0 {
                return Ok(Came::There);
            }
            left -= 1;
            run.bring();
            run.step(f64::INFINITY).map(came)
        })?;
        self.run.bring();
        Ok(())
    }

    /// To a time.
    fn until(&mut self, py: Python<'_>, time: f64) -> PyResult<()> {
        if time.is_nan() {
            return Err(PyValueError::new_err("the time to step to is not a number"));
        }
        self.run.stepper_mut().show_end();
        self.work(py, |run| if run.time() < time { run.step(time).map(came) } else { Ok(Came::There) })?;
        self.run.bring();
        Ok(())
    }

    /// Until all rests, or to the time `limit`; says whether it rests.
    fn rest(&mut self, py: Python<'_>, limit: Option<f64>) -> PyResult<bool> {
        let limit = limit.or(self.ends.time).unwrap_or(f64::INFINITY);
        if limit.is_nan() {
            return Err(PyValueError::new_err("the limit is not a number"));
        }
        self.run.stepper_mut().show_end();
        self.run.bring();
        self.work(py, |run| {
            if run.at_rest() || run.time() >= limit {
                return Ok(Came::There);
            }
            let dt = run.step(limit)?;
            run.bring();
            Ok(came(dt))
        })?;
        Ok(self.run.at_rest())
    }

    /// To the next multiple of `every`, whose state is then shown; false where the run has rested or reached an end of its case.
    fn next_frame(&mut self, py: Python<'_>, every: f64) -> PyResult<bool> {
        if every.is_nan() || every <= 0.0 {
            return Err(PyValueError::new_err(format!(
                "the interval of frames is {every}: give a number > 0"
            )));
        }
        if std::mem::take(&mut self.ended) {
            return Ok(false);
        }
        let (ends, shown) = (self.ends, self.run.time());
        let last = ends.time.unwrap_or(f64::INFINITY);
        let clock = FrameClock::begin(&mut *self.run, every);
        let over = |run: &dyn Run| run.at_rest() || reached(run, &ends).is_some();
        self.work(py, |run| {
            if clock.is_due(run) || over(run) { Ok(Came::There) } else { run.step(last).map(came) }
        })?;
        let (end, over) = (self.run.time(), over(&*self.run));
        clock.show(&mut *self.run);
        self.ended = over && self.run.time() == end;
        Ok(self.run.time() != shown)
    }

    /// A field by its name: an array that cannot be written, and whether it is the engine's own memory.
    fn field<'py>(slf: Bound<'py, Self>, name: &str) -> PyResult<(Bound<'py, PyAny>, bool)> {
        let own = slf.borrow();
        let Some(view) = own.run.field(name) else {
            let known: Vec<_> = own.run.plane().series().into_iter().map(|field| field.name).collect();
            return Err(PyKeyError::new_err(format!("{name:?}; there are {}", known.join(", "))));
        };
        let ([rows, columns], flat) = (view.shape, own.run.stepper().dimensions() == 1);
        if view.is_borrowed() {
            return Ok((lent(&slf, &view.values[view.start..], view.shape, view.row, flat)?, true));
        }
        let shape = if flat { vec![columns] } else { vec![rows, columns] };
        let array = PyArray1::from_vec(slf.py(), view.values.into_owned()).reshape(shape)?;
        array.readwrite().make_nonwriteable();
        Ok((array.into_any(), false))
    }

    /// Component number `k` of the state, as the engine keeps it: its own memory.
    fn component<'py>(slf: Bound<'py, Self>, k: usize) -> PyResult<Bound<'py, PyAny>> {
        let own = slf.borrow();
        let stepper = own.run.stepper();
        if k >= stepper.components() {
            return Err(PyIndexError::new_err(format!("the state has {} components", stepper.components())));
        }
        let view = stepper.component(k);
        let ([columns, rows], [_, row]) = (view.shape, view.strides);
        lent(&slf, &view.data[view.offset..], [rows, columns], row, stepper.dimensions() == 1)
    }

    /// How many components the state has.
    #[getter]
    fn components(&self) -> usize {
        self.run.stepper().components()
    }

    /// The maps of peaks and times so far by name, x fastest.
    fn peaks<'py>(&self, py: Python<'py>) -> PyResult<Vec<(&'static str, Bound<'py, PyAny>)>> {
        let [rows, columns] = [self.run.plane().y.len(), self.run.plane().x.len()];
        let shape = if rows == 0 { vec![columns] } else { vec![rows, columns] };
        let shaped = |(name, map)| {
            let array = PyArray1::from_vec(py, map).reshape(shape.clone())?;
            Ok((name, array.into_any()))
        };
        self.run.peaks().into_iter().map(shaped).collect()
    }

    /// The state to go on from, copied.
    fn checkpoint(&mut self) -> Checkpoint {
        self.run.stepper_mut().show_end();
        Checkpoint { state: self.run.save().into_owned(), origin: self.origin.clone() }
    }

    /// The state to go on from, into a file.
    fn checkpoint_to(&mut self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let Simulation { run, origin, .. } = self;
        py.detach(|| save(&mut **run, origin, &path)).map_err(|error| of_output(&error))
    }

    /// Names of the fields.
    #[getter]
    fn fields(&self) -> Vec<String> {
        self.run.plane().series().into_iter().map(|field| field.name).collect()
    }
    /// Centres of the cells along x.
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.run.plane().x)
    }
    /// Centres of the cells along y.
    #[getter]
    fn y<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.run.plane().y)
    }
    /// Time reached, or shown.
    #[getter]
    fn time(&self) -> f64 {
        self.run.time()
    }
    /// Steps done.
    #[getter]
    fn steps(&self) -> u64 {
        self.run.steps()
    }
    /// Nothing will ever move.
    #[getter]
    fn at_rest(&self) -> bool {
        self.run.at_rest()
    }
    /// Largest speed along the bed.
    #[getter]
    fn speed(&self) -> f64 {
        self.run.stepper().speed()
    }
    /// Volume on the grid.
    #[getter]
    fn volume(&mut self) -> f64 {
        self.run.take_totals().volume
    }
    /// Volume that has left, by outlet.
    #[getter]
    fn outflow(&self) -> Vec<(&'static str, f64)> {
        self.run.plane().outlets().into_iter().zip(self.run.stepper().outflow()).collect()
    }
    /// Volume that has come since the start.
    #[getter]
    fn inflow(&self) -> f64 {
        self.run.stepper().poured()
    }
    /// Name of the scheme.
    #[getter]
    fn scheme(&self) -> &str {
        self.run.scheme()
    }
}
