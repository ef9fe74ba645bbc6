//! `result.nc`: a NetCDF-4 file after the CF-1.11 conventions, written without holding the series in memory.
//!
//! The crate netcdf-writer builds the skeleton (dimensions, coordinates, attributes, variables with no data yet);
//! the data are then appended block by block and the skeleton's object headers are told where they lie
//! (`output/hdf5.rs`).

mod described;
mod write;

use super::Precision;
use std::borrow::Cow;
use std::time::{SystemTime, UNIX_EPOCH};

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
    /// "X", "Y" or "T"; empty for a coordinate that is no place and no time.
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

/// A line for [`Dataset::history`]: the instant in UTC and the command, as in "2026-03-01T12:00:00Z granflow run
/// a.toml".
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::frames::{Field, Frames};
    use netcdf_reader::NcFile;
    use std::path::Path;
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
