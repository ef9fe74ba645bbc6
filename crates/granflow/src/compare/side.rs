//! One side of a comparison: a result, a raster of thickness, or an outline.

use super::area::Area;
use super::grid::CellGrid;
use super::reach::Path as Track;
use super::{By, CompareError, Measured};
use crate::model::{Domain, ResultFile, Units};
use crate::output::summary::StopReason;
use crate::raster::{Comparison, Crs, RasterError, Reading};
use crate::release::{Form, Layer, ReleaseError};
use crate::results::{FilesError, Story};
use geo::{MultiPolygon, unary_union};
use granflow_case::open_file;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The attribute of an outline of ours that says what it outlines, and what that may be.
const NAME: &str = "name";
const OURS: [&str; 3] = ["release", "deposit", "peak_thickness"];

/// One side of a comparison.
#[derive(Debug, Clone)]
pub(super) struct Side {
    path: PathBuf,
    area: Area,
    crs: Option<Crs>,
    /// The volume of the deposit, and its centroid.
    volume: Option<(f64, Option<[f64; 2]>)>,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Result(Box<Run>),
    /// The thickness in the cells; NaN for none.
    Raster(CellGrid, Vec<f64>),
    Outline,
}

/// What a comparison needs of a run.
#[derive(Debug, Clone)]
struct Run {
    grid: CellGrid,
    dimensions: usize,
    domain: Arc<dyn Domain>,
    /// The maps that decide: of the compared thickness, and the deposit.
    compared: Vec<f64>,
    deposit: Option<Vec<f64>>,
    peak_thickness: Option<f64>,
    peak_speed: Option<f64>,
    /// What its maps begin at.
    least: f64,
    track: Option<Vec<[f64; 2]>>,
    stop_reason: String,
}

impl Side {
    /// Reads it; `notes` hears what was decided.
    pub fn read(path: &Path, by: By, notes: &mut Vec<String>) -> Result<Side, CompareError> {
        let path = if path.is_dir() { path.join("result.nc") } else { path.to_owned() };
        let mut head = [0; 64];
        let read = open_file(&path).and_then(|mut file| file.read(&mut head));
        let read = match read {
            Ok(count) => &head[..count],
            Err(source) if path.extension().is_some_and(|end| end == "nc") => {
                return Err(FilesError::Missing { path, source }.into());
            }
            Err(source) => return Err(CompareError::Io { path, source }),
        };
        let text = String::from_utf8_lossy(read);
        let first = text.trim_start_matches('\u{feff}').trim_start().chars().next();
        match read {
            [0x89, b'H', b'D', b'F', ..] | [b'C', b'D', b'F', ..] => result(path, by),
            [0, 0, 0x27, 0x0a, ..] => outline(path, by, notes),
            [b'I', b'I', ..] | [b'M', b'M', ..] => raster(path, notes),
            _ if first == Some('{') => outline(path, by, notes),
            _ if first.is_some_and(|letter| letter.is_ascii_alphabetic()) => raster(path, notes),
            _ => Err(CompareError::Kind { path }),
        }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }
    pub fn area(&self) -> &Area {
        &self.area
    }
    pub fn domain(&self) -> Option<&dyn Domain> {
        self.run().map(|run| &*run.domain)
    }
    /// Its cells and the compared map, of a run in one dimension.
    pub fn line(&self) -> Option<(CellGrid, &[f64])> {
        let run = self.run().filter(|run| run.dimensions == 1)?;
        Some((run.grid, &run.compared))
    }
    /// The path of the mass.
    pub fn track(&self) -> Option<Vec<[f64; 2]>> {
        self.run()?.track.clone()
    }
    /// The smallest threshold that its maps can show.
    pub fn least(&self) -> f64 {
        self.run().map_or(0.0, |run| run.least)
    }
    /// The centroid of its deposit, by volume.
    pub fn centroid(&self) -> Option<[f64; 2]> {
        self.volume?.1
    }

    fn run(&self) -> Option<&Run> {
        match &self.kind {
            Kind::Result(run) => Some(run),
            Kind::Raster(..) | Kind::Outline => None,
        }
    }

