//! When frames and ledger lines are due.

use crate::model::{Plane, Units};
use crate::run::{Run, after};
use granflow_case::Frames;

/// Ledger lines between two frames.
const LINES: f64 = 10.0;

/// The instants of a run's frames, and of the lines of its ledger between them.
#[derive(Clone, Copy, Debug)]
pub struct Schedule {
    frames: Frames,
    /// Time between two frames where a case names none: nobody knows when a run that ends by itself will end.
    default: f64,
    next_frame: f64,
    next_line: f64,
}

/// What is due after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// Nothing.
    Nothing,
    /// A line of the ledger.
    Line,
    /// A frame by the count of steps, and a line.
    Frame,
}

impl Schedule {
    /// Nothing is due before [`Schedule::plan`].
    #[must_use]
    pub fn new(frames: Frames, plane: &Plane) -> Schedule {
        let default = match plane.domain.units() {
            Units::Si => 10.0,
            Units::Scaled => 1.0,
        };
        Schedule { frames, default, next_frame: f64::INFINITY, next_line: f64::INFINITY }
    }
    /// The times of the next frame and line.
    #[must_use]
    pub fn next(&self) -> [f64; 2] {
        [self.next_frame, self.next_line]
    }
    /// Time between two frames; infinite where steps are counted.
    #[must_use]
    pub fn every(&self) -> f64 {
        self.interval().unwrap_or(f64::INFINITY)
    }
    /// Go on with these.
    pub fn resume(&mut self, [frame, line]: [f64; 2]) {
        (self.next_frame, self.next_line) = (frame, line);
    }
    /// Find the frame and the line after the present time, and after the frame that is shown now: that may be due a rounding later.
    pub fn plan(&mut self, run: &dyn Run) {
        let due = if self.next_frame.is_finite() { self.next_frame } else { f64::NEG_INFINITY };
        let time = run.time().max(due);
        if let Some(interval) = self.interval() {
            self.next_frame = after(time, interval);
            self.next_line = after(time, interval / LINES);
        }
    }
    /// What is due after a step; a line that is due moves on to the next. Frames at instants are not: see [`Schedule::next`].
    pub fn due(&mut self, run: &dyn Run) -> Due {
        let time = run.time();
        if matches!(self.frames, Frames::Steps(every) if run.steps().is_multiple_of(every)) {
            return Due::Frame;
        }
        if time < self.next_line {
            return Due::Nothing;
        }
        let interval = self.interval().unwrap_or(f64::INFINITY) / LINES;
        while self.next_line <= time {
            self.next_line += interval;
        }
        Due::Line
    }
    fn interval(&self) -> Option<f64> {
        match self.frames {
            Frames::Every(interval) => Some(interval),
            Frames::Steps(_) => None,
            Frames::Ends => Some(self.default),
        }
    }
}
