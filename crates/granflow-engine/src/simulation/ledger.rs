//! What has entered and left.

use super::state::Simulation;
use crate::tiles::OUTLETS;
use granflow_model::scheme::Scheme;

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Volume that has left by the left, right, bottom and top end and into nodata since the start.
    pub fn out(&self) -> [f64; OUTLETS.len()] {
        self.ledger().0.map(|sum| sum.value() * self.grid.measure())
    }

    /// Volume that has been poured in since the start.
    pub fn poured(&self) -> f64 {
        self.ledger().1.value()
    }
    /// Volume per time that is poured in now.
    pub fn supply(&self) -> f64 {
        self.supply
    }
}
