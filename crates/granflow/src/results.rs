//! What a run leaves: the series, the maps, the books, and the files made of them.

mod animation;
mod chute_figures;
mod drawing;
mod files;
mod history_figure;
mod mountain_figures;
mod outlines;
mod path;
mod rasters;
mod story;

pub use files::{FILM_SHARE, FilesError};
pub use story::Story;

use crate::case::{Case, FileKind};
use crate::output::frames::Frames;
use crate::output::ledger::Entry;
use crate::output::netcdf::{Axis, Crs, Dataset, Values, Variable, history};
use crate::output::summary::Summary;
use crate::output::{self, Precision};
use crate::raster::Raster;
use crate::setup::Scene;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Where the cells lie, and what lies under them.
#[derive(Debug, Clone)]
pub struct Plane {
    /// Cell centres along x.
    pub x: Vec<f64>,
    /// Cell centres along y; empty in one dimension.
    pub y: Vec<f64>,
    /// The mountain, if it is one; lengths are then metres, times seconds.
    pub bed: Option<Raster>,
    /// Released thickness normal to the bed on a mountain, thickness at the start on a chute.
    pub release: Vec<f64>,
}

impl Plane {
    /// The cells of a scene, from the lower corner, the size and the number of cells per axis.
    #[must_use]
    pub fn of(scene: &Scene, origin: &[f64], size: &[f64], cells: &[usize]) -> Plane {
        let centres =
            |k: usize| (0..cells[k]).map(|i| origin[k] + (i as f64 + 0.5) * size[k]).collect::<Vec<f64>>();
        let (bed, release) = match scene {
            Scene::Chute { initial, .. } => (None, initial.thickness.clone()),
            Scene::Mountain { terrain, release, .. } => {
                let normal = |(k, volume): (usize, &f64)| volume * terrain.cosine(k);
                (Some(terrain.bed.clone()), release.iter().enumerate().map(normal).collect())
            }
        };
        Plane { x: centres(0), y: if cells.len() > 1 { centres(1) } else { Vec::new() }, bed, release }
    }
    /// Is it a mountain?
    #[must_use]
    pub fn is_terrain(&self) -> bool {
        self.bed.is_some()
    }
    /// Bed elevation of every cell \[m\], on a mountain.
    #[must_use]
    pub fn bed(&self) -> Option<&[f64]> {
        self.bed.as_ref().map(|raster| raster.values.as_slice())
    }
    /// Names of the quantities that are kept as series, in the order of the frames.
    #[must_use]
    pub fn series(&self) -> Vec<&'static str> {
        let mut names = vec!["thickness", "velocity_x"];
        if !self.y.is_empty() {
            names.push("velocity_y");
        }
        if self.is_terrain() {
            names.extend(["surface", "speed"]);
        }
        names
    }
}

