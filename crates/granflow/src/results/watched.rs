//! Gauges and sections in `result.nc`: variables on the times at which they were looked at.

use crate::model::Units;
use crate::output::Precision;
use crate::output::lines::Table;
use crate::output::netcdf::{Axis, Dataset, Values, Variable};

/// The times of gauges and sections.
const TIME: &str = "series_time";

/// Gauges, or sections.
pub(super) struct Kind {
    /// What its dimension and its variables begin with.
    name: &'static str,
    /// Name, words and SI unit of each column of its table.
    columns: &'static [(&'static str, &'static str, &'static str)],
}

pub(super) const GAUGE: Kind = Kind {
    name: "gauge",
    columns: &[
        ("thickness", "thickness normal to the bed at the gauge", "m"),
        ("velocity_x", "velocity along x at the gauge", "m s-1"),
        ("velocity_y", "velocity along y at the gauge", "m s-1"),
        ("speed", "speed along the bed at the gauge", "m s-1"),
        ("pressure", "dynamic pressure at the gauge, density times speed squared", "kPa"),
    ],
};

pub(super) const SECTION: Kind = Kind {
    name: "section",
    columns: &[
        ("discharge", "volume per time through the section, from its left to its right", "m3 s-1"),
        ("volume", "volume that has passed the section since the start, from its left to its right", "m3"),
        ("thickness", "largest thickness normal to the bed along the section", "m"),
        ("pressure", "largest dynamic pressure along the section", "kPa"),
    ],
};

/// Adds a table to a dataset: dimensions, the names as an attribute, a variable for each column that has values.
pub(super) fn add(dataset: &mut Dataset, kind: &Kind, table: Table, units: Units) {
    let Table { columns, names, times, values } = table;
    if times.is_empty() {
        return;
    }
    if dataset.axes.iter().all(|axis| axis.name != TIME) {
        let axis = Axis::time(times, units.time());
        dataset.axes.push(Axis { name: TIME.to_owned(), standard_name: None, ..axis });
    }
    dataset.axes.push(Axis {
        name: kind.name.to_owned(),
        values: (0..names.len()).map(|number| number as f64).collect(),
        units: "1".to_owned(),
        long_name: format!("number of the {0}, in the order of the attribute {0}_names", kind.name),
        standard_name: None,
        axis: "",
    });
    dataset.attributes.push((format!("{}_names", kind.name), names.join(", ")));
    for (column, values) in columns.iter().zip(values) {
        let known = kind.columns.iter().find(|(name, ..)| name == column);
        let Some((name, words, unit)) = known.filter(|_| !values.iter().all(|value| value.is_nan())) else {
            continue;
        };
        dataset.variables.push(Variable {
            name: format!("{}_{name}", kind.name),
            long_name: (*words).to_owned(),
            units: if units == Units::Si { unit } else { "1" }.to_owned(),
            axes: vec![TIME.to_owned(), kind.name.to_owned()],
            precision: Precision::F64,
            values: Values::Static(values.into()),
        });
    }
}
