//! What is shown a run.

use super::Run;

/// Why a sink could not go on; the error of its own kind is inside.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct SinkError(pub Box<dyn std::error::Error + Send + Sync>);

impl SinkError {
    /// Around an error of the sink's own.
    pub fn of(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        SinkError(Box::new(error))
    }
}

/// Something that is shown a run by [`drive`](super::drive): after every step, and at instants of its own.
pub trait Sink {
    /// The next instant at which it wants to see the run, after the present time; infinite where there is none.
    fn next_instant(&self) -> f64 {
        f64::INFINITY
    }
    /// It asks for the end of the run.
    fn wants_end(&self) -> bool {
        false
    }
    /// The run stands as it did at [`Sink::next_instant`], which must be a later one from then on.
    ///
    /// # Errors
    /// [`SinkError`], which ends the run.
    fn at_instant(&mut self, _run: &mut dyn Run) -> Result<(), SinkError> {
        Ok(())
    }
    /// A step has been taken.
    ///
    /// # Errors
    /// [`SinkError`], which ends the run.
    fn after_step(&mut self, run: &mut dyn Run) -> Result<(), SinkError>;
}