    /// All cells of a run that have a bed, or are on a chute.
    pub fn cells(&self) -> Option<Area> {
        let Run { grid, domain, .. } = self.run()?;
        let marked = match domain.elevation() {
            Some(bed) => bed.iter().map(|level| level.is_finite()).collect(),
            None => vec![true; grid.cells()],
        };
        Some(Area::Cells { grid: *grid, marked })
    }

    /// The ends [low, high] along x and y of its cells or polygons.
    fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        match &self.kind {
            Kind::Result(run) => Some(run.grid.bounds()),
            Kind::Raster(grid, _) => Some(grid.bounds()),
            Kind::Outline => self.area.bounds(),
        }
    }

    /// Mark the cells that are thicker than the threshold.
    pub fn mark(&mut self, threshold: f64) {
        let above = |thickness: &[f64]| thickness.iter().map(|h| *h > threshold).collect();
        match &self.kind {
            Kind::Result(run) => {
                self.area = Area::Cells { grid: run.grid, marked: above(&run.compared) };
            }
            Kind::Raster(grid, thickness) => {
                self.area = Area::Cells { grid: *grid, marked: above(thickness) };
            }
            Kind::Outline => {}
        }
    }

    /// What to know of it.
    pub fn remarks(&self, by: By) -> Vec<String> {
        let mut remarks = Vec::new();
        let path = self.path.display();
        if self.area.size() == 0.0 {
            remarks.push(format!("{path} has no area above the threshold"));
        }
        if let Some(run) = self.run().filter(|_| by == By::Deposit)
            && ![StopReason::AtRest, StopReason::Trickle, StopReason::Steady]
                .iter()
                .any(|rest| rest.to_string() == run.stop_reason)
        {
            remarks.push(format!(
                "{path} ended before the mass was at rest ({}): its deposit is the thickness at the end",
                run.stop_reason
            ));
        }
        remarks
    }

    /// It in numbers, along a path.
    pub fn measured(&self, track: Option<&Track>) -> Measured {
        let rim = if track.is_some() { self.area.rim() } else { Vec::new() };
        let farthest = |of: &dyn Fn(&Track, [f64; 2]) -> f64| {
            let places = rim.iter().filter_map(|place| Some(of(track?, *place)));
            places.max_by(f64::total_cmp)
        };
        Measured {
            path: self.path.clone(),
            kind: match self.kind {
                Kind::Result(_) => "result",
                Kind::Raster(..) => "raster",
                Kind::Outline => "outline",
            },
            area: self.area.size(),
            volume: self.volume.map(|(volume, _)| volume),
            runout: farthest(&Track::along),
            reach: farthest(&Track::straight),
            peak_thickness: self.run().and_then(|run| run.peak_thickness),
            peak_speed: self.run().and_then(|run| run.peak_speed),
        }
    }
}

/// A run by its `result.nc`.
fn result(path: PathBuf, by: By) -> Result<Side, CompareError> {
    let Story { view, domain } = Story::read(&path)?;
    let file = ResultFile::open(&path)
        .map_err(|problem| FilesError::Foreign { path: path.clone(), problem: problem.clone() })?;
    let grid = CellGrid::of(&view.x, &view.y)
        .map_err(|problem| FilesError::Foreign { path: path.clone(), problem })?;
    let Some(compared) = view.map(by.map()).filter(|map| map.len() == grid.cells()) else {
        return Err(CompareError::NoMap { path, map: by.map() });
    };
    let largest = |name: &str| Some(view.map(name)?.iter().copied().fold(0.0_f64, f64::max));
    let least = file.text("threshold").split_whitespace().next().and_then(|number| number.parse().ok());
    let pictures = domain.model().pictures;
    let run = Run {
        dimensions: view.dimensions(),
        compared: compared.to_vec(),
        deposit: view.map("deposit").map(<[f64]>::to_vec),
        peak_thickness: largest("peak_thickness"),
        peak_speed: largest("peak_speed"),
        least: least.unwrap_or(0.0),
        track: pictures.and_then(|pictures| pictures.path(&view, &*domain)),
        stop_reason: file.text("stop_reason"),
        grid,
        domain,
    };
    let crs = run.domain.crs().map(|crs| Crs { epsg: crs.epsg, wkt: crs.wkt });
    Ok(Side { path, area: unmarked(grid), crs, volume: None, kind: Kind::Result(Box::new(run)) })
}

