//! What is drawn of an avalanche, by the place it flows on.

use super::{ChuteDomain, chute};
use crate::model::{Domain, Drawing, Instants, Pictures, ResultFile, Scene, View};
use crate::output::{self, style::Style};
use std::sync::Arc;

#[cfg(feature = "geo")]
use super::{maps, terrain::TerrainDomain};
#[cfg(feature = "geo")]
use crate::{
    raster::{Crs, Raster},
    release::Sparse,
    terrain::Curvature,
};

#[derive(Debug)]
pub(super) struct Avalanche;

impl Pictures for Avalanche {
    fn needed(&self) -> &'static [&'static str] {
        &["time", "x", "thickness"]
    }

    /// A chute, or the mountain where the file has a bed.
    fn domain(&self, file: &ResultFile, centres: [&[f64]; 2]) -> Result<Arc<dyn Domain>, String> {
        if file.has("bed") { terrain(file, centres) } else { Ok(Arc::new(ChuteDomain)) }
    }

    /// Those of a mountain show maps alone.
    fn shown(&self, domain: &dyn Domain, dimensions: usize) -> &'static [&'static str] {
        match (domain.get::<ChuteDomain>(), dimensions) {
            (None, _) => &[],
            (Some(_), 1) => &["thickness", "velocity_x"],
            (Some(_), _) => &["thickness"],
        }
    }

    fn figures<'a>(&self, view: &'a View<'a>, domain: &'a dyn Domain) -> Vec<Drawing<'a>> {
        #[cfg(feature = "geo")]
        if let Some(terrain) = domain.get::<TerrainDomain>() {
            return maps::figures(view, terrain);
        }
        let _ = domain;
        if view.dimensions() == 1 { chute::line(view) } else { chute::plane(view) }
    }

    /// On a mountain the line along which most of the mass went, on a chute its axis.
    fn path(&self, view: &View<'_>, domain: &dyn Domain) -> Option<Vec<[f64; 2]>> {
        #[cfg(feature = "geo")]
        if let Some(terrain) = domain.get::<TerrainDomain>() {
            return super::path::path(view, terrain).map(|path| path.points);
        }
        let _ = domain;
        let middle = |centres: &[f64]| Some(0.5 * (centres.first()? + centres.last()?));
        let y = middle(&view.y).unwrap_or(0.0);
        Some(vec![[*view.x.first()?, y], [*view.x.last()?, y]])
    }

    fn styles<'a>(
        &self,
        domain: &dyn Domain,
        map: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Vec<(&'static str, Style)> {
        #[cfg(feature = "geo")]
        if let Some(terrain) = domain.get::<TerrainDomain>() {
            return maps::styles(map, terrain);
        }
        let _ = (domain, map);
        Vec::new()
    }

    fn animated(&self) -> &'static [&'static str] {
        &["thickness"]
    }

    fn scene<'a>(
        &self,
        view: &'a View<'a>,
        domain: &'a dyn Domain,
        instants: &mut Instants<'_>,
    ) -> Result<Box<dyn Scene + 'a>, output::Error> {
        #[cfg(feature = "geo")]
        if let Some(terrain) = domain.get::<TerrainDomain>() {
            return maps::scene(view, terrain, instants);
        }
        let _ = (domain, instants);
        Ok(chute::scene(view))
    }
}

#[cfg(not(feature = "geo"))]
fn terrain(_file: &ResultFile, _centres: [&[f64]; 2]) -> Result<Arc<dyn Domain>, String> {
    Err("it has a bed, which this program draws only if it is built with the feature `geo`".to_owned())
}

#[cfg(feature = "geo")]
fn terrain(file: &ResultFile, centres: [&[f64]; 2]) -> Result<Arc<dyn Domain>, String> {
    Ok(Arc::new(TerrainDomain {
        raster: Arc::new(Raster { crs: crs(file), ..raster(centres, file.whole("bed")?)? }),
        release: Arc::new(Sparse::of(file.first("thickness", 2)?)),
        inlets: Arc::default(),
        density: f64::NAN,
        threshold: threshold(&file.text("threshold")),
        curvature: curvature(&file.text("curvature")),
        remarks: Vec::new(),
    }))
}

/// The threshold \[m\] of a file, from its attribute, as in "0.01 m"; the usual one where it has none.
#[cfg(feature = "geo")]
fn threshold(attribute: &str) -> f64 {
    let number = attribute.split_whitespace().next().and_then(|number| number.parse().ok());
    number.unwrap_or(granflow_case::terrain::THRESHOLD)
}

/// The coordinate reference system of a file.
#[cfg(feature = "geo")]
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
#[cfg(feature = "geo")]
fn curvature(attribute: &str) -> Curvature {
    let number = attribute.split_whitespace().next().and_then(|number| number.parse().ok());
    match (attribute, number) {
        ("off", _) => Curvature::Off,
        (_, length) => Curvature::Length(length.unwrap_or(granflow_case::terrain::CURVATURE)),
    }
}

/// The bed on the cells with these centres.
#[cfg(feature = "geo")]
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
