//! Sums over the cells of a run.

use super::state::Simulation;
use super::totals::Totals;
use crate::tiles::Tile;
use granflow_model::real::CompensatedSum;
use granflow_model::scheme::{Cell, Scheme};
use rayon::prelude::*;

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Sums over all cells, compensated and in fixed order; cells that changed since [`Simulation::take_sums`] are looked at.
    pub fn totals(&self) -> Totals {
        let sum = |(number, sums): (usize, &Totals)| {
            if self.outdated[number] { self.totals_of(&self.tiles[number]) } else { *sums }
        };
        let parts: Vec<Totals> = self.sums.par_iter().enumerate().map(sum).collect();
        let (mut volume, mut film) = (CompensatedSum::default(), CompensatedSum::default());
        let mut totals = Totals { speed: self.speed(), ..Totals::default() };
        for part in parts {
            volume.add(part.volume);
            film.add(part.film);
            totals.energy += part.energy;
            totals.wet += part.wet;
            totals.moving += part.moving;
        }
        let measure = self.grid.measure();
        totals.energy *= measure;
        Totals { volume: volume.value() * measure, film: film.value() * measure, ..totals }
    }

    /// Take the sums over the cells that have changed, so that [`Simulation::totals`] need not.
    pub fn take_sums(&mut self) {
        let mut sums = std::mem::take(&mut self.sums);
        sums.par_iter_mut().zip(&self.tiles).zip(&self.outdated).for_each(|((sums, tile), &outdated)| {
            if outdated {
                *sums = self.totals_of(tile);
            }
        });
        self.sums = sums;
        self.outdated.fill(false);
    }

    /// Sums over a tile, per cell measure.
    fn totals_of(&self, tile: &Tile) -> Totals {
        let mut totals = Totals::default();
        self.visit(tile, |cell| {
            let watch = self.scheme.diagnostics(cell);
            totals.volume += watch.volume;
            totals.film += watch.volume * watch.film;
            totals.energy += watch.energy;
            totals.wet += usize::from(watch.volume > 0.0);
            totals.moving += usize::from(watch.speed_squared > 0.0);
        });
        totals
    }

    /// See the cells of a tile that lie inside the data.
    pub(super) fn visit(&self, tile: &Tile, mut see: impl FnMut(&Cell<S::State, S::Ground>)) {
        let Tile { columns, rows, .. } = *tile;
        let width = columns[1] - columns[0];
        for j in rows[0]..rows[1] {
            let start = self.layout.place(columns[0] as isize, j as isize);
            let (states, grounds) = (self.now.row(start, width), self.grounds.row(start, width));
            for i in 0..width {
                let cell = Cell { state: states.get(i), ground: grounds.get(i) };
                if !self.scheme.is_nodata(&cell.ground) {
                    see(&cell);
                }
            }
        }
    }
}
