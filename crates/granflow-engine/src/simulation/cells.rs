//! The cells of a run, one by one and all.

use super::state::Simulation;
use crate::boundary;
use crate::parallel;
use crate::tiles::Tile;
use granflow_model::real::per_axis;
use granflow_model::scheme::{Cell, Diagnostics, Scheme, Spacing, Stencil};

/// The cells around one, outside a sweep.
struct Around<'a, const D: usize, S: Scheme<D, f64>> {
    simulation: &'a Simulation<D, S>,
    place: usize,
}

impl<const D: usize, S: Scheme<D, f64>> Stencil<D, f64, S::State, S::Ground, S::Forcing>
    for Around<'_, D, S>
{
    fn at(&self, offset: [isize; D]) -> Cell<S::State, S::Ground, S::Forcing> {
        let place = self.simulation.layout.moved(self.place, offset);
        self.simulation.cell_at(place)
    }
    fn spacing(&self) -> &Spacing<D, f64> {
        &self.simulation.spacing
    }
}

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// The state of a cell.
    pub fn state(&self, index: [usize; D]) -> S::State {
        self.now.get(self.place(index))
    }
    /// The ground of a cell.
    pub fn ground(&self, index: [usize; D]) -> S::Ground {
        self.grounds.get(self.place(index))
    }
    /// State, ground and forcing of a cell.
    pub fn cell(&self, index: [usize; D]) -> Cell<S::State, S::Ground, S::Forcing> {
        self.cell_at(self.place(index))
    }
    fn cell_at(&self, place: usize) -> Cell<S::State, S::Ground, S::Forcing> {
        Cell {
            state: self.now.get(place),
            ground: self.grounds.get(place),
            forcing: self.forcings.get(place),
        }
    }
    /// So many cells from `place` on.
    pub(super) fn row(
        &self,
        place: usize,
        len: usize,
    ) -> impl Iterator<Item = Cell<S::State, S::Ground, S::Forcing>> {
        let (states, grounds) = (self.now.row(place, len), self.grounds.row(place, len));
        let forcings = self.forcings.row(place, len);
        (0..len).map(move |i| Cell { state: states.get(i), ground: grounds.get(i), forcing: forcings.get(i) })
    }
    /// What the scheme watches in a cell.
    pub fn diagnostics(&self, index: [usize; D]) -> Diagnostics<f64> {
        self.scheme.diagnostics(&self.cell(index))
    }
    /// Pull as a share of the static bound, [`Scheme::yield_ratio`], in every cell, x fastest.
    pub fn yield_ratios(&mut self) -> Vec<f64> {
        boundary::fill(&mut self.now, &self.grid, &self.layout, |axis, s| self.scheme.mirror(axis, &s));
        let ratio = |number: usize| {
            let index = self.grid.index(number);
            let outside = self.scheme.is_nodata(&self.ground(index));
            let around = Around { simulation: self, place: self.place(index) };
            if outside { 0.0 } else { self.scheme.yield_ratio(&around) }
        };
        parallel::map(self.grid.count(), ratio)
    }
    /// What is made of every cell, x fastest.
    pub fn collect<T>(&self, value: impl Fn(&Cell<S::State, S::Ground, S::Forcing>) -> T) -> Vec<T> {
        (0..self.grid.count()).map(|number| value(&self.cell(self.grid.index(number)))).collect()
    }
    /// What is made of the moving cells for which it is something, tile by tile: of tiles in which nothing moves no cell is looked at.
    pub fn of_moving<T: Send>(
        &self,
        value: impl Fn([usize; D], &Cell<S::State, S::Ground, S::Forcing>) -> Option<T> + Sync,
    ) -> Vec<T> {
        let moving: Vec<usize> = (0..self.tiles.len()).filter(|tile| self.stats[*tile].speed > 0.0).collect();
        let of_tile = |number: usize| {
            let Tile { columns, rows, .. } = self.tiles[moving[number]];
            let mut values = Vec::new();
            for j in rows[0]..rows[1] {
                let place = self.layout.place(columns[0] as isize, j as isize);
                let row = (columns[0]..).zip(self.row(place, columns[1] - columns[0]));
                for (i, cell) in row.filter(|(_, cell)| self.scheme.diagnostics(cell).speed_squared > 0.0) {
                    values.extend(value(per_axis!(k => if k == 0 { i } else { j }), &cell));
                }
            }
            values
        };
        parallel::map(moving.len(), of_tile).into_iter().flatten().collect()
    }
    /// A value of as many cells as `values` holds, from number `from` on, x fastest, where every row is `columns` long
    /// ([`Layout::by_rows`](crate::grid::Layout::by_rows)).
    pub fn fill(
        &self,
        columns: usize,
        from: usize,
        values: &mut [f64],
        value: impl Fn(&Cell<S::State, S::Ground, S::Forcing>) -> f64,
    ) {
        self.layout.by_rows(columns, from, values, |place, row| {
            let cells = self.row(place, row.len());
            for (here, cell) in row.iter_mut().zip(cells) {
                *here = value(&cell);
            }
        });
    }

    /// A value of every cell, x fastest.
    pub fn map(&self, value: impl Fn(&Cell<S::State, S::Ground, S::Forcing>) -> f64 + Sync) -> Vec<f64> {
        const AT_ONCE: usize = 1 << 14;
        let mut values = vec![0.0; self.grid.count()];
        parallel::for_each_chunk_mut(&mut values, AT_ONCE, |from, part| {
            self.fill(self.layout.columns, from, part, &value);
        });
        values
    }
}
