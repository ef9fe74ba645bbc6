//! The files that a case names, read from the disk.

use crate::case::{Files, Outline};
use crate::release::Outlines;
use std::path::Path;

/// The disk: polygons are read as GeoJSON or shapefiles.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl Files for Disk {
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        let outlines = Outlines::read(path).map_err(|error| error.to_string())?;
        Ok(Box::new(Polygons(outlines)))
    }
}

/// The polygons of a file, as a case asks about them.
#[derive(Debug)]
struct Polygons(Outlines);

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
