//! `rasters/*.tif`: the summary maps for a geographic information system.

use crate::model::{At, Kind, Quantity};
use crate::output::{settle, temporary};
use crate::raster::RasterError;
use crate::results::Finished;
use crate::results::format::Format;
use granflow_case::FileKind;
use rayon::prelude::*;
use std::path::PathBuf;

/// Rasters for a geographic information system.
pub(super) static GEOTIFF: Format = Format::of(
    FileKind { name: "geotiff", about: "Summary maps, rasters/*.tif (terrain).", needs_terrain: true },
    |work| Ok(write(work.run)?),
);

/// Write the maps of a run on a raster: nodata outside the elevation model, and where they have no value,
/// since nothing thicker than the threshold came.
fn write(run: &Finished) -> Result<Vec<PathBuf>, RasterError> {
    let Some(bed) = run.plane.domain.raster() else { return Ok(Vec::new()) };
    let folder = run.directory.join("rasters");
    std::fs::create_dir_all(&folder).map_err(|source| RasterError::Io { path: folder.clone(), source })?;
    let write = |quantity: &&Quantity| -> Option<Result<PathBuf, RasterError>> {
        let map = run.map(quantity.name)?;
        let value = |cell: usize| if bed.values[cell].is_nan() { f64::NAN } else { map[cell] };
        let (part, path) = (temporary(&folder, quantity.name), folder.join(format!("{}.tif", quantity.name)));
        let lasting = || -> Result<PathBuf, RasterError> {
            bed.write_values(&part, value)?;
            settle(&part, &path).map_err(|source| RasterError::Io { path: path.clone(), source })?;
            Ok(path)
        };
        Some(lasting())
    };
    let maps: Vec<_> = run.plane.model().of_kind(Kind::Map).filter(|map| map.at == At::Cells).collect();
    maps.par_iter().filter_map(write).collect()
}
