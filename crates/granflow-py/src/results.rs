//! What a run left, as arrays and plain values of Python. A series of the run becomes an array without a copy.

use crate::error::of_output;
use granflow::output::Precision;
use granflow::output::netcdf::{Dataset, Values, Variable};
use granflow::output::summary::Summary;
use granflow::results::{Finished, Numbers};
use granflow::sinks::Kept;
use numpy::{Element, PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// A variable but for its numbers.
struct Head {
    name: String,
    axes: Vec<String>,
    attributes: Vec<(&'static str, String)>,
    shape: Vec<usize>,
    precision: Precision,
    /// The name of its series, or the numbers that do not change.
    series: Result<String, Vec<f64>>,
    /// It has no value where there is no terrain.
    masked: bool,
}

/// What a run left: as [`of_dataset`], and `summary` as JSON.
pub fn results(py: Python<'_>, mut kept: Kept) -> PyResult<Bound<'_, PyDict>> {
    let (results, heads, holes) = {
        let dataset =
            kept.dataset("granflow.run").map_err(|error| PyValueError::new_err(error.to_string()))?;
        described_all(py, &dataset)?
    };
    filled(py, &results, heads, &holes, |series| taken(&mut kept, series))?;
    summed_up(&results, &kept.summary)?;
    Ok(results)
}

/// What a run left in a folder: as [`results`].
pub fn of_files<'py>(py: Python<'py>, finished: &Finished) -> PyResult<Bound<'py, PyDict>> {
    let dataset = finished.dataset().map_err(|error| of_output(&error))?;
    let (results, heads, holes) = described_all(py, &dataset)?;
    let missing = |series: &str| PyRuntimeError::new_err(format!("the run kept no series {series}"));
    let stored = |series: &str| {
        let numbers = finished.series(series).map_err(|error| of_output(&error))?;
        numbers.ok_or_else(|| missing(series))
    };
    filled(py, &results, heads, &holes, stored)?;
    summed_up(&results, &finished.summary)?;
    Ok(results)
}

/// Puts `summary` among the results, as JSON.
fn summed_up(results: &Bound<'_, PyDict>, summary: &Summary) -> PyResult<()> {
    let text = serde_json::to_string_pretty(summary);
    results.set_item("summary", text.map_err(|error| PyRuntimeError::new_err(error.to_string()))?)
}

/// `coords` and `variables` as lists of (name, dimensions, array, attributes), `attrs`, the attributes of `crs` where there is one.
pub fn of_dataset<'py>(py: Python<'py>, dataset: &Dataset) -> PyResult<Bound<'py, PyDict>> {
    let (results, heads, holes) = described_all(py, dataset)?;
    let none = |series: &str| Err(PyRuntimeError::new_err(format!("there is no series {series}")));
    filled(py, &results, heads, &holes, none)?;
    Ok(results)
}

/// All but the variables; these without their numbers; the cells without terrain.
fn described_all<'py>(
    py: Python<'py>,
    dataset: &Dataset,
) -> PyResult<(Bound<'py, PyDict>, Vec<Head>, Vec<usize>)> {
    let (results, coords, attributes) = (PyDict::new(py), PyList::empty(py), PyDict::new(py));
    for axis in &dataset.axes {
        let values = PyArray1::from_slice(py, &axis.values);
        coords.append((&axis.name, [&axis.name], values, described(py, &axis.described())?))?;
    }
    for (name, value) in dataset.described() {
        attributes.set_item(name, value)?;
    }
    let holes = dataset
        .terrain
        .map_or(Vec::new(), |terrain| (0..terrain.len()).filter(|cell| terrain[*cell].is_nan()).collect());
    if let Some(crs) = &dataset.crs {
        let own = described(py, &crs.described())?;
        crs.number().map_or(Ok(()), |code| own.set_item("epsg", code))?;
        results.set_item("crs", own)?;
    }
    let mut heads = Vec::new();
    for variable in &dataset.variables {
        let size = |name: &String| dataset.axes.iter().find(|axis| axis.name == *name);
        let shape: Vec<usize> = variable.axes.iter().filter_map(size).map(|axis| axis.values.len()).collect();
        let length = shape.iter().skip(usize::from(variable.axes[0] == "time")).product();
        let masked = dataset.mask(variable, length).is_some();
        heads.push(head(variable, dataset.described_variable(variable), shape, masked));
    }
    results.set_item("coords", coords)?;
    results.set_item("attrs", attributes)?;
    Ok((results, heads, holes))
}

/// Puts the variables among the results, those of a series by what `of_series` gives.
fn filled(
    py: Python<'_>,
    results: &Bound<'_, PyDict>,
    heads: Vec<Head>,
    holes: &[usize],
    mut of_series: impl FnMut(&str) -> PyResult<Numbers>,
) -> PyResult<()> {
    let variables = PyList::empty(py);
    for head in heads {
        let numbers = match &head.series {
            Ok(series) => of_series(series)?,
            Err(values) => rounded(values, head.precision),
        };
        let holes: &[usize] = if head.masked { holes } else { &[] };
        let array = match numbers {
            Numbers::F32(values) => shaped(py, values, holes, f32::NAN, &head.shape)?,
            Numbers::F64(values) => shaped(py, values, holes, f64::NAN, &head.shape)?,
        };
        variables.append((&head.name, &head.axes, array, described(py, &head.attributes)?))?;
    }
    results.set_item("variables", variables)
}

fn head(variable: &Variable, attributes: Vec<(&'static str, &str)>, shape: Vec<usize>, masked: bool) -> Head {
    let series = match &variable.values {
        Values::Stored(name) => Ok(name.clone()),
        Values::Static(values) => Err(values.to_vec()),
        Values::Series(instants) => Err(instants.concat()),
    };
    Head {
        name: variable.name.clone(),
        axes: variable.axes.clone(),
        attributes: attributes.into_iter().map(|(name, value)| (name, value.to_owned())).collect(),
        shape,
        precision: variable.precision,
        series,
        masked,
    }
}

fn described<'py, V: AsRef<str>>(
    py: Python<'py>,
    attributes: &[(&'static str, V)],
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    attributes.iter().try_for_each(|(name, value)| all.set_item(name, value.as_ref()))?;
    Ok(all)
}

/// The numbers of a series, which the run then has no more.
fn taken(kept: &mut Kept, series: &str) -> PyResult<Numbers> {
    let found = kept.series.iter().position(|(name, _)| name == series);
    let missing = || PyRuntimeError::new_err(format!("the run kept no series {series}"));
    found.map(|number| kept.series.swap_remove(number).1).ok_or_else(missing)
}

fn rounded(values: &[f64], precision: Precision) -> Numbers {
    match precision {
        #[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is what was asked for")]
        Precision::F32 => Numbers::F32(values.iter().map(|value| *value as f32).collect()),
        Precision::F64 => Numbers::F64(values.to_vec()),
    }
}

/// The numbers as an array of a shape, with `nothing` in the cells `holes` of every instant.
fn shaped<'py, T: Element + Copy>(
    py: Python<'py>,
    mut values: Vec<T>,
    holes: &[usize],
    nothing: T,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let instants = if shape.len() > 2 { shape[0] } else { 1 };
    let length = values.len() / instants.max(1);
    for instant in 0..instants {
        holes.iter().for_each(|cell| values[instant * length + cell] = nothing);
    }
    let array = PyArray1::from_vec(py, values);
    debug_assert_eq!(array.len(), shape.iter().product::<usize>());
    Ok(array.reshape(shape.to_vec())?.into_any())
}
