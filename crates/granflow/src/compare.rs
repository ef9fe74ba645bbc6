//! How well a run meets another one, or what was mapped: `granflow compare`.
//!
//! Both sides are sets in the plane: the cells whose thickness exceeds a threshold, or the inside of polygons. Their areas are
//! cut with each other as they are, so that grids need not agree and nothing is resampled.

mod area;
mod error;
mod grid;
mod picture;
mod reach;
mod side;

pub use error::CompareError;

use crate::output::{self, whole_file};
use reach::Path as Track;
use serde::Serialize;
use side::Side;
use std::path::{Path, PathBuf};

/// The map of a result that is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// All that was reached: the map `peak_thickness`.
    #[default]
    Footprint,
    /// What lies at the end: the map `deposit`.
    Deposit,
}

impl By {
    /// What it is called.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Footprint => "footprint",
            Self::Deposit => "deposit",
        }
    }

    const fn map(self) -> &'static str {
        match self {
            Self::Footprint => "peak_thickness",
            Self::Deposit => "deposit",
        }
    }
}

/// The threshold where nobody says another one (units of the thickness).
pub const THRESHOLD: f64 = 0.1;

/// What is compared, and how.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options {
    /// Thickness that a layer must exceed to belong to an area (units of the thickness); [`THRESHOLD`] where `None`, or what the
    /// maps of a result begin at where that is more.
    pub threshold: Option<f64>,
    /// The map of a result.
    pub by: By,
    /// The thickness of a raster is along the vertical, as a difference of elevations is; else normal to the bed.
    pub vertical: bool,
}

/// One of the two sides in numbers; lengths, areas and volumes in the units of the run (m, m², m³ on terrain).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// The file.
    pub path: PathBuf,
    /// `result`, `raster` or `outline`.
    pub kind: &'static str,
    /// Its area; in one dimension a length.
    pub area: f64,
    /// Volume of its deposit; none of an outline.
    pub volume: Option<f64>,
    /// How far it reaches along the path, from the begin of the path on.
    pub runout: Option<f64>,
    /// The straight horizontal distance of its farthest place from the begin of the path.
    pub reach: Option<f64>,
    /// The largest peak thickness, of a result.
    pub peak_thickness: Option<f64>,
    /// The largest peak speed, of a result.
    pub peak_speed: Option<f64>,
}

/// How A meets B. Differences are A minus B, and none where a side does not have the quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The critical success index: hit / (hit + miss + false), 1 where both areas are one.
    ///
    /// J. T. Schaefer, The critical success index as an indicator of warning skill, Weather and Forecasting 5 (1990).
    pub csi: f64,
    /// Area of both.
    pub hit_area: f64,
    /// Area of B that A misses.
    pub miss_area: f64,
    /// Area of A that B does not have.
    pub false_area: f64,
    /// Difference of the runouts along the path.
    pub runout_difference: Option<f64>,
    /// Difference of the straight reaches.
    pub reach_difference: Option<f64>,
    /// Difference of the volumes of the deposits.
    pub volume_difference: Option<f64>,
    /// Distance of the centroids.
    pub centroid_distance: Option<f64>,
    /// What the centroids are those of: the volume of the deposits, or the area where a side has no thickness.
    pub centroid_of: &'static str,
    /// Difference of the largest peak thicknesses.
    pub peak_thickness_difference: Option<f64>,
    /// Difference of the largest peak speeds.
    pub peak_speed_difference: Option<f64>,
    /// What was compared.
    pub by: By,
    /// Thickness that a layer exceeds in the compared areas.
    pub threshold: f64,
    /// The side that is judged.
    pub a: Measured,
    /// The side that it is held against.
    pub b: Measured,
    /// What to know before the numbers are trusted, one sentence each.
    pub notes: Vec<String>,
    #[serde(skip)]
    drawn: Drawn,
}

/// What the figure needs.
#[derive(Debug, Clone)]
struct Drawn {
    sides: [Side; 2],
    path: Option<Track>,
}

/// The figure is drawn from the same sides.
impl PartialEq for Drawn {
    fn eq(&self, _: &Drawn) -> bool {
        true
    }
}

