//! Rasters: square cells in metres with nodata and a coordinate reference system, read from GeoTIFF and ESRI ASCII
//! grids, resampled, and written as GeoTIFF.

mod ascii;
mod crs;
mod declared;
mod error;
mod geotiff;
mod ground;
mod projection;
mod register;
mod resample;
mod room;
mod scale;
mod system;
mod wkt;

pub use crs::{Crs, CrsError, well_known_text};
pub use error::RasterError;
pub use resample::intervals;
pub use system::Comparison;

use declared::Declared;
use scale::Scale;
use system::Heights;

use crate::Remark;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Values that stand for nodata wherever they occur.
const UNDECLARED: [f64; 4] = [-9999.0, -32768.0, -32767.0, -99999.0];

/// A map whose lengths are wrong by a larger share is refused, and one beyond the smaller is warned of. UTM is true to 0.1 %.
const DISTORTED: f64 = 0.02;
const DOUBTFUL: f64 = 0.005;

/// A grid of square cells, north up on disk and south first in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Number of cells from west to east.
    pub columns: usize,
    /// Number of cells from south to north.
    pub rows: usize,
    /// x of the western outer edge \[m\].
    pub west: f64,
    /// y of the southern outer edge \[m\].
    pub south: f64,
    /// Edge length of a cell \[m\].
    pub cell: f64,
    /// One value per cell at index `row * columns + column`, row 0 in the south; NaN is nodata.
    pub values: Vec<f64>,
    /// Coordinate reference system, where known.
    pub crs: Option<Crs>,
}

/// A raster as it was read, and what the reader decided: units converted, systems that could not be compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Values in metres, or plain numbers; one in memory is shared, not copied, where nothing of it had to be changed.
    pub raster: Arc<Raster>,
    /// One sentence each, with the name of the file.
    pub notes: Vec<Remark>,
    /// Bytes that reading held at its peak.
    pub bytes: usize,
}

impl Reading {
    /// Reads a file as [`Raster::read_in`] does.
    ///
    /// # Errors
    /// As [`Raster::read_in`].
    pub fn of(path: &Path, crs: Option<&Crs>) -> Result<Reading, RasterError> {
        let (raster, declared, mut notes, bytes) = Self::stored(path, crs)?;
        raster.true_to_scale(path, &mut notes)?;
        Ok(Reading { bytes, ..Reading::in_metres(path, raster.into(), declared, crs, notes)? })
    }

    /// The same of heights on a terrain, whose map has been judged and whose system is `crs`.
    ///
    /// # Errors
    /// As [`Raster::read_in`].
    pub fn on_terrain(path: &Path, crs: Option<&Crs>) -> Result<Reading, RasterError> {
        let (raster, declared, notes, bytes) = Self::stored(path, crs)?;
        Ok(Reading { bytes, ..Reading::in_metres(path, raster.into(), declared, crs, notes)? })
    }

    /// The same of numbers on a terrain that are no heights, say coefficients of friction: a unit of heights is not applied.
    ///
    /// # Errors
    /// As [`Raster::read_in`].
    pub fn of_numbers(path: &Path, crs: Option<&Crs>) -> Result<Reading, RasterError> {
        let (raster, declared, notes, bytes) = Self::stored(path, crs)?;
        let declared = Declared { unit: None, heights: Some(Heights::Unit(1.0)), ..declared };
        Ok(Reading { bytes, ..Reading::in_metres(path, raster.into(), declared, crs, notes)? })
    }

    /// The same of a raster in memory, which is called `name` in messages: it is held to what is asked of one from a file.
    /// `heights` says whether its values are heights; else they are plain numbers, to which no unit of heights applies.
    ///
    /// # Errors
    /// As [`Raster::read_in`].
    pub fn of_memory(
        name: &Path,
        mut raster: Arc<Raster>,
        crs: Option<&Crs>,
        heights: bool,
    ) -> Result<Reading, RasterError> {
        let mut notes = Vec::new();
        let system = agreed(name, raster.crs.clone(), crs, &mut notes)?;
        if system != raster.crs {
            Arc::make_mut(&mut raster).crs = system;
        }
        let count = raster.values.iter().filter(|value| value.is_infinite()).count();
        if count > 0 {
            let values = Arc::make_mut(&mut raster).values.iter_mut();
            values.filter(|value| value.is_infinite()).for_each(|value| *value = f64::NAN);
            notes.push(infinite(name, count, ""));
        }
        let bytes = size_of_val(raster.values.as_slice());
        let heights = if heights { None } else { Some(Heights::Unit(1.0)) };
        let declared = Declared { heights, ..Declared::default() };
        Ok(Reading { bytes, ..Reading::in_metres(name, raster, declared, crs, notes)? })
    }

