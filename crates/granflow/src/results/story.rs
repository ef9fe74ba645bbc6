//! What the figures need of a run, from the run itself or from its files.

use super::{FilesError, Finished};
use crate::model::{Along, DURATIONS, Domain, Kind, Model, Pictures, Plane, ResultFile, View, save_all};
use crate::models::MODELS;
use crate::output;
use crate::output::figures::short;
use crate::output::frames::Frames;
use crate::output::ledger::Ledger;
use crate::output::lines::Table;
use crate::output::report;
use crate::output::summary::Summary;
use granflow_case::open_file;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A run as its figures see it, and the domain that draws it.
#[derive(Debug, Clone)]
pub struct Story<'a> {
    /// The numbers and words.
    pub view: View<'a>,
    /// What lies under the cells.
    pub domain: Arc<dyn Domain>,
}

/// The instants that figures show: all in one dimension, the first and the last otherwise.
fn instants(plane: &Plane, count: usize) -> Vec<usize> {
    match count {
        _ if plane.y.is_empty() => (0..count).collect(),
        0 | 1 => (0..count).collect(),
        _ => vec![0, count - 1],
    }
}

/// The series that figures show.
fn shown(plane: &Plane) -> &'static [&'static str] {
    let pictures = plane.model().pictures;
    pictures.map_or(&[], |pictures| pictures.shown(&*plane.domain, plane.dimensions()))
}

fn subtitle(plane: &Plane, scheme: &str, reason: &str, time: Option<f64>) -> String {
    let scheme = (plane.model().scheme_title)(scheme);
    match (time, plane.domain.units().label(" s")) {
        (Some(time), unit) => format!("{scheme}; {reason} at t = {}{unit}", short(time)),
        (None, _) => format!("{scheme}; {reason}"),
    }
}

impl<'r> Story<'r> {
    /// The story of a run that has just ended.
    ///
    /// # Errors
    /// [`FilesError`] if the frames cannot be read.
    pub fn of(run: &'r Finished) -> Result<Story<'r>, FilesError> {
        let plane = &run.plane;
        let mut frames = run.frames.again()?;
        let kept = instants(plane, frames.times().len());
        let mut series = Vec::new();
        for &name in shown(plane) {
            let Some(field) = frames.position(name) else { continue };
            let read: Result<_, output::Error> =
                kept.iter().map(|&frame| frames.read(frame, field)).collect();
            series.push((name, read?));
        }
        let summary = &run.summary;
        let reason = summary.stop_reason.to_string();
        let table = |path: &Option<PathBuf>| path.as_ref().map(|path| Table::read(path)).transpose();
        let watched = [table(&run.series[0])?, table(&run.series[1])?];
        let mut view = View {
            title: summary.title.clone(),
            subtitle: subtitle(plane, &summary.scheme, &reason, Some(summary.time)),
            units: plane.domain.units(),
            x: plane.x.clone(),
            y: plane.y.clone(),
            times: kept.iter().map(|&frame| frames.times()[frame]).collect(),
            series,
            maps: run.maps.iter().map(|(name, map)| (*name, map.into())).collect(),
            ledger: run.ledger.clone(),
            watched,
            along: None,
            thresholds: thresholds(|name| summary.extra(name)),
        };
        view.along = along(run, &view, &mut frames)?;
        Ok(Story { view, domain: plane.domain.clone() })
    }

    /// The story in a `result.nc` of a model of this library, with the `mass.csv` and the `summary.json` beside it
    /// where they are.
    ///
    /// # Errors
    /// [`FilesError`] naming the file that is missing, damaged, or no result of granflow.
    pub fn read(path: &Path) -> Result<Story<'static>, FilesError> {
        Self::read_with(path, MODELS)
    }

