//! A function that hears of every step, and a flag that ends a run.

use super::{Sink, SinkError};
use crate::run::Run;
use std::sync::atomic::{AtomicBool, Ordering};

/// Calls a function after every step.
pub struct Callback<F>(pub F);

impl<F: FnMut(&dyn Run)> Sink for Callback<F> {
    fn after_step(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        (self.0)(run);
        Ok(())
    }
}

/// Ends the run before its next step once the flag is set.
pub struct Stop<'a>(pub &'a AtomicBool);

impl Sink for Stop<'_> {
    fn wants_end(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
    fn after_step(&mut self, _run: &mut dyn Run) -> Result<(), SinkError> {
        Ok(())
    }
}
