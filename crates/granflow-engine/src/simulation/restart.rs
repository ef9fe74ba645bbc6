//! To save a run and to take it up again.

use super::last_step::LastStep;
use super::state::Simulation;
use crate::field::Field;
use crate::tiles::OUTLETS;
use granflow_model::real::CompensatedSum;
use granflow_model::scheme::Scheme;

/// How many numbers [`Simulation::clock`] has.
pub const CLOCK: usize = 3 + 2 * OUTLETS.len() + 3;

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// The numbers that a restart needs: time, step, updates, and the ledger.
    pub fn clock(&self) -> Vec<f64> {
        let (out, poured) = self.ledger();
        let mut numbers = vec![self.time(), self.step as f64, self.updates as f64];
        numbers.extend(out.iter().flat_map(|sum| sum.parts()));
        numbers.extend(poured.parts());
        numbers.push(self.last.dt);
        numbers
    }
    /// The state arrays, padded, for a checkpoint.
    pub fn arrays(&self) -> &Field {
        &self.now
    }
    /// Take up a run from [`Simulation::clock`] and [`Simulation::arrays`]; false where the sizes do not fit.
    pub fn restore(&mut self, clock: &[f64], arrays: Field) -> bool {
        let fits = clock.len() == CLOCK && arrays.holds::<S::State>(&self.layout);
        if fits {
            self.time = clock[0];
            self.step = clock[1] as u64;
            self.updates = clock[2] as u64;
            for (k, sum) in self.out.iter_mut().enumerate() {
                *sum = CompensatedSum::from_parts([clock[3 + 2 * k], clock[4 + 2 * k]]);
            }
            let end = 3 + 2 * OUTLETS.len();
            self.poured = CompensatedSum::from_parts([clock[end], clock[end + 1]]);
            self.last = LastStep { dt: clock[end + 2], ..LastStep::none(self.time) };
            self.now = arrays;
            self.next = self.now.clone();
            self.wake_all();
            self.rescan();
        }
        fits
    }

    /// Give back the memory that only steps need, for there will be none, or none before [`Simulation::restore`].
    pub fn release_buffers(&mut self) {
        self.next = Field::default();
        self.last.before = Field::default();
    }
}