/// A run that has ended, with all it leaves.
#[derive(Debug)]
pub struct Finished {
    /// Folder of the results.
    pub directory: PathBuf,
    /// Kinds of files that the case asks for.
    pub files: Vec<FileKind>,
    /// The whole text of the case.
    pub case: String,
    /// Where the cells lie.
    pub plane: Plane,
    /// The series, on disk.
    pub frames: Frames,
    /// The ledger.
    pub ledger: Vec<Entry>,
    /// peak_thickness, peak_speed, peak_pressure (terrain, kPa), arrival_time, stopping_time, deposit, yield_margin;
    /// x fastest, the first row in the south.
    pub maps: Vec<(&'static str, Vec<f64>)>,
    /// A thinner layer is a film.
    pub film: f64,
    /// The figures of the run.
    pub summary: Summary,
}

/// Names of the maps that a run may leave.
const MAPS: [&str; 7] = [
    "peak_thickness",
    "peak_speed",
    "peak_pressure",
    "arrival_time",
    "stopping_time",
    "deposit",
    "yield_margin",
];

/// Name, long name, and units in the papers' scaling and in SI.
const QUANTITIES: [(&str, &str, &str, &str); 13] = [
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
];

/// The peak pressure that counts as reached, for the runout \[kPa\].
const REACHED: f64 = 1.0;

impl Finished {
    /// Put together what a run leaves, with the maps and figures that follow from others.
    #[expect(clippy::too_many_arguments, reason = "the parts of one struct, each needed")]
    pub(crate) fn new(
        case: &Case,
        directory: PathBuf,
        plane: Plane,
        frames: Frames,
        ledger: Vec<Entry>,
        mut maps: Vec<(&'static str, Vec<f64>)>,
        deposit: Vec<f64>,
        margins: Vec<f64>,
        mut summary: Summary,
    ) -> Finished {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(*v));
        if plane.is_terrain()
            && let Some((_, speed)) = maps.iter().find(|(name, _)| *name == "peak_speed")
        {
            let pressure: Vec<f64> =
                speed.iter().map(|v| case.material().density() * v * v / 1000.0).collect();
            summary.add("peak_pressure_max", largest(&pressure));
            if let Some((length, drop)) = runout(&plane, &pressure) {
                summary.runout = Some(length);
                summary.reach_angle = Some((drop / length).atan().to_degrees());
            }
            maps.push(("peak_pressure", pressure));
        }
        maps.push(("deposit", deposit));
        maps.push(("yield_margin", margins));
        for (name, values) in &maps {
            if matches!(*name, "peak_thickness" | "peak_speed" | "deposit" | "yield_margin") {
                summary.add(&format!("{name}_max"), largest(values));
            }
        }
        let (files, film) = (case.files(), case.scheme.film());
        Finished { directory, files, case: case.text(), plane, frames, ledger, maps, film, summary }
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
    pub fn write_result(&self, command: &str) -> Result<(), output::Error> {
        let terrain = self.plane.is_terrain();
        let (length, time) = if terrain { ("m", "s") } else { ("1", "1") };
        let mut frames = Frames::open(self.frames.path())?.0;
        let mut axes = vec![Axis::time(frames.times().to_vec(), time)];
        let mut space = vec!["x".to_owned()];
        if !self.plane.y.is_empty() {
            axes.push(Axis::along("Y", "y", self.plane.y.clone(), length, terrain));
            space.insert(0, "y".to_owned());
        }
        axes.push(Axis::along("X", "x", self.plane.x.clone(), length, terrain));
        let precision = frames.precision();
        let variable = |name: &str, series: bool, precision: Precision, values: Values| {
            let (_, long_name, scaled, si) =
                QUANTITIES.iter().find(|(known, ..)| *known == name).copied().unwrap_or(("", "", "1", "1"));
            let mut axes = space.clone();
            if series {
                axes.insert(0, "time".to_owned());
            }
            let units = if terrain { si } else { scaled }.to_owned();
            Variable {
                name: name.to_owned(),
                long_name: long_name.to_owned(),
                units,
                axes,
                precision,
                values,
            }
        };
        let mut variables: Vec<Variable> = frames
            .fields()
            .iter()
            .map(|field| variable(&field.name, true, precision, Values::Stored(field.name.clone())))
            .collect();
        if let Some(bed) = self.plane.bed() {
            variables.push(variable("bed", false, Precision::F64, Values::Static(bed.to_vec())));
        }
        for (name, map) in &self.maps {
            variables.push(variable(name, false, precision, Values::Static(map.clone())));
        }
        let crs = self.plane.bed.as_ref().and_then(|bed| bed.crs.as_ref());
        let dataset = Dataset {
            title: self.summary.title.clone(),
            history: history(SystemTime::now(), command),
            case: self.case.clone(),
            attributes: vec![
                ("model".to_owned(), self.summary.model.clone()),
                ("scheme".to_owned(), self.summary.scheme.clone()),
                ("stop_reason".to_owned(), self.summary.stop_reason.to_string()),
            ],
            axes,
            variables,
            crs: crs.map(|crs| Crs { epsg: crs.epsg, wkt: crs.wkt.clone() }),
            outside: self.plane.bed().map(|bed| bed.iter().map(|z| z.is_nan()).collect()),
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
    let top =
        (0..bed.len()).filter(|&k| plane.release[k] > 0.0).max_by(|&a, &b| bed[a].total_cmp(&bed[b]))?;
    let from = |k: usize| {
        let (dx, dy) =
            (plane.x[k % columns] - plane.x[top % columns], plane.y[k / columns] - plane.y[top / columns]);
        dx.hypot(dy)
    };
    let far =
        (0..bed.len()).filter(|&k| pressure[k] >= REACHED).max_by(|&a, &b| from(a).total_cmp(&from(b)))?;
    (from(far) > 0.0).then(|| (from(far), bed[top] - bed[far]))
}
