//! The box of the world that a map shows, and the paper for it.

/// Where a raster lies: row 0 is the southernmost, values belong to whole cells.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Extent {
    /// Cells from west to east, at least two.
    pub nx: usize,
    /// Cells from south to north, at least two.
    pub ny: usize,
    /// The western edge (not centre) of the first column.
    pub west: f64,
    /// The southern edge of the first row.
    pub south: f64,
    /// Side of a cell.
    pub cell: f64,
}

impl Extent {
    pub(super) fn east(&self) -> f64 {
        self.west + self.nx as f64 * self.cell
    }
    pub(super) fn north(&self) -> f64 {
        self.south + self.ny as f64 * self.cell
    }
}

/// The part of the world that a map shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    pub x: [f64; 2],
    pub y: [f64; 2],
}

/// Width and height of what shows this box, in points.
pub(super) fn paper(view: View) -> (f64, f64) {
    let ratio = (view.y[1] - view.y[0]) / (view.x[1] - view.x[0]);
    if ratio < 0.95 { (640.0, 640.0 * ratio) } else { (610.0 / ratio, 610.0) }
}
