//! What a step costs: runs in which every cell has work, the time that their steps take, and what the memory can do.
//!
//! `granflow bench`, `cargo bench` and the counted instructions measure these same runs.

mod measure;
mod setups;
mod triad;

pub use measure::{SpeedError, Spell, median, spells};
pub use setups::{SETUPS, Setup};
pub use triad::Triad;

use crate::field::Field;
use crate::scheme::Scheme;
use crate::simulation::{Failure, Instructions, Simulation, Traffic};

/// A run to be measured, of whatever scheme.
pub trait Load: Send {
    /// Cells that are computed in a step.
    fn cells(&self) -> usize;
    /// Compute every cell.
    ///
    /// # Errors
    /// [`Failure`] where the state is beyond what the scheme takes.
    fn step(&mut self) -> Result<(), Failure>;
    /// Steps until it has moved on so far that cells come to rest, and it should begin anew.
    fn steps_left(&self) -> usize;
    /// Begin anew.
    fn restart(&mut self);
    /// What a step asks of the memory.
    fn traffic(&self) -> Traffic;
    /// Compute with these instructions.
    fn use_instructions(&mut self, instructions: Instructions);
}

/// A run and how it began.
struct Begun<const D: usize, S: Scheme<D, f64>> {
    run: Simulation<D, S>,
    clock: Vec<f64>,
    start: Field,
    left: usize,
}

impl<const D: usize, S: Scheme<D, f64>> Begun<D, S> {
    fn new(run: Simulation<D, S>) -> Self {
        let (clock, start) = (run.clock(), run.arrays().clone());
        let mut begun = Begun { run, clock, start, left: 0 };
        begun.left = begun.whole();
        begun
    }
    /// Steps in which a signal passes a small part of the grid.
    fn whole(&self) -> usize {
        (self.run.grid().cells[0] / 8).max(1)
    }
}

impl<const D: usize, S: Scheme<D, f64>> Load for Begun<D, S> {
    fn cells(&self) -> usize {
        self.run.grid().count()
    }
    fn step(&mut self) -> Result<(), Failure> {
        self.run.wake_all();
        self.left = self.left.saturating_sub(1);
        self.run.advance(f64::INFINITY).map(|_| ())
    }
    fn steps_left(&self) -> usize {
        self.left
    }
    fn restart(&mut self) {
        self.run.restore(&self.clock, self.start.clone());
        self.left = self.whole();
    }
    fn traffic(&self) -> Traffic {
        self.run.traffic()
    }
    fn use_instructions(&mut self, instructions: Instructions) {
        self.run.use_instructions(instructions);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> &'static Setup {
        SETUPS.iter().find(|setup| setup.name == name).expect("a setup")
    }

    #[test]
    fn every_cell_moves_until_the_restart_and_the_restart_is_the_start() {
        for setup in SETUPS {
            let mut load = setup.begin(40);
            assert_eq!(load.cells(), 40_usize.pow(setup.dimensions as u32), "{}", setup.name);
            for _ in 0..3 {
                while load.steps_left() > 0 {
                    load.step().unwrap_or_else(|failure| panic!("{}: {failure}", setup.name));
                }
                load.restart();
            }
        }
        let mut run = setups::on_plane::<2>(false, 40);
        while run.steps_left() > 0 {
            run.step().unwrap();
        }
        let (moving, wet) = run.run.counts();
        assert_eq!([moving, wet], [1600; 2]);
        let moved = run.run.arrays().parts.clone();
        run.restart();
        assert_eq!(run.run.arrays().parts, run.start.parts);
        while run.steps_left() > 0 {
            run.step().unwrap();
        }
        assert_eq!(run.run.arrays().parts, moved);
    }

    #[test]
    fn the_memory_model_counts_the_numbers_of_the_types() {
        let traffic = |name: &str| named(name).begin(200).traffic();
        // Three numbers in two dimensions, two in one, two of a pile; a plane is one ground.
        assert_eq!(traffic("balanced"), Traffic { read: 24.0, written: 24.0, allocated: 24.0 });
        assert_eq!(traffic("balanced_1d"), Traffic { read: 16.0, written: 16.0, allocated: 16.0 });
        // The second stage reads the state at the start of the step instead of allocating.
        assert_eq!(traffic("balanced_2"), Traffic { read: 72.0, written: 48.0, allocated: 24.0 });
        // Ten numbers of a terrain in every cell.
        assert_eq!(traffic("balanced_terrain").read, 24.0 + 80.0);
        // Only the tiles at the edges of the table see another ground than that of the middle.
        let pile = traffic("first_order");
        assert!((16.0..48.0).contains(&pile.read), "{pile:?}");
        assert_eq!([pile.written, pile.allocated], [16.0; 2]);
    }
}
