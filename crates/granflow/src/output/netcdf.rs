//! `result.nc`: a NetCDF-4 file after the CF-1.11 conventions, written without holding the series in memory.
//!
//! The crate netcdf-writer builds the skeleton (dimensions, coordinates, attributes, variables with no data yet); the data
//! are then appended block by block and the skeleton's object headers are told where they lie (`output/hdf5.rs`).

use super::frames::Frames;
use super::hdf5::{Block, allocate};
use super::{Error, Precision, whole_file};
#[cfg(feature = "geo")]
use crate::raster::well_known_text;
use netcdf_writer::{DimensionId, NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions, VariableId};
use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// An attribute of HDF5 must fit 64 KiB unless it lies in the heap; longer texts go there.
const LONGEST_INLINE_TEXT: usize = 60_000;

/// Numbers of a map that are turned into bytes in one go.
const PART: usize = 1 << 15;

/// A coordinate: a dimension with its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name of dimension and variable: `time`, `y`, `x`, `y_node`, `x_node`.
    pub name: String,
    /// The values, rising or falling.
    pub values: Vec<f64>,
    /// Units: "m", "s", "1" for scaled lengths.
    pub units: String,
    /// What it is, in words.
    pub long_name: String,
    /// Name in the CF table, such as `projection_x_coordinate`.
    pub standard_name: Option<String>,
    /// "X", "Y" or "T".
    pub axis: &'static str,
}

impl Axis {
    /// The coordinate `time`. "s" stays a number in xarray, where "seconds" would become a timedelta.
    #[must_use]
    pub fn time(values: Vec<f64>, units: &str) -> Self {
        Self {
            name: "time".into(),
            values,
            units: units.into(),
            long_name: "time since the start of the run".into(),
            standard_name: Some("time".into()),
            axis: "T",
        }
    }

    /// A coordinate along the map, eastward ("X") or northward ("Y"); `projected` if it belongs to a CRS.
    #[must_use]
    pub fn along(axis: &'static str, name: &str, values: Vec<f64>, units: &str, projected: bool) -> Self {
        let lower = axis.to_lowercase();
        Self {
            name: name.into(),
            values,
            units: units.into(),
            long_name: if projected {
                format!("{lower} coordinate of projection")
            } else {
                name.replace('_', " ")
            },
            standard_name: projected.then(|| format!("projection_{lower}_coordinate")),
            axis,
        }
    }
}

/// Where the values of a variable come from, row-major, without the time dimension.
#[derive(Debug, Clone, PartialEq)]
pub enum Values<'a> {
    /// One map that does not change.
    Static(Cow<'a, [f64]>),
    /// One map per instant, in memory.
    Series(Cow<'a, [Vec<f64>]>),
    /// The field of this name in the store of frames.
    Stored(String),
}

/// A quantity on some of the axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable<'a> {
    /// The name, such as `thickness`.
    pub name: String,
    /// What it is, in words.
    pub long_name: String,
    /// Units after UDUNITS: "m", "m s-1", "kPa", "1".
    pub units: String,
    /// Names of its axes, slowest first: `time`, `y`, `x`.
    pub axes: Vec<String>,
    /// Bits kept.
    pub precision: Precision,
    /// The numbers; NaN is "no value" and the file's `_FillValue`.
    pub values: Values<'a>,
}

/// The coordinate reference system of a run on terrain.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Crs {
    /// EPSG code.
    pub epsg: Option<u32>,
    /// Well-known text, where the input had one; else it is looked up by the code.
    pub wkt: Option<String>,
}

/// Everything that `result.nc` holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Dataset<'a> {
    /// Title of the run.
    pub title: String,
    /// What made the file; see [`history`].
    pub history: String,
    /// The case as it was computed.
    pub case: String,
    /// Further global attributes.
    pub attributes: Vec<(String, String)>,
    /// The coordinates.
    pub axes: Vec<Axis>,
    /// The quantities.
    pub variables: Vec<Variable<'a>>,
    /// Where on Earth.
    pub crs: Option<Crs>,
    /// NaN in cells without terrain: there every variable whose map has this length is NaN.
    pub terrain: Option<&'a [f64]>,
}

