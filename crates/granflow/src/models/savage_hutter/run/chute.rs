//! An avalanche on a chute in the papers' scaling: from a checked case to a run.

use super::super::ChuteDomain;
use super::compression::Compression;
use super::flowing::Flowing;
use super::laid::Laid;
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

/// Some of the cells of a chute side by side: number of the first along x and y, and how many.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub from: [usize; 2],
    pub cells: [usize; 2],
}

/// The run of a case on a chute.
pub(crate) fn start(run: &RunPlan, plan: &Plan, laid: &Laid) -> Result<Box<dyn Run>, StartError> {
    part(run, (plan, laid), Part { from: [0; 2], cells: plan.grid.cells() })
}

/// The run of a part of a chute, open where the chute goes on.
pub(crate) fn part(run: &RunPlan, chute: Chuted, part: Part) -> Result<Box<dyn Run>, StartError> {
    if chute.0.grid.y.is_none() { on::<1>(run, chute, part) } else { on::<2>(run, chute, part) }
}

/// A chute, and what another run left on it.
pub(crate) type Chuted<'a> = (&'a Plan, &'a Laid);

fn on<const D: usize>(run: &RunPlan, chute: Chuted, part: Part) -> Result<Box<dyn Run>, StartError> {
    let (plan, _) = chute;
    let mu = plan.material.mu.unwrap_or(0.0);
    let Method { name, film } = plan.scheme;
    let Some(law) = plan.material.law_in_loops() else {
        let law = plan.material.law;
        let second = name == SchemeName::EnergyStable2;
        let scheme = if second { EnergyStable::second(law, film) } else { EnergyStable::first(law, film) };
        return simulate::<D, _>(run, chute, part, scheme);
    };
    let published = |variant: Variant| variant.with(Coulomb { mu });
    match name {
        SchemeName::Balanced => simulate::<D, _>(run, chute, part, Balanced::first(law, film)),
        SchemeName::EnergyStable => simulate::<D, _>(run, chute, part, EnergyStable::first(law, film)),
        SchemeName::EnergyStable2 => simulate::<D, _>(run, chute, part, EnergyStable::second(law, film)),
        SchemeName::Balanced2 => simulate::<D, _>(run, chute, part, Balanced::second(law, film)),
        SchemeName::Verfahren1 => simulate::<D, _>(run, chute, part, published(VERFAHREN_1)),
        SchemeName::Verfahren2 => simulate::<D, _>(run, chute, part, published(VERFAHREN_2)),
        SchemeName::Verfahren3 => simulate::<D, _>(run, chute, part, published(VERFAHREN_3)),
        SchemeName::Verfahren4 => simulate::<D, _>(run, chute, part, published(VERFAHREN_4)),
        SchemeName::Verfahren5 => simulate::<D, _>(run, chute, part, published(VERFAHREN_5)),
    }
}

fn simulate<const D: usize, S>(
    run: &RunPlan,
    (plan, laid): Chuted,
    part: Part,
    scheme: S,
) -> Result<Box<dyn Run>, StartError>
where
    S: Kernel<D, State = Flow<D, f64>, Ground = Chute<D, f64>> + 'static,
{
    let (grid, film) = (grid::<D>(plan, part), plan.scheme.film);
    fits(grid.cells.iter().product(), Simulation::<D, S>::bytes_per_cell(false))?;
    let plane = Plane::of(&grid, Arc::new(ChuteDomain { remarks: laid.remarks.clone() }));
    let ground = |index: [usize; D]| ground_at(plan, part.from[0] + index[0]);
    let (columns, initial) = (plan.grid.cells()[0], &plan.initial);
    let state = |index: [usize; D]| {
        let row = if D > 1 { part.from[1] + index[D - 1] } else { 0 };
        let n = row * columns + part.from[0] + index[0];
        let u = [initial.velocity_x.at(n), initial.velocity_y.at(n)];
        let h = initial.thickness.at(n);
        Flow { h: laid.with(n, h), q: std::array::from_fn(|k| h * u[k]) }
    };
    let simulation = Simulation::new(scheme, grid, step_size(run), ground, state)?;
    let compression = Compression::of(&plan.material, film);
    let between = compression.into_iter().map(|compression| Box::new(compression) as _).collect();
    let physics = Flowing::<D, S>::new(run.scheme, film, false)
        .with_threshold(run.output.threshold)
        .with(between, None);
    Ok(Box::new(Simulated::new(simulation, physics, plane)))
}

fn grid<const D: usize>(plan: &Plan, Part { from, cells }: Part) -> Grid<D> {
    let axes = [Some(&plan.grid.x), plan.grid.y.as_ref()];
    let whole = |k: usize| cells[k] == plan.grid.cells()[k];
    Grid {
        cells: std::array::from_fn(|k| cells[k]),
        origin: std::array::from_fn(|k| {
            axes[k].map_or(0.0, |axis| axis.from + from[k] as f64 * axis.width())
        }),
        size: std::array::from_fn(|k| axes[k].map_or(1.0, Axis::width)),
        boundary: std::array::from_fn(|k| {
            plan.sides[k].map(|side| match side {
                Side::Wall if whole(k) => Boundary::Wall,
                Side::Periodic if whole(k) => Boundary::Periodic,
                _ => Boundary::Open,
            })
        }),
    }
}

/// The ground of a column of cells.
fn ground_at<const D: usize>(plan: &Plan, column: usize) -> Chute<D, f64> {
    let zeta = plan.columns.zeta(column);
    let down = plan.material.gravity * zeta.sin();
    Chute {
        tilt: std::array::from_fn(|k| if k == 0 { down } else { 0.0 }),
        beta: plan.beta(column),
        cos: plan.weight(column),
        curvature: plan.eta * plan.columns.kappa(column),
    }
}
