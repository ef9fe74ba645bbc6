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

/// Something that is shown a run after every step of [`drive`](super::drive).
pub trait Sink {
    /// The next instant at which it must see the run; infinite where any will do.
    fn next_instant(&self) -> f64 {
        f64::INFINITY
    }
    /// It asks for the end of the run.
    fn wants_end(&self) -> bool {
        false
    }
    /// A step has been taken.
    ///
    /// # Errors
    /// [`SinkError`], which ends the run.
    fn after_step(&mut self, run: &mut dyn Run) -> Result<(), SinkError>;
}
