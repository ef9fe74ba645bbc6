//! One step.

use super::error::Failure;
use super::state::Simulation;
use crate::boundary;
use crate::grid::GHOSTS;
use crate::sweep::{Output, Sweep, tracked};
use crate::tiles::{OUTLETS, TileStats};
use granflow_model::scheme::Scheme;

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// One step, not beyond time `until`; returns dt.
    ///
    /// # Errors
    /// [`Failure`]: where it is [`Failure::NotFinite`] the state is that after the failed step, else nothing has been done.
    pub fn advance(&mut self, until: f64) -> Result<f64, Failure> {
        self.show_end();
        let (dt, time) = self.next_step(until)?;
        self.keep_before(time);
        self.wake();
        let mut out = [0.0; OUTLETS.len()];
        for (stage, &rk_weight) in self.stages.iter().enumerate() {
            self.sweep(stage, dt, time);
            std::mem::swap(&mut self.now, &mut self.next);
            out = out.map(|out| out * (1.0 - rk_weight));
            self.take_stats(stage);
            // In the order of the tiles, whatever blocks they were computed in.
            for &number in &self.with_outlets {
                for (sum, part) in out.iter_mut().zip(self.stats[number as usize].outflow) {
                    *sum += (1.0 - rk_weight) * part;
                }
            }
        }
        (self.last.begin, self.last.at, self.last.dt) = (self.time, self.time, dt);
        (self.last.out, self.last.poured) = (out, dt * self.supply);
        self.time = time;
        self.step += 1;
        self.poured.add(self.last.poured);
        for (sum, part) in self.out.iter_mut().zip(out) {
            sum.add(part);
        }
        let finite = self.find_active();
        self.find_rate();
        if finite { Ok(dt) } else { Err(Failure::NotFinite { step: self.step, time: self.time }) }
    }

    /// The step that is taken towards `until`, and the time at its end.
    fn next_step(&self, until: f64) -> Result<(f64, f64), Failure> {
        let wanted = self.wanted_step();
        let left = until - self.time;
        // A rest of the way that only rounding left over is part of the last step.
        let rounding = if self.is_adaptive() { 0.0 } else { 1e-9 };
        let last = wanted * (1.0 + rounding) >= left;
        let (dt, time) = if last { (left, until) } else { (wanted, self.time + wanted) };
        let advances = time > self.time && dt.is_finite();
        if !advances {
            return Err(Failure::Collapsed { step: self.step, time: self.time, dt });
        }
        let max = self.scheme.max_courant();
        if S::REFUSES_LONG_STEPS && dt * self.rate() > max * (1.0 + 1e-9) {
            let courant = wanted * self.rate();
            return Err(Failure::TooLong { step: self.step, time: self.time, dt: wanted, courant, max });
        }
        Ok((dt, time))
    }

    /// Compute a stage in the tiles that are awake, from `now` to `next`.
    fn sweep(&mut self, stage: usize, dt: f64, time: f64) {
        let last = stage + 1 == self.stages.len();
        boundary::fill(&mut self.now, &self.grid, &self.layout, |axis, s| self.scheme.mirror(axis, &s));
        let sweep = Sweep {
            simd: self.simd,
            tiles: &self.tiles,
            awake: &self.awake,
            blocks: &self.blocks,
            layout: self.layout,
            size: [self.grid.size[0], self.grid.size[D - 1]],
            grounds: &self.grounds,
            forcings: &self.forcings,
            from: &self.now,
            reach: GHOSTS * self.stages.len(),
            dt,
            rk_weight: self.stages[stage],
            last,
            time,
            outlets: &self.outlets,
        };
        let output = Output {
            to: &mut self.next,
            maps: if last { self.maps.as_mut() } else { None },
            stats: &mut self.found,
            changes: &mut self.found_changes,
        };
        self.loops.sweep(&self.scheme, &sweep, output);
    }

    /// Keep what a sweep found under the numbers of its tiles.
    fn take_stats(&mut self, stage: usize) {
        let tracked = tracked::<D, S>();
        for (k, (&number, found)) in self.awake.iter().zip(&self.found).enumerate() {
            let number = number as usize;
            let stats = &mut self.stats[number];
            let activity = if stage == 0 { found.activity } else { found.activity.or(stats.activity) };
            *stats = TileStats { activity, ..*found };
            self.changes[number * tracked..(number + 1) * tracked]
                .copy_from_slice(&self.found_changes[k * tracked..(k + 1) * tracked]);
        }
    }

    /// Find the tiles that are active after a step; is every state in them a number?
    fn find_active(&mut self) -> bool {
        let mut finite = true;
        self.active.clear();
        for &number in &self.awake {
            let tile = &self.tiles[number as usize];
            let cells = (tile.columns[1] - tile.columns[0]) * (tile.rows[1] - tile.rows[0]);
            self.updates += (cells * self.stages.len()) as u64;
            let stats = &self.stats[number as usize];
            finite &= stats.rate < f64::INFINITY;
            self.row_max[number as usize / self.across].stale = true;
            self.outdated[number as usize] = true;
            if stats.activity.anywhere {
                self.active.push(number);
            }
        }
        finite
    }
}
