//! What can be wrong with a raster file, each with its cure.

use super::scale::Scale;
use super::{Crs, Raster};
use crate::Remark;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a raster was not read or written.
#[derive(Debug, Error)]
pub enum RasterError {
    /// The file could not be opened or read.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file could not be written.
    #[error("{path} cannot be written: {reason}", path = path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system or the encoder said.
        reason: String,
    },
    /// The content is neither GeoTIFF nor ESRI ASCII.
    #[error(
        "{path} is neither a GeoTIFF nor an ESRI ASCII grid ({found}). A grid begins with lines such as `ncols 100`; \
         if it is another raster that GDAL reads, convert it with\n  \
         gdal_translate {path} {stem}.tif", path = path.display(), stem = stem(path)
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// How the content begins.
        found: String,
    },
    /// The header of an ASCII grid is incomplete or holds something else.
    #[error("{path}, line {line}: {problem}", path = path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// The key, what was found and what is allowed.
        problem: String,
    },
    /// A value of an ASCII grid is no number.
    #[error(
        "{path}, line {line}: `{found}` is not a number{}", hint(found), path = path.display()
    )]
    Value {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// The text in place of a number.
        found: String,
    },
    /// An ASCII grid holds more or fewer values than its header says.
    #[error(
        "{path}: the header says {rows} rows of {columns} values = {expected}, but {found} values follow \
         (the last on line {line}); correct ncols and nrows, or fetch the file again if it was cut off",
        expected = rows * columns, path = path.display()
    )]
    Count {
        /// The file.
        path: PathBuf,
        /// `nrows`.
        rows: usize,
        /// `ncols`.
        columns: usize,
        /// Number of values in the file.
        found: usize,
        /// Line of the last value, from 1.
        line: usize,
    },
    /// The GeoTIFF is damaged or of a kind that is not understood.
    #[error("{path}: {problem}", path = path.display())]
    GeoTiff {
        /// The file.
        path: PathBuf,
        /// What is wrong and what helps.
        problem: String,
    },
    /// What is declared of the values, in the file or in the `.aux.xml` beside it, makes no sense.
    #[error("{path}: {problem}", path = path.display())]
    Declared {
        /// The file.
        path: PathBuf,
        /// What is wrong and what helps.
        problem: String,
    },
    /// A map on which lengths are not those on the ground.
    #[error(
        "{path} is in {found}, {wrong}; {cure}",
        path = path.display(), wrong = lengths, cure = match place {
            Some((epsg, cell)) => reproject(path, *epsg, *cell),
            None => anywhere(path),
        }
    )]
    NotToScale {
        /// The file.
        path: PathBuf,
        /// The system.
        found: String,
        /// By how much lengths on the map are wrong, in words.
        lengths: String,
        /// The UTM zone that fits, and a cell size in metres.
        place: Option<(u32, f64)>,
    },
    /// Cells are not square.
    #[error(
        "{path}: cells of {width} by {height} are not square; resample with\n  \
         gdalwarp -tr {cell} {cell} -r bilinear {path} {stem}_square.tif", cell = width.min(*height),
        path = path.display(), stem = stem(path)
    )]
    NotSquare {
        /// The file.
        path: PathBuf,
        /// Extent of a cell along x \[m\].
        width: f64,
        /// Extent of a cell along y \[m\].
        height: f64,
    },
    /// The CRS is geographic: positions in degrees.
    #[error(
        "{path} has its positions in degrees ({found}), granflow needs metres; {cure}",
        path = path.display(), cure = reproject(path, *epsg, *cell)
    )]
    Geographic {
        /// The file.
        path: PathBuf,
        /// The system or the cell size that shows it.
        found: String,
        /// The UTM zone that fits.
        epsg: u32,
        /// A cell size in metres that fits.
        cell: f64,
    },
    /// The unit of the coordinates is not the metre.
    #[error(
        "{path}: one unit of its coordinates is {metres} m, granflow needs metres; reproject with\n  \
         gdalwarp{from} -t_srs EPSG:xxxx -tr {cell} {cell} -r bilinear {path} {stem}_metres.tif\n\
         (EPSG:xxxx: a system in metres, see epsg.io). Heights stay as they are: if they are in feet, say so with\n  \
         gdal_edit.py -units ft {stem}_metres.tif\n(ft: 0.3048 m, us-ft: 1200/3937 m), and they are converted as they are read",
        path = path.display(), stem = stem(path)
    )]
    Unit {
        /// The file.
        path: PathBuf,
        /// Metres per unit.
        metres: f64,
        /// The option that says the system, where it is known.
        from: String,
        /// Cell size in metres.
        cell: f64,
    },
    /// No cell has a value.
    #[error("{path}: all {cells} cells are nodata; check the nodata value and the extent it was cut to",
        path = path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// Number of cells.
        cells: usize,
    },
    /// A value that stands for nodata is not declared as nodata.
    #[error(
        "{path}: the value {found} stands for nodata but is not declared so; declare it with\n  \
         gdal_edit.py -a_nodata {found} {path}\n(in an ASCII grid: NODATA_value {found})", path = path.display()
    )]
    Undeclared {
        /// The file.
        path: PathBuf,
        /// The value.
        found: f64,
    },
    /// Two coordinate reference systems that should be one.
    #[error(
        "{path} is in {own}, the terrain of the case in {wanted} ({proof}); correct crs in the case, or \
         reproject with\n  \
         gdalwarp -t_srs {} {path} {stem}_reprojected.tif{}", target[0], target[1], path = path.display(), stem = stem(path)
    )]
    CrsMismatch {
        /// The file.
        path: PathBuf,
        /// Its system.
        own: String,
        /// The other system.
        wanted: String,
        /// What differs.
        proof: String,
        /// What `gdalwarp -t_srs` takes, and what to know about that.
        target: Box<[String; 2]>,
    },
}

