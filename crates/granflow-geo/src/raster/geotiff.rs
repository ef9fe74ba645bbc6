//! GeoTIFF through the `geotiff-reader` and `geotiff-writer` crates.

mod keys;
mod samples;
mod write;

use super::declared::Declared;
use super::room::plausible;
use super::{Crs, Raster, RasterError, agreed, turn};
use crate::Remark;
use geotiff_reader::GeoTiffFile;
use keys::Horizontal;
use std::path::Path;

/// TIFF tag of GDAL's metadata.
const METADATA_TAG: u16 = 42112;

/// Reads a file piece by piece; `beside` is what its sidecar says, which comes before what the file says, as with GDAL.
pub(super) fn read(
    path: &Path,
    beside: Declared,
    given: Option<&Crs>,
    notes: &mut Vec<Remark>,
) -> Result<(Raster, Declared, usize), RasterError> {
    let size = std::fs::metadata(path).map_err(|source| RasterError::Io { path: path.into(), source })?.len();
    decoded(path, (GeoTiffFile::open(path), size), beside, given, notes)
}

/// Reads what a file called `name` holds.
pub(super) fn from_bytes(
    name: &Path,
    bytes: Vec<u8>,
    given: Option<&Crs>,
    notes: &mut Vec<Remark>,
) -> Result<(Raster, Declared, usize), RasterError> {
    let size = bytes.len() as u64;
    decoded(name, (GeoTiffFile::from_bytes(bytes), size), Declared::default(), given, notes)
}

fn decoded(
    path: &Path,
    (file, bytes): (Result<GeoTiffFile, geotiff_reader::Error>, u64),
    beside: Declared,
    given: Option<&Crs>,
    notes: &mut Vec<Remark>,
) -> Result<(Raster, Declared, usize), RasterError> {
    let error = |problem: &dyn std::fmt::Display| RasterError::geotiff(path, problem);
    let file = file.map_err(|e| match e {
        geotiff_reader::Error::NotGeoTiff => error(&unplaced(path)),
        e => error(&format!("the GeoTIFF cannot be read: {e}")),
    })?;
    plausible(path, file.tiff(), bytes)?;
    let [west, top, cell, height] = place(path, &file, beside.place)?;
    let declared = declared(path, &file, beside)?;
    let crs = system(path, &file, &declared, given, notes)?;
    let mut values = samples::values(path, &file, &declared, notes)?;
    let (columns, rows) = (file.width() as usize, file.height() as usize);
    let south = if height < 0.0 { top + rows as f64 * height } else { top };
    if height < 0.0 {
        turn(&mut values, columns);
    }
    let raster = Raster { columns, rows, west, south, cell, values, crs };
    if file.crs().model_type_enum() == geotiff_writer::ModelType::Geographic {
        return Err(RasterError::geographic(path, &raster));
    }
    if (cell - height.abs()).abs() > 1e-6 * cell {
        return Err(RasterError::NotSquare { path: path.into(), width: cell, height: height.abs() });
    }
    let bytes = held(&file, raster.values.len());
    Ok((raster, declared, bytes))
}

/// Decoded blocks that the reader keeps \[bytes\].
const BLOCKS: usize = 64 << 20;

/// Bytes held while so many cells are read: the numbers, those of the file, and of a packed file its decoded blocks.
fn held(file: &GeoTiffFile, cells: usize) -> usize {
    let Ok(ifd) = file.tiff().ifd(file.base_ifd_index()) else { return 8 * cells };
    let bits = ifd.bits_per_sample().ok().and_then(|bits| bits.first().copied());
    let sample = bits.map_or(1, |bits| usize::from(bits).div_ceil(8));
    let blocks = if ifd.compression() == 1 { 0 } else { BLOCKS.min(sample * cells) };
    (8 + sample) * cells + blocks
}

