//! What a run remembers: the volume at the start, peaks, time spent in steps.

use std::time::Duration;

/// Volume at the start and the peaks so far, in the units of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record {
    /// Volume at the start.
    pub initial: f64,
    /// Largest speed, of films too; that of layers which count is the largest of the map `peak_speed`.
    pub peak_speed: f64,
    /// Largest kinetic energy per density, if it is tracked.
    pub peak_energy: f64,
    /// Kinetic energy per density after the last step, if it is tracked, else at the start.
    pub energy: f64,
    /// The last time at which more than a trickle was found to move, if that is looked for; 0 before.
    pub flowed: f64,
    /// Cells with a depth when totals were last taken.
    pub wet_cells: usize,
    /// Time on the clock that the steps of this process took.
    pub stepping: Duration,
}
