//! From a case of an avalanche on a mountain to a simulation: elevation, releases, the ground of every cell.

use super::{SetupError, Visit};
use crate::case::avalanche::Material;
use crate::case::terrain::{Extent, Measured, Order, Plan};
use crate::case::{self, RunPlan};
use crate::grid::Grid;
use crate::raster::{Crs, Raster};
use crate::release::{self, Sparse};
use crate::results::{Plane, Under};
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Balanced;
use crate::savage_hutter::ground;
use crate::scheme::Boundary;
use crate::simulation::{Simulation, StepSize};
use crate::terrain::{Curvature, Terrain};
use crate::time::{EULER, SSP_RK2};
use std::sync::Arc;

/// More cells than any machine holds.
const MOST_CELLS: f64 = (1_u64 << 36) as f64;

/// A mountain, SI units, with what is released on it.
#[derive(Debug)]
pub struct Mountain {
    /// The bed.
    pub terrain: Terrain,
    /// Released volume per plan area H \[m\].
    pub release: Sparse,
    /// What flows, and what holds it back.
    pub material: Material,
    /// The order of the scheme.
    scheme: Order,
    /// Thickness below which a cell is a film.
    pub film: f64,
}

impl Mountain {
    /// Reads elevation and releases.
    ///
    /// # Errors
    /// [`SetupError`] at the first file or key that cannot be used.
    pub(super) fn load(run: &RunPlan, plan: Plan) -> Result<Self, SetupError> {
        let terrain = bed(run, &plan)?;
        let mut release = Sparse::default();
        for one in &plan.releases {
            release = release.plus(volume(one, &terrain)?);
        }
        trim();
        Ok(Mountain { terrain, release, material: plan.material, scheme: plan.scheme, film: plan.film })
    }

    /// The simulation that the case asks for, handed to `work`. The derivatives of the bed are fitted cell by cell as the
    /// simulation asks for its grounds.
    pub(super) fn simulate<V: Visit>(self, step: StepSize, work: V) -> V::Output {
        let Mountain { terrain, release, material, scheme, film } = self;
        let (bed, gravity, law) = (&terrain.bed, material.gravity, material.law);
        let columns = bed.columns;
        let grid = Grid {
            cells: [bed.columns, bed.rows],
            origin: [bed.west, bed.south],
            size: [bed.cell; 2],
            boundary: [[Boundary::Nothing; 2]; 2],
        };
        let thickness = release.map(|cell, volume| volume * terrain.fit(bed.place(cell)).cosine());
        // The grounds hold the elevation from here on.
        let under = Under::Mountain(Arc::new(bed.with_values(Vec::new())));
        let plane = Plane::of(&grid, under, thickness);
        let (scheme, stages) = match scheme {
            Order::First => (Balanced::first(law, film), EULER),
            Order::Second => (Balanced::second(law, film), SSP_RK2),
        };
        let ground = move |cell| ground_at(&terrain, gravity, cell);
        let state = move |[i, j]: [usize; 2]| Flow::still(release.get(j * columns + i));
        work.visit(plane, Simulation::new(scheme, grid, stages, step, ground, state))
    }
}

/// The ground of a cell of a mountain under `gravity` \[m/s^2\], by column and row, the first row in the south.
pub fn ground_at(mountain: &Terrain, gravity: f64, [column, row]: [usize; 2]) -> ground::Terrain<2, f64> {
    let level = mountain.bed.at(column, row);
    if level.is_nan() {
        return ground::Terrain::nothing(gravity);
    }
    let fit = mountain.fit([column, row]);
    ground::Terrain::of(level, fit.gradient, fit.cosine(), fit.hessian, gravity)
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
fn bed(run: &RunPlan, plan: &Plan) -> Result<Terrain, SetupError> {
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
        if columns < 3.0 || rows < 3.0 || columns * rows > MOST_CELLS {
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
fn volume(one: &case::terrain::Release, terrain: &Terrain) -> Result<Sparse, SetupError> {
    let cells = match &one.extent {
        Extent::Polygons { path, thickness } => {
            let thickness = match thickness {
                case::terrain::Thickness::Constant(value) => release::Thickness::Value(*value),
                case::terrain::Thickness::Attribute(name) => {
                    release::Thickness::Attribute(name.attribute.clone())
                }
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
