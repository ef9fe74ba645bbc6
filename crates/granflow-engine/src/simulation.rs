//! A run in memory, and how it goes from step to step.

mod activity;
mod advance;
mod cells;
mod error;
mod forcing;
mod ground;
mod instant;
mod last_step;
mod ledger;
mod maps;
mod passage;
mod rates;
mod restart;
mod state;
mod step_size;
mod sums;
mod totals;
mod traffic;

pub use crate::lanes::SimdLevel;
pub use crate::tiles::OUTLETS;
pub use error::{BuildError, Failure};
pub use passage::Face;
pub use restart::CLOCK;
pub use state::Simulation;
pub use step_size::StepSize;
pub use totals::Totals;
pub use traffic::Traffic;
