//! A mountain, and what lies on it, as a `result.nc` has them.

use super::ended::{self, Ended};
use super::terrain::TerrainDomain;
use crate::model::ResultFile;
use crate::raster::{Crs, Raster};
use crate::release::Sparse;
use crate::terrain::{Curvature, Terrain};
use std::path::Path;
use std::sync::Arc;

/// The mountain of a file with these cell centres.
pub(super) fn domain(file: &ResultFile, centres: [&[f64]; 2]) -> Result<TerrainDomain, String> {
    Ok(TerrainDomain {
        raster: Arc::new(Raster { crs: crs(file), ..raster(centres, file.whole("bed")?)? }),
        release: Arc::new(Sparse::of(file.first("thickness", 2)?)),
        inlets: Arc::default(),
        density: f64::NAN,
        threshold: threshold(&file.text("threshold")),
        curvature: curvature(&file.text("curvature")),
        remarks: Vec::new(),
    })
}

/// What lies on a mountain at the end of a run.
pub(super) struct Last {
    /// Volume per plan area \[m\].
    pub volume: Raster,
    /// The instant \[s\].
    pub time: f64,
    /// It had come to rest.
    pub rests: bool,
}

/// The last state in the `result.nc` of a run on a mountain.
pub(super) fn last(path: &Path) -> Result<Last, String> {
    let Ended { file, instant, time, rests } = ended::open(path, true)?;
    let (x, y) = (file.whole("x")?, file.whole("y")?);
    let domain = domain(&file, [&x, &y])?;
    let thickness = file.instant("thickness", instant, 2)?;
    let terrain = Terrain::new((*domain.raster).clone(), domain.curvature);
    let mut values = thickness;
    for (cell, value) in values.iter_mut().enumerate().filter(|(_, value)| **value > 0.0) {
        // The run that wrote it kept its cosines in single precision.
        *value /= f64::from(terrain.fit(domain.raster.place(cell)).cosine() as f32);
    }
    let volume = Raster { crs: domain.raster.crs.clone(), ..domain.raster.with_values(values) };
    Ok(Last { volume, time, rests })
}

/// The threshold \[m\] of a file, from its attribute, as in "0.01 m"; the usual one where it has none.
fn threshold(attribute: &str) -> f64 {
    let number = attribute.split_whitespace().next().and_then(|number| number.parse().ok());
    number.unwrap_or(granflow_case::terrain::THRESHOLD)
}

/// The coordinate reference system of a file.
fn crs(file: &ResultFile) -> Option<Crs> {
    let text = |name: &str| Some(file.attribute("crs", name)).filter(|text| !text.is_empty());
    let crs = |text: String| Crs::parse(&text).ok();
    let code = text("epsg_code").and_then(crs);
    let known = text("crs_wkt").and_then(crs);
    match (code, known) {
        (Some(code), Some(known)) => Some(Crs { epsg: code.epsg, ..known }),
        (code, known) => code.or(known),
    }
}

/// The length over which the slope of the bed is taken, from its attribute, as in "20 m" or "off"; the usual one where a file
/// has none.
fn curvature(attribute: &str) -> Curvature {
    let number = attribute.split_whitespace().next().and_then(|number| number.parse().ok());
    match (attribute, number) {
        ("off", _) => Curvature::Off,
        (_, length) => Curvature::Length(length.unwrap_or(granflow_case::terrain::CURVATURE)),
    }
}

/// The bed on the cells with these centres.
fn raster([x, y]: [&[f64]; 2], values: Vec<f64>) -> Result<Raster, String> {
    let [Some(cell), Some(rows)] = [x, y].map(|c| c.get(1).map(|second| second - c[0])) else {
        return Err("its bed has fewer than two cells along an axis".to_owned());
    };
    if values.len() != x.len() * y.len() || cell <= 0.0 || rows <= 0.0 {
        return Err("its bed does not fit its coordinates".to_owned());
    }
    Ok(Raster {
        columns: x.len(),
        rows: y.len(),
        west: x[0] - 0.5 * cell,
        south: y[0] - 0.5 * cell,
        cell,
        values,
        crs: None,
    })
}
