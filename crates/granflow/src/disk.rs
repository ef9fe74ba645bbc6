//! The files that a case names, read from the disk, and the kinds that it may ask for.

use granflow_case::{FileAccess, FileKind, Outline};
use std::path::Path;

/// The disk: polygons are read as GeoJSON or shapefiles.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl FileAccess for Disk {
    #[cfg(feature = "geo")]
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        let outlines = granflow_geo::release::Outlines::read(path).map_err(|error| error.to_string())?;
        Ok(Box::new(Polygons(outlines)))
    }

    #[cfg(feature = "geo")]
    fn numbers(&self, path: &Path, attribute: &str) -> Result<Vec<f64>, String> {
        let numbers = granflow_geo::release::Layer::read(path).and_then(|layer| layer.numbers(attribute));
        numbers.map_err(|error| error.to_string())
    }

    #[cfg(not(feature = "geo"))]
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        Err(format!("{}: polygons need granflow's feature `geo`", path.display()))
    }

    #[cfg(feature = "files")]
    fn kinds(&self) -> &'static [FileKind] {
        crate::results::formats::kinds()
    }

    #[cfg(not(feature = "files"))]
    fn kinds(&self) -> &'static [FileKind] {
        &[]
    }
}

/// The polygons of a file, as a case asks about them.
#[cfg(feature = "geo")]
#[derive(Debug)]
struct Polygons(granflow_geo::release::Outlines);

#[cfg(feature = "geo")]
impl Outline for Polygons {
    fn holds(&self, place: [f64; 2]) -> bool {
        self.0.holds(place)
    }

    fn depth(&self, place: [f64; 2]) -> f64 {
        self.0.depth(place)
    }

    fn bounds(&self) -> [[f64; 2]; 2] {
        self.0.bounds()
    }
}
