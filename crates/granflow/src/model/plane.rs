//! Where a run took place: its cells, and what lies under them.

#[cfg(feature = "files")]
use super::domain::Maps;
use super::domain::{Domain, Model};
use super::quantity::{At, Kind};
use crate::field::Field;
use crate::grid::Grid;
#[cfg(feature = "files")]
use crate::output::summary::Summary;
use std::sync::Arc;

/// Where the cells are, and what lies under them.
#[derive(Debug, Clone)]
pub struct Plane {
    /// Cell centres along x.
    pub x: Vec<f64>,
    /// Cell centres along y; empty in one dimension.
    pub y: Vec<f64>,
    /// What lies under the cells, and with it the model.
    pub domain: Arc<dyn Domain>,
}

impl Plane {
    /// The cells of a grid, with what lies under them.
    #[must_use]
    pub fn of<const D: usize>(grid: &Grid<D>, domain: Arc<dyn Domain>) -> Plane {
        let centres = |axis: usize| {
            let along = |i: usize| grid.centre([i; D])[axis];
            (0..grid.cells[axis]).map(along).collect::<Vec<f64>>()
        };
        Plane { x: centres(0), y: if D > 1 { centres(1) } else { Vec::new() }, domain }
    }

    /// The same plane with the elevation of its cells, where the domain does not keep it while a run computes.
    #[must_use]
    pub fn with_bed(mut self, elevation: impl Fn() -> Vec<f64>) -> Plane {
        if let Some(domain) = self.domain.with_bed(&elevation) {
            self.domain = domain;
        }
        self
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &'static Model {
        self.domain.model()
    }

    /// 1 or 2.
    #[must_use]
    pub fn dimensions(&self) -> usize {
        if self.y.is_empty() { 1 } else { 2 }
    }

    /// Number of cells.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.x.len() * self.y.len().max(1)
    }

    /// How many values a quantity has there; 0 where there are no nodes.
    #[must_use]
    pub fn length(&self, at: At) -> usize {
        let [x, y] = self.domain.nodes().unwrap_or_default();
        match at {
            At::Cells => self.cells(),
            At::Nodes => x.len() * y.len().max(1),
            At::FacesX => x.len() * self.y.len().max(1),
            At::FacesY => self.x.len() * y.len(),
        }
    }

    /// The quantities that are kept as series, in the order of the frames.
    #[must_use]
    pub fn series(&self) -> Vec<Field> {
        let series = self.model().of_kind(Kind::Series);
        let kept = series.filter(|series| self.domain.keeps(series, self.dimensions()));
        kept.map(|series| Field { name: series.name.to_owned(), length: self.length(series.at) }).collect()
    }

    /// Where mass can leave, in the order of the ledger: over the four sides, and inside the grid.
    #[must_use]
    pub fn outlets(&self) -> [&'static str; 5] {
        self.model().outlets
    }

    #[cfg(feature = "files")]
    /// Add the maps and the numbers of the summary that follow from the maps of a run.
    pub fn derive(&self, maps: &mut Maps, summary: &mut Summary) {
        self.domain.derive([&self.x, &self.y], maps, summary);
        let wanted = |name: &str| self.model().quantity(name).is_some_and(|quantity| quantity.maximum);
        for (name, values) in maps.iter().filter(|(name, _)| wanted(name)) {
            let largest = values.iter().fold(0.0_f64, |largest, v| largest.max(*v));
            summary.add(&format!("{name}_max"), largest);
        }
    }
}