/// Compares A with B, each the folder or the `result.nc` of a run, a raster of thickness (GeoTIFF, ESRI ASCII), or an outline
/// (polygons in GeoJSON or a shapefile). B is what A is held against: what only B has is missed, what only A has is false.
///
/// # Errors
/// [`CompareError`]: a file that cannot be read, sides that have no common place, nothing above the threshold.
pub fn compare(a: &Path, b: &Path, options: &Options) -> Result<Comparison, CompareError> {
    if let Some(threshold) = options.threshold.filter(|value| !(*value >= 0.0 && value.is_finite())) {
        return Err(CompareError::Threshold { threshold });
    }
    let mut notes = Vec::new();
    let mut sides = [Side::read(a, options.by, &mut notes)?, Side::read(b, options.by, &mut notes)?];
    side::fit(&sides, &mut notes)?;
    let threshold = threshold(&sides, options)?;
    sides.iter_mut().for_each(|side| side.mark(threshold));
    side::weigh(&mut sides, options.vertical);
    let [area_a, area_b] = sides.each_ref().map(Side::area);
    if area_a.size() == 0.0 && area_b.size() == 0.0 {
        return Err(CompareError::Nothing { threshold, a: a.into(), b: b.into() });
    }
    notes.extend(sides.iter().flat_map(|side| side.remarks(options.by)));
    notes.extend(beyond(&sides));
    Ok(numbers(sides, threshold, options.by, notes))
}

/// The threshold that all sides can show.
fn threshold(sides: &[Side; 2], options: &Options) -> Result<f64, CompareError> {
    let (least, of) = sides.iter().fold((0.0, &sides[0]), |(least, of), side| match side.least() {
        own if own > least => (own, side),
        _ => (least, of),
    });
    match options.threshold {
        Some(threshold) if threshold < least => {
            Err(CompareError::TooThin { path: of.path().into(), threshold, least })
        }
        Some(threshold) => Ok(threshold),
        None => Ok(THRESHOLD.max(least)),
    }
}

/// A note for each side whose area lies partly where the other, a run, has no cells.
fn beyond(sides: &[Side; 2]) -> Vec<String> {
    let [a, b] = sides;
    let note = |(run, other): (&Side, &Side)| {
        let (all, within) = (other.area().size(), other.area().common(&run.cells()?));
        let share = 100.0 * (1.0 - within / all);
        (all > 0.0 && share > 1e-6).then(|| {
            let [other, run] = [other, run].map(|side| side.path().display());
            format!("{share:.2} % of the area of {other} lies where {run} has no cells")
        })
    };
    [(a, b), (b, a)].into_iter().filter_map(note).collect()
}

fn numbers(sides: [Side; 2], threshold: f64, by: By, mut notes: Vec<String>) -> Comparison {
    let path = Track::longest(sides.iter().filter_map(Side::track));
    if path.is_none() {
        notes.push("neither side is a run with a path: there is no runout to compare".to_owned());
    }
    let [a, b] = sides.each_ref().map(|side| side.measured(path.as_ref()));
    let [area_a, area_b] = sides.each_ref().map(Side::area);
    let hit_area = area_a.common(area_b).min(a.area).min(b.area);
    let (miss_area, false_area) = (b.area - hit_area, a.area - hit_area);
    let difference = |of: fn(&Measured) -> Option<f64>| Some(of(&a)? - of(&b)?);
    let (centroids, centroid_of) = match sides.each_ref().map(Side::centroid) {
        [Some(a), Some(b)] => ([Some(a), Some(b)], "volume"),
        _ => (sides.each_ref().map(|side| side.area().centroid()), "area"),
    };
    Comparison {
        csi: hit_area / (hit_area + miss_area + false_area),
        hit_area,
        miss_area,
        false_area,
        runout_difference: difference(|side| side.runout),
        reach_difference: difference(|side| side.reach),
        volume_difference: difference(|side| side.volume),
        centroid_distance: match centroids {
            [Some([x, y]), Some([u, v])] => Some((x - u).hypot(y - v)),
            _ => None,
        },
        centroid_of,
        peak_thickness_difference: difference(|side| side.peak_thickness),
        peak_speed_difference: difference(|side| side.peak_speed),
        by,
        threshold,
        a,
        b,
        notes,
        drawn: Drawn { sides, path },
    }
}

impl Comparison {
    /// Writes `compare.json` and the figure `compare.png` into a folder; returns their paths.
    ///
    /// # Errors
    /// [`CompareError`] naming the file.
    pub fn write(&self, folder: &Path) -> Result<[PathBuf; 2], CompareError> {
        let [json, figure] = ["compare.json", "compare.png"].map(|name| folder.join(name));
        let picture = picture::draw(self)?;
        output::figures::save(&picture, &figure)?;
        let written = whole_file(&json, |out| {
            serde_json::to_writer_pretty(&mut *out, self).map_err(std::io::Error::from)?;
            writeln!(out)
        });
        if written.is_err() {
            // A picture beside numbers of another comparison would be read as theirs.
            [&json, &figure].into_iter().try_for_each(|path| output::remove_if_there(path))?;
        }
        written?;
        Ok([json, figure])
    }
}

#[cfg(test)]
mod tests;
