//! A case: its text, what is laid over it, and what it names in memory.

use crate::error::{of_case, of_start};
use granflow::raster::{Crs, Raster};
use granflow::{Checked, Inputs};
use numpy::ndarray::ArrayView2;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;

/// A case as it is written.
#[pyclass(module = "granflow._native", frozen)]
#[derive(Clone)]
pub struct Case {
    place: Place,
    overrides: Vec<String>,
    /// What makes it one member of its ensemble.
    member: Option<Vec<String>>,
    inputs: Inputs,
}

/// Where its text is.
#[derive(Clone)]
enum Place {
    File(PathBuf),
    Text { text: String, name: String },
}

impl Case {
    fn of(place: Place) -> Case {
        Case { place, overrides: Vec::new(), member: None, inputs: Inputs::default() }
    }

    fn read(&self, py: Python<'_>) -> PyResult<granflow::Case> {
        let case = match &self.place {
            Place::File(path) => granflow::Case::read_with(path, &self.overrides),
            Place::Text { text, name } => granflow::Case::parse_with(text, name, &self.overrides),
        };
        let case = match &self.member {
            Some(changes) => case.and_then(|case| case.member(changes)),
            None => case,
        };
        case.map_err(|error| of_case(py, &error))
    }

    /// The case, not checked, and what it may name in memory.
    pub fn parts(&self, py: Python<'_>) -> PyResult<(granflow::Case, Inputs)> {
        Ok((self.read(py)?, self.inputs.clone()))
    }

    /// What it may name in memory.
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// The case, checked.
    pub fn checked(&self, py: Python<'_>) -> PyResult<Checked> {
        self.read(py)?.check_with(&self.inputs).map_err(|error| of_case(py, &error))
    }
}

#[pymethods]
impl Case {
    /// From a file.
    #[staticmethod]
    fn from_file(path: PathBuf) -> Case {
        Self::of(Place::File(path))
    }

    /// From a text that messages call `name`.
    #[staticmethod]
    fn from_text(text: String, name: String) -> Case {
        Self::of(Place::Text { text, name })
    }

    /// The same with `key.path=value` laid over it, the value as TOML.
    fn with_override(&self, assignment: String) -> Case {
        let mut case = self.clone();
        // What makes a member is laid over the case; what is set later, over both.
        case.member.as_mut().unwrap_or(&mut case.overrides).push(assignment);
        case
    }

    /// One member of its ensemble, by the overrides that make it.
    fn of_member(&self, changes: Vec<String>) -> Case {
        Case { member: Some(changes), ..self.clone() }
    }

    /// The same with a file in memory.
    fn with_file(&self, name: &str, bytes: Vec<u8>) -> Case {
        Case { inputs: self.inputs.clone().with_file(name, bytes), ..self.clone() }
    }

    /// The same with a raster in memory, its first row in the south.
    #[pyo3(signature = (name, values, west, south, cell, crs))]
    fn with_raster(
        &self,
        name: &str,
        values: PyReadonlyArray2<'_, f64>,
        west: f64,
        south: f64,
        cell: f64,
        crs: Option<&str>,
    ) -> PyResult<Case> {
        let crs = match crs {
            Some(text) => {
                let wrong = |error: granflow::raster::CrsError| PyValueError::new_err(error.to_string());
                Some(Crs::parse(text).map_err(wrong)?)
            }
            None => None,
        };
        let &[rows, columns] = values.shape() else { unreachable!("two dimensions") };
        let values = values.as_array().iter().copied().collect();
        let raster = Raster { columns, rows, west, south, cell, values, crs };
        Ok(Case { inputs: self.inputs.clone().with_raster(name, raster), ..self.clone() })
    }

    /// The values of a raster in memory, without a copy: shape (rows, columns), row 0 in the south, not to be written.
    fn raster<'py>(slf: Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let Some(Raster { columns, rows, values, .. }) = slf.get().inputs.raster(name) else {
            return Err(PyKeyError::new_err(name.to_owned()));
        };
        let cells = ArrayView2::from_shape((*rows, *columns), values)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        // SAFETY: the array keeps the case alive, which keeps the raster and never changes it.
        let array = unsafe { PyArray2::borrow_from_array(&cells, slf.clone().into_any()) };
        array.readwrite().make_nonwriteable();
        Ok(array)
    }

    /// Says what is wrong with it, if anything is.
    fn check(&self, py: Python<'_>) -> PyResult<()> {
        self.checked(py).map(drop)
    }

    /// What would be computed, as lines of a name and a value.
    fn describe(&self, py: Python<'_>) -> PyResult<Vec<(&'static str, String)>> {
        let checked = self.checked(py)?;
        py.detach(|| checked.describe()).map_err(|error| of_start(py, &error))
    }

    /// The case as one TOML document.
    fn resolved(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.read(py)?.resolved())
    }

    /// The case with its defaults, as TOML.
    fn to_toml(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.read(py)?.to_toml())
    }
}
