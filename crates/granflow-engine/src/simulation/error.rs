//! Why a simulation cannot be made, or cannot go on.

use super::step_size::StepSize;
use crate::grid::Grid;
use crate::tiles::MAX_STAGES;

/// Why a simulation cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BuildError {
    /// An axis of the grid has no cell, or more than memory can hold.
    Cells {
        /// 0 for x, 1 for y.
        axis: usize,
        /// How many were asked for.
        cells: usize,
    },
    /// The cells have no size along an axis: it must be positive and finite.
    Size {
        /// 0 for x, 1 for y.
        axis: usize,
        /// The size asked for.
        size: f64,
    },
    /// The fixed step is not positive and finite.
    Step {
        /// The step asked for.
        dt: f64,
    },
    /// The Courant number is not positive, or larger than the scheme takes.
    Courant {
        /// The Courant number asked for.
        courant: f64,
        /// The largest one: [`granflow_model::scheme::Scheme::max_courant`].
        max: f64,
    },
    /// A step has more stages than sleeping tiles allow for.
    Stages {
        /// How many stages it has.
        stages: usize,
        /// The largest number.
        max: usize,
    },
    /// What a builder was given is out of range.
    Value {
        /// What it is.
        name: &'static str,
        /// The value found.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
}

impl core::fmt::Display for BuildError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let name = |axis: usize| ["x", "y"][axis];
        match *self {
            Self::Cells { axis, cells } => {
                write!(
                    f,
                    "the grid has {cells} cells along {}: give it at least 1, and as many in all as fit into memory",
                    name(axis)
                )
            }
            Self::Size { axis, size } => {
                write!(f, "the cell size along {} is {size:e}: give a positive and finite number", name(axis))
            }
            Self::Step { dt } => write!(f, "the fixed step is {dt:e}: give a positive and finite number"),
            Self::Courant { courant, max } => {
                write!(f, "the Courant number is {courant}: the scheme takes numbers above 0 and up to {max}")
            }
            Self::Stages { stages, max } => {
                write!(f, "a step of the scheme has {stages} stages: this engine takes up to {max}")
            }
            Self::Value { name, value, allowed } => write!(f, "the {name} is {value}: give {allowed}"),
        }
    }
}

impl core::error::Error for BuildError {}

/// Can a simulation be made on this grid, with this step, of a scheme with this largest Courant number?
pub(super) fn check<const D: usize>(
    grid: &Grid<D>,
    step_size: StepSize,
    max_courant: f64,
    stages: usize,
) -> Result<(), BuildError> {
    /// Bytes that can be addressed, less room for ghosts and for several numbers in each cell.
    const MOST: usize = isize::MAX as usize >> 7;
    let valid = |number: f64| number > 0.0 && number.is_finite();
    let mut count = 1_usize;
    for (axis, (&cells, &size)) in grid.cells.iter().zip(&grid.size).enumerate() {
        count = count.saturating_mul(cells);
        if cells == 0 || count > MOST {
            return Err(BuildError::Cells { axis, cells });
        }
        if !valid(size) {
            return Err(BuildError::Size { axis, size });
        }
    }
    if stages > MAX_STAGES {
        return Err(BuildError::Stages { stages, max: MAX_STAGES });
    }
    match step_size {
        StepSize::Fixed(dt) if !valid(dt) => Err(BuildError::Step { dt }),
        StepSize::Courant(courant) if !(courant > 0.0 && courant <= max_courant) => {
            Err(BuildError::Courant { courant, max: max_courant })
        }
        _ => Ok(()),
    }
}

/// Why a step could not be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// A state became infinite or not a number.
    NotFinite {
        /// Steps done.
        step: u64,
        /// Time reached.
        time: f64,
    },
    /// A fixed step is too long for the state as it has become.
    TooLong {
        /// Steps done.
        step: u64,
        /// Time reached.
        time: f64,
        /// The step.
        dt: f64,
        /// Its Courant number.
        courant: f64,
        /// The largest allowed.
        max: f64,
    },
    /// The step became too small to advance the clock.
    Collapsed {
        /// Steps done.
        step: u64,
        /// Time reached.
        time: f64,
        /// The step asked for.
        dt: f64,
    },
}

impl core::fmt::Display for Failure {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotFinite { step, time } => write!(
                f,
                "the state is not finite after step {step}, time {time}: take a smaller step, or a positive scheme (verfahren_1, balanced); on a table, rates that are finite"
            ),
            Self::TooLong { step, time, dt, courant, max } => write!(
                f,
                "the fixed step {dt:e} is too long at step {step}, time {time}: its Courant number is {courant:.3}, the scheme takes up to {max}; set a smaller scheme.step, or scheme.courant for an adaptive one"
            ),
            Self::Collapsed { step, time, dt } => write!(
                f,
                "the step collapsed to {dt:e} at step {step}, time {time}: some speed has grown without bound"
            ),
        }
    }
}

impl core::error::Error for Failure {}

#[cfg(test)]
mod tests {
    use super::*;
    use granflow_model::scheme::Boundary;

    #[test]
    fn grids_without_cells_and_steps_beyond_the_scheme_are_refused() {
        let grid = |cells, size| Grid { cells, origin: [0.0; 2], size, boundary: [[Boundary::Open; 2]; 2] };
        let good = grid([3, 2], [0.5; 2]);
        let step = StepSize::Courant(0.5);
        assert_eq!(check(&good, step, 0.5, 2), Ok(()));
        assert_eq!(check(&good, StepSize::Fixed(7.0), 0.5, 2), Ok(()));
        assert_eq!(
            check(&grid([3, 0], [0.5; 2]), step, 0.5, 2),
            Err(BuildError::Cells { axis: 1, cells: 0 })
        );
        let huge = 1 << (usize::BITS / 2);
        assert!(matches!(check(&grid([huge; 2], [0.5; 2]), step, 0.5, 2), Err(BuildError::Cells { .. })));
        for size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                check(&grid([3, 2], [size, 0.5]), step, 0.5, 2),
                Err(BuildError::Size { axis: 0, .. })
            ));
            assert!(matches!(check(&good, StepSize::Fixed(size), 0.5, 2), Err(BuildError::Step { .. })));
            assert!(matches!(check(&good, StepSize::Courant(size), 0.5, 2), Err(BuildError::Courant { .. })));
        }
        assert_eq!(check(&good, step, 0.5, 3), Err(BuildError::Stages { stages: 3, max: 2 }));
        let error = check(&good, StepSize::Courant(0.51), 0.5, 2).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the Courant number is 0.51: the scheme takes numbers above 0 and up to 0.5"
        );
        let of = |grid: &Grid<2>, step, stages| check(grid, step, 0.5, stages).unwrap_err().to_string();
        for (text, part) in [
            (of(&grid([3, 0], [0.5; 2]), step, 2), "0 cells along y: give it at least 1"),
            (of(&grid([3, 2], [-1.0, 0.5]), step, 2), "the cell size along x is -1e0: give a positive"),
            (of(&good, StepSize::Fixed(0.0), 2), "the fixed step is 0e0: give a positive"),
            (of(&good, step, 3), "has 3 stages: this engine takes up to 2"),
        ] {
            assert!(text.contains(part), "{text}");
        }
    }
}