fn unmarked(grid: CellGrid) -> Area {
    Area::Cells { grid, marked: Vec::new() }
}

/// A raster of thickness.
fn raster(path: PathBuf, notes: &mut Vec<String>) -> Result<Side, CompareError> {
    let Reading { raster, notes: read, .. } = Reading::of(&path, None)?;
    notes.extend(read.iter().map(|remark| remark.text().to_owned()));
    // A difference of elevation models falls where mass was taken up.
    let below: Vec<f64> = raster.values.iter().copied().filter(|h| *h < 0.0).collect();
    if !below.is_empty() {
        let volume = -below.iter().sum::<f64>() * raster.cell * raster.cell;
        notes.push(format!(
            "{}: {} cells are below 0, {volume:.1} m3 in all: they count as bare, and their volume is left out",
            path.display(),
            below.len()
        ));
    }
    let grid = CellGrid::from(&*raster);
    let crs = raster.crs.clone();
    let values = raster.values.iter().map(|h| if *h < 0.0 { 0.0 } else { *h }).collect();
    Ok(Side { path, area: unmarked(grid), crs, volume: None, kind: Kind::Raster(grid, values) })
}

/// Polygons; of the outlines that a run left, those of what is compared.
fn outline(path: PathBuf, by: By, notes: &mut Vec<String>) -> Result<Side, CompareError> {
    let mut layer = Layer::read(&path)?;
    let names = layer.values(NAME);
    if names.len() > 1 && names.iter().all(|name| OURS.contains(name)) {
        if !names.contains(&by.map()) {
            let has = names.join(", ");
            return Err(CompareError::NoOutline { path, has, wanted: by.map() });
        }
        notes.push(format!("{}: of its outlines that of {} was taken", path.display(), by.map()));
        layer = layer.only(NAME, by.map());
    }
    let crs = layer.crs().cloned();
    let polygons = layer.outlines()?;
    let polygons = match polygons.len() {
        0 => return Err(ReleaseError::Empty { path }.into()),
        1 => MultiPolygon::new(polygons),
        _ => unary_union(&polygons),
    };
    Ok(Side { path, area: Area::Polygons(polygons), crs, volume: None, kind: Kind::Outline })
}

/// Refuses two sides that lie in no common plane; notes what cannot be known.
pub(super) fn fit([a, b]: &[Side; 2], notes: &mut Vec<String>) -> Result<(), CompareError> {
    let apart = |problem: String| Err(CompareError::Apart { a: a.path.clone(), b: b.path.clone(), problem });
    if let (Some(one), Some(other)) = (a.run(), b.run()) {
        if one.dimensions != other.dimensions {
            return apart("one is in one dimension, the other in two; compare runs of the same kind".into());
        }
        if one.domain.elevation().is_some() != other.domain.elevation().is_some() {
            return apart("one is on a chute, the other on terrain; compare runs of the same kind".into());
        }
        if one.grid.size != other.grid.size {
            let [one, other] = [one, other].map(|run| run.grid.size[0]);
            notes
                .push(format!("cells of {one} and of {other}: they were cut with each other, not resampled"));
        }
    }
    for (run, other) in [(a, b), (b, a)] {
        let Some(of_run) = run.run().filter(|_| other.run().is_none()) else { continue };
        if of_run.dimensions == 1 {
            return apart("a run in one dimension is compared with another such run only".into());
        }
        if of_run.domain.units() == Units::Scaled && other.crs.is_some() {
            let problem = "one is on a chute in the papers' scaling, the other says a coordinate system; give x and y of the \
                           chute, without a system";
            return apart(problem.into());
        }
    }
    for (silent, other) in [(a, b), (b, a)] {
        if let Some(problem) = in_degrees(silent, other) {
            return apart(problem);
        }
    }
    let (Some(own), Some(other)) = (&a.crs, &b.crs) else {
        let silent =
            [(a, b), (b, a)].into_iter().find(|(one, other)| one.crs.is_none() && other.crs.is_some());
        if let Some((silent, other)) = silent {
            let of = other.crs.as_ref().map(Crs::describe).unwrap_or_default();
            notes.push(format!(
                "{} says no coordinate system; that of the other was taken, {of}",
                silent.path.display()
            ));
        }
        return Ok(());
    };
    match own.compare(other) {
        Comparison::Same => Ok(()),
        Comparison::Unknown(what) => {
            let [own, other] = [own, other].map(Crs::describe);
            notes.push(format!("whether {own} is {other} could not be decided ({what}); it was taken to be"));
            Ok(())
        }
        Comparison::Different(proof) => match (&a.kind, &b.kind) {
            (_, Kind::Raster(..)) => Err(RasterError::mismatch(&b.path, other, own, proof).into()),
            (Kind::Raster(..), _) => Err(RasterError::mismatch(&a.path, own, other, proof).into()),
            (_, Kind::Outline) => Err(ReleaseError::system(&b.path, other, own, proof).into()),
            (Kind::Outline, _) => Err(ReleaseError::system(&a.path, own, other, proof).into()),
            _ => apart(format!(
                "one is in {}, the other in {} ({proof}); compute both on elevation models of one system",
                own.describe(),
                other.describe()
            )),
        },
    }
}

