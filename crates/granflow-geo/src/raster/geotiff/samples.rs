//! The values of a TIFF: what is stored, and what is said to be absent by nodata, by unstored blocks, by masks.

use crate::Remark;
use crate::raster::RasterError;
use crate::raster::declared::{Declared, conceal};
use geotiff_reader::GeoTiffFile;
use std::path::Path;
use tiff_reader::{ExtraSample, Ifd, TiffFile};

const SUBFILE: u16 = 254;
/// The bit of [`SUBFILE`] that makes an image the mask of another, and the one of overviews.
const MASK: u64 = 4;
const REDUCED: u64 = 1;

/// All values of the first band, first row first as stored, NaN for what is absent.
pub(super) fn values(
    path: &Path,
    file: &GeoTiffFile,
    declared: &Declared,
    notes: &mut Vec<Remark>,
) -> Result<Vec<f64>, RasterError> {
    let error = |problem: String| RasterError::geotiff(path, problem);
    let ifd = file.tiff().ifd(file.base_ifd_index()).map_err(|e| error(e.to_string()))?;
    let alpha = alpha(path, file, ifd)?;
    let mut values = band(path, file, ifd, 0)?;
    let [columns, rows] = [ifd.width(), ifd.height()].map(|count| count as usize);
    if values.len() != columns * rows {
        return Err(error(format!("{} values for {rows} rows of {columns}", values.len())));
    }
    if let Some(nodata) = declared.nodata {
        fill_unstored(ifd, &mut values, nodata);
    }
    let infinite = values.iter().filter(|value| value.is_infinite()).count();
    if infinite > 0 && !declared.nodata.is_some_and(f64::is_infinite) {
        notes.push(crate::raster::infinite(path, infinite, ""));
    }
    for value in values.iter_mut().filter(|value| declared.is_missing(**value)) {
        *value = f64::NAN;
    }
    let opaque = match alpha {
        Some(band_index) => Some(band(path, file, ifd, band_index)?),
        None => mask(path, file.tiff(), ifd)?,
    };
    for opaque in opaque.iter().chain(&declared.mask) {
        conceal(path, &mut values, opaque)?;
    }
    Ok(values)
}

/// The band that says how opaque the first one is; an error where there are more bands than that.
fn alpha(path: &Path, file: &GeoTiffFile, ifd: &Ifd) -> Result<Option<usize>, RasterError> {
    let bands = file.band_count() as usize;
    if bands == 1 {
        return Ok(None);
    }
    let extra = ifd.extra_samples().map_err(|e| RasterError::geotiff(path, e))?;
    let opaque = |sample: &ExtraSample| {
        matches!(sample, ExtraSample::AssociatedAlpha | ExtraSample::UnassociatedAlpha)
    };
    let alpha = extra.iter().position(opaque).map(|k| bands - extra.len() + k);
    if bands == 2 && alpha == Some(1) {
        return Ok(alpha);
    }
    let mask = alpha.map(|alpha| format!(" -mask {}", alpha + 1)).unwrap_or_default();
    let problem = format!(
        "{bands} bands, elevation is one; choose it with\n  gdal_translate -b 1{mask} {0} {1}_band.tif",
        path.display(),
        path.with_extension("").display()
    );
    Err(RasterError::geotiff(path, problem))
}

/// The values of one band.
fn band(path: &Path, file: &GeoTiffFile, ifd: &Ifd, index: usize) -> Result<Vec<f64>, RasterError> {
    let error = |problem: String| RasterError::geotiff(path, problem);
    let other = |found: String| {
        error(format!("{found}; convert with\n  gdal_translate -ot Float32 {} float.tif", path.display()))
    };
    let layout = ifd.raster_layout().map_err(|e| other(e.to_string()))?;
    macro_rules! read {
        ($($format:literal, $bits:pat => $sample:ty;)*) => {
            match (layout.sample_format, layout.bits_per_sample) {
                $(($format, $bits) => file
                    .read_band::<$sample>(index)
                    .map(|band| band.into_iter().map(|value| value as f64).collect::<Vec<f64>>()),)*
                (format, bits) => return Err(other(format!("samples of format {format} with {bits} bits"))),
            }
        };
    }
    let values = read! {
        1, 1..=8 => u8; 1, 9..=16 => u16; 1, 32 => u32; 1, 64 => u64;
        2, 8 => i8; 2, 16 => i16; 2, 32 => i32; 2, 64 => i64;
        3, 32 => f32; 3, 64 => f64;
    };
    values.map_err(|e| {
        let cure = format!("gdal_translate -co COMPRESS=DEFLATE {} plain.tif", path.display());
        error(format!("the values cannot be read: {e}; if other programs can, convert it with\n  {cure}"))
    })
}

/// The internal mask of an image, if it has one: the first image of its size that is a mask and no overview.
fn mask(path: &Path, file: &TiffFile, ifd: &Ifd) -> Result<Option<Vec<f64>>, RasterError> {
    let kind = |ifd: &Ifd| ifd.tag(SUBFILE).and_then(|tag| tag.value.as_u64()).unwrap_or(0);
    let of_it = |other: &&Ifd| {
        kind(other) & MASK != 0
            && kind(other) & REDUCED == 0
            && (other.width(), other.height()) == (ifd.width(), ifd.height())
    };
    let Some(mask) = file.ifds().iter().find(of_it) else { return Ok(None) };
    let opaque = file.read_image_from_ifd::<u8>(mask);
    let opaque = opaque.map_err(|e| RasterError::geotiff(path, format!("its mask cannot be read: {e}")))?;
    Ok(Some(opaque.into_iter().map(f64::from).collect()))
}

/// Puts nodata where blocks are not stored, as GDAL reads sparse files; without nodata it reads 0, and so does the reader.
fn fill_unstored(ifd: &Ifd, values: &mut [f64], nodata: f64) {
    let [columns, rows] = [ifd.width(), ifd.height()].map(|count| count as usize);
    let tiled = ifd.is_tiled();
    let (offsets, counts) = if tiled {
        (ifd.tile_offsets(), ifd.tile_byte_counts())
    } else {
        (ifd.strip_offsets(), ifd.strip_byte_counts())
    };
    let (Some(offsets), Some(counts)) = (offsets, counts) else { return };
    let [width, height] = match (ifd.tile_width(), ifd.tile_height()) {
        (Some(width), Some(height)) if tiled => [width as usize, height as usize],
        _ => [columns, ifd.rows_per_strip() as usize],
    };
    let [width, height] = [width.clamp(1, columns), height.clamp(1, rows)];
    let across = columns.div_ceil(width);
    // Where bands are stored apart, the blocks of the first come first.
    let blocks = across * rows.div_ceil(height);
    for (block, (offset, count)) in offsets.iter().zip(counts).take(blocks).enumerate() {
        if *offset != 0 && count != 0 {
            continue;
        }
        let (left, top) = (block % across * width, block / across * height);
        for row in top..(top + height).min(rows) {
            values[row * columns..][left..(left + width).min(columns)].fill(nodata);
        }
    }
}
