//! Where a run is looked at: gauges as cells, sections as faces of cells.

mod stairs;

use crate::StartError;
use crate::inputs::Inputs;
use crate::model::Plane;
use crate::run::{Face, Run};
use granflow_case::{Line, RunPlan};
use stairs::{Nodes, stairs};

/// The gauges and sections of a case on the cells of its run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Watch {
    /// Names of the gauges, and the cells that they lie in.
    pub gauges: Vec<(String, usize)>,
    /// The sections.
    pub sections: Vec<WatchedSection>,
    /// The path that the case names.
    pub path: Option<Vec<[f64; 2]>>,
    /// What a reader decided, one sentence each.
    pub notes: Vec<String>,
}

/// A section on the cells of a run: the staircase of faces that is nearest to its line.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchedSection {
    /// Its name.
    pub name: String,
    /// Its faces, with 1 where mass that crosses the line from its left to its right passes towards larger coordinates, else -1.
    pub faces: Vec<(Face, f64)>,
    /// The cells on both sides.
    pub cells: Vec<usize>,
}

impl Watch {
    /// Finds the cells and faces; a line that is not among `inputs` is a file on the disk.
    ///
    /// # Errors
    /// [`StartError::Case`] naming the key of a place that is outside the grid or has no elevation, and of a line that is
    /// shorter than a cell; a file of a line that cannot be read.
    pub fn of(plan: &RunPlan, inputs: &Inputs, run: &dyn Run) -> Result<Watch, StartError> {
        let mut watch = Watch::default();
        let plane = run.plane();
        if let Some(path) = &plan.output.path {
            watch.path = Some(path_on(path, plan, inputs, plane, &mut watch.notes)?);
        }
        if plan.watched.is_empty() {
            return Ok(watch);
        }
        let nodes = Nodes::of(plane);
        for (index, gauge) in plan.watched.gauges.iter().enumerate() {
            let key = format!("gauge[{index}].at");
            let Some(cell) = nodes.cell(&gauge.at) else {
                return Err(outside(plan, &key, &gauge.at, &nodes));
            };
            if no_data(run, cell) {
                let message = format!("{} lies where the terrain has no elevation", said(&gauge.at));
                return Err(plan.fault(&key, message, "move it onto the terrain").into());
            }
            watch.gauges.push((gauge.name.clone(), cell));
        }
        for (index, section) in plan.watched.sections.iter().enumerate() {
            let key = format!("section[{index}]");
            let (key, points) = match &section.line {
                Line::Points(points) => (format!("{key}.line"), points.clone()),
                Line::File(path) => {
                    (format!("{key}.file"), from_file(path, inputs, plane, &mut watch.notes)?)
                }
            };
            if let Some(point) = points.iter().find(|point| nodes.cell(point).is_none()) {
                return Err(outside(plan, &key, point, &nodes));
            }
            let faces = stairs(&points, &nodes);
            if faces.is_empty() {
                let message = "the line is shorter than a cell: it separates none from another";
                return Err(plan.fault(&key, message, "make it longer than a cell").into());
            }
            let mut cells: Vec<usize> = faces.iter().flat_map(|(face, _)| nodes.beside(*face)).collect();
            cells.sort_unstable();
            cells.dedup();
            cells.retain(|cell| !no_data(run, *cell));
            if cells.is_empty() {
                let message = "the line lies where the terrain has no elevation";
                return Err(plan.fault(&key, message, "move it onto the terrain").into());
            }
            watch.sections.push(WatchedSection { name: section.name.clone(), faces, cells });
        }
        Ok(watch)
    }

    /// Whether there is nothing to look at.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.gauges.is_empty() && self.sections.is_empty()
    }
}

/// The path that a case names, which must lie on the grid.
fn path_on(
    path: &std::path::Path,
    plan: &RunPlan,
    inputs: &Inputs,
    plane: &Plane,
    notes: &mut Vec<String>,
) -> Result<Vec<[f64; 2]>, StartError> {
    let (points, nodes) = (from_file(path, inputs, plane, notes)?, Nodes::of(plane));
    if let Some(point) = points.iter().find(|point| nodes.cell(point).is_none()) {
        return Err(outside(plan, "output.path", point, &nodes));
    }
    Ok(points.iter().map(|point| [point[0], point[1]]).collect())
}

/// A cell without elevation has no value of some field.
fn no_data(run: &dyn Run, cell: usize) -> bool {
    let fields = 0..run.plane().series().len();
    let mut value = [0.0];
    fields.into_iter().any(|field| {
        run.fill(field, cell, &mut value);
        value[0].is_nan()
    })
}

fn said(at: &[f64]) -> String {
    let numbers: Vec<String> = at.iter().map(f64::to_string).collect();
    format!("({})", numbers.join(", "))
}

fn outside(plan: &RunPlan, key: &str, at: &[f64], nodes: &Nodes) -> StartError {
    let [x, y] = nodes.ends();
    let mut ends = format!("x {} to {}", x[0], x[1]);
    if at.len() > 1 {
        ends += &format!(", y {} to {}", y[0], y[1]);
    }
    let message = format!("{} lies outside the grid, which has {ends}", said(at));
    plan.fault(key, message, "move it onto the grid, or widen the grid").into()
}

/// The line of a file, in the system of the terrain.
#[cfg(feature = "geo")]
fn from_file(
    path: &std::path::Path,
    inputs: &Inputs,
    plane: &Plane,
    notes: &mut Vec<String>,
) -> Result<Vec<Vec<f64>>, StartError> {
    let (points, remarks) = inputs.line(path, plane.domain.raster())?;
    notes.extend(remarks.iter().map(ToString::to_string));
    Ok(points.into_iter().map(Vec::from).collect())
}

#[cfg(not(feature = "geo"))]
fn from_file(
    _path: &std::path::Path,
    _inputs: &Inputs,
    _plane: &Plane,
    _notes: &mut Vec<String>,
) -> Result<Vec<Vec<f64>>, StartError> {
    Err(StartError::Feature { feature: "geo" })
}
