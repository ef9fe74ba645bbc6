//! `outlines.geojson`: release, deposit, and all that was reached.

use super::Finished;
use super::path::REACHED;
use crate::output;
use crate::output::outlines::{self, Lattice, Outline, contour};
use crate::raster::Raster;
use crate::release::Sparse;
use geo::{Area, MultiPolygon};
use std::path::PathBuf;

/// The centres of a raster's cells.
pub(super) fn lattice(raster: &Raster) -> Lattice {
    Lattice { columns: raster.columns, x: raster.x(0), y: raster.y(0), dx: raster.cell, dy: raster.cell }
}

/// The thickness whose outline is that of the release: that of the other outlines, less where all is thinner.
pub(super) fn release_threshold(release: &Sparse) -> f64 {
    let most = release.most();
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
    let release = &run.plane.release;
    let outline = |name: &str, map: &[f64], threshold: f64| Outline {
        name: name.to_owned(),
        threshold,
        unit: "m".to_owned(),
        area: contour(map, lattice(raster), threshold),
    };
    let mut all = vec![outline("release", &release.dense(raster.values.len()), release_threshold(release))];
    for name in ["deposit", "peak_thickness"] {
        all.extend(run.map(name).map(|map| outline(name, map, REACHED)));
    }
    let path = run.directory.join("outlines.geojson");
    outlines::write(&path, &all, raster.crs.as_ref().and_then(|crs| crs.epsg))?;
    Ok(Some(path))
}