impl RasterError {
    pub(super) fn header(path: &Path, line: usize, problem: impl Into<String>) -> RasterError {
        RasterError::Header { path: path.into(), line, problem: problem.into() }
    }

    pub(super) fn geotiff(path: &Path, problem: impl std::fmt::Display) -> RasterError {
        RasterError::GeoTiff { path: path.into(), problem: problem.to_string() }
    }

    pub(super) fn geographic(path: &Path, raster: &Raster) -> RasterError {
        let (x, y) = (0.5 * (raster.west + raster.east()), 0.5 * (raster.south + raster.north()));
        let cell = two_digits(raster.cell * 111_320.0 * y.to_radians().cos().abs().max(0.1).sqrt());
        let found = match &raster.crs {
            Some(crs) => format!("{crs}, cell size {}", raster.cell),
            None => format!("cell size {}", raster.cell),
        };
        RasterError::Geographic { path: path.into(), found, epsg: utm(x, y), cell }
    }

    pub(super) fn not_to_scale(path: &Path, raster: &Raster, scale: Scale) -> RasterError {
        let found = raster.crs.as_ref().map(Crs::describe).unwrap_or_default();
        let place = match scale {
            Scale::World => None,
            Scale::At { factors, degrees, .. } => {
                let cell = two_digits(raster.cell / (factors[0] * factors[1]).sqrt());
                Some((utm(degrees[0], degrees[1]), cell))
            }
        };
        RasterError::NotToScale { path: path.into(), found, lengths: wrong(scale), place }
    }

    pub(super) fn unit(path: &Path, crs: Option<&Crs>, metres: f64, cell: f64) -> RasterError {
        let from = crs.and_then(|crs| crs.epsg).map(|code| format!(" -s_srs EPSG:{code}"));
        let (path, cell) = (path.into(), two_digits(cell * metres));
        RasterError::Unit { path, metres, from: from.unwrap_or_default(), cell }
    }

    /// That a raster is in another system than wanted; `proof` says what differs.
    pub fn mismatch(path: &Path, own: &Crs, wanted: &Crs, proof: String) -> RasterError {
        let target = Box::new(Crs::target(Some(wanted)));
        let (own, wanted) = (own.describe(), wanted.describe());
        RasterError::CrsMismatch { path: path.into(), own, wanted, proof, target }
    }
}

/// The UTM zone of a place in degrees, on WGS 84.
fn utm(longitude: f64, latitude: f64) -> u32 {
    let zone = (((longitude + 180.0) / 6.0).floor().rem_euclid(60.0)) as u32 + 1;
    if latitude < 0.0 { 32700 + zone } else { 32600 + zone }
}

/// In what way lengths are wrong.
fn wrong(scale: Scale) -> String {
    let Scale::At { factors, ways, .. } = scale else {
        return "a map of the world, on which lengths are not those on the ground".into();
    };
    let long = |factor: f64| -> String {
        match 100.0 * (factor - 1.0) {
            percent if percent.abs() < 0.05 => "true".into(),
            percent if percent < 0.0 => format!("{:.1} % too short", -percent),
            percent => format!("{percent:.1} % too long"),
        }
    };
    let [one, other] = factors.map(long);
    match one == other {
        true => format!("where lengths are {one} here"),
        false => format!("where lengths are {one} {} and {other} {} here", ways[0], ways[1]),
    }
}

/// The warning of a map on which lengths are a little wrong.
pub(super) fn nearly_to_scale(path: &Path, crs: &Crs, scale: Scale) -> Remark {
    let (path, found, lengths) = (path.display(), crs.describe(), wrong(scale));
    Remark::Warning(format!(
        "{path}: it is in {found}, {lengths}, and slopes and areas are wrong with them; a system made for this place \
         has true lengths (UTM, the national one; see epsg.io)"
    ))
}

/// How a raster comes into a system in metres, where nothing is known of its place.
fn anywhere(path: &Path) -> String {
    let (path, stem) = (path.display(), stem(path));
    format!(
        "reproject with\n  gdalwarp -t_srs EPSG:xxxx -r bilinear {path} {stem}_metres.tif\n\
         (EPSG:xxxx: the UTM zone or the national system of its place, see epsg.io)"
    )
}

/// How a raster comes into a system in metres.
fn reproject(path: &Path, epsg: u32, cell: f64) -> String {
    format!(
        "reproject with\n  gdalwarp -t_srs EPSG:{epsg} -tr {cell} {cell} -r bilinear {path} {stem}_metres.tif\n\
         (EPSG:{epsg} is the UTM zone of its centre, the national system does as well)",
        path = path.display(),
        stem = stem(path)
    )
}

fn stem(path: &Path) -> String {
    path.with_extension("").display().to_string()
}

fn hint(found: &str) -> &'static str {
    match found.contains([',', ';']) {
        true => "; values are separated by blanks, with a point or a comma for decimals",
        false => "; values are numbers or the nodata value",
    }
}

/// Rounds to two significant digits.
fn two_digits(value: f64) -> f64 {
    let scale = 10f64.powi(value.abs().log10().floor().max(-300.0) as i32 - 1);
    let rounded = (value / scale).round() * scale;
    if scale < 1.0 { (rounded * 1e6).round() / 1e6 } else { rounded }
}