/// A line for [`Dataset::history`]: the instant in UTC and the command, as in "2026-03-01T12:00:00Z granflow run a.toml".
#[must_use]
pub fn history(now: SystemTime, command: &str) -> String {
    let seconds = now.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Years counted from 1 March of year 0, so that the leap day ends a year; 146097 days make 400 years.
    let (era, day) = ((days + 719_468) / 146_097, (days + 719_468) % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let date = day - (153 * month + 2) / 5 + 1;
    let (year, month) =
        (era * 400 + year + u64::from(month >= 10), if month < 10 { month + 3 } else { month - 9 });
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{date:02}T{hour:02}:{minute:02}:{second:02}Z {command}")
}

impl Dataset<'_> {
    /// Writes the file as a whole; stored series pass through memory one field of one frame at a time.
    ///
    /// # Errors
    /// [`Error::Invalid`] if names, shapes and frames do not fit together; [`Error::Io`], [`Error::Damaged`].
    pub fn write(&self, path: &Path, frames: Option<&mut Frames>) -> Result<(), Error> {
        let layout = self.layout(frames.as_deref()).map_err(|problem| Error::invalid(path, problem))?;
        whole_file(path, |out| self.stream(&layout, frames, out))
    }

    /// The bytes of the file, where no series is stored on disk.
    ///
    /// # Errors
    /// [`Error::Invalid`] if names and shapes do not fit together.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        let name = Path::new("result.nc");
        let layout = self.layout(None).map_err(|problem| Error::invalid(name, problem))?;
        let mut bytes = Vec::new();
        self.stream(&layout, None, &mut bytes).map_err(Error::io(name, "write"))?;
        Ok(bytes)
    }

    /// Where everything stands in the file, after checking that it fits together.
    fn layout(&self, frames: Option<&Frames>) -> Result<Layout, String> {
        let plan = self.plan(frames)?;
        let mut skeleton = self.skeleton().map_err(|error| error.to_string())?;
        let sizes: Vec<_> = self.variables.iter().zip(&plan).map(|(v, maps)| maps.bytes(v)).collect();
        let blocks = allocate(&mut skeleton, &sizes)?;
        Ok(Layout { plan, skeleton, blocks })
    }

    fn stream(
        &self,
        Layout { plan, skeleton, blocks }: &Layout,
        mut frames: Option<&mut Frames>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        out.write_all(skeleton)?;
        let mut position = skeleton.len() as u64;
        for ((variable, maps), block) in self.variables.iter().zip(plan).zip(blocks) {
            let Block { address, size } = *block;
            out.write_all(&vec![0; (address - position) as usize])?;
            self.write_maps(variable, maps, frames.as_deref_mut(), out)?;
            position = address + size;
        }
        Ok(())
    }

    fn write_maps(
        &self,
        variable: &Variable,
        maps: &Maps,
        mut frames: Option<&mut Frames>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let precision = variable.precision;
        let terrain = self.terrain.filter(|terrain| terrain.len() == maps.length);
        let mut nothing = Vec::new();
        precision.encode(&[f64::NAN], &mut nothing);
        let mut bytes = Vec::new();
        // Part by part: a map is a good share of what a run takes.
        let part = |from: usize| from..(from + PART).min(maps.length);
        let parts = || (0..maps.length).step_by(PART).map(part);
        for (instant, part) in (0..maps.count).flat_map(|instant| parts().map(move |part| (instant, part))) {
            bytes.clear();
            match (&variable.values, frames.as_deref_mut()) {
                (Values::Static(map), _) => precision.encode(&map[part.clone()], &mut bytes),
                (Values::Series(series), _) => precision.encode(&series[instant][part.clone()], &mut bytes),
                (Values::Stored(_), Some(frames)) => {
                    let read = frames.read_bytes(instant, maps.field, part.clone(), &mut bytes);
                    read.map_err(io::Error::other)?;
                    // What is stored as it is wanted is not taken apart.
                    if frames.precision() != precision {
                        let values = frames.precision().decode(&bytes);
                        bytes.clear();
                        precision.encode(&values, &mut bytes);
                    }
                }
                (Values::Stored(_), None) => unreachable!("plan() has refused this"),
            }
            if let Some(terrain) = terrain {
                let cells = bytes.chunks_exact_mut(precision.width()).zip(&terrain[part]);
                cells.filter(|(_, z)| z.is_nan()).for_each(|(cell, _)| cell.copy_from_slice(&nothing));
            }
            out.write_all(&bytes)?;
        }
        Ok(())
    }

    /// How many maps of which length each variable has, after checking that everything fits.
    fn plan(&self, frames: Option<&Frames>) -> Result<Vec<Maps>, String> {
        for axis in &self.axes {
            if axis.values.is_empty() {
                return Err(format!("axis {} has no values", axis.name));
            }
        }
        self.variables.iter().map(|variable| self.maps(variable, frames)).collect()
    }

    fn maps(&self, variable: &Variable<'_>, frames: Option<&Frames>) -> Result<Maps, String> {
        let name = &variable.name;
        let size = |own: &String| {
            let axis = self.axes.iter().find(|axis| axis.name == *own);
            axis.map(|axis| axis.values.len())
                .ok_or_else(|| format!("variable {name} lies on axis {own}, which is not given"))
        };
        let sizes: Vec<_> = variable.axes.iter().map(size).collect::<Result<_, _>>()?;
        let timed = variable.axes.first().is_some_and(|first| first == "time");
        let (count, length) = (if timed { sizes[0] } else { 1 }, sizes.iter().skip(timed.into()).product());
        let mut field = 0;
        let (found, lengths): (usize, Vec<usize>) = match &variable.values {
            Values::Static(map) => (1, vec![map.len()]),
            Values::Series(series) => (series.len(), series.iter().map(Vec::len).collect()),
            Values::Stored(stored) => {
                let frames = frames.ok_or_else(|| format!("variable {name} needs the store of frames"))?;
                field = frames
                    .position(stored)
                    .ok_or_else(|| format!("the store of frames has no field {stored}"))?;
                (frames.times().len(), vec![frames.fields()[field].length])
            }
        };
        if timed == matches!(variable.values, Values::Static(_)) || variable.axes.is_empty() {
            return Err(format!(
                "variable {name} on axes {:?} does not fit values of its kind",
                variable.axes
            ));
        }
        if found != count || lengths.iter().any(|&own| own != length) {
            return Err(format!(
                "variable {name} should have {count} maps of {length} values, found {found} of {lengths:?}"
            ));
        }
        Ok(Maps { count, length, field })
    }

    fn skeleton(&self) -> netcdf_writer::Result<Vec<u8>> {
        let mut file = NcFileBuilder::new();
        let globals = [
            ("Conventions", "CF-1.11"),
            ("title", &self.title),
            ("history", &self.history),
            ("source", concat!("granflow ", env!("CARGO_PKG_VERSION"))),
            ("case", &self.case),
        ];
        let more = self.attributes.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        for (name, value) in globals.into_iter().chain(more) {
            file.add_attribute(name, text(value))?;
        }
        let mut dimensions: Vec<(&str, DimensionId)> = Vec::new();
        for axis in &self.axes {
            let id = file.add_dimension(&axis.name, axis.values.len() as u64)?;
            dimensions.push((&axis.name, id));
        }
        for (axis, &(_, dimension)) in self.axes.iter().zip(&dimensions) {
            let id = file.add_variable::<f64>(&axis.name, &[dimension])?;
            file.write_variable(id, &axis.values)?;
            let standard = axis.standard_name.as_deref().map(|name| ("standard_name", name));
            let names = [("units", axis.units.as_str()), ("long_name", &axis.long_name), ("axis", axis.axis)];
            describe(&mut file, id, names.into_iter().chain(standard))?;
        }
        if let Some(crs) = &self.crs {
            let id = file.add_variable::<i32>("crs", &[])?;
            file.write_variable(id, &[0])?;
            crs.describe(&mut file, id)?;
        }
        for variable in &self.variables {
            let dimension =
                |axis: &String| dimensions.iter().find(|(name, _)| name == axis).map(|&(_, id)| id);
            let axes: Vec<_> = variable.axes.iter().filter_map(dimension).collect(); // plan() has found them all
            let id = match variable.precision {
                Precision::F32 => {
                    let id = file.add_variable::<f32>(&variable.name, &axes)?;
                    file.set_variable_fill_value(id, f32::NAN)?;
                    id
                }
                Precision::F64 => {
                    let id = file.add_variable::<f64>(&variable.name, &axes)?;
                    file.set_variable_fill_value(id, f64::NAN)?;
                    id
                }
            };
            let mapping = self.crs.as_ref().map(|_| ("grid_mapping", "crs"));
            let names = [("units", variable.units.as_str()), ("long_name", &variable.long_name)];
            describe(&mut file, id, names.into_iter().chain(mapping))?;
        }
        Ok(file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 })?.1)
    }
}

