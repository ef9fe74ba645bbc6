//! A grid of equal cells in the plane; a line of cells is one row of height 1.

use crate::raster::{Raster, intervals};

/// Where the cells lie; cell number `row * count[0] + column`, row 0 in the south.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CellGrid {
    /// The outer corner in the south-west.
    pub low: [f64; 2],
    /// Edge lengths of a cell.
    pub size: [f64; 2],
    /// Columns and rows.
    pub count: [usize; 2],
}

impl From<&Raster> for CellGrid {
    fn from(raster: &Raster) -> CellGrid {
        CellGrid {
            low: [raster.west, raster.south],
            size: [raster.cell; 2],
            count: [raster.columns, raster.rows],
        }
    }
}

impl CellGrid {
    /// The grid of these centres; none along y in one dimension.
    pub fn of(x: &[f64], y: &[f64]) -> Result<CellGrid, String> {
        let along = |centres: &[f64]| -> Option<[f64; 2]> {
            let size = (centres.last()? - centres.first()?) / (centres.len() - 1) as f64;
            (size > 0.0).then_some([centres[0] - 0.5 * size, size])
        };
        let x_axis = along(x).ok_or("it has fewer than two cells along x")?;
        let y_axis = match y {
            [] => [0.0, 1.0],
            y => along(y).ok_or("it has fewer than two cells along y")?,
        };
        Ok(CellGrid {
            low: [x_axis[0], y_axis[0]],
            size: [x_axis[1], y_axis[1]],
            count: [x.len(), y.len().max(1)],
        })
    }

    pub fn cells(&self) -> usize {
        self.count[0] * self.count[1]
    }

    pub fn cell_area(&self) -> f64 {
        self.size[0] * self.size[1]
    }

    pub fn centre(&self, cell: usize) -> [f64; 2] {
        let at = [cell % self.count[0], cell / self.count[0]];
        [0, 1].map(|axis| self.low[axis] + (at[axis] as f64 + 0.5) * self.size[axis])
    }

    /// The corners of a cell.
    pub fn corners(&self, cell: usize) -> [[f64; 2]; 4] {
        let at = [cell % self.count[0], cell / self.count[0]];
        [[0, 0], [1, 0], [1, 1], [0, 1]]
            .map(|step| [0, 1].map(|axis| self.low[axis] + (at[axis] + step[axis]) as f64 * self.size[axis]))
    }

    /// The ends [low, high] along x and y.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let low = self.low[axis];
            [low, low + self.count[axis] as f64 * self.size[axis]]
        })
    }

    /// The cell that a place lies in.
    pub fn at(&self, place: [f64; 2]) -> Option<usize> {
        let mut found = [0; 2];
        for axis in 0..2 {
            let cells = (place[axis] - self.low[axis]) / self.size[axis];
            if !(cells >= 0.0 && cells < self.count[axis] as f64) {
                return None;
            }
            found[axis] = cells as usize;
        }
        Some(found[1] * self.count[0] + found[0])
    }

    /// For each interval of this grid along an axis those of another that overlap it, with the common lengths.
    pub fn shares(&self, other: &CellGrid, axis: usize) -> Vec<Vec<(usize, f64)>> {
        let old = (other.low[axis], other.size[axis], other.count[axis]);
        intervals(old, (self.low[axis], self.size[axis], self.count[axis]))
    }
}
