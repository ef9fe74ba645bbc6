//! The laws that the results of every run keep. A result that breaks one is worth nothing, and nobody may take it for one.

use super::{Run, mass_error};
use granflow_engine::View;

/// Relative mass error that rounding alone stays below.
const ROUNDING: f64 = 1e-12;

/// What the states of a run promise beside that every number in them is finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laws {
    /// So many of the first components of the state are layers: never negative.
    pub layers: usize,
    /// Largest mass error, relative to all that was there at the start, came and left.
    pub mass_error: f64,
}

impl Default for Laws {
    /// No component is known to be a layer; mass is kept to 1e-12.
    fn default() -> Self {
        Laws { layers: 0, mass_error: ROUNDING }
    }
}

/// A law that a run has broken, with the place and the cure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Broken {
    /// A number of the state is infinite or none.
    #[error("component {component} of the state is {value} {place}: {CURE}")]
    NotFinite {
        /// Which component, from 0: thickness, then momentum; standing, then rolling layer.
        component: usize,
        /// The number.
        value: f64,
        /// Cell, step and time.
        place: String,
    },
    /// A layer is thinner than nothing.
    #[error("a layer is {value:e} thick {place}: {scheme} does not keep layers positive here; {CURE}")]
    Negative {
        /// Its thickness.
        value: f64,
        /// Cell, step and time.
        place: String,
        /// Name of the scheme.
        scheme: String,
    },
    /// Mass came from nowhere, or went there.
    #[error("the mass error is {error:.1e} {place}, {scheme} keeps it below {most:.0e}: {CURE}")]
    Mass {
        /// The error, relative.
        error: f64,
        /// The largest one allowed.
        most: f64,
        /// Step and time.
        place: String,
        /// Name of the scheme.
        scheme: String,
    },
    /// A sum over the cells is too large for a number.
    #[error(
        "the {sum} of all cells is {value} {place}: take units in which lengths, thicknesses and speeds are near 1"
    )]
    Sum {
        /// Of what.
        sum: &'static str,
        /// The number.
        value: f64,
        /// Step and time.
        place: String,
    },
    /// A peak or a time is too large for the single precision of the maps.
    #[error(
        "the map {map} is {value} {place}: maps hold numbers up to 3e38; take units in which they are near 1"
    )]
    Map {
        /// Its name.
        map: &'static str,
        /// The number.
        value: f32,
        /// Cell, step and time.
        place: String,
    },
}

const CURE: &str = "take a smaller scheme.step, or scheme.courant, or a scheme that keeps this law: energy_stable for an avalanche, \
                    first_order for a sandpile";

/// Does the state of `run` keep its laws, as it stands?
///
/// # Errors
/// [`Broken`]: the first law that is broken, at the first cell.
pub fn check_state(run: &mut dyn Run) -> Result<(), Broken> {
    let totals = run.take_totals();
    let run = &*run;
    let Laws { layers, mass_error: most } = run.laws();
    let stepper = run.stepper();
    for component in 0..stepper.components() {
        let view = stepper.component(component);
        if let Some((value, cell)) = first(&view, |value| !value.is_finite()) {
            return Err(Broken::NotFinite { component, value, place: place(run, Some(cell)) });
        }
        let negative = |value: f64| value < 0.0;
        if let Some((value, cell)) = first(&view, negative).filter(|_| component < layers) {
            return Err(Broken::Negative {
                value,
                place: place(run, Some(cell)),
                scheme: run.scheme().into(),
            });
        }
    }
    let speeds = if run.has_speed() { [totals.energy, totals.speed] } else { [0.0; 2] };
    let sums = [("volume", totals.volume), ("kinetic energy", speeds[0]), ("largest speed", speeds[1])];
    if let Some((sum, value)) = sums.into_iter().find(|(_, value)| !value.is_finite()) {
        return Err(Broken::Sum { sum, value, place: place(run, None) });
    }
    let error = mass_error(run, &totals);
    if error.abs() <= most {
        return Ok(());
    }
    Err(Broken::Mass { error, most, place: place(run, None), scheme: run.scheme().to_owned() })
}

/// Do state and maps of `run` keep their laws at its end?
///
/// # Errors
/// As [`check_state`].
pub fn check_end(run: &mut dyn Run) -> Result<(), Broken> {
    check_state(run)?;
    let run = &*run;
    let (layout, maps) = (run.stepper().layout(), run.stepper().maps());
    for (map, values) in maps.into_iter().flat_map(granflow_engine::Maps::named) {
        for row in 0..layout.rows {
            let values = &values[layout.place(0, row as isize)..][..layout.columns];
            if let Some(column) = values.iter().position(|value| value.is_infinite()) {
                let (value, place) = (values[column], place(run, Some([column, row])));
                return Err(Broken::Map { map, value, place });
            }
        }
    }
    Ok(())
}

/// The first number that is `wrong`, row by row, and its cell.
fn first(view: &View<'_>, wrong: impl Fn(f64) -> bool) -> Option<(f64, [usize; 2])> {
    // Without a way out of the loop over a row, it is computed on vectors.
    let holds = |row: &[f64]| row.iter().fold(false, |any, value| any | wrong(*value));
    let (number, row) = view.rows().enumerate().find(|(_, row)| holds(row))?;
    let column = row.iter().position(|value| wrong(*value))?;
    Some((row[column], [column, number]))
}

/// A cell, if one is to blame, the step and the time, in words.
fn place(run: &dyn Run, cell: Option<[usize; 2]>) -> String {
    let plane = run.plane();
    let at = |centres: &[f64], index: usize| centres.get(index).copied();
    let cell = cell.map(|[column, row]| match [at(&plane.x, column), at(&plane.y, row)] {
        [Some(x), Some(y)] => format!("in cell ({column}, {row}) at x = {x:?}, y = {y:?}, "),
        [Some(x), None] if plane.y.is_empty() => format!("in cell {column} at x = {x:?}, "),
        _ => format!("at node ({column}, {row}), "),
    });
    format!("{}after step {}, at time {:?}", cell.unwrap_or_default(), run.steps(), run.time())
}