/// That a side that says no system is in degrees and the other is not, where they have no place in common: in metres such a small
/// box beside the origin is far more often a slip.
fn in_degrees(silent: &Side, other: &Side) -> Option<String> {
    let form = match &silent.kind {
        Kind::Raster(..) => Form::Raster,
        Kind::Outline => Form::Polygons,
        Kind::Result(_) => return None,
    };
    let [own, others] = [silent.bounds()?, other.bounds()?];
    let degrees = |[x, y]: [[f64; 2]; 2]| {
        [x, y].iter().zip([360.0, 90.0]).all(|(ends, most)| ends[0] >= -most && ends[1] <= most)
    };
    let apart = own.iter().zip(&others).any(|(own, other)| own[0] >= other[1] || own[1] <= other[0]);
    (silent.crs.is_none() && degrees(own) && !degrees(others) && apart).then(|| {
        let path = silent.path.display();
        format!("{path} {}", form.degrees(&silent.path, other.crs.as_ref()))
    })
}

/// Find the volumes of the deposits, and their centroids. What a raster holds normal to the bed is turned by the slope of the
/// bed of the run beside it.
pub(super) fn weigh(sides: &mut [Side; 2], vertical: bool) {
    let runs = sides.each_ref().map(|side| side.run().map(|run| (run.grid, run.domain.clone())));
    for (k, side) in sides.iter_mut().enumerate() {
        let (grid, thickness, bed) = match &side.kind {
            Kind::Result(run) => match &run.deposit {
                Some(deposit) => (run.grid, deposit, runs[k].as_ref()),
                None => continue,
            },
            Kind::Raster(grid, thickness) => (*grid, thickness, runs[1 - k].as_ref().filter(|_| !vertical)),
            Kind::Outline => continue,
        };
        let filled: Vec<usize> = (0..grid.cells()).filter(|&cell| thickness[cell] > 0.0).collect();
        let under = |cell: &usize| bed.and_then(|(its, _)| its.at(grid.centre(*cell)));
        let below: Vec<Option<usize>> = filled.iter().map(under).collect();
        let steep = match bed {
            Some((_, domain)) => domain.per_plan_area(&below),
            None => vec![1.0; filled.len()],
        };
        let (mut volume, mut moment) = (0.0, [0.0; 2]);
        for (&cell, steep) in filled.iter().zip(steep) {
            let (own, centre) = (thickness[cell] * steep * grid.cell_area(), grid.centre(cell));
            volume += own;
            moment = [0, 1].map(|axis| moment[axis] + own * centre[axis]);
        }
        side.volume = Some((volume, (volume > 0.0).then(|| moment.map(|moment| moment / volume))));
    }
}
