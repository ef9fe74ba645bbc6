//! How fast a run changes, and the step that follows from it.

use super::state::{Simulation, TileRowMax};
use super::step_size::StepSize;
use crate::parallel;
use crate::sweep::tracked;
use crate::tiles::TileStats;
use granflow_model::scheme::Scheme;

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// max over cells of |change of each component of the state|/dt in the last step. Infinite before the first, after a step that
    /// was cut to less than half (a change divided by a sliver is rounding), and where the scheme does not keep watch of it.
    pub fn drift(&self) -> &[f64] {
        &self.drift
    }

    /// Every cell rests by the scheme's own proof and the last step changed nothing: nothing ever will.
    pub fn at_rest(&self) -> bool {
        self.step > 0 && self.active.is_empty()
    }
    /// Largest speed along the bed.
    pub fn speed(&self) -> f64 {
        self.row_max.iter().fold(0.0, |max, row| row.speed.max(max))
    }
    /// Rates and speeds of the state as it stands (needed once, before the first step or after a restart).
    pub(super) fn rescan(&mut self) {
        self.stats = parallel::map(self.tiles.len(), |number| self.scanned_tile(number));
        // Nothing is known of the change before the next step.
        self.changes.fill(f64::INFINITY);
        self.outdated.fill(true);
        self.row_max.fill(TileRowMax { stale: true, ..TileRowMax::default() });
        self.find_rate();
    }

    /// The rate and the speed of a tile as it stands.
    pub(super) fn scanned_tile(&self, number: usize) -> TileStats {
        let (mut stats, mut square) = (TileStats::default(), 0.0);
        self.visit(&self.tiles[number], |cell| {
            let rate = self.scheme.rate(cell, &self.spacing);
            stats.rate = if stats.rate < rate { rate } else { stats.rate };
            square = self.scheme.diagnostics(cell).speed_squared.max(square);
        });
        stats.speed = square.sqrt();
        stats
    }

    /// max over cells of [`Scheme::rate`]: the Courant number of a step dt is dt times this.
    pub fn rate(&self) -> f64 {
        self.rate
    }
    /// The step that the Courant condition or the case asks for; infinite where nothing could move.
    pub fn wanted_step(&self) -> f64 {
        match self.step_size {
            StepSize::Fixed(dt) => dt,
            StepSize::Courant(courant) => {
                // At courant = 1 a fast thin cell empties to the last bit: rounding must not take more than it holds.
                const LESS: f64 = 1.0 - 1e-14;
                LESS * courant / self.rate
            }
        }
    }

    /// Does the step follow from the state?
    pub fn is_adaptive(&self) -> bool {
        matches!(self.step_size, StepSize::Courant(_))
    }

    /// Find the largest rate, speed and changes; rows of tiles that all slept are as they were.
    pub(super) fn find_rate(&mut self) {
        let (across, tracked) = (self.across, tracked::<D, S>());
        for (number, row) in self.row_max.iter_mut().enumerate().filter(|(_, row)| row.stale) {
            let tiles = number * across..(number + 1) * across;
            *row = TileRowMax::default();
            for stats in &self.stats[tiles.clone()] {
                row.rate = if row.rate < stats.rate { stats.rate } else { row.rate };
                row.speed = row.speed.max(stats.speed);
            }
            let largest = &mut self.row_changes[number * tracked..(number + 1) * tracked];
            largest.fill(0.0);
            raise(largest, &self.changes[tiles.start * tracked..tiles.end * tracked]);
        }
        self.rate = self.row_max.iter().fold(0.0, |max, row| if max < row.rate { row.rate } else { max });
        if tracked > 0 {
            let whole = self.last.dt > 0.0 && self.last.dt > 0.5 * self.wanted_step();
            self.drift.fill(0.0);
            raise(&mut self.drift, &self.row_changes);
            for change in &mut self.drift {
                *change = if whole { *change / self.last.dt } else { f64::INFINITY };
            }
        }
    }
}

/// Raise each number to the largest one of the same component in `values`.
fn raise(largest: &mut [f64], values: &[f64]) {
    for values in values.chunks_exact(largest.len().max(1)) {
        for (largest, value) in largest.iter_mut().zip(values) {
            *largest = largest.max(*value);
        }
    }
}
