//! The uniform grid, and where its cells are in memory.

use granflow_model::scheme::Boundary;

/// A uniform grid of cells \[origin + i size, origin + (i + 1) size\] along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<const D: usize> {
    /// Number of cells per axis (x, y).
    pub cells: [usize; D],
    /// Lower corner of the first cell, in the units of the case.
    pub origin: [f64; D],
    /// Cell size per axis.
    pub size: [f64; D],
    /// What happens at the lower and upper end of each axis.
    pub boundary: [[Boundary; 2]; D],
}

impl<const D: usize> Grid<D> {
    /// Centre of cell `index` per axis.
    pub fn centre(&self, index: [usize; D]) -> [f64; D] {
        std::array::from_fn(|k| self.origin[k] + (index[k] as f64 + 0.5) * self.size[k])
    }
    /// Number of cells.
    pub fn count(&self) -> usize {
        self.cells.iter().product()
    }
    /// Length or area of a cell.
    pub fn measure(&self) -> f64 {
        self.size.iter().product()
    }
    /// Cell number `place`, x fastest, as an index per axis.
    pub fn index(&self, place: usize) -> [usize; D] {
        let mut rest = place;
        std::array::from_fn(|k| {
            let i = rest % self.cells[k];
            rest /= self.cells[k];
            i
        })
    }
}

/// Ghost cells at each end of each axis: a face needs the edges of two cells, an edge the cells within its reach.
pub const GHOSTS: usize = 1 + granflow_model::scheme::REACH;

/// Numbers behind the last row, so that a vector can be read from every place.
pub(crate) const PADDING: usize = 2 * crate::lanes::MAX_LANES;

/// Rows of the padded arrays: x fastest, ghosts included; one row in one dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Cells along x.
    pub columns: usize,
    /// Rows of cells.
    pub rows: usize,
    /// Distance in memory between the rows.
    pub stride: usize,
    /// Ghost rows below the first.
    pub margin: usize,
}

impl Layout {
    /// The layout of a grid.
    pub fn of<const D: usize>(grid: &Grid<D>) -> Layout {
        let rows = if D > 1 { grid.cells[D - 1] } else { 1 };
        Layout {
            columns: grid.cells[0],
            rows,
            stride: grid.cells[0] + 2 * GHOSTS,
            margin: if D > 1 { GHOSTS } else { 0 },
        }
    }
    /// Is it that of a grid of so many dimensions?
    pub(crate) fn fits(&self, dimensions: usize) -> bool {
        if dimensions > 1 { self.margin == GHOSTS } else { self.margin == 0 && self.rows == 1 }
    }
    /// Numbers in one padded array.
    pub fn len(&self) -> usize {
        self.stride * (self.rows + 2 * self.margin) + PADDING
    }
    /// A layout always holds a cell.
    pub fn is_empty(&self) -> bool {
        false
    }
    /// Place of the cell in column `i`, row `j`; ghosts have indices -1, -2, ... and columns, columns + 1, ...
    #[inline(always)]
    pub fn place(&self, i: isize, j: isize) -> usize {
        ((j + self.margin as isize) as usize) * self.stride + (i + GHOSTS as isize) as usize
    }
    /// Show `row` the `values` of cells from number `from` on, x fastest, in pieces of a row, each with the place of its first
    /// cell; every row is `columns` long: the grid's own, or one less where the last column is left out.
    pub fn by_rows(
        &self,
        columns: usize,
        from: usize,
        values: &mut [f64],
        mut row: impl FnMut(usize, &mut [f64]),
    ) {
        let (mut number, mut rest) = (from, values);
        while !rest.is_empty() {
            let (i, j) = (number % columns, number / columns);
            let (piece, after) = rest.split_at_mut((columns - i).min(rest.len()));
            number += piece.len();
            row(self.place(i as isize, j as isize), piece);
            rest = after;
        }
    }
    /// Place of the cell `offset` cells away along each axis.
    #[inline(always)]
    pub fn moved<const D: usize>(&self, place: usize, offset: [isize; D]) -> usize {
        let mut place = place as isize;
        for axis in 0..D {
            place += offset[axis] * self.step(axis) as isize;
        }
        place as usize
    }
    /// A padded array without its ghosts, x fastest.
    pub fn unpadded<T: Copy + Into<f64>>(&self, array: &[T]) -> Vec<f64> {
        let start = |j: usize| self.place(0, j as isize);
        let mut values = Vec::with_capacity(self.columns * self.rows);
        for j in 0..self.rows {
            values.extend(array[start(j)..start(j) + self.columns].iter().map(|&value| value.into()));
        }
        values
    }
    /// Distance in memory of neighbours along `axis`.
    #[inline(always)]
    pub fn step(&self, axis: usize) -> usize {
        if axis == 0 { 1 } else { self.stride }
    }
}

impl Grid<1> {
    /// An interval cut into equal cells, open at both ends.
    pub fn line([from, to]: [f64; 2], cells: usize) -> Grid<1> {
        let size = [(to - from) / cells as f64];
        Grid { cells: [cells], origin: [from], size, boundary: [[Boundary::Open; 2]] }
    }
}

impl Grid<2> {
    /// A rectangle \[from, to\] along x and y cut into equal cells, open on all sides.
    pub fn rectangle(x: [f64; 2], y: [f64; 2], cells: [usize; 2]) -> Grid<2> {
        let size = [(x[1] - x[0]) / cells[0] as f64, (y[1] - y[0]) / cells[1] as f64];
        Grid { cells, origin: [x[0], y[0]], size, boundary: [[Boundary::Open; 2]; 2] }
    }
}
