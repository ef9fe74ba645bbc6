//! How much a TIFF of so many bytes may hold.

use super::RasterError;
use std::path::Path;
use tiff_reader::TiffFile;

/// Cells that any file may have, and how many more for each of its bytes: a file of equal values packs a few thousand into one.
const CELLS_LEAST: u64 = 1 << 22;
const CELLS_PER_BYTE: u64 = 1 << 12;

/// Refuses images that no file of so many bytes holds, before room is made for them.
pub(super) fn plausible(path: &Path, file: &TiffFile, bytes: u64) -> Result<(), RasterError> {
    let most = CELLS_LEAST + CELLS_PER_BYTE.saturating_mul(bytes);
    for ifd in file.ifds() {
        let (columns, rows) = (u64::from(ifd.width()), u64::from(ifd.height()));
        if columns == 0 || rows == 0 {
            let problem = format!("it says it has {rows} rows of {columns} cells; fetch it again");
            return Err(RasterError::geotiff(path, problem));
        }
        let block =
            u64::from(ifd.tile_width().unwrap_or(1)).saturating_mul(ifd.tile_height().unwrap_or(1).into());
        if columns.saturating_mul(rows).max(block) > most {
            let problem = format!(
                "it says it has {rows} rows of {columns} cells in {bytes} bytes; fetch it again, or where it is whole and almost \
                 empty store all of it with\n  gdal_translate -co COMPRESS=DEFLATE {} {}_whole.tif",
                path.display(),
                path.with_extension("").display()
            );
            return Err(RasterError::geotiff(path, problem));
        }
    }
    Ok(())
}
