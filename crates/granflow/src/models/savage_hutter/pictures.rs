//! What is drawn of an avalanche, by the place it flows on.

use super::{ChuteDomain, chute};
use crate::model::{Domain, Drawing, Instants, Pictures, ResultFile, Scene, View};
use crate::output;
use std::sync::Arc;

#[cfg(feature = "geo")]
use super::{maps, terrain::TerrainDomain};
#[cfg(feature = "geo")]
use crate::{raster::Raster, release::Sparse};

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
        raster: Arc::new(raster(centres, file.whole("bed")?)?),
        release: Arc::new(Sparse::of(file.first("thickness", 2)?)),
        density: f64::NAN,
        threshold: threshold(&file.text("threshold")),
        remarks: Vec::new(),
    }))
}

/// The threshold \[m\] of a file, from its attribute, as in "0.01 m"; the usual one where it has none.
#[cfg(feature = "geo")]
fn threshold(attribute: &str) -> f64 {
    let number = attribute.split_whitespace().next().and_then(|number| number.parse().ok());
    number.unwrap_or(granflow_case::terrain::THRESHOLD)
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
