//! A run at regular instants.

use super::{Failure, Run};

/// The run at multiples of an interval, the present state first: `while let Some(run) = frames.next()? { .. }`. It ends when
/// the run is at rest; one that may never be needs a limit of its own. Adaptive steps end at the instants; fixed steps are
/// never cut: shown is the one that comes nearest.
pub struct Frames<'r> {
    run: &'r mut (dyn Run + 'r),
    every: f64,
    begun: bool,
}

impl<'r> Frames<'r> {
    pub(super) fn new(run: &'r mut (dyn Run + 'r), every: f64) -> Self {
        assert!(every > 0.0, "the interval of the frames is {every}: give a number > 0");
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
            let early = half_step(self.run);
            let next = after(self.run.time() + early, self.every);
            let until = if self.run.stepper().is_adaptive() { next } else { f64::INFINITY };
            while self.run.time() + early < next && !self.run.at_rest() && self.run.step(until)?.is_finite() {
            }
        }
        Ok(Some(&mut *self.run))
    }
}

/// The multiple of `interval` after `time`, so that rounding does not add up.
pub(crate) fn after(time: f64, interval: f64) -> f64 {
    let next = ((time / interval).floor() + 1.0) * interval;
    if next - time > 1e-9 * interval { next } else { next + interval }
}

/// Half a fixed step: what is due within belongs to this one; 0 for adaptive steps, which are cut.
pub(crate) fn half_step(run: &dyn Run) -> f64 {
    let stepper = run.stepper();
    if stepper.is_adaptive() { 0.0 } else { 0.5 * stepper.wanted_step() }
}
