//! GeoTIFF through the `geotiff-reader` and `geotiff-writer` crates.

use super::{Crs, Raster, RasterError, agreed, turn};
use geotiff_reader::GeoTiffFile;
use geotiff_writer::{Compression, GeoKeyValue, GeoTiffBuilder, GeoTransform, ModelType, Predictor};
use ndarray::Array2;
use std::path::Path;

/// What nodata is written as.
const NODATA: f32 = -9999.0;
/// GeoKeys by number (OGC GeoTIFF 1.1, annex B).
const CITATION: u16 = 1026;
const PROJECTED_SYSTEM: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;
const LINEAR_UNIT: u16 = 3076;
/// A GeoKey value that stands for "defined by other keys".
const USER_DEFINED: u16 = 32767;
/// How ESRI and GDAL store a definition in a citation.
const EMBEDDED: &str = "ESRI PE String = ";
/// TIFF tag of GDAL's metadata, where scale and offset of the values stand.
const METADATA_TAG: u16 = 42112;

/// Reads a file piece by piece.
pub(super) fn read(path: &Path, given: Option<&Crs>) -> Result<Raster, RasterError> {
    decoded(path, GeoTiffFile::open(path), given)
}

/// Reads what a file called `name` holds.
pub(super) fn from_bytes(name: &Path, bytes: Vec<u8>, given: Option<&Crs>) -> Result<Raster, RasterError> {
    decoded(name, GeoTiffFile::from_bytes(bytes), given)
}

fn decoded(
    path: &Path,
    file: Result<GeoTiffFile, geotiff_reader::Error>,
    given: Option<&Crs>,
) -> Result<Raster, RasterError> {
    let error = |problem: &dyn std::fmt::Display| RasterError::geotiff(path, problem);
    let file = file.map_err(|e| match e {
        geotiff_reader::Error::NotGeoTiff => error(&unplaced(path)),
        e => error(&format!("the GeoTIFF cannot be read: {e}")),
    })?;
    if file.band_count() != 1 {
        let cure = format!("gdal_translate -b 1 {0} band.tif", path.display());
        return Err(error(&format!(
            "{} bands, elevation is one; choose it with\n  {cure}",
            file.band_count()
        )));
    }
    let at = file.transform().ok_or_else(|| error(&unplaced(path)))?;
    if at.skew_x != 0.0 || at.skew_y != 0.0 || at.pixel_width <= 0.0 || at.pixel_height == 0.0 {
        let cure = format!(
            "gdalwarp -r bilinear {0} {1}_straight.tif",
            path.display(),
            path.with_extension("").display()
        );
        return Err(error(&format!(
            "its rows do not run from west to east (rotated or mirrored); straighten it with\n  {cure}"
        )));
    }
    let (cell, height) = (at.pixel_width, at.pixel_height.abs());
    let (columns, rows) = (file.width() as usize, file.height() as usize);
    let north_up = at.pixel_height < 0.0;
    let south = if north_up { at.origin_y - rows as f64 * height } else { at.origin_y };
    let crs = system(path, &file, given)?;
    let mut values = samples(path, &file)?;
    if values.len() != columns * rows {
        return Err(error(&format!("{} values for {rows} rows of {columns}", values.len())));
    }
    if north_up {
        turn(&mut values, columns);
    }
    let raster = Raster { columns, rows, west: at.origin_x, south, cell, values, crs };
    if file.crs().model_type_enum() == ModelType::Geographic {
        return Err(RasterError::geographic(path, &raster));
    }
    if (cell - height).abs() > 1e-6 * cell {
        return Err(RasterError::NotSquare { path: path.into(), width: cell, height });
    }
    Ok(raster)
}

fn unplaced(path: &Path) -> String {
    let (path, stem) = (path.display(), path.with_extension("").display().to_string());
    format!(
        "a TIFF without position; if a world file (.tfw) lies beside it, write that into it with\n  \
         gdal_translate -a_srs EPSG:xxxx {path} {stem}_placed.tif"
    )
}

/// The file's CRS: a registered code, a definition embedded in a citation, or none.
fn system(path: &Path, file: &GeoTiffFile, given: Option<&Crs>) -> Result<Option<Crs>, RasterError> {
    let keys = file.geokeys();
    let citation = [PROJECTED_CITATION, CITATION].into_iter().filter_map(|key| keys.get_ascii(key));
    let embedded =
        citation.filter_map(|text| text.split_once(EMBEDDED)).find_map(|(_, wkt)| Crs::parse(wkt).ok());
    let coded = file.epsg().map(|code| Crs { epsg: Some(code), wkt: None });
    let foot = match keys.get_short(LINEAR_UNIT) {
        Some(9002) => Some(0.3048),
        Some(9003) => Some(1200.0 / 3937.0),
        _ => None,
    };
    if let (Some(metres), Some(transform)) = (foot, file.transform()) {
        return Err(RasterError::unit(path, metres, transform.pixel_width));
    }
    let own = embedded.or(coded);
    if own.is_none() && given.is_none() && file.crs().model_type_enum() == ModelType::Projected {
        return Err(RasterError::geotiff(
            path,
            format!(
                "its coordinate reference system is described by parameters without an EPSG code; name it by \
                 crs = \"EPSG:xxxx\" in the case, or in the file with\n  gdal_edit.py -a_srs EPSG:xxxx {}",
                path.display()
            ),
        ));
    }
    agreed(path, own, given)
}

