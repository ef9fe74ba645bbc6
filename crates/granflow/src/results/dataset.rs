//! The contents of `result.nc`, from the table of a model's quantities: the series may be on disk or in memory.

use crate::model::{At, Plane, Quantity};
use crate::output::Precision;
use crate::output::netcdf::{Axis, Dataset, Values, Variable};

/// What `result.nc` says of a run in words.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct About {
    /// Title of the run.
    pub title: String,
    /// What made the file; see [`history`](crate::output::netcdf::history).
    pub history: String,
    /// The case as it was computed; running it again gives the same numbers.
    pub case: String,
    /// The text of the case as it was written.
    pub case_text: String,
    /// The scheme's name.
    pub scheme: String,
    /// Why the run ended.
    pub stop_reason: String,
    /// Thickness that a layer must exceed to count in peaks and times (units of the thickness); none where
    /// there are no such maps.
    pub threshold: Option<f64>,
}

/// Everything that `result.nc` holds of a run: the series by name, one value per instant of `times`, then what is
/// fixed, then the maps.
///
/// # Errors
/// The name of a series or a map that is no quantity of the model.
pub fn dataset<'a>(
    plane: &'a Plane,
    precision: Precision,
    times: Vec<f64>,
    series: Vec<(&str, Values<'a>)>,
    maps: &'a [(&'static str, Vec<f64>)],
    about: About,
) -> Result<Dataset<'a>, String> {
    let known = |name: &str| {
        let model = plane.model();
        model.quantity(name).ok_or_else(|| format!("the model {} has no quantity {name}", model.name))
    };
    let mut variables = Vec::new();
    for (name, values) in series {
        variables.push(variable(plane, known(name)?, true, precision, values));
    }
    let maps = maps.iter().map(|(name, map)| (*name, map.as_slice().into()));
    for (name, map) in plane.domain.fixed().into_iter().chain(maps) {
        if !map.is_empty() {
            let quantity = known(name)?;
            let precision = if quantity.exact { Precision::F64 } else { precision };
            variables.push(variable(plane, quantity, false, precision, Values::Static(map)));
        }
    }
    let About { title, history, case, case_text, scheme, stop_reason, threshold } = about;
    let mut attributes = vec![
        ("model", plane.model().name.to_owned()),
        ("scheme", scheme),
        ("stop_reason", stop_reason),
        ("case_text", case_text),
    ];
    let unit = plane.domain.units().label(" m");
    attributes.extend(threshold.map(|threshold| ("threshold", format!("{threshold}{unit}"))));
    attributes.extend(plane.domain.attributes());
    Ok(Dataset {
        title,
        history,
        case,
        attributes: attributes.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        axes: axes(plane, times),
        variables,
        crs: plane.domain.crs(),
        terrain: plane.domain.elevation(),
    })
}

/// Time, centres of the cells, nodes.
fn axes(plane: &Plane, times: Vec<f64>) -> Vec<Axis> {
    let (units, projected) = (plane.domain.units(), plane.domain.projected());
    let mut axes = vec![Axis::time(times, units.time())];
    let [x_node, y_node] = plane.domain.nodes().unwrap_or_default();
    for (axis, name, places) in [
        ("Y", "y", plane.y.as_slice()),
        ("X", "x", &plane.x),
        ("Y", "y_node", y_node),
        ("X", "x_node", x_node),
    ] {
        if !places.is_empty() {
            axes.push(Axis::along(axis, name, places.to_vec(), units.length(), projected));
        }
    }
    axes
}

fn variable<'a>(
    plane: &Plane,
    quantity: &Quantity,
    series: bool,
    precision: Precision,
    values: Values<'a>,
) -> Variable<'a> {
    let at = match quantity.at {
        At::Cells => ["y", "x"],
        At::Nodes => ["y_node", "x_node"],
        At::FacesX => ["y", "x_node"],
        At::FacesY => ["y_node", "x"],
    };
    let space = &at[2 - plane.dimensions()..];
    Variable {
        name: quantity.name.to_owned(),
        long_name: quantity.long_name.to_owned(),
        units: quantity.units_in(plane.domain.units()).to_owned(),
        axes: series.then_some("time").into_iter().chain(space.iter().copied()).map(str::to_owned).collect(),
        precision,
        values,
    }
}
