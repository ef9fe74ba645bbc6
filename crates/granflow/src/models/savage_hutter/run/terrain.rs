//! An avalanche on a mountain, SI units: from a checked case to a run.

use super::super::TerrainDomain;
use super::between::BetweenSteps;
use super::compression::Compression;
use super::erosion::Erodible;
use super::flowing::Flowing;
use super::forest::Forest;
use super::loaded::{Loaded, load};
use super::mountain::{Mountains, curvature_of};
use super::supply::Supply;
use crate::StartError;
use crate::inputs::Inputs;
use crate::memory::fits;
use crate::model::Plane;
use crate::run::{Run, Simulated, step_size};
use granflow_case::RunPlan;
use granflow_case::terrain::{Plan, TerrainScheme};
use granflow_engine::grid::Grid;
use granflow_engine::kernels::Kernel;
use granflow_engine::simulation::Simulation;
use granflow_geo::Remark;
use granflow_geo::release::Sparse;
use granflow_geo::terrain::Terrain;
use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::{Flow, ground};
use granflow_model::scheme::Boundary;
use std::sync::Arc;

/// The run of a case on a mountain.
pub(crate) fn start(
    run: &RunPlan,
    plan: &Plan,
    inputs: &Inputs,
    mountains: Option<&Mountains>,
) -> Result<Box<dyn Run>, StartError> {
    simulate(run, plan, load(run, plan, inputs, mountains)?)
}

/// The run on a mountain that was read. The derivatives of the bed are fitted cell by cell as the simulation asks for its
/// grounds.
pub(super) fn simulate(
    run: &RunPlan,
    plan: &Plan,
    Loaded { terrain, release, remarks, material, parameters, layer, supply, .. }: Loaded,
) -> Result<Box<dyn Run>, StartError> {
    let (bed, gravity) = (&terrain.bed, plan.material.gravity);
    let columns = bed.columns;
    let grid = Grid {
        cells: [bed.columns, bed.rows],
        origin: [bed.west, bed.south],
        size: [bed.cell; 2],
        boundary: [[Boundary::Absorbing; 2]; 2],
    };
    let plane = Plane::of(&grid, Arc::new(domain(run, plan, (&terrain, &release, &supply), remarks)));
    let film = plan.scheme.film;
    // What comes later and what is picked up bring a head of their own.
    let grows = !supply.is_empty() || layer.as_ref().is_some_and(|(_, volume)| *volume > 0.0);
    let pressure_coefficient = plan.material.pressure_coefficient;
    let ceiling = if grows { f64::MAX } else { gravity * ceiling(&terrain, pressure_coefficient, &release) };
    let compression = Compression::of(&plan.material, film);
    let density = plan.material.density;
    let erodible = plan.entrainment.as_ref().zip(layer).map(|(entrainment, (whole, _))| {
        Erodible::of(entrainment, whole, (material.law, parameters.clone()), density, &terrain.bed)
    });
    let ground = move |cell| ground_at(&terrain, gravity, cell).with_pressure(pressure_coefficient);
    let state = move |[i, j]: [usize; 2]| Flow::still(release.get(j * columns + i));
    let chosen = material.mu.filter(|_| material.by_volume);
    let begin = Begin { run, film, grid, plane, supply, erodible, compression, chosen };
    let Some(law) = material.law_in_loops() else {
        let law = material.law;
        let scheme = match plan.scheme.name {
            TerrainScheme::EnergyStable2 => EnergyStable::second(law, film),
            TerrainScheme::EnergyStable => EnergyStable::first(law, film),
            TerrainScheme::Balanced | TerrainScheme::Balanced2 => {
                unreachable!("a case with these schemes has a law of the loops")
            }
        };
        let forest = plan.forest_breaks_at.map(|strength| Forest::of(strength, density, parameters.clone()));
        let forest = forest.map(|forest| Box::new(forest) as _);
        let of_cell = move |[i, j]: [usize; 2], _| parameters.at(j * columns + i);
        return begin.with(scheme.below(ceiling), ground, state, (of_cell, forest));
    };
    match plan.scheme.name {
        TerrainScheme::Balanced => begin.with(Balanced::first(law, film), ground, state, (|_, ()| (), None)),
        TerrainScheme::Balanced2 => {
            begin.with(Balanced::second(law, film), ground, state, (|_, ()| (), None))
        }
        TerrainScheme::EnergyStable => {
            begin.with(EnergyStable::first(law, film).below(ceiling), ground, state, (|_, ()| (), None))
        }
        TerrainScheme::EnergyStable2 => {
            begin.with(EnergyStable::second(law, film).below(ceiling), ground, state, (|_, ()| (), None))
        }
    }
}

