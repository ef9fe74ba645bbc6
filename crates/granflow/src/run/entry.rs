//! The line of the ledger of a run as it stands.

use super::{Run, Totals};
use crate::entry::{Entry, sum};

impl Entry {
    /// The line of a run as it stands.
    pub fn of(run: &mut dyn Run) -> Entry {
        let totals = run.take_totals();
        let speeds = |value: f64| if run.has_speed() { value } else { f64::NAN };
        Entry {
            time: run.time(),
            step: run.steps(),
            mass: totals.volume,
            mass_in: run.stepper().poured(),
            out: run.stepper().outflow(),
            mass_error: mass_error(run, &totals),
            wet_cells: totals.wet as u64,
            moving_cells: totals.moving as u64,
            max_speed: speeds(totals.speed),
            kinetic_energy: speeds(totals.energy),
        }
    }
}

/// (volume + left - initial - poured)/(initial + poured + came over open edges), and 0 of nothing.
pub fn mass_error(run: &dyn Run, totals: &Totals) -> f64 {
    let (out, poured, initial) = (run.stepper().outflow(), run.stepper().poured(), run.record().initial);
    let whole = initial + poured + sum(out.map(|out| (-out).max(0.0)));
    if whole == 0.0 { 0.0 } else { (totals.volume + sum(out) - initial - poured) / whole }
}
