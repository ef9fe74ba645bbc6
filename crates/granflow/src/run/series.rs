//! The series of a run: when its frames and ledger lines are due, and what they hold.

use super::model::Model;
use super::{CHECKPOINT, JOIN, LINES, Run, RunError, relative};
use crate::case;
use crate::output::ledger::{Entry, sum};
use crate::output::summary::StopReason;
use std::time::Instant;

impl<const D: usize, S: Model<D>> Run<'_, '_, D, S> {
    /// Time between frames, where it is set by time.
    pub(super) fn interval(&self) -> Option<f64> {
        match self.work.case.frames {
            case::Frames::Every(interval) => Some(interval),
            case::Frames::Steps(_) => None,
            // Nobody knows when a run that ends by itself will end.
            case::Frames::Ends if self.plane.is_terrain() => Some(10.0),
            case::Frames::Ends => Some(1.0),
        }
    }

    /// The frame and the ledger line after the present time.
    pub(super) fn schedule(&mut self) {
        let half = if self.simulation.is_adaptive() { 0.0 } else { 0.5 * self.simulation.wanted_step() };
        let time = self.simulation.time() + half;
        if let Some(interval) = self.interval() {
            // Multiples of the interval, so that rounding does not add up.
            let after = |interval: f64| {
                let next = ((time / interval).floor() + 1.0) * interval;
                if next - time > 1e-9 * interval { next } else { next + interval }
            };
            self.next_frame = after(interval);
            self.next_line = after(interval / LINES);
        }
    }

    /// A line of the ledger.
    pub(super) fn line(&mut self) -> Result<(), RunError> {
        if self.written[1] == self.simulation.time() {
            return Ok(());
        }
        self.simulation.take_sums();
        let simulation = &self.simulation;
        let totals = simulation.totals();
        let out = simulation.out();
        let (gone, mass_in) = (sum(out), simulation.poured());
        self.wet_cells = totals.wet;
        self.written[1] = simulation.time();
        self.writer.line(Entry {
            time: simulation.time(),
            step: simulation.step(),
            mass: totals.volume,
            mass_in,
            out,
            mass_error: relative(totals.volume + gone - self.initial - mass_in, self.initial + mass_in),
            wet_cells: totals.wet as u64,
            moving_cells: totals.moving as u64,
            max_speed: if S::PEAKS { totals.speed } else { f64::NAN },
            kinetic_energy: if S::PEAKS { totals.energy } else { f64::NAN },
        })?;
        Ok(())
    }

    /// A frame of the series and its line in the ledger.
    pub(super) fn frame(&mut self) -> Result<(), RunError> {
        let (simulation, plane) = (&self.simulation, &self.plane);
        self.writer.frame(simulation.time(), |field, from, values| {
            S::fill(simulation, plane, field, from, values);
        })?;
        self.written[0] = simulation.time();
        self.line()
    }
    /// Have what there is joined into `result.nc`, if that is worth its cost again.
    pub(super) fn join(&mut self) -> Result<(), RunError> {
        if let Some(cost) = self.writer.joined() {
            self.joined = Some((Instant::now(), cost));
        }
        if let Some((last, cost)) = self.joined
            && last.elapsed().as_secs_f64() > (JOIN * cost).max(CHECKPOINT)
        {
            let ending = self.ending(StopReason::Interrupted);
            self.writer.join(ending)?;
            self.joined = None;
        }
        Ok(())
    }
}
