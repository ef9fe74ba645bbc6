//! `outlines.geojson`: release, deposit, and all that was reached.

use super::Finished;
use super::path::REACHED;
use crate::output;
use crate::output::outlines::{self, Lattice, Outline, contour};
use crate::raster::Raster;
use geo::{Area, MultiPolygon};
use std::path::PathBuf;

/// The centres of a raster's cells.
pub(super) fn lattice(raster: &Raster) -> Lattice {
    Lattice { columns: raster.columns, x: raster.x(0), y: raster.y(0), dx: raster.cell, dy: raster.cell }
}

/// The thickness whose outline is that of the release: that of the other outlines, less where all is thinner.
pub(super) fn release_threshold(release: &[f64]) -> f64 {
    let most = release.iter().fold(0.0_f64, |most, v| most.max(*v));
    if most > 0.0 { REACHED.min(0.5 * most) } else { REACHED }
}

/// The outer rings that enclose more than `least` square metres.
pub(super) fn rings(area: &MultiPolygon<f64>, least: f64) -> Vec<Vec<[f64; 2]>> {
    let large = area.iter().filter(|polygon| polygon.unsigned_area() > least);
    large.map(|polygon| polygon.exterior().coords().map(|c| [c.x, c.y]).collect()).collect()
}

/// Write `outlines.geojson` of a run on a mountain.
pub(super) fn write(run: &Finished) -> Result<Option<PathBuf>, output::Error> {
    let Some(raster) = run.plane.mountain() else { return Ok(None) };
    let release = Some(("release", run.plane.release.as_slice(), release_threshold(&run.plane.release)));
    let others = ["deposit", "peak_thickness"].map(|name| Some((name, run.map(name)?, REACHED)));
    let outline = |(name, map, threshold): (&str, &[f64], f64)| Outline {
        name: name.to_owned(),
        threshold,
        unit: "m".to_owned(),
        area: contour(map, lattice(raster), threshold),
    };
    let all: Vec<Outline> = [release].into_iter().chain(others).flatten().map(outline).collect();
    let path = run.directory.join("outlines.geojson");
    outlines::write(&path, &all, raster.crs.as_ref().and_then(|crs| crs.epsg))?;
    Ok(Some(path))
}