/// What files and figures must know of a mountain.
fn domain(
    run: &RunPlan,
    plan: &Plan,
    (terrain, release, supply): (&Terrain, &Sparse, &Supply),
    remarks: Vec<Remark>,
) -> TerrainDomain {
    let bed = &terrain.bed;
    let all =
        supply.late.iter().fold(release.clone(), |all, late| all.plus(late.cells.iter().copied().collect()));
    let thickness = all.map(|cell, volume| volume * terrain.fit(bed.place(cell)).cosine());
    let inlets = supply.inflows.iter().flat_map(|inflow| &inflow.inlets).map(|inlet| inlet.cell);
    TerrainDomain {
        // The grounds hold the elevation.
        raster: Arc::new(bed.with_values(Vec::new())),
        release: Arc::new(thickness),
        inlets: inlets.collect(),
        density: plan.material.density,
        threshold: run.output.threshold,
        curvature: curvature_of(plan),
        remarks,
    }
}

/// A run that is to begin.
struct Begin<'a> {
    run: &'a RunPlan,
    film: f64,
    grid: Grid<2>,
    plane: Plane,
    supply: Supply,
    erodible: Option<Erodible>,
    compression: Option<Compression>,
    /// mu, if it was chosen by the volume.
    chosen: Option<f64>,
}

impl Begin<'_> {
    /// With a scheme, what acts on each cell, and what may change that.
    fn with<S>(
        self,
        scheme: S,
        ground: impl Fn([usize; 2]) -> ground::Terrain<2, f64> + Sync,
        state: impl Fn([usize; 2]) -> Flow<2, f64> + Sync,
        (forcing, forest): (
            impl Fn([usize; 2], S::Forcing) -> S::Forcing + Sync,
            Option<Box<dyn BetweenSteps<2, S>>>,
        ),
    ) -> Result<Box<dyn Run>, StartError>
    where
        S: Kernel<2, State = Flow<2, f64>, Ground = ground::Terrain<2, f64>> + 'static,
    {
        let Begin { run, film, grid, plane, supply, erodible, compression, chosen } = self;
        fits(grid.cells.iter().product(), Simulation::<2, S>::bytes_per_cell(false))?;
        let mut simulation = Simulation::new(scheme, grid, step_size(run), ground, state)?;
        simulation.apply(forcing);
        let supply = (!supply.is_empty()).then(|| Box::new(supply) as Box<dyn BetweenSteps<2, S>>);
        let erodible = erodible.map(|erodible| Box::new(erodible) as _);
        let compression = compression.map(|compression| Box::new(compression) as _);
        let between = supply.into_iter().chain(erodible).chain(forest).chain(compression).collect();
        let physics =
            Flowing::new(run.scheme, film, true).with_threshold(run.output.threshold).with(between, chosen);
        Ok(Box::new(Simulated::new(simulation, physics, plane)))
    }
}

/// The highest total head \[m\] that a mass released at rest can have: its highest surface and its greatest height c^2 H over
/// the bed, which a front gains; a depth counts by the earth-pressure coefficient `k`.
fn ceiling(terrain: &Terrain, k: f64, release: &Sparse) -> f64 {
    let (mut top, mut deepest) = (f64::NEG_INFINITY, 0.0_f64);
    for (cell, volume) in release.iter().filter(|(_, volume)| *volume > 0.0) {
        let [column, row] = terrain.bed.place(cell);
        let cos = terrain.fit([column, row]).cosine();
        let depth = k * (cos * cos * volume);
        top = top.max(terrain.bed.at(column, row) + depth);
        deepest = deepest.max(depth);
    }
    top + deepest
}

/// The ground of a cell of a mountain under `gravity` \[m/s^2\], by column and row, the first row in the south.
pub(crate) fn ground_at(
    mountain: &Terrain,
    gravity: f64,
    [column, row]: [usize; 2],
) -> ground::Terrain<2, f64> {
    let level = mountain.bed.at(column, row);
    if level.is_nan() {
        return ground::Terrain::nothing(gravity);
    }
    let fit = mountain.fit([column, row]);
    ground::Terrain::of(level, fit.gradient, fit.cosine(), fit.hessian, gravity)
}
