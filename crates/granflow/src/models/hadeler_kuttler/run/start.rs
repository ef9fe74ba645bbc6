//! A growing sandpile: from a checked case to a run.

use super::pouring::Pouring;
use super::sand::Sand;
use crate::StartError;
use crate::memory::fits;
use crate::run::{Run, Simulated, step_size};
use granflow_case::sandpile::{Pile, Plan, Poured, SchemeName};
use granflow_case::{Grid, RunPlan};
use granflow_engine::simulation::{BuildError, Simulation, StepSize};
use granflow_model::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};

/// Bytes for each cell that a run holds beside its simulation: table, height, layers at the start, shares of the source.
pub(super) const BESIDE: usize = 68;

/// The run of a case of growing sandpiles.
pub(crate) fn start(run: &RunPlan, plan: Plan) -> Result<Box<dyn Run>, StartError> {
    let Plan { scheme, theta_exponent, grid, table } = plan;
    let scheme = match scheme {
        SchemeName::FirstOrder => FIRST_ORDER,
        SchemeName::SecondOrder => SECOND_ORDER,
        SchemeName::Adaptive => HadelerKuttler { slopes: Slopes::Adaptive { exponent: theta_exponent } },
    };
    match table {
        Poured::Line(pile) => on(run, &grid, *pile, scheme),
        Poured::Plane(pile) => on(run, &grid, *pile, scheme),
    }
}

fn on<const D: usize>(
    run: &RunPlan,
    grid: &Grid,
    pile: Pile<D>,
    scheme: HadelerKuttler,
) -> Result<Box<dyn Run>, StartError> {
    let cells = grid.cells().iter().product();
    fits(cells, Simulation::<D, HadelerKuttler>::bytes_per_cell(false) + BESIDE)?;
    let sand = Sand::new(run, grid, pile)?;
    // At its equilibrium a pile is the first-order scheme's.
    let scheme = if sand.equilibrium.is_some() { FIRST_ORDER } else { scheme };
    Ok(pour(sand, scheme, run.scheme, step_size(run))?)
}

/// The run of a table with what is poured on it, by a scheme under its name.
pub(crate) fn pour<const D: usize>(
    sand: Sand<D>,
    scheme: HadelerKuttler,
    name: &'static str,
    step: StepSize,
) -> Result<Box<dyn Run>, BuildError> {
    let (simulation, plane) = (sand.simulation(scheme, step)?, sand.plane());
    let table = plane.domain.clone();
    Ok(Box::new(Simulated::new(simulation, Pouring::new(sand, table, name), plane)))
}
