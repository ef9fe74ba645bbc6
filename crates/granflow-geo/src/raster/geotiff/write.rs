//! Writing GeoTIFF by the `geotiff-writer` crate.

use super::keys::{CITATION, EMBEDDED, PROJECTED_CITATION, PROJECTED_SYSTEM, USER_DEFINED};
use crate::raster::{Crs, Raster, RasterError};
use geotiff_writer::{Compression, GeoKeyValue, GeoTiffBuilder, GeoTransform, ModelType, Predictor};
use ndarray::Array2;
use std::path::Path;

/// What nodata is written as.
const NODATA: f32 = -9999.0;

impl Raster {
    /// Writes a GeoTIFF of 32-bit floats, north up, deflated, nodata -9999, with the CRS; the file appears whole.
    ///
    /// A CRS that has only a WKT definition is embedded the way ESRI and GDAL do, which QGIS and rasterio read.
    ///
    /// # Errors
    /// [`RasterError::Write`].
    pub fn write_geotiff(&self, path: &Path) -> Result<(), RasterError> {
        self.write_values(path, |cell| self.values[cell])
    }

    /// As [`Raster::write_geotiff`], with another value in each of its cells.
    ///
    /// # Errors
    /// [`RasterError::Write`].
    pub fn write_values(&self, path: &Path, value: impl Fn(usize) -> f64) -> Result<(), RasterError> {
        let error = |reason: String| RasterError::Write { path: path.into(), reason };
        let stored = |k: usize| {
            let (row, column) = (self.rows - 1 - k / self.columns, k % self.columns);
            let value = value(row * self.columns + column);
            if value.is_nan() { NODATA } else { value as f32 }
        };
        let values = (0..self.rows * self.columns).map(stored).collect();
        let image =
            Array2::from_shape_vec((self.rows, self.columns), values).map_err(|e| error(e.to_string()))?;
        let [columns, rows] = [self.columns, self.rows].map(u32::try_from);
        let (Ok(columns), Ok(rows)) = (columns, rows) else {
            return Err(error(format!("{} by {} cells are more than a TIFF holds", self.columns, self.rows)));
        };
        let place = GeoTransform::from_origin_and_pixel_size(self.west, self.north(), self.cell, -self.cell);
        let builder = GeoTiffBuilder::new(columns, rows)
            .transform(place)
            .nodata(&NODATA.to_string())
            .compression(Compression::Deflate)
            .predictor(Predictor::FloatingPoint);
        let builder = with_system(builder, self.crs.as_ref()).map_err(error)?;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut file = temporary_in(folder).map_err(|e| error(e.to_string()))?;
        builder.write_2d_to(file.as_file_mut(), image.view()).map_err(|e| error(e.to_string()))?;
        file.persist(path).map_err(|e| error(e.to_string()))?;
        Ok(())
    }
}

/// A file that all may read who may read others of this user.
#[cfg(unix)]
fn temporary_in(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let all = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    tempfile::Builder::new().permissions(all).tempfile_in(folder)
}

#[cfg(not(unix))]
fn temporary_in(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    tempfile::NamedTempFile::new_in(folder)
}

fn with_system(builder: GeoTiffBuilder, crs: Option<&Crs>) -> Result<GeoTiffBuilder, String> {
    match crs {
        None => Ok(builder),
        Some(Crs { epsg: Some(code), .. }) => {
            let code = u16::try_from(*code).map_err(|_| format!("EPSG:{code} does not fit a GeoTIFF key"))?;
            Ok(builder.projected_epsg(code))
        }
        Some(crs @ Crs { wkt, .. }) => {
            let plain = |text: &str| -> String {
                let keep = |c: char| c.is_ascii_graphic() && c != '|' || c == ' ';
                text.split_whitespace().collect::<Vec<_>>().join(" ").replace(|c| !keep(c), "_")
            };
            let definition = format!("{EMBEDDED}{}", plain(wkt.as_deref().unwrap_or_default()));
            Ok(builder
                .model_type(ModelType::Unknown(USER_DEFINED))
                .geokey(CITATION, GeoKeyValue::Ascii(plain(&crs.to_string())))
                .geokey(PROJECTED_SYSTEM, GeoKeyValue::Short(USER_DEFINED))
                .geokey(PROJECTED_CITATION, GeoKeyValue::Ascii(definition)))
        }
    }
}
