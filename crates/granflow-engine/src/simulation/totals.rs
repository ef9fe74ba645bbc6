//! Sums over the whole grid.

/// Sums over the whole grid.
#[derive(Clone, Copy, Debug, Default)]
pub struct Totals {
    /// Volume (length x depth in one dimension): sum of h times the cell measure.
    pub volume: f64,
    /// Part of it in films.
    pub film: f64,
    /// Largest speed along the bed.
    pub speed: f64,
    /// Kinetic energy per density.
    pub energy: f64,
    /// Cells with a depth.
    pub wet: usize,
    /// Cells with a momentum.
    pub moving: usize,
    /// The part of the volume that is in them.
    pub moving_volume: f64,
}
