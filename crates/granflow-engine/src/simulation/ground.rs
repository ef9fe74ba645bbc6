//! What follows from the grounds: outlets, and tiles that see one ground only.

use super::state::Simulation;
use crate::grid::GHOSTS;
use crate::tiles::{OutletFace, Tile};
use granflow_model::scheme::{Boundary, Components, Scheme};

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Note what follows from the grounds: the outlets, and which tiles see one ground only.
    pub(super) fn rebuild_ground_cache(&mut self) {
        self.outlets.clear();
        self.with_outlets.clear();
        for number in 0..self.tiles.len() {
            let from = self.outlets.len();
            let Tile { columns, rows, .. } = self.tiles[number];
            for j in rows[0]..rows[1] {
                for i in columns[0]..columns[1] {
                    self.find_outlets([i, j]);
                }
            }
            let uniform = self.is_uniform([columns, rows]);
            let tile = &mut self.tiles[number];
            (tile.outlets, tile.uniform) = (from..self.outlets.len(), uniform);
            if !tile.outlets.is_empty() {
                self.with_outlets.push(number as u32);
            }
        }
    }

    /// Are ground and forcing the same bit for bit in the cells of a tile and all that they see? Not asked where they are kept in
    /// single precision, for it is of no use there: see `sweep::strip`.
    pub(super) fn is_uniform(&self, [columns, rows]: [[usize; 2]; 2]) -> bool {
        if S::Ground::F32_MASK | S::Forcing::F32_MASK != 0 {
            return false;
        }
        let margin = self.layout.margin as isize;
        let start = |j: isize| self.layout.place(columns[0] as isize - GHOSTS as isize, j);
        let width = columns[1] - columns[0] + 2 * GHOSTS;
        let starts = (rows[0] as isize - margin..rows[1] as isize + margin).map(start);
        self.grounds.is_uniform(starts.clone(), width) && self.forcings.is_uniform(starts, width)
    }

    /// Note the faces of a cell that lead out of the domain.
    fn find_outlets(&mut self, cell: [usize; 2]) {
        let place = self.layout.place(cell[0] as isize, cell[1] as isize);
        let here: S::Ground = self.grounds.get(place);
        if self.scheme.is_nodata(&here) {
            return;
        }
        for axis in 0..D {
            for side in 0..2 {
                let ends = cell[axis] == if side == 0 { 0 } else { self.grid.cells[axis] - 1 };
                if ends && self.grid.boundary[axis][side] == Boundary::Periodic {
                    continue;
                }
                let step = self.layout.step(axis);
                let there = self.grounds.get(if side == 0 { place - step } else { place + step });
                let way = 2 * axis + side;
                if let Some(outlet) = if ends { Some(way) } else { self.scheme.outlet(&here, &there, way) } {
                    let cell = cell.map(|k| k as u32);
                    self.outlets.push(OutletFace {
                        cell,
                        axis: axis as u8,
                        side: side as u8,
                        outlet: outlet as u8,
                    });
                }
            }
        }
    }
}