/// The file but for its numbers: the maps of each variable, the skeleton, and where the numbers go.
struct Layout {
    plan: Vec<Maps>,
    skeleton: Vec<u8>,
    blocks: Vec<Block>,
}

/// The maps of one variable: how many, how long, and which field of the store.
struct Maps {
    count: usize,
    length: usize,
    field: usize,
}

impl Maps {
    fn bytes(&self, variable: &Variable) -> u64 {
        (self.count * self.length * variable.precision.width()) as u64
    }
}

impl Crs {
    /// The attributes that CF (`crs_wkt`), GDAL and rioxarray (`spatial_ref`) look for; GDAL wants well-known text there, so
    /// a bare EPSG code is looked up.
    fn describe(&self, file: &mut NcFileBuilder, id: VariableId) -> netcdf_writer::Result<()> {
        let code = self.epsg.map(|code| format!("EPSG:{code}"));
        let known = self.epsg.and_then(well_known_text);
        let wkt = self.wkt.as_deref().or(known.as_deref());
        let names = [
            ("long_name", Some("coordinate reference system")),
            ("crs_wkt", wkt),
            ("spatial_ref", wkt.or(code.as_deref())),
            ("epsg_code", code.as_deref()),
        ];
        describe(file, id, names.into_iter().filter_map(|(name, value)| Some((name, value?))))?;
        match self.epsg.and_then(|code| i32::try_from(code).ok()) {
            Some(code) => file.add_variable_attribute(id, "epsg", NcAttrValue::Ints(vec![code])),
            None => Ok(()),
        }
    }
}