    /// What is stored, what is declared of it, and the bytes that reading held.
    fn stored(path: &Path, crs: Option<&Crs>) -> Result<(Raster, Declared, Vec<Remark>, usize), RasterError> {
        let mut magic = [0; 4];
        let file = std::fs::File::open(path).and_then(|mut file| file.read(&mut magic));
        file.map_err(|source| RasterError::Io { path: path.into(), source })?;
        let beside = Declared::beside(path)?;
        let mut notes = Vec::new();
        if is_tiff(&magic) {
            let (raster, declared, bytes) = geotiff::read(path, beside, crs, &mut notes)?;
            return Ok((raster, declared, notes, bytes));
        }
        // The text, and its numbers.
        let size = std::fs::metadata(path).map_or(0, |file| file.len() as usize);
        let (raster, declared) = ascii::read(path, beside, crs, &mut notes)?;
        let bytes = size + size_of_val(raster.values.as_slice());
        Ok((raster, declared, notes, bytes))
    }

    /// The raster with what is declared of its values applied, checked.
    fn in_metres(
        path: &Path,
        mut raster: Arc<Raster>,
        declared: Declared,
        given: Option<&Crs>,
        mut notes: Vec<Remark>,
    ) -> Result<Reading, RasterError> {
        raster.check(path)?;
        let systems = raster.crs.iter().chain(given);
        let heights = declared.heights.or(systems.filter_map(Crs::heights).next());
        let [factor, offset] = Declared { heights, ..declared }.to_metres(path, &mut notes)?;
        if factor != 1.0 || offset != 0.0 {
            let values = Arc::make_mut(&mut raster).values.iter_mut();
            values.for_each(|value| *value = *value * factor + offset);
        }
        Ok(Reading { raster, notes, bytes: 0 })
    }
}

impl Raster {
    /// Reads a GeoTIFF (any sample type and compression, BigTIFF) or an ESRI ASCII grid, told apart by content.
    ///
    /// What is said to be absent is: nodata, masks, alpha 0, blocks of a sparse file. Scale, offset and units of the values
    /// are applied. All of that, and the CRS, is taken from the file, the `.aux.xml` and `.msk` files beside it, and the `.prj`
    /// file beside an ASCII grid.
    ///
    /// # Errors
    /// Every [`RasterError`] but those of writing; each names the file and the cure.
    pub fn read(path: &Path) -> Result<Raster, RasterError> {
        Raster::read_in(path, None)
    }

    /// As [`Raster::read`], with the CRS a case gives for files that carry none.
    ///
    /// # Errors
    /// As [`Raster::read`]; also [`RasterError::CrsMismatch`] when the file's own CRS contradicts the given one.
    pub fn read_in(path: &Path, crs: Option<&Crs>) -> Result<Raster, RasterError> {
        Reading::of(path, crs).map(|reading| Arc::unwrap_or_clone(reading.raster))
    }

    /// As [`Raster::read_in`], from the bytes of a file that is called `name` in messages.
    ///
    /// Nothing beside it is read: what a `.prj` file says is passed as `crs`.
    ///
    /// # Errors
    /// As [`Raster::read_in`].
    pub fn from_bytes(name: &Path, bytes: Vec<u8>, crs: Option<&Crs>) -> Result<Raster, RasterError> {
        let mut notes = Vec::new();
        let (raster, declared) = if is_tiff(&bytes) {
            let (raster, declared, _) = geotiff::from_bytes(name, bytes, crs, &mut notes)?;
            (raster, declared)
        } else {
            ascii::from_bytes(name, &bytes, (None, Declared::default()), crs, &mut notes)?
        };
        raster.true_to_scale(name, &mut notes)?;
        let reading = Reading::in_metres(name, raster.into(), declared, crs, notes)?;
        Ok(Arc::unwrap_or_clone(reading.raster))
    }

