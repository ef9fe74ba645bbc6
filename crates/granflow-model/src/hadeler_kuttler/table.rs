//! The table: the cells on which sand can lie, and the edges over which it falls or which hold it back.
//!
//! A table is a mask of cells. A face between a cell of the table and a cell beside it is an edge of the table, open or a
//! wall. Nodes lie at the corners of the cells, node `index` at the lower left corner of cell `index`; the grid of the
//! scheme therefore has one column and one row more than the table, which hold nodes only, and places are numbered on
//! that grid, x fastest.

#[cfg(test)]
mod tests;

use super::{Ground, Source};
use crate::scheme::Side;
use alloc::vec;
use alloc::vec::Vec;

/// An edge of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge<const D: usize> {
    /// The axis that crosses it.
    pub axis: usize,
    /// The cell above it along that axis.
    pub index: [usize; D],
    /// Which way it faces: `Left` if the table lies on its upper side.
    pub faces: Side,
    /// A hole of the table lies beyond, not the outside.
    pub hole: bool,
}

impl<const D: usize> Edge<D> {
    /// Its middle, counted in cells from the lower corner of the table.
    pub fn middle(&self) -> [f64; D] {
        core::array::from_fn(|k| self.index[k] as f64 + if k == self.axis { 0.0 } else { 0.5 })
    }
}

/// Cells of a table that hang together through their faces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece<const D: usize> {
    /// Its cells, the first one first, the others in no order.
    pub cells: Vec<[usize; D]>,
    /// Its open edges: with none, sand that is poured on it never leaves, and it has no steady state.
    pub open_edges: usize,
}

/// Where sand lies, falls off and is held back.
#[derive(Clone, Debug, PartialEq)]
pub struct Table<const D: usize> {
    cells: [usize; D],
    steps: [usize; D],
    inside: Vec<bool>,
    hole: Vec<bool>,
    wall: Vec<[bool; D]>,
    weight: Vec<f64>,
    dropped: usize,
}

impl<const D: usize> Table<D> {
    /// All of the cells; `open[axis]` says whether the sides at the lower and upper end of the axis are open.
    pub fn rectangle(cells: [usize; D], open: [[bool; 2]; D]) -> Self {
        let wall = |edge: &Edge<D>| !open[edge.axis][if edge.faces == Side::Left { 0 } else { 1 }];
        Self::masked(cells, |_| true, wall)
    }

    /// The cells of which `inside` is true; `wall` decides at each edge whether it is a wall.
    ///
    /// A hole is a part of the grid beside the table from which no way leads out, not even past a corner. A cell whose
    /// nodes all end open edges never holds sand, and has no slope down which sand would leave it: it is taken off
    /// the table, [`Table::dropped`] says how many were.
    pub fn masked(
        cells: [usize; D],
        inside: impl Fn([usize; D]) -> bool,
        wall: impl Fn(&Edge<D>) -> bool,
    ) -> Self {
        let size = cells.iter().map(|n| n + 1).product();
        let mut table = Table {
            cells,
            steps: core::array::from_fn(|axis| cells[..axis].iter().map(|n| n + 1).product()),
            inside: vec![false; size],
            hole: vec![false; size],
            wall: vec![[false; D]; size],
            weight: vec![0.0; size],
            dropped: 0,
        };
        for place in 0..size {
            let index = table.index(place);
            table.inside[place] = (0..D).all(|k| index[k] < cells[k]) && inside(index);
        }
        loop {
            table.find_holes();
            table.raise_walls(&wall);
            let pinned = |&cell: &usize| table.corners(cell).all(|node| table.weight[node] == 0.0);
            let bare: Vec<usize> = table.places().filter(pinned).collect();
            if bare.is_empty() {
                return table;
            }
            table.dropped += bare.len();
            for cell in bare {
                table.inside[cell] = false;
            }
        }
    }