    /// As [`Story::read`], of one of these models.
    ///
    /// # Errors
    /// As [`Story::read`].
    pub fn read_with(path: &Path, models: &[&'static Model]) -> Result<Story<'static>, FilesError> {
        let foreign = |problem: String| FilesError::Foreign { path: path.into(), problem };
        open_file(path).map_err(|source| FilesError::Missing { path: path.into(), source })?;
        let file = ResultFile::open(path).map_err(foreign)?;
        let (model, pictures) = model(&file, models).map_err(foreign)?;
        let plane = plane(&file, pictures).map_err(foreign)?;
        let beside = |name: &str| Some(path.with_file_name(name)).filter(|path| path.exists());
        let ledger = match beside("mass.csv") {
            Some(path) => Ledger::open(&path)?.entries().to_vec(),
            None => Vec::new(),
        };
        let summary = beside("summary.json").map(|path| Summary::read(&path)).transpose()?;
        let times = file.whole("time").map_err(foreign)?;
        let time = summary.map(|summary| summary.time).or(times.last().copied());
        let kept = instants(&plane, times.len());
        let mut series = Vec::new();
        for &name in shown(&plane).iter().filter(|name| file.has(name)) {
            let read = kept.iter().map(|&instant| file.instant(name, instant, plane.dimensions()));
            series.push((name, read.collect::<Result<_, String>>().map_err(foreign)?));
        }
        let mut maps = Vec::new();
        for map in model.of_kind(Kind::Map).filter(|map| file.has(map.name)) {
            maps.push((map.name, file.whole(map.name).map_err(foreign)?.into()));
        }
        let table = |name: &str| beside(name).map(|path| Table::read(&path)).transpose();
        let watched = [table("gauges.csv")?, table("sections.csv")?];
        let along = beside("range_time.csv").map(|path| Along::read(&path)).transpose()?;
        let view = View {
            title: file.text("title"),
            subtitle: subtitle(&plane, &file.text("scheme"), &file.text("stop_reason"), time),
            units: plane.domain.units(),
            times: kept.iter().map(|&instant| times[instant]).collect(),
            series,
            maps,
            ledger,
            watched,
            along,
            thresholds: thresholds(|name| file.text(name).parse().ok()),
            x: plane.x,
            y: plane.y,
        };
        Ok(Story { view, domain: plane.domain })
    }

    /// Draw the standard figures into `folder`.
    ///
    /// # Errors
    /// [`FilesError`] naming the figure or the file.
    pub fn draw(&self, folder: &Path) -> Result<Vec<report::Figure>, FilesError> {
        let Some(pictures) = self.domain.model().pictures else { return Ok(Vec::new()) };
        Ok(save_all(&pictures.figures(&self.view, &*self.domain), folder)?)
    }
}

/// The thresholds of the maps of durations, each from what is kept under its name.
fn thresholds(kept: impl Fn(&str) -> Option<f64>) -> Vec<(&'static str, f64)> {
    DURATIONS.into_iter().filter_map(|(name, ..)| Some((name, kept(&format!("{name}_threshold"))?))).collect()
}

/// What passed along the path that the case names, else along that which is found, where mass flows on a map.
fn along(run: &Finished, view: &View, frames: &mut Frames) -> Result<Option<Along>, FilesError> {
    let domain = &*run.plane.domain;
    let Some(pictures) = domain.model().pictures.filter(|_| domain.projected()) else { return Ok(None) };
    let Some(points) = run.path.clone().or_else(|| pictures.path(view, domain)) else { return Ok(None) };
    let threshold = run.summary.threshold.unwrap_or(0.0);
    Ok(Along::of((&points, run.path_width), [&run.plane.x, &run.plane.y], threshold, frames)?)
}

/// The model that a file names; of a file that names none of these, the first whose variables it has.
fn model(
    file: &ResultFile,
    models: &[&'static Model],
) -> Result<(&'static Model, &'static dyn Pictures), String> {
    let drawn = || models.iter().filter_map(|model| model.pictures.map(|pictures| (*model, pictures)));
    let named = file.text("model");
    let missing = |pictures: &dyn Pictures| pictures.needed().iter().find(|name| !file.has(name)).copied();
    let fits = || drawn().find(|(_, pictures)| missing(*pictures).is_none());
    let found = drawn().find(|(model, _)| model.name == named).or_else(fits).or_else(|| drawn().next());
    let found = found.ok_or("nothing draws any model")?;
    match missing(found.1) {
        Some(name) => Err(format!("it has no variable `{name}`")),
        None => Ok(found),
    }
}

/// The cells of a file, and what lies under them.
fn plane(file: &ResultFile, pictures: &dyn Pictures) -> Result<Plane, String> {
    let (x, y) = (file.whole("x")?, file.optional("y")?);
    let domain = pictures.domain(file, [&x, &y])?;
    Ok(Plane { x, y, domain })
}
