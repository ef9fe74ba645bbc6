//! What a step costs: runs in which every cell has work, the time that their steps take, and what the memory can do.
//!
//! `granflow bench`, `cargo bench` and the counted instructions measure these same runs.

mod measure;
mod setups;
mod triad;

pub use measure::{SpeedError, Spell, median, spells};
pub(crate) use setups::{COURANT, grid};
pub use setups::{Extent, Setup};
pub use triad::Triad;

use crate::kernels::Kernel;
use crate::simulation::{Failure, SimdLevel, Simulation, Traffic};
use granflow_engine::Field;

/// A run to be measured, of whatever scheme.
pub trait Load: Send {
    /// Cells that are computed in a step.
    fn cells(&self) -> usize;
    /// Compute every cell, or those that are awake where a part is dry.
    ///
    /// # Errors
    /// [`Failure`] where the state is beyond what the scheme takes.
    fn step(&mut self) -> Result<(), Failure>;
    /// Steps left before cells come to rest; then it should restart.
    fn steps_left(&self) -> usize;
    /// Go back to the first state.
    ///
    /// # Errors
    /// [`Failure`] where the state is beyond what the scheme takes.
    fn restart(&mut self) -> Result<(), Failure>;
    /// What a step of every cell asks of the memory.
    fn traffic(&self) -> Traffic;
    /// Compute with these instructions.
    fn use_simd(&mut self, instructions: SimdLevel);
}

/// A run and how it began.
pub(crate) struct Begun<const D: usize, S: Kernel<D>> {
    run: Simulation<D, S>,
    clock: Vec<f64>,
    start: Field,
    left: usize,
    /// No cell may sleep.
    all: bool,
}

impl<const D: usize, S: Kernel<D>> Begun<D, S> {
    pub fn new(run: Simulation<D, S>, all: bool) -> Self {
        let (clock, start) = (run.clock(), run.arrays().clone());
        let mut begun = Begun { run, clock, start, left: 0, all };
        begun.left = begun.whole();
        begun
    }
    /// Steps in which a signal passes a small part of the grid.
    fn whole(&self) -> usize {
        (self.run.grid().cells[0] / 8).max(1)
    }
}

impl<const D: usize, S: Kernel<D>> Load for Begun<D, S> {
    fn cells(&self) -> usize {
        self.run.grid().count()
    }
    fn step(&mut self) -> Result<(), Failure> {
        if self.all {
            self.run.wake_all();
        }
        self.left = self.left.saturating_sub(1);
        self.run.advance(f64::INFINITY).map(|_| ())
    }
    fn steps_left(&self) -> usize {
        self.left
    }
    fn restart(&mut self) -> Result<(), Failure> {
        self.run.restore(&self.clock, self.start.clone());
        if !self.all {
            // The first step finds out what may sleep.
            self.step()?;
        }
        self.left = self.whole();
        Ok(())
    }
    fn traffic(&self) -> Traffic {
        self.run.traffic()
    }
    fn use_simd(&mut self, instructions: SimdLevel) {
        self.run.use_simd(instructions);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::savage_hutter::run::speed as avalanches;
    use crate::models::setups;

    fn whole(cells: usize) -> Extent {
        Extent { cells, wet: 1.0 }
    }

    #[test]
    fn every_setup_runs_until_its_restart_and_again() {
        for setup in setups() {
            for wet in [1.0, 0.3].into_iter().filter(|wet| *wet == 1.0 || setup.dry) {
                let mut load = setup.start(Extent { cells: 40, wet });
                assert_eq!(load.cells(), 40_usize.pow(setup.dimensions as u32), "{}", setup.name);
                for _ in 0..3 {
                    while load.steps_left() > 0 {
                        load.step().unwrap_or_else(|failure| panic!("{}: {failure}", setup.name));
                    }
                    load.restart().unwrap_or_else(|failure| panic!("{}: {failure}", setup.name));
                }
            }
        }
    }

    fn all_move_and_begin_anew<S: Kernel<2>>(mut load: Begun<2, S>) {
        let mut go = || {
            while load.steps_left() > 0 {
                load.step().unwrap();
            }
            let totals = load.run.totals();
            let (counts, moved) = ((totals.moving, totals.wet), load.run.arrays().components().to_vec());
            load.restart().unwrap();
            assert_eq!(load.run.arrays().components(), load.start.components());
            (counts, moved)
        };
        let first = go();
        assert_eq!(first.0, (1600, 1600), "cells that move, cells that are wet");
        assert!(first == go());
    }

    #[test]
    fn every_cell_moves_until_the_restart_and_the_restart_is_the_start() {
        all_move_and_begin_anew(avalanches::on_plane::<2, _>(avalanches::balanced(false), whole(40)));
        all_move_and_begin_anew(avalanches::on_terrain(avalanches::balanced(false), whole(40)));
    }

    #[test]
    fn what_is_dry_sleeps() {
        let mut load =
            avalanches::on_plane::<2, _>(avalanches::balanced(false), Extent { cells: 400, wet: 0.25 });
        load.restart().unwrap();
        assert_eq!(
            load.run.totals().wet,
            200 * 200 + 4 * 200,
            "the square, and a row of cells along its sides"
        );
        let before = load.run.updates();
        load.step().unwrap();
        let share = (load.run.updates() - before) as f64 / 160_000.0;
        // Of the square, and of the tiles around it, 20 x 12 cells each.
        assert!((0.25..0.45).contains(&share), "{share}");
    }

    #[test]
    fn the_memory_model_counts_the_numbers_of_the_types() {
        let named = |name: &str| setups().find(|setup| setup.name == name).expect("a setup");
        let traffic = |name: &str| named(name).start(whole(200)).traffic();
        // Three numbers in two dimensions, two in one, two of a pile; a plane is one ground.
        assert_eq!(traffic("balanced"), Traffic { read: 24.0, written: 24.0, allocated: 24.0 });
        assert_eq!(traffic("balanced_1d"), Traffic { read: 16.0, written: 16.0, allocated: 16.0 });
        // The second stage reads the state at the start of the step instead of allocating.
        assert_eq!(traffic("balanced_2"), Traffic { read: 72.0, written: 48.0, allocated: 24.0 });
        // Of a terrain the elevation in every cell, and six numbers in single precision.
        assert_eq!(traffic("balanced_terrain").read, 24.0 + 8.0 + 24.0);
        // Only the tiles at the edges of the table see another ground than that of the middle.
        let pile = traffic("first_order");
        assert!((16.0..48.0).contains(&pile.read), "{pile:?}");
        assert_eq!([pile.written, pile.allocated], [16.0; 2]);
    }
}
