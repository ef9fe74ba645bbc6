//! The state at an instant within the last step. What is written at instants changes nothing of what is computed: no step is
//! cut for it.

use super::state::Simulation;
use crate::field::Field;
use crate::tiles::OUTLETS;
use granflow_model::real::CompensatedSum;
use granflow_model::scheme::Scheme;

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Ask for the step that passes `time`, to be looked into by [`Simulation::show`]: a method of several stages then keeps the
    /// state before it.
    pub fn expect(&mut self, time: f64) {
        self.last.asked = time;
    }

    /// Show the state at `time` within the last step, on the straight line between its begin and its end,
    /// U + (time - begin)/dt (U' - U), with the ledger at that time, until [`Simulation::show_end`], the next step, or another
    /// instant, which must not be earlier. Rates, [`Simulation::at_rest`], peaks and maps stay those of the end of the step.
    ///
    /// # Panics
    /// If `time` is not within the last step, or before an instant that is shown, or was not asked for
    /// ([`Simulation::expect`]).
    pub fn show(&mut self, time: f64) {
        let from = self.last.at;
        self.show_end();
        if time == self.time {
            return;
        }
        assert!(from <= time && time < self.time, "time {time} is not within the last step, or was passed");
        assert!(self.last.kept, "nobody asked for the step that passed time {time}");
        let share = (time - from) / (self.time - from);
        let (end, before) = self.ends();
        before.approach(end, share);
        (self.last.at, self.last.shown) = (time, true);
        self.swap_ends();
    }

    /// Show the end of the last step again.
    pub fn show_end(&mut self) {
        if std::mem::take(&mut self.last.shown) {
            self.swap_ends();
        }
    }

    /// Is an instant within the last step shown?
    pub fn is_shown(&self) -> bool {
        self.last.shown
    }

    /// The state, and the one at the begin of the last step.
    fn ends(&mut self) -> (&mut Field, &mut Field) {
        let before = if self.stages.len() == 1 { &mut self.next } else { &mut self.last.before };
        (&mut self.now, before)
    }

    fn swap_ends(&mut self) {
        let (now, before) = self.ends();
        std::mem::swap(now, before);
        // Cells that sleep are the same at both times.
        for &number in &self.awake {
            self.outdated[number as usize] = true;
        }
    }

    /// Keep the state before a step to `time`, where it will be asked for and the stages write over it.
    pub(super) fn keep_before(&mut self, time: f64) {
        self.last.kept = self.stages.len() == 1 || self.last.asked <= time;
        if self.stages.len() > 1 && self.last.kept {
            self.last.before.copy_from(&self.now);
        }
    }

    /// The ledger at what is shown: what has left through each outlet, per cell measure, and what has been poured in.
    pub(super) fn ledger(&self) -> ([CompensatedSum; OUTLETS.len()], CompensatedSum) {
        let (mut out, mut poured) = (self.out, self.poured);
        if self.is_shown() {
            // The share of the step that lies behind the instant.
            let hidden = (self.time - self.last.at) / (self.time - self.last.begin);
            for (sum, part) in out.iter_mut().zip(self.last.out) {
                sum.add(-hidden * part);
            }
            poured.add(-hidden * self.last.poured);
        }
        (out, poured)
    }
}
