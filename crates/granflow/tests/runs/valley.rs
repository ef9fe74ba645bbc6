//! A valley, and runs on it.

use crate::asc;
use granflow::Case;
use granflow::run::Run;
use std::fs;
use std::path::Path;

pub const CELL: f64 = 5.0;

/// A raster by the places of its cells.
pub fn write_grid(path: &Path, cells: [usize; 2], value: impl Fn(f64, f64) -> f64) {
    asc::write_grid(path, cells, [0.0; 2], CELL, |i, j| {
        value((i as f64 + 0.5) * CELL, (j as f64 + 0.5) * CELL)
    });
}

/// A valley: steep, then level, with banks.
pub fn valley() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_grid(&folder.path().join("dem.asc"), [70, 24], |x, y| {
        500.0 - 0.6 * x.min(180.0) - 0.05 * (x - 180.0).max(0.0) + 0.003 * (y - 60.0).powi(2)
    });
    folder
}

pub const FIRST: &str = "[[release]]\ncap = { height = 3.0, centre = [40.0, 60.0], radius = 25.0 }\n";

pub fn start(folder: &Path, parts: &str, time: &str) -> Box<dyn Run> {
    try_start(folder, parts, time).unwrap()
}

pub fn try_start(folder: &Path, parts: &str, time: &str) -> Result<Box<dyn Run>, String> {
    let path = folder.join("case.toml");
    let text = format!(
        "[terrain]\ndem = \"dem.asc\"\ncrs = \"EPSG:31287\"\n[material]\ndensity = 200.0\n\
         friction.coulomb = {{ mu = 0.3 }}\n{parts}[time]\n{time}\n"
    );
    fs::write(&path, text).unwrap();
    let said = |error: granflow::case::CaseError| format!("{error}");
    let checked = Case::read(&path).map_err(said)?.check().map_err(said)?;
    checked.start().map_err(|error| error.to_string())
}

/// A field, as bits.
pub fn field(run: &dyn Run, name: &str) -> Vec<u64> {
    run.field(name).unwrap().iter().map(f64::to_bits).collect()
}

pub fn thickness(run: &dyn Run) -> Vec<u64> {
    field(run, "thickness")
}

pub fn map(run: &mut dyn Run, name: &str) -> Vec<f64> {
    run.maps().into_iter().find(|(own, _)| *own == name).unwrap().1
}

pub fn number(run: &dyn Run, name: &str) -> Option<f64> {
    run.numbers().into_iter().find(|(key, _)| key == name).map(|(_, value)| value)
}

pub fn steps(run: &mut dyn Run, count: usize) {
    for _ in 0..count {
        run.step(1e9).unwrap();
    }
}
