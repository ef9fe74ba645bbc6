//! A component of the state as it is kept in memory, without a copy.

use crate::grid::Layout;

/// One component of the state of every cell: cell (i, j) is number `offset + i strides[0] + j strides[1]` of `data`.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The padded array, ghosts included.
    pub data: &'a [f64],
    /// Place of the cell with the smallest coordinates.
    pub offset: usize,
    /// Cells along x and y; 1 along y in one dimension.
    pub shape: [usize; 2],
    /// Distance of neighbours along x and y, in numbers.
    pub strides: [usize; 2],
}

impl<'a> View<'a> {
    pub(crate) fn new(data: &'a [f64], layout: &Layout) -> Self {
        View {
            data,
            offset: layout.place(0, 0),
            shape: [layout.columns, layout.rows],
            strides: [layout.step(0), layout.step(1)],
        }
    }
    /// The number of a cell.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn get(&self, index: [usize; 2]) -> f64 {
        assert!(index[0] < self.shape[0] && index[1] < self.shape[1], "no cell {index:?}");
        self.data[self.offset + index[0] * self.strides[0] + index[1] * self.strides[1]]
    }
    /// The rows of cells, from the one with the smallest y.
    pub fn rows(&self) -> impl Iterator<Item = &'a [f64]> {
        let View { data, offset, shape, strides } = *self;
        (0..shape[1]).map(move |j| &data[offset + j * strides[1]..][..shape[0]])
    }
}
