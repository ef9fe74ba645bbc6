//! Rasters that a test writes.

use std::fmt::Write;
use std::fs;
use std::path::Path;

/// An ASCII grid with its lower left corner at `corner`; the value of each cell by column and row, from the south west.
pub fn write_grid(
    path: &Path,
    [columns, rows]: [usize; 2],
    [west, south]: [f64; 2],
    cell: f64,
    value: impl Fn(usize, usize) -> f64,
) {
    let mut text = format!(
        "ncols {columns}\nnrows {rows}\nxllcorner {west}\nyllcorner {south}\ncellsize {cell}\nNODATA_value -9999\n"
    );
    for j in (0..rows).rev() {
        for i in 0..columns {
            write!(text, "{:?} ", value(i, j)).unwrap();
        }
        text.push('\n');
    }
    fs::write(path, text).unwrap();
}
