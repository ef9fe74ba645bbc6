//! What the figures need of a run, from the run itself or from its files.

use super::{FilesError, Finished, Plane, Table, Under};
use crate::output;
use crate::output::ledger::{Entry, Ledger};
use crate::output::summary::Summary;
use crate::raster::Raster;
use crate::release::Sparse;
use netcdf_reader::{NcFile, NcSliceInfo, NcSliceInfoElem};
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

/// A run as its figures see it.
#[derive(Debug, Clone)]
pub struct Story<'a> {
    /// The case's title.
    pub title: String,
    /// Scheme, why and when the run ended, in one line.
    pub subtitle: String,
    /// Where the cells lie.
    pub plane: Plane,
    /// The instants that are kept: all in one dimension, the first and the last otherwise.
    pub times: Vec<f64>,
    /// What is shown of each of them, by name: on a chute `thickness` and, in one dimension, `velocity_x`; on a table
    /// `standing_layer` and `rolling_layer`.
    pub series: Vec<(&'static str, Vec<Vec<f64>>)>,
    /// The maps by name, as in [`Finished::maps`].
    pub maps: Vec<(&'static str, Cow<'a, [f64]>)>,
    /// The ledger; empty where it is not known.
    pub ledger: Vec<Entry>,
}

/// The instants that figures show: all in one dimension, the first and the last otherwise.
fn instants(plane: &Plane, count: usize) -> Vec<usize> {
    match count {
        _ if plane.y.is_empty() => (0..count).collect(),
        0 | 1 => (0..count).collect(),
        _ => vec![0, count - 1],
    }
}

/// The series that figures show; those of a mountain show maps alone.
fn shown(plane: &Plane) -> &'static [&'static str] {
    match (&plane.under, plane.y.is_empty()) {
        (Under::Table(_), _) => &["standing_layer", "rolling_layer"],
        (Under::Chute, true) => &["thickness", "velocity_x"],
        (Under::Chute, false) => &["thickness"],
        (Under::Mountain(_), _) => &[],
    }
}

fn subtitle(scheme: &str, reason: &str, time: Option<f64>, terrain: bool) -> String {
    let scheme = scheme.replace("verfahren_", "Verfahren ");
    let unit = if terrain { " s" } else { "" };
    match time {
        Some(time) => format!("{scheme}; {reason} at t = {}{unit}", crate::output::figures::short(time)),
        None => format!("{scheme}; {reason}"),
    }
}

