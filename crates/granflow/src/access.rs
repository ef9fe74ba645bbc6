//! How a case reaches the files that it names, and the kinds that it may ask for.

use crate::inputs::Inputs;
use granflow_case::{FileAccess, FileKind, Outline, on_disk};
#[cfg(feature = "geo")]
use granflow_geo::release::Outlines;
use std::io;
use std::path::Path;

/// What is in memory, else the disk.
pub(crate) struct Access<'a>(pub &'a Inputs);

impl FileAccess for Access<'_> {
    #[cfg(feature = "geo")]
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        let outlines = self.0.layer(path).and_then(Outlines::of).map_err(|error| error.to_string())?;
        Ok(Box::new(Polygons(outlines)))
    }

    #[cfg(feature = "geo")]
    fn numbers(&self, path: &Path, attribute: &str) -> Result<Vec<f64>, String> {
        let numbers = self.0.layer(path).and_then(|layer| layer.numbers(attribute));
        numbers.map_err(|error| error.to_string())
    }

    #[cfg(not(feature = "geo"))]
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        Err(format!("{}: polygons need granflow's feature `geo`", path.display()))
    }

    fn find(&self, path: &Path) -> io::Result<()> {
        if self.0.holds(path) { Ok(()) } else { on_disk(path) }
    }

    fn bytes(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.0.file(path).map_or_else(|| std::fs::read(path), |bytes| Ok(bytes.to_vec()))
    }

    fn kinds(&self) -> &'static [FileKind] {
        file_kinds()
    }
}

/// The kinds of files that a case may ask for.
#[cfg(feature = "files")]
#[must_use]
pub fn file_kinds() -> &'static [FileKind] {
    crate::results::formats::kinds()
}

/// The kinds of files that a case may ask for: none without the feature `files`.
#[cfg(not(feature = "files"))]
#[must_use]
pub fn file_kinds() -> &'static [FileKind] {
    &[]
}

/// The polygons of a file, as a case asks about them.
#[cfg(feature = "geo")]
#[derive(Debug)]
struct Polygons(Outlines);

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
