//! The cells of a run, one by one and all.

use super::state::Simulation;
use crate::boundary;
use granflow_model::scheme::{Cell, Diagnostics, Scheme, Spacing, Stencil};
use rayon::prelude::*;

/// The cells around one, outside a sweep.
struct Around<'a, const D: usize, S: Scheme<D, f64>> {
    simulation: &'a Simulation<D, S>,
    place: usize,
}

impl<const D: usize, S: Scheme<D, f64>> Stencil<D, f64, S::State, S::Ground> for Around<'_, D, S> {
    fn at(&self, offset: [isize; D]) -> Cell<S::State, S::Ground> {
        let place = self.simulation.layout.moved(self.place, offset);
        Cell { state: self.simulation.now.get(place), ground: self.simulation.grounds.get(place) }
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
    /// Ground and state of a cell.
    pub fn cell(&self, index: [usize; D]) -> Cell<S::State, S::Ground> {
        Cell { state: self.state(index), ground: self.ground(index) }
    }
    /// What the scheme watches in a cell.
    pub fn diagnostics(&self, index: [usize; D]) -> Diagnostics<f64> {
        self.scheme.diagnostics(&self.cell(index))
    }
    /// Pull as a share of the static bound, [`Scheme::yield_ratio`], in every cell, x fastest.
    pub fn yield_ratios(&mut self) -> Vec<f64> {
        boundary::fill(&mut self.now, &self.grid, &self.layout, |axis, s| self.scheme.mirror(axis, &s));
        let margin = |number: usize| {
            let index = self.grid.index(number);
            let outside = self.scheme.is_nodata(&self.ground(index));
            let around = Around { simulation: self, place: self.place(index) };
            if outside { 0.0 } else { self.scheme.yield_ratio(&around) }
        };
        (0..self.grid.count()).into_par_iter().map(margin).collect()
    }
    /// What is made of every cell, x fastest.
    pub fn collect<T>(&self, value: impl Fn(&Cell<S::State, S::Ground>) -> T) -> Vec<T> {
        (0..self.grid.count()).map(|number| value(&self.cell(self.grid.index(number)))).collect()
    }
    /// A value of as many cells as `values` holds, from number `from` on, x fastest, where every row is `columns` long: the
    /// grid's own, or one less in each where the last column is left out.
    pub fn fill(
        &self,
        columns: usize,
        from: usize,
        values: &mut [f64],
        value: impl Fn(&Cell<S::State, S::Ground>) -> f64,
    ) {
        let (mut number, mut rest) = (from, values);
        while !rest.is_empty() {
            let (i, j) = (number % columns, number / columns);
            let (row, after) = rest.split_at_mut((columns - i).min(rest.len()));
            let place = self.layout.place(i as isize, j as isize);
            let (states, grounds) = (self.now.row(place, row.len()), self.grounds.row(place, row.len()));
            number += row.len();
            for (i, here) in row.iter_mut().enumerate() {
                *here = value(&Cell { state: states.get(i), ground: grounds.get(i) });
            }
            rest = after;
        }
    }

    /// A value of every cell, x fastest.
    pub fn map(&self, value: impl Fn(&Cell<S::State, S::Ground>) -> f64 + Sync) -> Vec<f64> {
        const AT_ONCE: usize = 1 << 14;
        let mut values = vec![0.0; self.grid.count()];
        let parts = values.par_chunks_mut(AT_ONCE).enumerate();
        parts.for_each(|(k, part)| self.fill(self.layout.columns, k * AT_ONCE, part, &value));
        values
    }
}
