//! `rasters/*.tif`: the summary maps for a geographic information system.

use crate::model::{At, Kind, Quantity};
use crate::output::rasters;
#[cfg(feature = "figures")]
use crate::output::style::Style;
use crate::results::FilesError;
#[cfg(feature = "figures")]
use crate::results::Finished;
use crate::results::format::{Format, Work};
use granflow_case::FileKind;
use rayon::prelude::*;
use std::path::PathBuf;

/// Rasters for a geographic information system.
pub(super) static GEOTIFF: Format = Format::of(
    FileKind { name: "geotiff", about: "Summary maps, rasters/*.tif (terrain).", needs_terrain: true },
    write,
);

/// Write the maps of a run on a raster: nodata outside the elevation model, and where they have no value,
/// since nothing thicker than the threshold came. Beside each stands the style of its figure.
fn write(work: &Work) -> Result<Vec<PathBuf>, FilesError> {
    let run = work.run;
    let Some(bed) = run.plane.domain.raster() else { return Ok(Vec::new()) };
    let folder = run.directory.join("rasters");
    let write = |quantity: &&Quantity| -> Option<Result<PathBuf, FilesError>> {
        let map = run.map(quantity.name)?;
        Some(rasters::write(&folder, quantity.name, bed, map).map_err(FilesError::from))
    };
    rasters::make(&folder)?;
    let maps: Vec<_> = run.plane.model().of_kind(Kind::Map).filter(|map| map.at == At::Cells).collect();
    let written: Vec<PathBuf> = maps.par_iter().filter_map(write).collect::<Result<_, _>>()?;
    #[cfg(feature = "figures")]
    for (name, style) in styles(run) {
        rasters::write_style(&folder, name, &style)?;
    }
    Ok(written)
}

/// The colours of the figures of a run, by the names of the maps.
#[cfg(feature = "figures")]
fn styles(run: &Finished) -> Vec<(&'static str, Style)> {
    let Some(pictures) = run.plane.model().pictures else { return Vec::new() };
    pictures.styles(&*run.plane.domain, &|name| run.map(name))
}
