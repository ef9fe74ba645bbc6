//! What a run leaves: the series, the maps, the books, and the files made of them.

mod animation;
mod chute_figures;
mod drawing;
mod files;
mod history_figure;
mod mountain_figures;
mod outlines;
mod path;
mod plane;
mod profiles;
mod rasters;
mod story;
mod table_figures;

pub use files::{FILM_SHARE, FilesError};
pub use plane::{Plane, Table, Under};
pub use story::Story;

use crate::case::{FileKind, RunPlan};
use crate::output::frames::Frames;
use crate::output::ledger::Entry;
use crate::output::netcdf::{Axis, Crs, Dataset, Values, Variable, history};
use crate::output::summary::Summary;
use crate::output::{self, Precision};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A run that has ended, with all it leaves.
#[derive(Debug)]
pub struct Finished {
    /// Folder of the results.
    pub directory: PathBuf,
    /// Kinds of files that the case asks for.
    pub files: Vec<FileKind>,
    /// The text of the case, with the overrides as comment lines.
    pub case: String,
    /// The case with the overrides laid in.
    pub resolved: String,
    /// Where the cells lie.
    pub plane: Plane,
    /// The series, on disk.
    pub frames: Frames,
    /// The ledger.
    pub ledger: Vec<Entry>,
    /// peak_thickness, peak_speed, peak_pressure (terrain, kPa), arrival_time, stopping_time, deposit, yield_margin; on a
    /// table source (cells) and determined (nodes); x fastest, the first row in the south.
    pub maps: Vec<(&'static str, Vec<f64>)>,
    /// A thinner layer is a film.
    pub film: f64,
    /// The figures of the run.
    pub summary: Summary,
}

/// Names of the maps that a run may leave.
const MAPS: [&str; 9] = [
    "peak_thickness",
    "peak_speed",
    "peak_pressure",
    "arrival_time",
    "stopping_time",
    "deposit",
    "yield_margin",
    "source",
    "determined",
];

/// Name, long name, and units in the papers' scaling and in SI.
const QUANTITIES: [(&str, &str, &str, &str); 20] = [
    ("thickness", "thickness normal to the bed", "1", "m"),
    ("velocity_x", "velocity along x", "1", "m s-1"),
    ("velocity_y", "velocity along y", "1", "m s-1"),
    ("surface", "elevation of the free surface", "1", "m"),
    ("speed", "speed along the bed", "1", "m s-1"),
    ("bed", "elevation of the bed", "1", "m"),
    ("peak_thickness", "largest thickness normal to the bed", "1", "m"),
    ("peak_speed", "largest speed along the bed", "1", "m s-1"),
    ("peak_pressure", "largest dynamic pressure, density times speed squared", "1", "kPa"),
    ("arrival_time", "time at which the mass arrived", "1", "s"),
    ("stopping_time", "time at which the cell last moved", "1", "s"),
    ("deposit", "thickness normal to the bed at the end", "1", "m"),
    ("yield_margin", "pull at the end as a share of the largest that friction holds", "1", "1"),
    ("standing_layer", "thickness of the standing layer", "1", "1"),
    ("rolling_layer", "thickness of the rolling layer", "1", "1"),
    ("table_height", "height of the table", "1", "1"),
    ("source", "sand poured on per area and time at the end", "1", "1"),
    ("determined", "1 where the equilibrium fixes the standing layer, else 0", "1", "1"),
    ("wall_x", "1 where the face across x is a wall, else 0", "1", "1"),
    ("wall_y", "1 where the face across y is a wall, else 0", "1", "1"),
];

/// The peak pressure that counts as reached, for the runout \[kPa\].
const REACHED: f64 = 1.0;

impl Finished {
    /// Put together what a run leaves, with the maps and figures that follow from others, of a mass that is a film below
    /// the first of two numbers and whose density is the second.
    #[must_use]
    pub fn new(
        case: &RunPlan,
        [film, density]: [f64; 2],
        directory: PathBuf,
        plane: Plane,
        frames: Frames,
        ledger: Vec<Entry>,
        mut maps: Vec<(&'static str, Vec<f64>)>,
        mut summary: Summary,
    ) -> Finished {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(*v));
        if plane.is_terrain()
            && let Some((_, speed)) = maps.iter().find(|(name, _)| *name == "peak_speed")
        {
            let pressure: Vec<f64> = speed.iter().map(|v| density * v * v / 1000.0).collect();
            summary.add("peak_pressure_max", largest(&pressure));
            if let Some((length, drop)) = runout(&plane, &pressure) {
                summary.runout = Some(length);
                summary.reach_angle = Some((drop / length).atan().to_degrees());
            }
            maps.push(("peak_pressure", pressure));
        }
        for (name, values) in &maps {
            if matches!(*name, "peak_thickness" | "peak_speed" | "deposit" | "yield_margin") {
                summary.add(&format!("{name}_max"), largest(values));
            }
        }
        let (files, text, resolved) = (case.files.clone(), case.text(), case.resolved());
        Finished { directory, files, case: text, resolved, plane, frames, ledger, maps, film, summary }
    }

