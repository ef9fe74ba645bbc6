//! From a case of an avalanche on a mountain to a simulation: elevation, releases, the ground of every cell.

use super::{SetupError, Visit, law, step_size};
use crate::case::{self, Case, SchemeName};
use crate::grid::Grid;
use crate::model::Plane;
use crate::models::savage_hutter::TerrainDomain;
use crate::raster::{Crs, Raster};
use crate::release::{self, Sparse};
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Balanced;
use crate::savage_hutter::ground;
use crate::scheme::Boundary;
use crate::simulation::Simulation;
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
}

impl Mountain {
    /// Reads elevation and releases.
    ///
    /// # Errors
    /// [`SetupError`] at the first file or key that cannot be used.
    pub(super) fn load(case: &Case, terrain: &case::Terrain) -> Result<Self, SetupError> {
        let terrain = bed(case, terrain)?;
        let mut release = Sparse::default();
        for (number, one) in case.release.iter().enumerate() {
            release = release.plus(volume(case, one, number, &terrain)?);
        }
        trim();
        Ok(Mountain { terrain, release })
    }

    /// The simulation that the case asks for, handed to `work`. The derivatives of the bed are fitted cell by cell as the
    /// simulation asks for its grounds.
    pub(super) fn simulate<V: Visit>(self, case: &Case, work: V) -> V::Output {
        let Mountain { terrain, release } = self;
        let (bed, gravity) = (&terrain.bed, case.gravity());
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
            density: case.material().density(),
        };
        let plane = Plane::of(&grid, Arc::new(domain));
        let (law, film) = (law(case), case.scheme.film());
        let (scheme, stages) = match case.scheme.name {
            SchemeName::Balanced2 => (Balanced::second(law, film), SSP_RK2),
            _ => (Balanced::first(law, film), EULER),
        };
        let ground = move |cell| ground_at(&terrain, gravity, cell);
        let state = move |[i, j]: [usize; 2]| Flow::still(release.get(j * columns + i));
        work.visit(plane, Simulation::new(scheme, grid, stages, step_size(case), ground, state))
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
fn bed(case: &Case, terrain: &case::Terrain) -> Result<Terrain, SetupError> {
    let crs = match &terrain.crs {
        Some(text) => Some(Crs::parse(text).map_err(|error| {
            case.fault("terrain.crs", error.to_string(), "write it as crs = \"EPSG:31287\"")
        })?),
        None => None,
    };
    let mut bed = Raster::read_in(&case.resolve(&terrain.dem), crs.as_ref())?;
    let [width, height] = [bed.columns, bed.rows].map(|count| count as f64 * bed.cell);
    if let Some(cell) = terrain.cell {
        let [columns, rows] = [width / cell, height / cell];
        if columns < 3.0 || rows < 3.0 || columns * rows > MOST_CELLS {
            let message = format!(
                "cells of {cell} m cut the terrain of {width} m x {height} m into {columns:.1} x {rows:.1}"
            );
            let cure = "allowed are at least 3 along each side, and not more than a machine holds";
            return Err(case.fault("terrain.cell", message, cure).into());
        }
        bed = bed.resample(cell);
    }
    if let Some(length) = terrain.curvature.length().filter(|length| *length > width.min(height)) {
        let message = format!("a window of {length} m is wider than the terrain of {width} m x {height} m");
        let cure = "the window spans a few cells, for instance length = \"20 m\"";
        return Err(case.fault("terrain.curvature.length", message, cure).into());
    }
    let curvature = terrain.curvature.length().map_or(Curvature::Off, Curvature::Length);
    Ok(Terrain::new(bed, curvature))
}

/// Volume per plan area that one release gives to the cells.
fn volume(case: &Case, one: &case::Release, number: usize, terrain: &Terrain) -> Result<Sparse, SetupError> {
    let thickness = match &one.thickness {
        Some(case::Thickness::Constant(value)) => Some(release::Thickness::Value(*value)),
        Some(case::Thickness::Attribute(name)) => Some(release::Thickness::Attribute(name.attribute.clone())),
        None => None,
    };
    let missing = || {
        case.fault(
            &format!("release.{number}"),
            "the release says neither where nor how thick",
            "give polygons with a thickness, a raster, or a cap",
        )
    };
    let cells = match (&one.polygons, &one.raster, &one.cap) {
        (Some(path), None, None) => {
            release::polygons(&case.resolve(path), &thickness.ok_or_else(missing)?, &terrain.bed)?
        }
        (None, Some(path), None) => release::raster(&case.resolve(path), &terrain.bed)?,
        (None, None, Some(cap)) => release::cap(cap.height, cap.centre, cap.radius, &terrain.bed)?,
        _ => return Err(missing().into()),
    };
    let measured = match one.measured {
        case::Measured::Normal => release::Measured::Normal,
        case::Measured::Vertical => release::Measured::Vertical,
    };
    Ok(release::per_plan_area(cells, terrain, measured))
}
