//! A growing sandpile without a case file.

use super::sand::{Places, Sand, Sources};
use super::site::Site;
use super::start::pour;
use crate::check_value::check_value;
use crate::run::Run;
use granflow_engine::simulation::{BuildError, StepSize};
use granflow_model::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER};
use granflow_model::hadeler_kuttler::table::Table;
use granflow_model::scheme::Scheme;

/// A sandpile to be started, in the papers' scaling: slopes in units of the angle of repose, the adaptive scheme, an empty
/// flat table with its lower left corner at 0, nothing poured.
pub struct Sandpile<const D: usize> {
    table: Table<D>,
    size: [f64; D],
    rates: Vec<f64>,
    scheme: (&'static str, HadelerKuttler),
}

/// Rates that never change.
struct Steady(Vec<f64>);

impl Sources for Steady {
    fn rate(&self, _t: f64) -> Vec<f64> {
        self.0.clone()
    }
    fn changes(&self) -> Vec<f64> {
        Vec::new()
    }
    fn is_moving(&self, _time: f64) -> bool {
        false
    }
    fn lasting(&self) -> Option<Vec<f64>> {
        Some(self.0.clone())
    }
}

impl<const D: usize> Sandpile<D> {
    /// On a table with cells of this size.
    #[must_use]
    pub fn on(table: Table<D>, size: [f64; D]) -> Self {
        let cells = table.cells().iter().product();
        Sandpile { table, size, rates: vec![0.0; cells], scheme: ("adaptive", ADAPTIVE) }
    }
    /// The rate f at which sand is poured \[thickness per time\], at the centres of the cells.
    #[must_use]
    pub fn source(mut self, rate: impl Fn([f64; D]) -> f64) -> Self {
        let cells = self.table.cells();
        for (number, here) in self.rates.iter_mut().enumerate() {
            let mut rest = number;
            let centre = std::array::from_fn(|k| {
                let i = rest % cells[k];
                rest /= cells[k];
                (i as f64 + 0.5) * self.size[k]
            });
            *here = rate(centre);
        }
        self
    }
    /// First order, well-balanced.
    #[must_use]
    pub fn first_order(self) -> Self {
        Sandpile { scheme: ("first_order", FIRST_ORDER), ..self }
    }
    /// Second order, not well-balanced.
    #[must_use]
    pub fn second_order(self) -> Self {
        Sandpile { scheme: ("second_order", SECOND_ORDER), ..self }
    }
    /// The run; nothing is computed yet.
    ///
    /// # Errors
    /// [`BuildError`] for cells without a size, or a rate that is negative or not finite.
    pub fn start(self) -> Result<Box<dyn Run>, BuildError> {
        let Sandpile { table, size, rates, scheme: (name, scheme) } = self;
        for &rate in &rates {
            check_value("rate of the source", rate, "a finite number >= 0 in every cell", |rate| {
                rate >= 0.0
            })?;
        }
        let places = |axis: usize, count: usize, shift: f64| -> Vec<f64> {
            if axis < D { (0..count).map(|k| (k as f64 + shift) * size[axis]).collect() } else { Vec::new() }
        };
        let cells = table.cells();
        let along = |axis: usize| cells[axis.min(D - 1)];
        let nodes = table.nodes().iter().product();
        let sand = Sand {
            places: Places {
                centres: [places(0, along(0), 0.5), places(1, along(1), 0.5)],
                nodes: [places(0, along(0) + 1, 0.0), places(1, along(1) + 1, 0.0)],
            },
            site: Site::level(table, size),
            layers: [vec![0.0; nodes], vec![0.0; rates.len()]],
            sources: Box::new(Steady(rates)),
            equilibrium: None,
        };
        let step = StepSize::Courant(<HadelerKuttler as Scheme<D, f64>>::suggested_courant(&scheme));
        pour(sand, scheme, name, step)
    }
}
