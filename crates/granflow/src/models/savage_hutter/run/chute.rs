//! An avalanche on a chute in the papers' scaling: from a checked case to a run.

use super::super::ChuteDomain;
use super::flowing::Flowing;
use crate::StartError;
use crate::memory::fits;
use crate::model::Plane;
use crate::run::{Run, Simulated, step_size};
use granflow_case::avalanche::{Method, SchemeName};
use granflow_case::chute::Plan;
use granflow_case::{Axis, RunPlan, Side};
use granflow_engine::grid::Grid;
use granflow_engine::kernels::Kernel;
use granflow_engine::simulation::Simulation;

use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::friction::Coulomb;
use granflow_model::savage_hutter::ground::Chute;
use granflow_model::savage_hutter::kinetic::{
    VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5, Variant,
};
use granflow_model::scheme::Boundary;
use std::sync::Arc;

/// The run of a case on a chute.
pub(crate) fn start(run: &RunPlan, plan: Plan) -> Result<Box<dyn Run>, StartError> {
    if plan.grid.y.is_none() { on::<1>(run, plan) } else { on::<2>(run, plan) }
}

fn on<const D: usize>(run: &RunPlan, plan: Plan) -> Result<Box<dyn Run>, StartError> {
    let mu = plan.material.mu;
    let Method { name, film } = plan.scheme;
    let Some(law) = plan.material.law_in_loops() else {
        let law = plan.material.law;
        let second = name == SchemeName::EnergyStable2;
        let scheme = if second { EnergyStable::second(law, film) } else { EnergyStable::first(law, film) };
        return simulate::<D, _>(run, plan, scheme);
    };
    let published = |variant: Variant| variant.with(Coulomb { mu });
    match name {
        SchemeName::Balanced => simulate::<D, _>(run, plan, Balanced::first(law, film)),
        SchemeName::EnergyStable => simulate::<D, _>(run, plan, EnergyStable::first(law, film)),
        SchemeName::EnergyStable2 => simulate::<D, _>(run, plan, EnergyStable::second(law, film)),
        SchemeName::Balanced2 => simulate::<D, _>(run, plan, Balanced::second(law, film)),
        SchemeName::Verfahren1 => simulate::<D, _>(run, plan, published(VERFAHREN_1)),
        SchemeName::Verfahren2 => simulate::<D, _>(run, plan, published(VERFAHREN_2)),
        SchemeName::Verfahren3 => simulate::<D, _>(run, plan, published(VERFAHREN_3)),
        SchemeName::Verfahren4 => simulate::<D, _>(run, plan, published(VERFAHREN_4)),
        SchemeName::Verfahren5 => simulate::<D, _>(run, plan, published(VERFAHREN_5)),
    }
}

fn simulate<const D: usize, S>(run: &RunPlan, plan: Plan, scheme: S) -> Result<Box<dyn Run>, StartError>
where
    S: Kernel<D, State = Flow<D, f64>, Ground = Chute<D, f64>> + 'static,
{
    let (grid, grounds, initial, film) = (grid::<D>(&plan), columns(&plan), plan.initial, plan.scheme.film);
    fits(grid.cells.iter().product(), Simulation::<D, S>::bytes_per_cell(false))?;
    let columns = grid.cells[0];
    let plane = Plane::of(&grid, Arc::new(ChuteDomain));
    // Both own what they read: it is given back once the simulation is made.
    let ground = move |index: [usize; D]| {
        let Chute { tilt, beta, cos, curvature } = grounds[index[0]];
        Chute { tilt: std::array::from_fn(|k| tilt[k]), beta, cos, curvature }
    };
    let state = move |index: [usize; D]| {
        let n = if D > 1 { index[D - 1] * columns + index[0] } else { index[0] };
        let u = [initial.velocity_x[n], initial.velocity_y[n]];
        let h = initial.thickness[n];
        Flow { h, q: std::array::from_fn(|k| h * u[k]) }
    };
    let simulation = Simulation::new(scheme, grid, step_size(run), ground, state)?;
    let physics = Flowing::<S>::new(run.scheme, film, false).with_threshold(run.output.threshold);
    Ok(Box::new(Simulated::new(simulation, physics, plane)))
}

fn grid<const D: usize>(plan: &Plan) -> Grid<D> {
    let axes = [Some(&plan.grid.x), plan.grid.y.as_ref()];
    Grid {
        cells: std::array::from_fn(|k| axes[k].map_or(1, |axis| axis.cells)),
        origin: std::array::from_fn(|k| axes[k].map_or(0.0, |axis| axis.from)),
        size: std::array::from_fn(|k| axes[k].map_or(1.0, Axis::width)),
        boundary: std::array::from_fn(|k| {
            plan.sides[k].map(|side| match side {
                Side::Open => Boundary::Open,
                Side::Wall => Boundary::Wall,
                Side::Periodic => Boundary::Periodic,
            })
        }),
    }
}

/// The ground of every column of cells.
fn columns(plan: &Plan) -> Vec<Chute<2, f64>> {
    let column = |k: usize| Chute {
        tilt: [plan.material.gravity * plan.zeta[k].sin(), 0.0],
        beta: plan.beta(k),
        cos: plan.weight(k),
        curvature: plan.eta * plan.kappa[k],
    };
    (0..plan.zeta.len()).map(column).collect()
}
