//! What a page is told: errors with their place and cure, and what a raster file holds.

use granflow::StartError;
use granflow::case::CaseError;
use granflow::raster::Raster;
use serde_json::{Value, json};
use std::path::Path;

/// An error that is one sentence.
pub fn plain(message: impl ToString) -> Value {
    json!({ "message": message.to_string(), "help": [] })
}

/// An error of a case: what, where, and the cure.
pub fn of_case(error: &CaseError) -> Value {
    let (line, column) = error.line_column().unzip();
    json!({
        "message": error.message(), "key": error.key(), "line": line, "column": column, "help": error.help_lines(),
    })
}

/// An error of setting a run up.
pub fn of_start(error: &StartError) -> Value {
    match error {
        StartError::Case(error) => of_case(error),
        other => plain(other),
    }
}

/// What a raster file holds: where it lies, and its values.
pub fn raster(name: &str) -> Result<(Value, Vec<f64>), Value> {
    let Raster { columns, rows, west, south, cell, values, crs } =
        Raster::read(Path::new(name)).map_err(plain)?;
    let about = json!({
        "columns": columns, "rows": rows, "west": west, "south": south, "cell": cell,
        "crs": crs.map(|crs| crs.describe()),
    });
    Ok((about, values))
}
