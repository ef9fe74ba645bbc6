//! What is drawn of an avalanche, by the place it flows on.

use super::{ChuteDomain, chute};
use crate::model::{Domain, Drawing, Instants, Pictures, ResultFile, Scene, View};
use crate::output::{self, style::Style};
use std::sync::Arc;

#[cfg(feature = "geo")]
use super::{maps, terrain::TerrainDomain};

#[derive(Debug)]
pub(super) struct Avalanche;

impl Pictures for Avalanche {
    fn needed(&self) -> &'static [&'static str] {
        &["time", "x", "thickness"]
    }

    /// A chute, or the mountain where the file has a bed.
    fn domain(&self, file: &ResultFile, centres: [&[f64]; 2]) -> Result<Arc<dyn Domain>, String> {
        if file.has("bed") { terrain(file, centres) } else { Ok(Arc::new(ChuteDomain::default())) }
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
    Ok(Arc::new(super::stored::domain(file, centres)?))
}
