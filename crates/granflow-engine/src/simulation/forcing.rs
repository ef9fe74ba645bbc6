//! What acts on the cells from outside, and which tiles its changes wake.

use super::change::bits;
use super::state::Simulation;
use crate::boundary;
use crate::disjoint::DisjointSlice;
use crate::parallel;
use crate::tiles::{Activity, Tile};
use granflow_model::real::{CompensatedSum, per_axis};
use granflow_model::scheme::{Boundary, Components, Scheme};

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Give every cell the forcing that `change` makes of its index and its present one, from now on.
    ///
    /// Only tiles in which a bit of it changes wake (with those that a step reaches from them), and only what follows from
    /// their forcing is found again. Where no bit changes nothing happens.
    pub fn apply(&mut self, change: impl Fn([usize; D], S::Forcing) -> S::Forcing + Sync) {
        if S::Forcing::COUNT == 0 {
            return;
        }
        self.replace_forcings(change);
        self.forcings_changed();
    }

    /// The same for some cells.
    ///
    /// # Panics
    /// If a cell is outside the grid.
    pub fn apply_to(
        &mut self,
        cells: impl IntoIterator<Item = [usize; D]>,
        change: impl Fn(S::Forcing) -> S::Forcing,
    ) {
        self.forced.fill(false);
        for index in cells {
            let place = self.place(index);
            let old: S::Forcing = self.forcings.get(place);
            let new = change(old);
            if bits(new) != bits(old) {
                self.forcings.set(place, new);
                let number = self.tile_of(index);
                self.forced[number] = true;
            }
        }
        self.forcings_changed();
    }

    /// Find again what follows from the forcing of the tiles in which it changed.
    fn forcings_changed(&mut self) {
        if !self.forced.contains(&true) {
            return;
        }
        let (grid, layout, scheme) = (&self.grid, &self.layout, &self.scheme);
        boundary::fill(&mut self.forcings, grid, layout, |axis, f| scheme.mirror_forcing(axis, &f));
        for number in 0..self.tiles.len() {
            if self.forced[number] {
                self.stats[number].activity = Activity::EVERYWHERE;
                self.outdated[number] = true;
                self.poured_on[number] = self.has_source(&self.tiles[number]);
                self.active.push(number as u32);
            }
        }
        let forced = std::mem::take(&mut self.forced);
        self.find_uniform(&forced);
        self.forced = forced;
        self.supply = self.supplied();
    }

    /// The forcing of a cell.
    pub fn forcing(&self, index: [usize; D]) -> S::Forcing {
        self.forcings.get(self.place(index))
    }

    /// Replace the forcings, and note in which tiles a bit of them changes.
    fn replace_forcings(&mut self, change: impl Fn([usize; D], S::Forcing) -> S::Forcing + Sync) {
        let (tiles, layout) = (&self.tiles, &self.layout);
        let forcings = self.forcings.writer::<S::Forcing>();
        let forced = DisjointSlice::new(&mut self.forced);
        parallel::for_each(tiles.len(), |number| {
            let mut changes = false;
            for j in tiles[number].rows[0]..tiles[number].rows[1] {
                for i in tiles[number].columns[0]..tiles[number].columns[1] {
                    let place = layout.place(i as isize, j as isize);
                    // SAFETY: a cell belongs to one tile, and a tile to one thread.
                    unsafe {
                        let old = forcings.get(place);
                        let new = change(per_axis!(k => if k == 0 { i } else { j }), old);
                        changes |= forcings.replace(place, new);
                    }
                }
            }
            // SAFETY: as above.
            unsafe { forced.slice(number..number + 1)[0] = changes };
        });
    }

    /// Find out again which tiles see one ground and one forcing only: those that see a tile in which one `changed`.
    pub(super) fn find_uniform(&mut self, changed: &[bool]) {
        let (across, up) = (self.across, self.tiles.len() / self.across);
        // There a tile also sees the other end of the grid.
        let periodic = self.grid.boundary.iter().any(|ends| ends.contains(&Boundary::Periodic));
        for number in 0..self.tiles.len() {
            let (x, y) = (number % across, number / across);
            let near = |k: usize, count: usize| k.saturating_sub(1)..(k + 2).min(count);
            let sees = near(y, up).any(|v| near(x, across).any(|u| changed[v * across + u]));
            if sees || periodic {
                let Tile { columns, rows, .. } = self.tiles[number];
                self.tiles[number].uniform = self.is_uniform([columns, rows]);
            }
        }
    }

    /// Is anything poured on a cell of a tile?
    fn has_source(&self, tile: &Tile) -> bool {
        let width = tile.columns[1] - tile.columns[0];
        (tile.rows[0]..tile.rows[1]).any(|j| {
            let row = self.forcings.row(self.layout.place(tile.columns[0] as isize, j as isize), width);
            (0..width).any(|i| self.scheme.source_rate(&row.get(i)) != 0.0)
        })
    }

    /// Volume per time that is poured in: the sum over the cells, x fastest; those of tiles without a source add nothing.
    fn supplied(&self) -> f64 {
        let mut sum = CompensatedSum::default();
        for (tiles, poured_on) in self.tiles.chunks(self.across).zip(self.poured_on.chunks(self.across)) {
            for j in tiles[0].rows[0]..tiles[0].rows[1] {
                for (tile, _) in tiles.iter().zip(poured_on).filter(|(_, poured_on)| **poured_on) {
                    let width = tile.columns[1] - tile.columns[0];
                    let place = self.layout.place(tile.columns[0] as isize, j as isize);
                    let row = self.forcings.row(place, width);
                    for i in 0..width {
                        sum.add(self.scheme.source_rate(&row.get(i)));
                    }
                }
            }
        }
        sum.value() * self.grid.measure()
    }
}
