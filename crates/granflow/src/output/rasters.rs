//! Maps as GeoTIFF, and the styles in which QGIS opens them.

#[cfg(feature = "figures")]
use super::Error;
use super::{settle, temporary};
#[cfg(feature = "figures")]
use super::{style::Style, whole_file};
use crate::raster::{Raster, RasterError};
use std::fs;
use std::path::{Path, PathBuf};

/// Makes a folder for rasters.
pub(crate) fn make(folder: &Path) -> Result<(), RasterError> {
    fs::create_dir_all(folder).map_err(|source| RasterError::Io { path: folder.to_owned(), source })
}

/// Writes a map as `NAME.tif`, nodata where it has no value and outside the elevation model `bed`.
pub(crate) fn write(folder: &Path, name: &str, bed: &Raster, map: &[f64]) -> Result<PathBuf, RasterError> {
    let value = |cell: usize| if bed.values[cell].is_nan() { f64::NAN } else { map[cell] };
    let (part, path) = (temporary(folder, name), folder.join(format!("{name}.tif")));
    bed.write_values(&part, value)?;
    settle(&part, &path).map_err(|source| RasterError::Io { path: path.clone(), source })?;
    Ok(path)
}

/// Writes the style of a map as `NAME.qml`, which QGIS takes for `NAME.tif` by itself.
#[cfg(feature = "figures")]
pub(crate) fn write_style(folder: &Path, name: &str, style: &Style) -> Result<PathBuf, Error> {
    let path = folder.join(format!("{name}.qml"));
    whole_file(&path, |out| out.write_all(style.qml().as_bytes()))?;
    Ok(path)
}