    /// Beside the table and out of reach from the rim of the grid, by faces and corners.
    fn find_holes(&mut self) {
        for place in 0..self.inside.len() {
            self.hole[place] = !self.inside[place];
        }
        let rim = |index: [usize; D]| (0..D).any(|k| index[k] == 0 || index[k] + 1 >= self.cells[k]);
        let mut reached: Vec<usize> =
            (0..self.hole.len()).filter(|&place| self.hole[place] && rim(self.index(place))).collect();
        for &place in &reached {
            self.hole[place] = false;
        }
        // Cells of the rim are all reached: from elsewhere the eight neighbours are on the grid.
        while let Some(place) = reached.pop() {
            for way in 0..3_usize.pow(D as u32) {
                let (mut near, mut rest) = (place, way);
                for axis in 0..D {
                    near = near.wrapping_add((rest % 3) * self.step(axis)).wrapping_sub(self.step(axis));
                    rest /= 3;
                }
                if self.hole.get(near) == Some(&true) {
                    self.hole[near] = false;
                    reached.push(near);
                }
            }
        }
    }

    /// Walls, and what each node stands for.
    fn raise_walls(&mut self, wall: &impl Fn(&Edge<D>) -> bool) {
        for place in 0..self.wall.len() {
            self.wall[place] = core::array::from_fn(|axis| self.edge(place, axis).is_some_and(|e| wall(&e)));
            self.weight[place] = self.around(place).count() as f64 / (1 << D) as f64;
        }
        for edge in self.open_edges() {
            let first = self.place(edge.index);
            self.weight[first] = 0.0;
            for axis in (0..D).filter(|axis| *axis != edge.axis) {
                let last = first + self.step(axis);
                self.weight[last] = 0.0;
            }
        }
    }

    /// Number of cells along each axis, those beside the table included.
    pub fn cells(&self) -> [usize; D] {
        self.cells
    }
    /// Number of nodes along each axis.
    pub fn nodes(&self) -> [usize; D] {
        self.cells.map(|n| n + 1)
    }
    /// Number of cells of the table.
    pub fn count(&self) -> usize {
        self.places().count()
    }
    /// Length or area of the table, for cells of this size.
    pub fn area(&self, size: [f64; D]) -> f64 {
        self.count() as f64 * size.iter().product::<f64>()
    }
    /// Cells of the mask that were taken off: all their nodes end open edges.
    pub fn dropped(&self) -> usize {
        self.dropped
    }
    /// Does the cell belong to the table?
    pub fn inside(&self, index: [usize; D]) -> bool {
        self.inside[self.place(index)]
    }
    /// Does the cell lie in a hole of the table?
    pub fn hole(&self, index: [usize; D]) -> bool {
        self.hole[self.place(index)]
    }
    /// Share of a cell's measure that a node stands for: (cells of the table around it)/2^D, and 0 where it ends an open
    /// edge, so that u = 0 there, or touches no cell of the table.
    pub fn weight(&self, node: [usize; D]) -> f64 {
        self.weight[self.place(node)]
    }
    /// Is the node a corner of a cell of the table?
    pub fn touches(&self, node: [usize; D]) -> bool {
        self.around(self.place(node)).next().is_some()
    }

