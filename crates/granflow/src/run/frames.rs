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
            let clock = FrameClock::begin(self.run, self.every);
            while !clock.is_due(self.run) && !self.run.at_rest() && self.run.step(f64::INFINITY)?.is_finite()
            {
            }
            clock.show(self.run);
        }
        self.ended = self.run.at_rest();
        Ok(Some(&mut *self.run))
    }
}

/// The way to the next frame, for whoever takes the steps: they end once the frame [is due](FrameClock::is_due) or nothing moves any
/// more; then it is [shown](FrameClock::show).
#[derive(Clone, Copy, Debug)]
pub struct FrameClock {
    next: f64,
}

impl FrameClock {
    /// The next multiple of `every` after the time that `run` shows.
    pub fn begin(run: &mut dyn Run, every: f64) -> FrameClock {
        let next = after(run.time(), every);
        run.stepper_mut().expect(next);
        run.stepper_mut().show_end();
        FrameClock { next }
    }

    /// The last step has reached the frame.
    #[must_use]
    pub fn is_due(&self, run: &dyn Run) -> bool {
        run.time() >= self.next
    }

    /// Show the run as it was at the frame, if the last step has reached it.
    pub fn show(&self, run: &mut dyn Run) {
        if self.is_due(run) {
            run.stepper_mut().show(self.next);
        }
    }
}

/// The multiple of `interval` after `time`, so that rounding does not add up.
pub(crate) fn after(time: f64, interval: f64) -> f64 {
    let next = ((time / interval).floor() + 1.0) * interval;
    if next - time > 1e-9 * interval { next } else { next + interval }
}
