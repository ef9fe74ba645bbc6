//! Sums over the cells of a run.

use super::state::Simulation;
use super::totals::Totals;
use crate::parallel;
use crate::tiles::Tile;
use granflow_model::real::CompensatedSum;
use granflow_model::scheme::{Cell, Scheme};

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Sums over all cells, compensated and in fixed order; cells that changed since [`Simulation::take_sums`] are looked at.
    pub fn totals(&self) -> Totals {
        let sum = |number: usize| {
            if self.outdated[number] { self.totals_of(&self.tiles[number]) } else { self.sums[number] }
        };
        let parts = parallel::map(self.tiles.len(), sum);
        let [mut volume, mut film, mut moving_volume] = [CompensatedSum::default(); 3];
        let mut totals = Totals::default();
        for part in parts {
            volume.add(part.volume);
            film.add(part.film);
            moving_volume.add(part.moving_volume);
            totals.energy += part.energy;
            totals.wet += part.wet;
            totals.moving += part.moving;
            totals.speed = totals.speed.max(part.speed);
        }
        let measure = self.grid.measure();
        totals.energy *= measure;
        let [volume, film, moving_volume] = [volume, film, moving_volume].map(|sum| sum.value() * measure);
        Totals { volume, film, moving_volume, ..totals }
    }

    /// Take the sums over the cells that have changed, so that [`Simulation::totals`] need not.
    pub fn take_sums(&mut self) {
        let mut sums = std::mem::take(&mut self.sums);
        /// Tiles that a thread takes at once.
        const AT_ONCE: usize = 16;
        parallel::for_each_chunk_mut(&mut sums, AT_ONCE, |from, sums| {
            for (number, sums) in (from..).zip(sums) {
                if self.outdated[number] {
                    *sums = self.totals_of(&self.tiles[number]);
                }
            }
        });
        self.sums = sums;
        self.outdated.fill(false);
    }

    /// Is there such a cell inside the data?
    pub fn any(&self, is: impl Fn(&Cell<S::State, S::Ground, S::Forcing>) -> bool + Sync) -> bool {
        parallel::any(self.tiles.len(), |number| {
            let mut found = false;
            self.visit(&self.tiles[number], |cell| found = found || is(cell));
            found
        })
    }

    /// Sums over a tile, per cell measure.
    fn totals_of(&self, tile: &Tile) -> Totals {
        let (mut totals, mut square) = (Totals::default(), 0.0);
        self.visit(tile, |cell| {
            let watch = self.scheme.diagnostics(cell);
            totals.volume += watch.volume;
            totals.film += watch.volume * watch.film;
            totals.energy += watch.energy;
            totals.wet += usize::from(watch.volume > 0.0);
            if watch.speed_squared > 0.0 {
                totals.moving += 1;
                totals.moving_volume += watch.volume;
            }
            square = watch.speed_squared.max(square);
        });
        totals.speed = square.sqrt();
        totals
    }

    /// See the cells of a tile that are inside the data.
    pub(super) fn visit(&self, tile: &Tile, mut see: impl FnMut(&Cell<S::State, S::Ground, S::Forcing>)) {
        let Tile { columns, rows, .. } = *tile;
        let width = columns[1] - columns[0];
        for j in rows[0]..rows[1] {
            let start = self.layout.place(columns[0] as isize, j as isize);
            for cell in self.row(start, width) {
                if !self.scheme.is_nodata(&cell.ground) {
                    see(&cell);
                }
            }
        }
    }
}
