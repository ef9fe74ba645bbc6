//! `outlines.geojson`, where the model outlines anything.

use crate::output::outlines;
use crate::results::FilesError;
use crate::results::format::{Format, Work};
use granflow_case::FileKind;
use std::path::PathBuf;

/// Outlines for a geographic information system.
pub(super) static VECTOR: Format = Format::of(
    FileKind {
        name: "vector",
        about: "Outlines of the deposit, outlines.geojson (terrain).",
        needs_terrain: true,
    },
    write,
);

fn write(work: &Work) -> Result<Vec<PathBuf>, FilesError> {
    let run = work.run;
    let Some(raster) = run.plane.domain.raster() else { return Ok(Vec::new()) };
    let path = run.directory.join("outlines.geojson");
    let epsg = raster.crs.as_ref().and_then(|crs| crs.epsg);
    outlines::write(&path, &run.plane.domain.outlines(&run.maps), epsg)?;
    Ok(vec![path])
}
