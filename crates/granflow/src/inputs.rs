//! What a case names: from memory, else from the disk.

#[cfg(feature = "geo")]
use granflow_geo::Remark;
#[cfg(feature = "geo")]
use granflow_geo::raster::{Crs, Raster, RasterError, Reading};
#[cfg(feature = "geo")]
use granflow_geo::release::{Layer, ReleaseError};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Files and rasters in memory that a case may name; every other name is a file on the disk.
///
/// A case finds them by the last part of a path. Names such as `<terrain.dem>` are no files anywhere, and tell in messages what
/// is meant.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    files: BTreeMap<String, Arc<[u8]>>,
    #[cfg(feature = "geo")]
    rasters: BTreeMap<String, Arc<Raster>>,
}

/// What is kept under the last part of a path.
fn kept<'a, T>(all: &'a BTreeMap<String, Arc<T>>, path: &Path) -> Option<&'a Arc<T>>
where
    T: ?Sized,
{
    all.get(path.file_name()?.to_str()?)
}

impl Inputs {
    /// The same with the content of a file.
    #[must_use]
    pub fn with_file(mut self, name: &str, bytes: impl Into<Arc<[u8]>>) -> Self {
        self.files.insert(name.to_owned(), bytes.into());
        self
    }

    /// The same with a raster.
    #[cfg(feature = "geo")]
    #[must_use]
    pub fn with_raster(mut self, name: &str, raster: impl Into<Arc<Raster>>) -> Self {
        self.rasters.insert(name.to_owned(), raster.into());
        self
    }

    /// A raster by its name.
    #[cfg(feature = "geo")]
    #[must_use]
    pub fn raster(&self, name: &str) -> Option<&Raster> {
        self.rasters.get(name).map(|raster| &**raster)
    }

    /// What tells a file or raster in memory from another: its length in bytes and their checksum.
    #[cfg(feature = "files")]
    pub(crate) fn fingerprint(&self, path: &Path) -> Option<(u64, u32)> {
        if let Some(bytes) = kept(&self.files, path) {
            return Some((bytes.len() as u64, crc32fast::hash(bytes)));
        }
        self.fingerprint_of_raster(path)
    }

    #[cfg(all(feature = "files", feature = "geo"))]
    fn fingerprint_of_raster(&self, path: &Path) -> Option<(u64, u32)> {
        let Raster { columns, rows, west, south, cell, values, crs } = &**kept(&self.rasters, path)?;
        let mut sum = crc32fast::Hasher::new();
        sum.update(format!("{columns} {rows} {west:?} {south:?} {cell:?} {crs:?}").as_bytes());
        values.iter().for_each(|value| sum.update(&value.to_le_bytes()));
        Some((size_of_val(values.as_slice()) as u64, sum.finalize()))
    }

    #[cfg(all(feature = "files", not(feature = "geo")))]
    fn fingerprint_of_raster(&self, _path: &Path) -> Option<(u64, u32)> {
        None
    }

    /// The content of a file in memory.
    pub(crate) fn file(&self, path: &Path) -> Option<&[u8]> {
        kept(&self.files, path).map(|bytes| &**bytes)
    }

    pub(crate) fn holds(&self, path: &Path) -> bool {
        #[cfg(feature = "geo")]
        if kept(&self.rasters, path).is_some() {
            return true;
        }
        kept(&self.files, path).is_some()
    }
}

#[cfg(feature = "geo")]
impl Inputs {
    /// A raster of thicknesses on a terrain.
    pub(crate) fn thickness(&self, path: &Path, crs: Option<&Crs>) -> Result<Reading, RasterError> {
        match kept(&self.rasters, path) {
            Some(raster) => Reading::of_memory(path, raster.clone(), crs, true),
            None => Reading::on_terrain(path, crs),
        }
    }

    /// A raster of heights.
    pub(crate) fn heights(&self, path: &Path, crs: Option<&Crs>) -> Result<Reading, RasterError> {
        match kept(&self.rasters, path) {
            Some(raster) => Reading::of_memory(path, raster.clone(), crs, true),
            None => Reading::of(path, crs),
        }
    }

    /// A raster of plain numbers.
    pub(crate) fn numbers(&self, path: &Path, crs: Option<&Crs>) -> Result<Reading, RasterError> {
        match kept(&self.rasters, path) {
            Some(raster) => Reading::of_memory(path, raster.clone(), crs, false),
            None => Reading::of_numbers(path, crs),
        }
    }

    /// The points of a line, in the system of `terrain`.
    pub(crate) fn line(
        &self,
        path: &Path,
        terrain: Option<&Raster>,
    ) -> Result<(Vec<[f64; 2]>, Vec<Remark>), ReleaseError> {
        match kept(&self.files, path) {
            Some(bytes) => granflow_geo::line_from(path, bytes, terrain),
            None => granflow_geo::line(path, terrain),
        }
    }

    /// Polygons.
    pub(crate) fn layer(&self, path: &Path) -> Result<Layer, ReleaseError> {
        match kept(&self.files, path) {
            Some(bytes) => Layer::from_bytes(path, bytes, None, None),
            None => Layer::read(path),
        }
    }
}