    /// A raster of the same cells and CRS with other values, or none.
    pub fn with_values(&self, values: Vec<f64>) -> Raster {
        debug_assert!(values.is_empty() || values.len() == self.columns * self.rows);
        let Raster { columns, rows, west, south, cell, .. } = *self;
        Raster { columns, rows, west, south, cell, values, crs: self.crs.clone() }
    }

    /// x of the centre of a column \[m\].
    pub fn x(&self, column: usize) -> f64 {
        self.west + (column as f64 + 0.5) * self.cell
    }

    /// y of the centre of a row, counted from the south \[m\].
    pub fn y(&self, row: usize) -> f64 {
        self.south + (row as f64 + 0.5) * self.cell
    }

    /// x of the eastern outer edge \[m\].
    pub fn east(&self) -> f64 {
        self.west + self.columns as f64 * self.cell
    }

    /// y of the northern outer edge \[m\].
    pub fn north(&self) -> f64 {
        self.south + self.rows as f64 * self.cell
    }

    /// The value of a cell, NaN for nodata.
    ///
    /// # Panics
    /// When the cell does not exist.
    pub fn at(&self, column: usize, row: usize) -> f64 {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        self.values[row * self.columns + column]
    }

    /// The index of the cell that holds a place, if there is one; all four edges belong to the raster.
    pub fn cell_at(&self, [x, y]: [f64; 2]) -> Option<usize> {
        let inside = (self.west..=self.east()).contains(&x) && (self.south..=self.north()).contains(&y);
        let [column, row] = [(x - self.west) / self.cell, (y - self.south) / self.cell].map(|at| at as usize);
        inside.then(|| row.min(self.rows - 1) * self.columns + column.min(self.columns - 1))
    }

    /// Column and row of the cell at an index of [`Raster::values`].
    pub fn place(&self, index: usize) -> [usize; 2] {
        [index % self.columns, index / self.columns]
    }

    /// Smallest and largest value, `None` where all is nodata.
    pub fn range(&self) -> Option<(f64, f64)> {
        let valid = self.values.iter().filter(|value| !value.is_nan());
        valid
            .fold(None, |range, &v| Some(range.map_or((v, v), |(lo, hi): (f64, f64)| (lo.min(v), hi.max(v)))))
    }

    /// Refuses a raster whose CRS contradicts that of `terrain`; `path` is where it was read from.
    ///
    /// # Errors
    /// [`RasterError::CrsMismatch`] with the command that reprojects.
    pub fn same_system(&self, path: &Path, terrain: &Raster) -> Result<(), RasterError> {
        agreed(path, self.crs.clone(), terrain.crs.as_ref(), &mut Vec::new()).map(|_| ())
    }

    /// Degrees show in three ways: the CRS says so, or coordinates fit on a globe of 360 by 180 while the relief is
    /// more than ten times the extent, as metres over degrees are and no ground is.
    fn geographic(&self) -> bool {
        let globe =
            self.west >= -360.0 && self.east() <= 360.0 && self.south >= -90.0 && self.north() <= 90.0;
        let extent = self.cell * self.columns.max(self.rows) as f64;
        let steep = self.range().is_some_and(|(low, high)| high - low > 10.0 * extent);
        self.crs.as_ref().is_some_and(Crs::is_geographic) || globe && self.cell < 1.0 && steep
    }

    /// The scale of the map where it is worst: in the middle, at a corner, or amid a side.
    fn scale(&self) -> Option<Scale> {
        let crs = self.crs.as_ref()?;
        let middle = [0.5 * (self.west + self.east()), 0.5 * (self.south + self.north())];
        let [xs, ys] = [[middle[0], self.west, self.east()], [middle[1], self.south, self.north()]];
        let places = xs.into_iter().flat_map(|x| ys.map(|y| [x, y]));
        let scales = places.filter_map(|place| crs.scale(place));
        scales.max_by(|a, b| a.error().total_cmp(&b.error()))
    }