/// x of the western edge, y of the first row's outer edge, width and height of a cell, the height negative where the first
/// row lies in the north.
fn place(path: &Path, file: &GeoTiffFile, beside: Option<[f64; 6]>) -> Result<[f64; 4], RasterError> {
    let inside = file
        .transform()
        .map(|at| [at.origin_x, at.pixel_width, at.skew_x, at.origin_y, at.skew_y, at.pixel_height]);
    let at = beside.or(inside).ok_or_else(|| RasterError::geotiff(path, unplaced(path)))?;
    let [west, cell, skew_x, top, skew_y, height] = at;
    if skew_x != 0.0 || skew_y != 0.0 || cell <= 0.0 || height == 0.0 {
        let cure = format!(
            "gdalwarp -r bilinear {0} {1}_straight.tif",
            path.display(),
            path.with_extension("").display()
        );
        return Err(RasterError::geotiff(
            path,
            format!(
                "its rows do not run from west to east (rotated or mirrored); straighten it with\n  {cure}"
            ),
        ));
    }
    Ok([west, top, cell, height])
}

fn unplaced(path: &Path) -> String {
    let (path, stem) = (path.display(), path.with_extension("").display().to_string());
    format!(
        "a TIFF without position; if a world file (.tfw) lies beside it, write that into it with\n  \
         gdal_translate -a_srs EPSG:xxxx {path} {stem}_placed.tif"
    )
}

/// What the sidecar and the file say of the values.
fn declared(path: &Path, file: &GeoTiffFile, beside: Declared) -> Result<Declared, RasterError> {
    let error = |problem: String| RasterError::geotiff(path, problem);
    let ifd = file.tiff().ifd(file.base_ifd_index()).map_err(|e| error(e.to_string()))?;
    let metadata = ifd.tag(METADATA_TAG).and_then(|tag| tag.value.as_str()).unwrap_or_default();
    let nodata =
        match file.nodata().map(|text| text.trim_matches(['\0', ' '])).filter(|text| !text.is_empty()) {
            None => None,
            Some(text) => Some(text.replace(',', ".").parse().map_err(|_| {
                let cure = format!("gdal_edit.py -a_nodata -9999 {}", path.display());
                error(format!(
                    "its nodata value is `{text}`, which is no number; write the value with\n  {cure}"
                ))
            })?),
        };
    let inside =
        Declared { nodata, heights: keys::heights(file.geokeys()), ..Declared::inside(path, metadata)? };
    Ok(beside.or(inside))
}

/// The file's CRS, from the sidecar or from the keys, with what the case gives.
fn system(
    path: &Path,
    file: &GeoTiffFile,
    declared: &Declared,
    given: Option<&Crs>,
    notes: &mut Vec<Remark>,
) -> Result<Option<Crs>, RasterError> {
    let keys = file.geokeys();
    let own = match (&declared.system, keys::horizontal(keys)) {
        (Some(text), _) => Some(Crs::parse(text).map_err(|e| RasterError::Declared {
            path: super::declared::with_suffix(path, ".aux.xml"),
            problem: format!("its SRS is not understood: {e}"),
        })?),
        (None, Horizontal::Known(crs)) => Some(crs),
        (None, Horizontal::None) => None,
        (None, Horizontal::Unknown) if given.is_some() => {
            let text = "its coordinate reference system is described by parameters that are not understood; crs of the case was taken";
            notes.push(Remark::Warning(format!("{}: {text}", path.display())));
            None
        }
        (None, Horizontal::Unknown) => {
            return Err(RasterError::geotiff(
                path,
                format!(
                    "its coordinate reference system is described by parameters without an EPSG code; name it by \
                     crs = \"EPSG:xxxx\" in the case, or in the file with\n  gdal_edit.py -a_srs EPSG:xxxx {}",
                    path.display()
                ),
            ));
        }
    };
    if declared.system.is_none()
        && let Some(metres) = keys::unit(keys).filter(|metres| (metres - 1.0).abs() > 1e-9)
    {
        let cell = file.transform().map_or(1.0, |at| at.pixel_width);
        return Err(RasterError::unit(path, own.as_ref(), metres, cell));
    }
    agreed(path, own, given, notes)
}

#[cfg(test)]
mod tests;
