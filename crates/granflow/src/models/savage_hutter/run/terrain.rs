//! An avalanche on a mountain, SI units: from a checked case to a run.

use super::super::TerrainDomain;
use super::flowing::Flowing;
use crate::StartError;
use crate::memory::fits;
use crate::model::Plane;
use crate::run::{Run, Simulated, step_size};
use granflow_case::RunPlan;
use granflow_case::terrain::{Extent, Measured, Plan, Release, TerrainScheme, Thickness};
use granflow_engine::grid::Grid;
use granflow_engine::kernels::Kernel;
use granflow_engine::simulation::Simulation;
use granflow_geo::raster::{Crs, Raster};
use granflow_geo::release::{self, Sparse};
use granflow_geo::terrain::{Curvature, Terrain};
use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::{Flow, ground};
use granflow_model::scheme::Boundary;
use std::sync::Arc;

/// More cells than any machine holds.
const MAX_CELLS: f64 = (1_u64 << 36) as f64;

/// The run of a case on a mountain.
pub(crate) fn start(run: &RunPlan, plan: &Plan) -> Result<Box<dyn Run>, StartError> {
    let (terrain, release) = load(run, plan)?;
    simulate(run, plan, terrain, release)
}

/// The run on a mountain that was read. The derivatives of the bed are fitted cell by cell as the simulation asks for its
/// grounds.
pub(super) fn simulate(
    run: &RunPlan,
    plan: &Plan,
    terrain: Terrain,
    release: Sparse,
) -> Result<Box<dyn Run>, StartError> {
    let (bed, gravity) = (&terrain.bed, plan.material.gravity);
    let columns = bed.columns;
    let grid = Grid {
        cells: [bed.columns, bed.rows],
        origin: [bed.west, bed.south],
        size: [bed.cell; 2],
        boundary: [[Boundary::Absorbing; 2]; 2],
    };
    let thickness = release.map(|cell, volume| volume * terrain.fit(bed.place(cell)).cosine());
    // The grounds hold the elevation from here on.
    let domain = TerrainDomain {
        raster: Arc::new(bed.with_values(Vec::new())),
        release: Arc::new(thickness),
        density: plan.material.density,
        threshold: run.output.threshold,
    };
    let plane = Plane::of(&grid, Arc::new(domain));
    let (law, film) = (plan.material.law, plan.scheme.film);
    let ceiling = gravity * ceiling(&terrain, &release);
    let ground = move |cell| ground_at(&terrain, gravity, cell);
    let state = move |[i, j]: [usize; 2]| Flow::still(release.get(j * columns + i));
    match plan.scheme.name {
        TerrainScheme::Balanced => begin(run, film, Balanced::first(law, film), (grid, plane), ground, state),
        TerrainScheme::Balanced2 => {
            begin(run, film, Balanced::second(law, film), (grid, plane), ground, state)
        }
        TerrainScheme::EnergyStable => {
            let scheme = EnergyStable::first(law, film).below(ceiling);
            begin(run, film, scheme, (grid, plane), ground, state)
        }
        TerrainScheme::EnergyStable2 => {
            let scheme = EnergyStable::second(law, film).below(ceiling);
            begin(run, film, scheme, (grid, plane), ground, state)
        }
    }
}

/// A run with a scheme.
fn begin<S>(
    run: &RunPlan,
    film: f64,
    scheme: S,
    (grid, plane): (Grid<2>, Plane),
    ground: impl Fn([usize; 2]) -> ground::Terrain<2, f64> + Sync,
    state: impl Fn([usize; 2]) -> Flow<2, f64> + Sync,
) -> Result<Box<dyn Run>, StartError>
where
    S: Kernel<2, State = Flow<2, f64>, Ground = ground::Terrain<2, f64>, Forcing = ()> + 'static,
{
    fits(grid.cells.iter().product(), Simulation::<2, S>::bytes_per_cell(false))?;
    let simulation = Simulation::new(scheme, grid, step_size(run), ground, state)?;
    let physics = Flowing::new(run.scheme, film, true).with_threshold(run.output.threshold);
    Ok(Box::new(Simulated::new(simulation, physics, plane)))
}

/// The highest total head \[m\] that a mass released at rest can have: its highest surface and its greatest height c^2 H over
/// the bed, which a front gains.
fn ceiling(terrain: &Terrain, release: &Sparse) -> f64 {
    let (mut top, mut deepest) = (f64::NEG_INFINITY, 0.0_f64);
    for (cell, volume) in release.iter().filter(|(_, volume)| *volume > 0.0) {
        let [column, row] = terrain.bed.place(cell);
        let cos = terrain.fit([column, row]).cosine();
        let depth = cos * cos * volume;
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

/// Elevation, and released volume per plan area H \[m\].
pub(super) fn load(run: &RunPlan, plan: &Plan) -> Result<(Terrain, Sparse), StartError> {
    let terrain = bed(run, plan)?;
    let mut release = Sparse::default();
    for one in &plan.releases {
        release = release.plus(volume(one, &terrain)?);
    }
    trim();
    Ok((terrain, release))
}

/// Hands back to the system what reading has left: the allocator would keep it for more of the same, and none will come.
fn trim() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: only memory that is free is given back.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// The elevation on the cells that the case asks for.
fn bed(run: &RunPlan, plan: &Plan) -> Result<Terrain, StartError> {
    let crs = match &plan.crs {
        Some(text) => Some(Crs::parse(text).map_err(|error| {
            run.fault("terrain.crs", error.to_string(), "write it as crs = \"EPSG:31287\"")
        })?),
        None => None,
    };
    let mut bed = Raster::read_in(&plan.dem, crs.as_ref())?;
    let [width, height] = [bed.columns, bed.rows].map(|count| count as f64 * bed.cell);
    if let Some(cell) = plan.cell {
        let [columns, rows] = [width / cell, height / cell];
        if columns < 3.0 || rows < 3.0 || columns * rows > MAX_CELLS {
            let message = format!(
                "cells of {cell} m cut the terrain of {width} m x {height} m into {columns:.1} x {rows:.1}"
            );
            let cure = "allowed are at least 3 along each side, and not more than a machine holds";
            return Err(run.fault("terrain.cell", message, cure).into());
        }
        bed = bed.resample(cell);
    }
    if let Some(length) = plan.curvature.filter(|length| *length > width.min(height)) {
        let message = format!("a window of {length} m is wider than the terrain of {width} m x {height} m");
        let cure = "the window spans a few cells, for instance length = \"20 m\"";
        return Err(run.fault("terrain.curvature.length", message, cure).into());
    }
    let curvature = plan.curvature.map_or(Curvature::Off, Curvature::Length);
    Ok(Terrain::new(bed, curvature))
}

/// Volume per plan area that one release gives to the cells.
fn volume(one: &Release, terrain: &Terrain) -> Result<Sparse, StartError> {
    let cells = match &one.extent {
        Extent::Polygons { path, thickness } => {
            let thickness = match thickness {
                Thickness::Constant(value) => release::Thickness::Value(*value),
                Thickness::Attribute(name) => release::Thickness::Attribute(name.attribute.clone()),
            };
            release::polygons(path, &thickness, &terrain.bed)?
        }
        Extent::Raster(path) => release::raster(path, &terrain.bed)?,
        Extent::Cap(cap) => release::cap(cap.height, cap.centre, cap.radius, &terrain.bed)?,
    };
    let measured = match one.measured {
        Measured::Normal => release::Measured::Normal,
        Measured::Vertical => release::Measured::Vertical,
    };
    Ok(release::per_plan_area(cells, terrain, measured))
}
