//! A run at regular instants.

use super::{Failure, Run};

/// The run at multiples of an interval, the present state first: `while let Some(run) = frames.next()? { .. }`. It ends when
/// the run is at rest; one that may never be needs a limit of its own. No step is cut at an instant: the run is shown as it
/// was there ([`Stepper::show`](super::Stepper::show)) until it is stepped again, from the end of the step.
pub struct Frames<'r> {
    run: &'r mut (dyn Run + 'r),
    every: f64,
    begun: bool,
    /// The last instant was the end of the run.
    ended: bool,
}

impl<'r> Frames<'r> {
    pub(super) fn new(run: &'r mut (dyn Run + 'r), every: f64) -> Self {
        assert!(every > 0.0, "the interval of the frames is {every}: give a number > 0");
        Frames { run, every, begun: false, ended: false }
    }

    /// Step to the next instant and show the run there; `None` once it was shown at rest.
    ///
    /// # Errors
    /// [`Failure`] of the first step that cannot be taken.
    #[expect(clippy::should_implement_trait, reason = "an iterator cannot lend what it holds")]
    pub fn next(&mut self) -> Result<Option<&mut (dyn Run + 'r)>, Failure> {
        if std::mem::replace(&mut self.begun, true) {
            if self.ended {
                return Ok(None);
            }
            let next = after(self.run.time(), self.every);
            self.run.stepper_mut().expect(next);
            self.run.stepper_mut().show_end();
            while self.run.time() < next && !self.run.at_rest() && self.run.step(f64::INFINITY)?.is_finite() {
            }
            if next <= self.run.time() {
                self.run.stepper_mut().show(next);
            }
        }
        self.ended = self.run.at_rest();
        Ok(Some(&mut *self.run))
    }
}

/// The multiple of `interval` after `time`, so that rounding does not add up.
pub(crate) fn after(time: f64, interval: f64) -> f64 {
    let next = ((time / interval).floor() + 1.0) * interval;
    if next - time > 1e-9 * interval { next } else { next + interval }
}
