//! Tiles: the rectangles of cells that are computed or sleep as one.

use crate::grid::{GHOSTS, Layout};
use std::ops::Range;

/// The most cells side by side that are computed in one go, with the neighbour at each end.
pub(crate) const STRIP: usize = 128;

/// The most stages of a step: each reaches [`GHOSTS`] cells further, and a signal must not pass a tile in one step.
pub(crate) const MAX_STAGES: usize = 6 / GHOSTS;

/// Largest extent of a tile along x and y. Half of it is at least 6, the reach of a two-stage step: so small may tiles be that
/// a grid is cut into.
pub(crate) const fn tile_size(dimensions: usize) -> [usize; 2] {
    if dimensions == 1 { [STRIP - 2, 1] } else { [(STRIP - 2) / 6, 12] }
}

/// The most rows of tiles that one thread computes in one go: the rows between them are then read once.
pub(crate) const MAX_TILES: usize = 6;

/// The five outlets of the domain, as the ledger counts them.
pub const OUTLETS: [&str; 5] = ["left", "right", "bottom", "top", "nodata"];

/// A rectangle of cells, half open.
#[derive(Clone, Debug)]
pub(crate) struct Tile {
    /// Columns from, to.
    pub columns: [usize; 2],
    /// Rows from, to.
    pub rows: [usize; 2],
    /// Its faces that lead out of the domain, as numbers in the list of all.
    pub outlets: Range<usize>,
    /// Ground and forcing are the same in all cells that the tile sees.
    pub uniform: bool,
}

/// A rectangle of tiles that are awake: neighbours in the list of these, row by row.
#[derive(Clone, Debug)]
pub(crate) struct TileBlock {
    /// Places in the list.
    pub awake: Range<usize>,
    /// How many tiles are side by side.
    pub across: usize,
}

/// A face that leads out of the domain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OutletFace {
    /// The cell's column and row.
    pub cell: [u32; 2],
    /// The axis of the face.
    pub axis: u8,
    /// 0 at the lower end of the cell, 1 at the upper.
    pub side: u8,
    /// By which of [`OUTLETS`].
    pub outlet: u8,
}

/// What a sweep found in one tile; by default of no cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TileStats {
    /// Largest sum of signal speeds over dx \[1/time\]; infinite where a state is no number.
    pub rate: f64,
    /// Largest speed along the bed.
    pub speed: f64,
    /// Volume per cell measure that left by each of [`OUTLETS`] in the step.
    pub outflow: [f64; OUTLETS.len()],
    /// Where a cell changed, or may yet.
    pub activity: Activity,
}

/// Where in a tile a cell changed, or may yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Activity {
    /// In any of its cells.
    pub anywhere: bool,
    /// In those from which a step reaches beyond its lower and its upper end along x, and along y.
    pub near: [[bool; 2]; 2],
}

impl Activity {
    /// In all cells.
    pub const EVERYWHERE: Activity = Activity { anywhere: true, near: [[true; 2]; 2] };

    /// Here or there.
    pub fn or(self, other: Activity) -> Activity {
        let near = |axis: usize, side: usize| self.near[axis][side] | other.near[axis][side];
        Activity {
            anywhere: self.anywhere | other.anywhere,
            near: [[near(0, 0), near(0, 1)], [near(1, 0), near(1, 1)]],
        }
    }
    /// Does a step reach the tile that is `dx` and `dy` tiles away?
    pub fn reaches(&self, [dx, dy]: [isize; 2]) -> bool {
        let along = |axis: usize, d: isize| d == 0 || self.near[axis][usize::from(d > 0)];
        self.anywhere && along(0, dx) && along(1, dy)
    }
}

/// The grid cut into tiles, row by row; how many are side by side.
pub(crate) fn cut(layout: &Layout) -> (Vec<Tile>, usize) {
    let ends = |count: usize, size: usize| {
        let tiles = count.div_ceil(size);
        (0..tiles).map(move |k| [k * count / tiles, (k + 1) * count / tiles])
    };
    let [width, height] = tile_size(if layout.margin > 0 { 2 } else { 1 });
    let across = ends(layout.columns, width).count();
    let mut tiles = Vec::new();
    for rows in ends(layout.rows, height) {
        for columns in ends(layout.columns, width) {
            tiles.push(Tile { columns, rows, outlets: 0..0, uniform: false });
        }
    }
    (tiles, across)
}
