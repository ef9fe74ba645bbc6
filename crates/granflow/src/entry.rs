//! A line of the ledger: where the mass is at an instant.

use granflow_model::real::CompensatedSum;

/// One line of the ledger; masses are totals since the start, in the case's units (m³ on terrain).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Entry {
    /// Simulated time.
    pub time: f64,
    /// Steps done.
    pub step: u64,
    /// Mass on the grid.
    pub mass: f64,
    /// Mass that was released or poured on.
    pub mass_in: f64,
    /// Mass that left over the sides and inside them: left, right, bottom, top, and inside the grid.
    pub out: [f64; 5],
    /// (mass - `mass_in` + mass out - mass at the start) / (mass at the start + `mass_in` + what came over open edges).
    pub mass_error: f64,
    /// Cells that hold mass above a film.
    pub wet_cells: u64,
    /// Cells that move.
    pub moving_cells: u64,
    /// Largest speed; NaN where the model has none.
    pub max_speed: f64,
    /// Kinetic energy per density; NaN where the model has none.
    pub kinetic_energy: f64,
}

impl Entry {
    /// All that left: the sum over the sides and nodata.
    #[must_use]
    pub fn mass_out(&self) -> f64 {
        sum(self.out)
    }
}

/// The sum of `values` in their order, with Neumaier's compensation: its error does not grow with their number.
///
/// A. Neumaier, Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen, ZAMM 54 (1974), algorithm
/// IV.
#[must_use]
pub fn sum(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut sum = CompensatedSum::default();
    values.into_iter().for_each(|value| sum.add(value));
    sum.value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_keeps_what_plain_addition_loses() {
        assert_eq!(sum([1.0, 1e100, 1.0, -1e100]), 2.0);
        assert_eq!(sum(std::iter::repeat_n(0.1, 1_000_000)), 100_000.0);
        assert_ne!(std::iter::repeat_n(0.1, 1_000_000).sum::<f64>(), 100_000.0);
        assert_eq!(sum([1.0, f64::INFINITY]), f64::INFINITY);
        assert!(sum([1.0, f64::NAN]).is_nan());
        assert_eq!(sum([]), 0.0);
    }
}