impl<'r> Story<'r> {
    /// The story of a run that has just ended.
    ///
    /// # Errors
    /// [`FilesError`] if the frames cannot be read.
    pub fn of(run: &'r Finished) -> Result<Story<'r>, FilesError> {
        let plane = run.plane.clone();
        let mut frames = run.frames.again()?;
        let kept = instants(&plane, frames.times().len());
        let mut series = Vec::new();
        for &name in shown(&plane) {
            let Some(field) = frames.position(name) else { continue };
            let read: Result<_, output::Error> =
                kept.iter().map(|&frame| frames.read(frame, field)).collect();
            series.push((name, read?));
        }
        let summary = &run.summary;
        Ok(Story {
            title: summary.title.clone(),
            subtitle: subtitle(
                &summary.scheme,
                &summary.stop_reason.to_string(),
                Some(summary.time),
                plane.is_terrain(),
            ),
            times: kept.iter().map(|&frame| frames.times()[frame]).collect(),
            series,
            maps: run.maps.iter().map(|(name, map)| (*name, map.into())).collect(),
            ledger: run.ledger.clone(),
            plane,
        })
    }

    /// The story in a `result.nc`, with the `mass.csv` and the `summary.json` beside it where they are.
    ///
    /// # Errors
    /// [`FilesError`] naming the file that is missing, damaged, or no result of granflow.
    pub fn read(path: &Path) -> Result<Story<'static>, FilesError> {
        let foreign = |problem: String| FilesError::Foreign { path: path.into(), problem };
        std::fs::File::open(path).map_err(|source| FilesError::Missing { path: path.into(), source })?;
        let file =
            NcFile::open(path).map_err(|error| foreign(format!("it is no NetCDF-4 file ({error})")))?;
        let text = |name: &str| {
            let attribute = file.global_attribute(name).ok();
            attribute.and_then(|attribute| attribute.value.as_string()).unwrap_or_default()
        };
        let has = |name: &str| file.variable(name).is_ok();
        let table = has("standing_layer");
        let needed: &[&str] =
            if table { &["time", "x", "x_node", "rolling_layer"] } else { &["time", "x", "thickness"] };
        if let Some(name) = needed.iter().find(|name| !has(name)) {
            return Err(foreign(format!("it has no variable `{name}`")));
        }
        let whole = |name: &str| -> Result<Vec<f64>, FilesError> {
            let read = file.read_variable_as_f64(name);
            Ok(read.map_err(|error| foreign(format!("`{name}`: {error}")))?.iter().copied().collect())
        };
        let x = whole("x")?;
        let y = if has("y") { whole("y")? } else { Vec::new() };
        let optional = |name: &str| if has(name) { whole(name) } else { Ok(Vec::new()) };
        let under = if table {
            let faces = |name: &str| Ok::<_, FilesError>(optional(name)?.iter().map(|&w| w > 0.0).collect());
            Under::Table(Table {
                x_node: whole("x_node")?,
                y_node: optional("y_node")?,
                inside: Vec::new(),
                height: optional("table_height")?,
                wall_x: faces("wall_x")?,
                wall_y: faces("wall_y")?,
            })
        } else if has("bed") {
            Under::Mountain(Arc::new(raster(&x, &y, whole("bed")?).map_err(foreign)?))
        } else {
            Under::Chute
        };
        let times = whole("time")?;
        let mut plane = Plane { x, y, under, release: Sparse::default() };
        let kept = instants(&plane, times.len());
        let read = |name: &str| -> Result<Vec<Vec<f64>>, FilesError> {
            let all = NcSliceInfoElem::Slice { start: 0, end: u64::MAX, step: 1 };
            let frame = |&frame: &usize| {
                let mut selections = vec![NcSliceInfoElem::Index(frame as u64), all.clone()];
                selections.extend((!plane.y.is_empty()).then(|| all.clone()));
                let read = file.read_variable_slice_as_f64(name, &NcSliceInfo { selections });
                let values = read.map_err(|error| foreign(format!("`{name}`: {error}")))?;
                Ok(values.iter().copied().collect())
            };
            kept.iter().map(frame).collect()
        };
        let mut series = Vec::new();
        for &name in shown(&plane).iter().filter(|name| has(name)) {
            series.push((name, read(name)?));
        }
        let mut maps = Vec::new();
        for name in super::MAPS.into_iter().filter(|name| has(name)) {
            maps.push((name, whole(name)?.into()));
        }
        let beside = |name: &str| Some(path.with_file_name(name)).filter(|path| path.exists());
        let ledger = match beside("mass.csv") {
            Some(path) => Ledger::open(&path)?.entries().to_vec(),
            None => Vec::new(),
        };
        let summary = beside("summary.json").map(|path| Summary::read(&path)).transpose()?;
        let time = summary.map(|summary| summary.time).or(times.last().copied());
        let first = |name: &str| {
            series.iter().find(|(own, _)| *own == name).and_then(|(_, series)| series.first()).cloned()
        };
        plane.release = Sparse::of(match first("thickness") {
            None if has("thickness") => read("thickness")?.into_iter().next().unwrap_or_default(),
            start => start.unwrap_or_default(),
        });
        if let Under::Table(table) = &mut plane.under {
            table.inside = first("rolling_layer").unwrap_or_default().iter().map(|v| !v.is_nan()).collect();
            if !table.fits(&plane.x, &plane.y) {
                return Err(foreign("its cells do not fit its nodes".to_owned()));
            }
        }
        Ok(Story {
            title: text("title"),
            subtitle: subtitle(&text("scheme"), &text("stop_reason"), time, plane.is_terrain()),
            times: kept.iter().map(|&frame| times[frame]).collect(),
            series,
            maps,
            ledger,
            plane,
        })
    }

    /// A series by its name; empty if it is not shown.
    #[must_use]
    pub fn series(&self, name: &str) -> &[Vec<f64>] {
        self.series.iter().find(|(known, _)| *known == name).map_or(&[], |(_, series)| series)
    }

    /// A map by its name.
    #[must_use]
    pub fn map(&self, name: &str) -> Option<&[f64]> {
        self.maps.iter().find(|(known, _)| *known == name).map(|(_, values)| values.as_ref())
    }

    /// Unit of a quantity: `si` on a mountain, none in the papers' scaling.
    pub(super) fn unit<'s>(&self, si: &'s str) -> &'s str {
        if self.plane.is_terrain() { si } else { "" }
    }
}

/// The bed on the cells with these centres.
fn raster(x: &[f64], y: &[f64], values: Vec<f64>) -> Result<Raster, String> {
    let [Some(cell), Some(rows)] = [x, y].map(|c| c.get(1).map(|second| second - c[0])) else {
        return Err("its bed has fewer than two cells along an axis".to_owned());
    };
    if values.len() != x.len() * y.len() || cell <= 0.0 || rows <= 0.0 {
        return Err("its bed does not fit its coordinates".to_owned());
    }
    Ok(Raster {
        columns: x.len(),
        rows: y.len(),
        west: x[0] - 0.5 * cell,
        south: y[0] - 0.5 * cell,
        cell,
        values,
        crs: None,
    })
}
