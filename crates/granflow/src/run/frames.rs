//! A run at regular instants.

use super::{Failure, Run};

/// The run at multiples of an interval, the present state first: `while let Some(run) = frames.next()? { .. }`. It ends when
/// the run is at rest.
pub struct Frames<'r> {
    run: &'r mut (dyn Run + 'r),
    every: f64,
    begun: bool,
}

impl<'r> Frames<'r> {
    pub(super) fn new(run: &'r mut (dyn Run + 'r), every: f64) -> Self {
        Frames { run, every, begun: false }
    }

    /// Step to the next instant and show the run there; `None` once it was shown at rest.
    ///
    /// # Errors
    /// [`Failure`] of the first step that cannot be taken.
    #[expect(clippy::should_implement_trait, reason = "an iterator cannot lend what it holds")]
    pub fn next(&mut self) -> Result<Option<&mut (dyn Run + 'r)>, Failure> {
        if std::mem::replace(&mut self.begun, true) {
            if self.run.at_rest() {
                return Ok(None);
            }
            let next = after(self.run.time(), self.every);
            while self.run.time() < next && !self.run.at_rest() && self.run.step(next)?.is_finite() {}
        }
        Ok(Some(&mut *self.run))
    }
}

/// The multiple of `interval` after `time`, so that rounding does not add up.
pub(crate) fn after(time: f64, interval: f64) -> f64 {
    let next = ((time / interval).floor() + 1.0) * interval;
    if next - time > 1e-9 * interval { next } else { next + interval }
}
