//! Runs to measure a scheme by: everything moves, nothing is dry unless asked for. Each model gives its own.

use super::Load;
use crate::grid::Grid;
use crate::scheme::Boundary;
use crate::simulation::StepSize;

/// The step of all of them.
pub(crate) const COURANT: StepSize = StepSize::Courant(0.4);

/// A run to measure a scheme by.
pub struct Setup {
    /// Its name, that of its scheme.
    pub name: &'static str,
    /// What is computed, in words.
    pub about: &'static str,
    /// Number of dimensions.
    pub dimensions: usize,
    /// May a part of it be dry? The published schemes lose positivity there, all but the first.
    pub dry: bool,
    /// Makes the run.
    pub begin: fn(Extent) -> Box<dyn Load>,
}

/// How large a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Cells along each axis.
    pub cells: usize,
    /// Share of the grid that is wet, a square in the middle; the rest is dry, or stands still, and may sleep.
    pub wet: f64,
}

impl Extent {
    /// Does the cell belong to the wet part?
    pub fn is_wet<const D: usize>(&self, index: [usize; D]) -> bool {
        let half = 0.5 * self.wet.powf(1.0 / D as f64) * self.cells as f64;
        index.iter().all(|k| (*k as f64 + 0.5 - 0.5 * self.cells as f64).abs() < half)
    }
    /// All of it is wet.
    pub fn all(&self) -> bool {
        self.wet >= 1.0
    }
}

impl Setup {
    /// The run of this extent.
    pub fn start(&self, extent: Extent) -> Box<dyn Load> {
        (self.begin)(extent)
    }
}

/// \[-1/2, 1/2\] along each axis.
pub(crate) fn grid<const D: usize>(cells: usize, boundary: Boundary) -> Grid<D> {
    Grid { cells: [cells; D], origin: [-0.5; D], size: [1.0 / cells as f64; D], boundary: [[boundary; 2]; D] }
}
