//! What acts on an avalanche between two steps: mass that comes or is picked up, a forest that breaks.

use crate::run::{Maps, Numbers};
use granflow_engine::simulation::Simulation;
use granflow_model::scheme::Scheme;
use std::borrow::Cow;

/// Something that acts between two steps.
pub(super) trait BetweenSteps<const D: usize, S: Scheme<D, f64>>: Send + Sync {
    /// Act up to the time of the simulation, `dt` after it last did; again at the same time, with 0, nothing.
    fn act(&mut self, simulation: &mut Simulation<D, S>, dt: f64);
    /// The time up to which nothing else comes, or by which it must be asked again.
    fn next(&self, _simulation: &Simulation<D, S>) -> f64 {
        f64::INFINITY
    }
    /// Nothing begins or goes on by itself after `time`.
    fn is_settled(&self, _time: f64) -> bool {
        true
    }
    /// It holds all that moved; were the run to go on, the step would start it again.
    fn is_held(&self) -> bool {
        false
    }
    /// The time at which something last came by itself.
    fn came(&self) -> f64 {
        0.0
    }
    /// What a checkpoint must keep: always as many numbers.
    fn save(&self) -> Cow<'_, [f64]>;
    /// Take up so many numbers again; the state follows. False where they do not fit.
    fn restore(&mut self, simulation: &mut Simulation<D, S>, saved: &[f64]) -> bool;
    /// For the summary.
    fn numbers(&self, _simulation: &Simulation<D, S>) -> Numbers {
        Numbers::default()
    }
    /// For the results.
    fn maps(&self) -> Maps {
        Maps::default()
    }
}