    /// A map by its name.
    #[must_use]
    pub fn map(&self, name: &str) -> Option<&[f64]> {
        self.maps.iter().find(|(known, _)| *known == name).map(|(_, values)| values.as_slice())
    }

    /// Write `result.nc`.
    ///
    /// # Errors
    /// [`output::Error`] naming the file.
    pub fn write_result<'a>(&'a self, command: &str) -> Result<(), output::Error> {
        let terrain = self.plane.is_terrain();
        let (length, time) = if terrain { ("m", "s") } else { ("1", "1") };
        let mut frames = self.frames.again()?;
        let mut axes = vec![Axis::time(frames.times().to_vec(), time)];
        let (x, y) = (&self.plane.x, &self.plane.y);
        let mut along = |axis, name: &str, places: &[f64]| {
            if !places.is_empty() {
                axes.push(Axis::along(axis, name, places.to_vec(), length, terrain));
            }
        };
        along("Y", "y", y);
        along("X", "x", x);
        if let Some(table) = self.plane.as_table() {
            along("Y", "y_node", &table.y_node);
            along("X", "x_node", &table.x_node);
        }
        let precision = frames.precision();
        let variable = |name: &str, at: [&str; 2], series: bool, precision: Precision, values: Values<'a>| {
            let (_, long_name, scaled, si) =
                QUANTITIES.iter().find(|(known, ..)| *known == name).copied().unwrap_or(("", "", "1", "1"));
            let space = if y.is_empty() { &at[1..] } else { &at };
            let axes = series.then_some("time").into_iter().chain(space.iter().copied());
            let units = if terrain { si } else { scaled }.to_owned();
            Variable {
                name: name.to_owned(),
                long_name: long_name.to_owned(),
                units,
                axes: axes.map(str::to_owned).collect(),
                precision,
                values,
            }
        };
        let cells = x.len() * y.len().max(1);
        let place = |length: usize| if length == cells { ["y", "x"] } else { ["y_node", "x_node"] };
        let mut variables = Vec::new();
        for field in frames.fields() {
            let stored = Values::Stored(field.name.clone());
            variables.push(variable(&field.name, place(field.length), true, precision, stored));
        }
        let mut fixed = |name: &str, at: [&str; 2], precision: Precision, map: Cow<'a, [f64]>| {
            if !map.is_empty() {
                variables.push(variable(name, at, false, precision, Values::Static(map)));
            }
        };
        if let Some(bed) = self.plane.bed() {
            fixed("bed", ["y", "x"], Precision::F64, bed.into());
        }
        if let Some(table) = self.plane.as_table() {
            let faces = |walls: &[bool]| walls.iter().map(|&wall| f64::from(wall)).collect();
            fixed("table_height", ["y_node", "x_node"], Precision::F64, table.height.as_slice().into());
            fixed("wall_x", ["y", "x_node"], precision, faces(&table.wall_x));
            fixed("wall_y", ["y_node", "x"], precision, faces(&table.wall_y));
        }
        for (name, map) in &self.maps {
            fixed(name, place(map.len()), precision, map.as_slice().into());
        }
        let crs = self.plane.mountain().and_then(|bed| bed.crs.as_ref());
        let dataset = Dataset {
            title: self.summary.title.clone(),
            history: history(SystemTime::now(), command),
            case: self.resolved.clone(),
            attributes: vec![
                ("case_text".to_owned(), self.case.clone()),
                ("model".to_owned(), self.summary.model.clone()),
                ("scheme".to_owned(), self.summary.scheme.clone()),
                ("stop_reason".to_owned(), self.summary.stop_reason.to_string()),
            ],
            axes,
            variables,
            crs: crs.map(|crs| Crs { epsg: crs.epsg, wkt: crs.wkt.clone() }),
            terrain: self.plane.bed(),
        };
        dataset.write(&self.result(), Some(&mut frames))
    }

    /// Path of `result.nc`.
    #[must_use]
    pub fn result(&self) -> PathBuf {
        self.directory.join("result.nc")
    }
    /// Folder of the figures.
    #[must_use]
    pub fn figures(&self) -> PathBuf {
        self.directory.join(Path::new("figures"))
    }
}

/// Horizontal length, and drop, from the highest released cell to the farthest that the mass reached with a peak
/// pressure of [`REACHED`].
fn runout(plane: &Plane, pressure: &[f64]) -> Option<(f64, f64)> {
    let bed = plane.bed()?;
    let columns = plane.x.len();
    let released = plane.release.iter().filter(|(_, thickness)| *thickness > 0.0).map(|(cell, _)| cell);
    let top = released.max_by(|&a, &b| bed[a].total_cmp(&bed[b]))?;
    let from = |k: usize| {
        let (dx, dy) =
            (plane.x[k % columns] - plane.x[top % columns], plane.y[k / columns] - plane.y[top / columns]);
        dx.hypot(dy)
    };
    let far =
        (0..bed.len()).filter(|&k| pressure[k] >= REACHED).max_by(|&a, &b| from(a).total_cmp(&from(b)))?;
    (from(far) > 0.0).then(|| (from(far), bed[top] - bed[far]))
}