/// All values, first row first as stored, nodata as NaN.
fn samples(path: &Path, file: &GeoTiffFile) -> Result<Vec<f64>, RasterError> {
    let error = |problem: String| RasterError::geotiff(path, problem);
    let ifd = file.tiff().ifd(file.base_ifd_index()).map_err(|e| error(e.to_string()))?;
    let metadata = ifd.tag(METADATA_TAG).and_then(|tag| tag.value.as_str()).unwrap_or_default();
    if metadata.contains("role=\"scale\"") || metadata.contains("role=\"offset\"") {
        let cure = format!("gdal_translate -unscale -ot Float32 {0} metres.tif", path.display());
        return Err(error(format!(
            "its values are stored with a scale and an offset; apply them with\n  {cure}"
        )));
    }
    let layout = ifd.raster_layout().map_err(|e| error(e.to_string()))?;
    macro_rules! read {
        ($($format:literal, $bits:pat => $sample:ty;)*) => {
            match (layout.sample_format, layout.bits_per_sample) {
                $(($format, $bits) => file
                    .read_band::<$sample>(0)
                    .map(|band| band.into_iter().map(|value| value as f64).collect::<Vec<f64>>()),)*
                (format, bits) => {
                    let cure = format!("gdal_translate -ot Float32 {} float.tif", path.display());
                    return Err(error(format!("samples of format {format} with {bits} bits; convert with\n  {cure}")));
                }
            }
        };
    }
    let values = read! {
        1, 1..=8 => u8; 1, 9..=16 => u16; 1, 32 => u32; 1, 64 => u64;
        2, 8 => i8; 2, 16 => i16; 2, 32 => i32; 2, 64 => i64;
        3, 32 => f32; 3, 64 => f64;
    };
    let mut values = values.map_err(|e| {
        let cure = format!("gdal_translate -co COMPRESS=DEFLATE {} plain.tif", path.display());
        error(format!("the values cannot be read: {e}; if other programs can, convert it with\n  {cure}"))
    })?;
    let nodata: Option<f64> = file.nodata().and_then(|text| text.trim_matches(['\0', ' ']).parse().ok());
    for value in &mut values {
        let missing = nodata.is_some_and(|nodata| (*value - nodata).abs() <= 1e-7 * nodata.abs());
        if missing || !value.is_finite() {
            *value = f64::NAN;
        }
    }
    Ok(values)
}

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
        let mut options = tempfile::Builder::new();
        #[cfg(unix)]
        options.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = options.tempfile_in(folder).map_err(|e| error(e.to_string()))?;
        builder.write_2d_to(file.as_file_mut(), image.view()).map_err(|e| error(e.to_string()))?;
        file.persist(path).map_err(|e| error(e.to_string()))?;
        Ok(())
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::sampled;
    use geotiff_writer::WriteSample;

    fn hill() -> Raster {
        let hill = sampled(7, 5, |x, y| if x > 6.0 && y < 1.0 { f64::NAN } else { 100.0 + x * x - 3.0 * y });
        Raster { west: 176_973.437_998_359_2, south: 376_237.836, cell: 4.997_688_906_601, ..hill }
    }

    fn written<T: WriteSample + geotiff_writer::NumericSample>(
        build: impl Fn(GeoTiffBuilder) -> GeoTiffBuilder,
        sample: impl Fn(f64) -> T,
    ) -> Result<Raster, RasterError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dem.tif");
        let image = Array2::from_shape_fn((2, 3), |(row, column)| sample((10 * row + column) as f64));
        let place = GeoTransform::from_origin_and_pixel_size(500.0, 900.0, 2.0, -2.0);
        build(GeoTiffBuilder::new(3, 2).transform(place)).write_2d(&path, image.view()).unwrap();
        Raster::read(&path)
    }

    fn refused(build: impl Fn(GeoTiffBuilder) -> GeoTiffBuilder) -> String {
        written(build, |v| v as f32).unwrap_err().to_string()
    }

    #[test]
    fn what_is_written_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hill.tif");
        let definition = "PROJCS[\"Höhe | Lambert\",GEOGCS[\"G\"],UNIT[\"Meter\",1.0]]";
        for text in [None, Some("EPSG:31287"), Some(definition)] {
            let raster = Raster { crs: text.map(|text| Crs::parse(text).unwrap()), ..hill() };
            raster.write_geotiff(&path).unwrap();
            let back = Raster::read(&path).unwrap();
            assert_eq!((back.columns, back.rows, back.cell, back.west), (7, 5, raster.cell, raster.west));
            assert!((back.south - raster.south).abs() < 1e-9);
            for (a, b) in raster.values.iter().zip(&back.values) {
                assert!(*b == f64::from(*a as f32) || a.is_nan() && b.is_nan(), "{a} {b}");
            }
            assert_eq!(back.crs.as_ref().and_then(|c| c.epsg), raster.crs.as_ref().and_then(|c| c.epsg));
            assert_eq!(back.crs.is_some(), raster.crs.is_some());
        }
        assert_eq!(Raster::read(&path).unwrap().crs.unwrap().to_string(), "H_he _ Lambert");
        let bytes = Raster::from_bytes(&path, std::fs::read(&path).unwrap(), None).unwrap();
        assert_eq!(format!("{bytes:?}"), format!("{:?}", Raster::read(&path).unwrap()), "NaN is not NaN");
        let nowhere =
            hill().write_geotiff(&folder.path().join("no/such/folder.tif")).unwrap_err().to_string();
        assert!(nowhere.contains("folder.tif cannot be written"), "{nowhere}");
    }

    #[test]
    fn every_sample_type_and_compression_is_read() {
        let expected = vec![10.0, 11.0, f64::NAN, 0.0, 1.0, 2.0];
        let check = |raster: Result<Raster, RasterError>| {
            let raster = raster.unwrap();
            assert_eq!((raster.west, raster.south, raster.cell), (500.0, 896.0, 2.0));
            let same = raster.values.iter().zip(&expected).all(|(a, b)| a == b || a.is_nan() && b.is_nan());
            assert!(same, "{:?}", raster.values);
        };
        let nodata = |builder: GeoTiffBuilder| builder.nodata("12");
        check(written(nodata, |v| v as u8));
        check(written(nodata, |v| v as i8));
        check(written(nodata, |v| v as u16));
        check(written(nodata, |v| v as i16));
        check(written(nodata, |v| v as u32));
        check(written(nodata, |v| v as i32));
        check(written(nodata, |v| v as u64));
        check(written(nodata, |v| v as i64));
        check(written(nodata, |v| v));
        for compression in [Compression::Lzw, Compression::Deflate, Compression::Zstd] {
            check(written(|b| nodata(b).compression(compression).tile_size(16, 16), |v| v as f32));
        }
        check(written(|b| nodata(b).tiff_variant(geotiff_writer::TiffVariant::BigTiff), |v| v as f32));
        let south_up = GeoTransform::from_origin_and_pixel_size(500.0, 896.0, 2.0, 2.0);
        let raster = written(|b| nodata(b).transform(south_up), |v| v as f32).unwrap();
        assert_eq!((raster.south, raster.at(1, 0), raster.at(1, 1)), (896.0, 1.0, 11.0));
    }

    #[test]
    fn refusals_name_the_cure() {
        let degrees = GeoTransform::from_origin_and_pixel_size(11.5, 47.5, 1e-4, -1e-4);
        let message = refused(|b| b.geographic_epsg(4258).transform(degrees));
        assert!(message.contains("EPSG:4258") && message.contains("gdalwarp -t_srs EPSG:32632"), "{message}");
        let tall = GeoTransform::from_origin_and_pixel_size(500.0, 900.0, 2.0, -3.0);
        assert!(refused(|b| b.transform(tall)).contains("gdalwarp -tr 2 2"));
        let turned = GeoTransform { skew_x: 0.5, ..tall };
        assert!(refused(|b| b.transform(turned)).contains("rotated or mirrored"));
        let feet = refused(|b| b.projected_epsg(2264).geokey(LINEAR_UNIT, GeoKeyValue::Short(9003)));
        assert!(feet.contains("0.3048006") && feet.contains("-tr 0.61 0.61"), "{feet}");
        let unnamed = refused(|b| b.projected_epsg(USER_DEFINED));
        assert!(unnamed.contains("gdal_edit.py -a_srs EPSG:xxxx"), "{unnamed}");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cut.tif");
        std::fs::write(&path, b"II*\0\x08\0").unwrap();
        assert!(Raster::read(&path).unwrap_err().to_string().contains("cut.tif: the GeoTIFF cannot be read"));
        assert!(Raster::read(&folder.path().join("none.tif")).unwrap_err().to_string().contains("none.tif"));
    }
}