    /// The edges over which sand falls.
    pub fn open_edges(&self) -> Vec<Edge<D>> {
        self.edges().filter(|(_, wall)| !wall).map(|(edge, _)| edge).collect()
    }
    /// All edges, each with whether it is a wall.
    pub fn edges(&self) -> impl Iterator<Item = (Edge<D>, bool)> + '_ {
        let along =
            move |place| (0..D).filter_map(move |k| Some((self.edge(place, k)?, self.wall[place][k])));
        (0..self.inside.len()).flat_map(along)
    }
    /// The edge below a place along `axis`, if there is one.
    fn edge(&self, place: usize, axis: usize) -> Option<Edge<D>> {
        let below = self.below(place, axis);
        let (low, high) = (self.is_inside(below), self.inside[place]);
        let (faces, beyond) = if high { (Side::Left, below) } else { (Side::Right, place) };
        let hole = self.hole.get(beyond) == Some(&true);
        (low != high).then(|| Edge { axis, index: self.index(place), faces, hole })
    }

    /// The parts of the table that do not hang together.
    pub fn pieces(&self) -> Vec<Piece<D>> {
        let mut left = self.inside.clone();
        let mut pieces = Vec::new();
        for start in 0..left.len() {
            if !core::mem::take(&mut left[start]) {
                continue;
            }
            let (mut cells, mut open_edges, mut todo) = (Vec::new(), 0, vec![start]);
            while let Some(place) = todo.pop() {
                cells.push(self.index(place));
                for axis in 0..D {
                    let above = place + self.step(axis);
                    for (face, near) in [(place, self.below(place, axis)), (above, above)] {
                        if !self.is_inside(near) {
                            open_edges += usize::from(!self.wall[face][axis]);
                        } else if core::mem::take(&mut left[near]) {
                            todo.push(near);
                        }
                    }
                }
            }
            pieces.push(Piece { cells, open_edges });
        }
        pieces
    }

    /// What the scheme needs to know of a cell and its node, where the table has height `bed`.
    pub fn ground(&self, index: [usize; D], bed: f64) -> Ground<D, f64> {
        self.ground_at(self.place(index), bed)
    }
    /// The source of a cell, split along the axes; beside the table there is none.
    pub fn source(&self, index: [usize; D], split: [f64; D]) -> Source<D, f64> {
        self.source_at(self.place(index), split)
    }
    #[inline(always)]
    pub(super) fn source_at(&self, place: usize, split: [f64; D]) -> Source<D, f64> {
        if self.inside[place] { Source { split } } else { Source::none() }
    }
    #[inline(always)]
    pub(super) fn ground_at(&self, place: usize, bed: f64) -> Ground<D, f64> {
        let number = |yes: bool| if yes { 1.0 } else { 0.0 };
        Ground {
            bed,
            inside: number(self.inside[place]),
            weight: self.weight[place],
            wall: self.wall[place].map(number),
            hole: number(self.hole[place]),
        }
    }

    /// Number of a cell, or of its node, on the grid of the scheme.
    pub fn place(&self, index: [usize; D]) -> usize {
        (0..D).map(|k| index[k] * self.step(k)).sum()
    }
    /// Number of a place's cell where only cells are counted, x fastest.
    pub fn cell(&self, place: usize) -> usize {
        let index = self.index(place);
        (0..D).rev().fold(0, |number, k| number * self.cells[k] + index[k])
    }
    /// The index of a place.
    pub fn index(&self, place: usize) -> [usize; D] {
        core::array::from_fn(|k| place / self.step(k) % (self.cells[k] + 1))
    }
    /// Distance of neighbours along `axis`.
    pub(super) fn step(&self, axis: usize) -> usize {
        self.steps[axis]
    }
    /// How many places there are.
    #[cfg(feature = "std")]
    pub(super) fn size(&self) -> usize {
        self.inside.len()
    }
    /// Is there a cell of the table at this place? No, where there is no such place; and a step below the first column
    /// leads to the last one of the row before, which holds nodes only.
    pub(super) fn is_inside(&self, place: usize) -> bool {
        self.inside.get(place) == Some(&true)
    }
    /// The place below, along `axis`.
    pub(super) fn below(&self, place: usize, axis: usize) -> usize {
        place.wrapping_sub(self.step(axis))
    }
    /// The cells of the table.
    pub fn places(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.inside.len()).filter(|place| self.inside[*place])
    }
    /// From a node to the corner numbered `corner` of a cell that it is the lowest node of: bit k is the end along axis k.
    pub fn span(&self, corner: usize) -> usize {
        (0..D).filter(|k| corner >> k & 1 == 1).map(|k| self.step(k)).sum()
    }
    /// The nodes of a cell.
    pub(super) fn corners(&self, cell: usize) -> impl Iterator<Item = usize> + '_ {
        (0..1 << D).map(move |corner| cell + self.span(corner))
    }
    /// The cells of the table around a node, each with the number of the corner that the node is.
    pub(super) fn around(&self, node: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..1 << D)
            .map(move |corner| (node.wrapping_sub(self.span(corner)), corner))
            .filter(|(cell, _)| self.is_inside(*cell))
    }
    /// Does the node end an open edge?
    pub fn pinned(&self, node: usize) -> bool {
        self.weight[node] == 0.0 && self.around(node).next().is_some()
    }
}
