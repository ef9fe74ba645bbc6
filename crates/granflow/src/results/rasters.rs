//! `rasters/*.tif`: the summary maps for a geographic information system.

use super::{Finished, MAPS};
use crate::raster::RasterError;
use rayon::prelude::*;
use std::path::PathBuf;

/// Write the maps of a run on a mountain: nodata outside the elevation model, and for the times where nothing came;
/// thicknesses below the film are 0.
pub(super) fn write(run: &Finished) -> Result<Vec<PathBuf>, RasterError> {
    let Some(bed) = run.plane.mountain() else { return Ok(Vec::new()) };
    let folder = run.directory.join("rasters");
    std::fs::create_dir_all(&folder).map_err(|source| RasterError::Io { path: folder.clone(), source })?;
    let write = |name: &&str| -> Option<Result<PathBuf, RasterError>> {
        let map = run.map(name)?;
        let thickness = matches!(*name, "peak_thickness" | "deposit");
        let value = |cell: usize| match map[cell] {
            _ if bed.values[cell].is_nan() => f64::NAN,
            value if thickness && value < run.film => 0.0,
            value => value,
        };
        let path = folder.join(format!("{name}.tif"));
        Some(bed.write_values(&path, value).map(|()| path))
    };
    MAPS.par_iter().filter_map(write).collect()
}