    /// Are lengths on the map those on the ground? A small difference is a warning.
    fn true_to_scale(&self, path: &Path, notes: &mut Vec<Remark>) -> Result<(), RasterError> {
        let metres =
            |crs: &&Crs| !crs.is_geographic() && crs.metres_per_unit().is_none_or(|unit| unit == 1.0);
        let Some(crs) = self.crs.as_ref().filter(metres) else { return Ok(()) };
        match self.scale() {
            Some(scale) if scale.error() > DISTORTED => {
                return Err(RasterError::not_to_scale(path, self, scale));
            }
            Some(scale) if scale.error() > DOUBTFUL => notes.push(error::nearly_to_scale(path, crs, scale)),
            _ => {}
        }
        Ok(())
    }

    /// The demands on every raster: metres, and at least one value.
    fn check(&self, path: &Path) -> Result<(), RasterError> {
        if self.geographic() {
            return Err(RasterError::geographic(path, self));
        }
        if let Some(metres) =
            self.crs.as_ref().and_then(Crs::metres_per_unit).filter(|m| (m - 1.0).abs() > 1e-9)
        {
            return Err(RasterError::unit(path, self.crs.as_ref(), metres, self.cell));
        }
        let Some((low, high)) = self.range() else {
            return Err(RasterError::Empty { path: path.into(), cells: self.values.len() });
        };
        if UNDECLARED.contains(&low) || low < -1e30 || high > 1e30 {
            let found = if high > 1e30 { high } else { low };
            return Err(RasterError::Undeclared { path: path.into(), found });
        }
        Ok(())
    }
}

/// Whether a file that begins so is a TIFF or BigTIFF.
fn is_tiff(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| bytes.starts_with(&magic[..]))
}

/// The file beside `path` that has another extension, in lower or upper case.
pub(crate) fn beside(path: &Path, extension: &str) -> PathBuf {
    let [lower, upper] = [extension.to_string(), extension.to_uppercase()].map(|e| path.with_extension(e));
    if !lower.exists() && upper.exists() { upper } else { lower }
}

/// Turns rows that begin in the north into rows that begin in the south, in place.
fn turn(values: &mut [f64], columns: usize) {
    let mut rows = values.chunks_exact_mut(columns);
    while let (Some(north), Some(south)) = (rows.next(), rows.next_back()) {
        north.swap_with_slice(south);
    }
}

/// The CRS of a file and the one that a case gives, where they agree; a note where that cannot be known.
fn agreed(
    path: &Path,
    own: Option<Crs>,
    given: Option<&Crs>,
    notes: &mut Vec<Remark>,
) -> Result<Option<Crs>, RasterError> {
    let (Some(own), Some(given)) = (&own, given) else { return Ok(own.or(given.cloned())) };
    match own.compare(given) {
        Comparison::Different(proof) => return Err(RasterError::mismatch(path, own, given, proof)),
        Comparison::Unknown(what) => notes.push(uncertain(path, own, given, &what)),
        Comparison::Same => {}
    }
    Ok(Some(Crs { epsg: own.epsg.or(given.epsg), wkt: own.wkt.clone().or(given.wkt.clone()) }))
}

/// The note on cells that are infinite and not declared as nodata; `place` says where, if that is known.
fn infinite(path: &Path, cells: usize, place: &str) -> Remark {
    let cells = if cells == 1 { "1 cell is".to_owned() } else { format!("{cells} cells are") };
    let path = path.display();
    Remark::Note(format!("{path}: {cells} infinite{place}, and taken as nodata"))
}