/// Nothing is looked up without the table of codes.
#[cfg(not(feature = "geo"))]
fn well_known_text(_epsg: u32) -> Option<String> {
    None
}

fn describe<'a>(
    file: &mut NcFileBuilder,
    id: VariableId,
    attributes: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> netcdf_writer::Result<()> {
    attributes.into_iter().try_for_each(|(name, value)| file.add_variable_attribute(id, name, text(value)))
}

fn text(value: &str) -> NcAttrValue {
    if value.len() > LONGEST_INLINE_TEXT {
        NcAttrValue::Strings(vec![value.into()])
    } else {
        NcAttrValue::Chars(value.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::frames::Field;
    use netcdf_reader::NcFile;
    use std::time::Duration;

    fn variable<'a>(name: &str, axes: &[&str], precision: Precision, values: Values<'a>) -> Variable<'a> {
        Variable {
            name: name.into(),
            long_name: format!("the {name}"),
            units: "m".into(),
            axes: axes.iter().map(|&axis| axis.into()).collect(),
            precision,
            values,
        }
    }

    fn sample(folder: &Path) -> (Dataset<'static>, Frames) {
        let fields = [("thickness", 6), ("speed", 6)];
        let fields = fields.map(|(name, length)| Field { name: name.into(), length }).into();
        let mut frames = Frames::create(&folder.join("frames"), Precision::F64, fields).unwrap();
        for t in [0.0, 0.5, 1.0] {
            let thickness: Vec<_> = (0..6).map(|i| t + f64::from(i) / 3.0).collect();
            frames.append(t, &[&thickness, &[t; 6]]).unwrap();
        }
        let dataset = Dataset {
            title: "Überlauf".into(),
            history: history(UNIX_EPOCH, "granflow run"),
            case: "# long\n".repeat(20_000),
            attributes: vec![("references".into(), String::new())],
            axes: vec![
                Axis::time(frames.times().to_vec(), "s"),
                Axis::along("Y", "y", vec![15.0, 5.0], "m", true),
                Axis::along("X", "x", vec![5.0, 15.0, 25.0], "m", true),
            ],
            variables: vec![
                variable(
                    "thickness",
                    &["time", "y", "x"],
                    Precision::F64,
                    Values::Stored("thickness".into()),
                ),
                variable("speed", &["time", "y", "x"], Precision::F32, Values::Stored("speed".into())),
                variable("bed", &["y", "x"], Precision::F32, Values::Static((0..6).map(f64::from).collect())),
                variable(
                    "edge",
                    &["time", "x"],
                    Precision::F64,
                    Values::Series(vec![vec![1.0; 3]; 3].into()),
                ),
            ],
            crs: Some(Crs { epsg: Some(31287), wkt: None }),
            terrain: Some(&[0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0]),
        };
        (dataset, frames)
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.nc");
        let (dataset, mut frames) = sample(folder.path());
        dataset.write(&path, Some(&mut frames)).unwrap();
        let file = NcFile::open(&path).unwrap();
        let thickness = file.read_variable::<f64>("thickness").unwrap();
        assert_eq!(thickness.shape(), [3, 2, 3]);
        assert_eq!(thickness[[2, 1, 2]].to_bits(), (1.0 + 5.0 / 3.0_f64).to_bits());
        assert!((0..3).all(|t| thickness[[t, 0, 1]].is_nan()));
        assert_eq!(thickness.iter().filter(|value| value.is_nan()).count(), 3);
        let speed = file.read_variable::<f32>("speed").unwrap();
        assert_eq!((speed[[1, 1, 1]], speed[[0, 0, 1]].is_nan()), (0.5, true));
        let bed = file.read_variable::<f32>("bed").unwrap();
        assert_eq!((bed.shape(), bed[[1, 2]]), (&[2, 3][..], 5.0));
        assert_eq!(file.read_variable::<f64>("edge").unwrap().sum(), 9.0);
        assert_eq!(file.read_variable::<f64>("time").unwrap().as_slice().unwrap(), [0.0, 0.5, 1.0]);
        assert_eq!(file.read_variable::<f64>("y").unwrap().as_slice().unwrap(), [15.0, 5.0]);
        let attribute = |name: &str| file.global_attribute(name).unwrap().value.as_string().unwrap();
        assert_eq!((attribute("Conventions"), attribute("title")), ("CF-1.11".into(), "Überlauf".into()));
        assert_eq!(attribute("case"), dataset.case);
        let crs = &file.variable("crs").unwrap().attributes;
        assert!(crs.iter().any(|a| {
            a.name == "spatial_ref"
                && a.value
                    .as_string()
                    .is_some_and(|wkt| wkt.contains("Austria Lambert") && !wkt.contains("TOWGS84"))
        }));
        let of_bed = &file.variable("bed").unwrap().attributes;
        assert!(
            of_bed.iter().any(|a| a.name == "grid_mapping" && a.value.as_string().as_deref() == Some("crs"))
        );
    }

    #[test]
    fn what_does_not_fit_together_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.nc");
        let (sound, mut frames) = sample(folder.path());
        let mut refuse = |part: &str, change: &dyn Fn(&mut Dataset)| {
            let mut dataset = sound.clone();
            change(&mut dataset);
            let message = dataset.write(&path, Some(&mut frames)).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("result.nc"), "{message}");
            assert!(!path.exists());
        };
        refuse("axis z", &|d| d.variables[2].axes[0] = "z".into());
        refuse("no field h", &|d| d.variables[0].values = Values::Stored("h".into()));
        refuse("1 maps of 6 values", &|d| d.variables[2].values = Values::Static(vec![0.0; 5].into()));
        refuse("3 maps of 3 values", &|d| {
            d.variables[3].values = Values::Series(vec![vec![0.0; 3]; 2].into())
        });
        refuse("does not fit", &|d| d.variables[0].values = Values::Static(vec![0.0; 18].into()));
        refuse("no values", &|d| d.axes[0].values.clear());
        refuse("bed", &|d| d.variables[1].name = "bed".into());
        assert!(sound.write(&path, None).unwrap_err().to_string().contains("needs the store"));
    }

    #[test]
    fn instants_are_written_as_dates() {
        let days = |days: u64| UNIX_EPOCH + Duration::from_secs(days * 86_400 + 3661);
        for (day, date) in
            [(0, "1970-01-01"), (11_016, "2000-02-29"), (11_017, "2000-03-01"), (19_722, "2023-12-31")]
        {
            assert_eq!(history(days(day), "x"), format!("{date}T01:01:01Z x"));
        }
    }
}