/// The note on two systems that could not be compared.
pub(crate) fn uncertain(path: &Path, own: &Crs, other: &Crs, what: &str) -> Remark {
    let (own, other) = (own.describe(), other.describe());
    let path = path.display();
    Remark::Warning(format!(
        "{path}: whether {own} is {other} could not be decided ({what}); it was taken to be"
    ))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A raster of 1 m cells with its corner at the origin and the values of `f` at the cell centres.
    pub(crate) fn sampled(columns: usize, rows: usize, f: impl Fn(f64, f64) -> f64) -> Raster {
        let centre = |k| k as f64 + 0.5;
        let values = (0..rows * columns).map(|k| f(centre(k % columns), centre(k / columns))).collect();
        Raster { columns, rows, west: 0.0, south: 0.0, cell: 1.0, values, crs: None }
    }

    fn refused(raster: Raster) -> String {
        raster.check(Path::new("dem.tif")).unwrap_err().to_string()
    }

    #[test]
    fn degrees_are_refused_with_the_command_that_reprojects() {
        let degrees =
            Raster { west: 11.0, south: 47.0, cell: 1e-4, ..sampled(20, 20, |x, y| 1500.0 + x + 2.0 * y) };
        let message = refused(degrees.clone());
        assert!(message.contains("gdalwarp -t_srs EPSG:32632 -tr 9.2 9.2 -r bilinear dem.tif"), "{message}");
        let south = Raster { south: -33.0, west: -70.5, ..degrees.clone() };
        assert!(refused(south).contains("EPSG:32719"));
        let flume = Raster { values: sampled(20, 20, |x, _| 1e-4 * x).values, ..degrees };
        assert!(flume.check(Path::new("flume.asc")).is_ok());
        let crs = Some(Crs { epsg: Some(4326), wkt: None });
        assert!(refused(Raster { crs, ..flume }).contains("gdalwarp"));
    }

    #[test]
    fn a_raster_in_memory_is_held_to_the_same() {
        let name = Path::new("<terrain.dem>");
        let tilted = sampled(4, 3, |x, _| if x < 1.0 { f64::INFINITY } else { x });
        let read = Reading::of_memory(name, tilted.clone().into(), None, true).unwrap();
        assert!(read.raster.values[0].is_nan() && read.raster.values[1] == 1.5);
        assert!(read.notes[0].text().contains("3 cells are infinite"), "{:?}", read.notes);
        let [a, b] = [31287, 32632].map(|epsg| Crs { epsg: Some(epsg), wkt: None });
        let other = Raster { crs: Some(a), ..tilted };
        let message = Reading::of_memory(name, other.into(), Some(&b), true).unwrap_err().to_string();
        assert!(message.contains("<terrain.dem>") && message.contains("EPSG:31287"), "{message}");
    }

    #[test]
    fn empty_rasters_and_feet_are_refused() {
        assert!(refused(sampled(3, 2, |_, _| f64::NAN)).contains("all 6 cells are nodata"));
        let low = sampled(3, 2, |x, _| if x < 1.0 { -32768.0 } else { 900.0 });
        assert!(refused(low).contains("gdal_edit.py -a_nodata -32768 dem.tif"));
        let feet = Crs::parse(r#"PROJCS["x",GEOGCS["y"],UNIT["foot",0.3048]]"#).unwrap();
        let message = refused(Raster { crs: Some(feet), ..sampled(3, 2, |_, _| 1.0) });
        assert!(message.contains("0.3048 m") && message.contains("gdalwarp"), "{message}");
    }

    #[test]
    fn a_given_system_fills_in_and_a_contradiction_is_refused() {
        let [a, b] = [31287, 32632].map(|epsg| Crs { epsg: Some(epsg), wkt: None });
        let path = Path::new("dem.asc");
        assert_eq!(agreed(path, None, Some(&a), &mut Vec::new()).unwrap(), Some(a.clone()));
        let message = agreed(path, Some(b.clone()), Some(&a), &mut Vec::new()).unwrap_err().to_string();
        assert!(
            message.contains("EPSG:32632") && message.contains("EPSG:31287") && message.contains("gdalwarp"),
            "{message}"
        );
        let terrain = Raster { crs: Some(a), ..sampled(2, 2, |_, _| 0.0) };
        let thickness = Raster { crs: Some(b), ..terrain.clone() };
        let message = thickness.same_system(Path::new("h.tif"), &terrain).unwrap_err().to_string();
        assert!(message.contains("h.tif") && message.contains("-t_srs EPSG:31287"), "{message}");
    }
}
