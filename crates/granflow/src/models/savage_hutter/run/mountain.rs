//! The mountain of a case, as it was read: for one run, or for several.

use crate::StartError;
use crate::inputs::Inputs;
use granflow_case::RunPlan;
use granflow_case::terrain::Plan;
use granflow_geo::Remark;
use granflow_geo::raster::{Crs, Raster};
use granflow_geo::terrain::{Curvature, Survey, Terrain};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// More cells than any machine holds.
const MAX_CELLS: f64 = (1_u64 << 36) as f64;

/// A mountain that was read; a copy shares its elevation and its fits.
#[derive(Debug, Clone)]
pub(crate) struct Mountain {
    pub terrain: Terrain,
    /// The system that the case gives.
    pub crs: Option<Crs>,
    pub survey: Survey,
    /// What was decided while reading, and what looks wrong.
    pub remarks: Vec<Remark>,
    /// Bytes that were held while the elevation model was read.
    pub reading: usize,
}

/// What makes a mountain: file, system, part, cell, length of the window.
type Key = (PathBuf, Option<String>, Option<[u64; 4]>, Option<u64>, Option<u64>);

/// Mountains that several runs share, each read and fitted once.
#[derive(Debug, Default)]
pub(crate) struct Mountains(Mutex<Vec<(Key, Mountain)>>);

impl Mountains {
    /// The mountain of a case; the first who asks for one reads it, and others wait.
    pub fn of(&self, run: &RunPlan, plan: &Plan, inputs: &Inputs) -> Result<Mountain, StartError> {
        let bits = |value: f64| value.to_bits();
        let region = plan.region.map(|region| region.map(bits));
        let (cell, curvature) = (plan.cell.map(bits), plan.curvature.map(bits));
        let key = (plan.dem.clone(), plan.crs.clone(), region, cell, curvature);
        let mut known = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some((_, mountain)) = known.iter().find(|(own, _)| *own == key) {
            return Ok(mountain.clone());
        }
        let mountain = Mountain::read(run, plan, inputs)?;
        let mountain = Mountain { terrain: mountain.terrain.with_fits(), ..mountain };
        known.push((key, mountain.clone()));
        Ok(mountain)
    }
}

impl Mountain {
    /// Reads the elevation of a case.
    pub fn read(run: &RunPlan, plan: &Plan, inputs: &Inputs) -> Result<Mountain, StartError> {
        let mut remarks = Vec::new();
        let (bed, crs, reading) = bed(run, plan, inputs, &mut remarks)?;
        let survey = Survey::of(&bed);
        remarks.extend(survey.warnings(&plan.dem.display().to_string()));
        Ok(Mountain { terrain: curved(run, plan, bed)?, crs, survey, remarks, reading })
    }
}

/// The elevation on the cells that the case asks for, the system that the case gives, and the bytes that reading held.
fn bed(
    run: &RunPlan,
    plan: &Plan,
    inputs: &Inputs,
    remarks: &mut Vec<Remark>,
) -> Result<(Arc<Raster>, Option<Crs>, usize), StartError> {
    let crs = match &plan.crs {
        Some(text) => Some(Crs::parse(text).map_err(|error| {
            run.fault("terrain.crs", error.to_string(), "write it as crs = \"EPSG:31287\"")
        })?),
        None => None,
    };
    let reading = inputs.heights(&plan.dem, crs.as_ref())?;
    remarks.extend(reading.notes);
    let held = reading.bytes;
    let bed = part(run, plan, reading.raster)?;
    if bed.crs.is_none() {
        remarks.push(Remark::Note(format!(
            "{}: it says no coordinate reference system; its coordinates were taken as metres (crs = \"EPSG:xxxx\" in \
             [terrain] names one)",
            plan.dem.display()
        )));
    }
    let Some(cell) = plan.cell else { return Ok((bed, crs, held)) };
    let [width, height] = [bed.columns, bed.rows].map(|count| count as f64 * bed.cell);
    let [columns, rows] = [width / cell, height / cell];
    if columns < 3.0 || rows < 3.0 || columns * rows > MAX_CELLS {
        let message = format!(
            "cells of {cell} m cut the terrain of {width} m x {height} m into {columns:.1} x {rows:.1}"
        );
        let cure = "allowed are at least 3 along each side, and not more than a machine holds";
        return Err(run.fault("terrain.cell", message, cure).into());
    }
    let bed = if cell == bed.cell { bed } else { bed.resample(cell).into() };
    Ok((bed, crs, held))
}

/// The part of the elevation model that the case asks for.
fn part(run: &RunPlan, plan: &Plan, whole: Arc<Raster>) -> Result<Arc<Raster>, StartError> {
    let Some(region) = plan.region else { return Ok(whole) };
    let refused = |message: String| {
        let (x, y) = ([whole.west, whole.east()], [whole.south, whole.north()]);
        let cure = format!("the raster has x {} to {}, y {} to {}", x[0], x[1], y[0], y[1]);
        StartError::from(run.fault("terrain.region", message, &cure))
    };
    let part = whole.cropped(region).ok_or_else(|| refused("no cell of the raster lies in it".to_owned()))?;
    let Raster { columns, rows, .. } = part;
    if columns < 3 || rows < 3 {
        return Err(refused(format!(
            "it leaves {columns} x {rows} cells, a run needs at least 3 along each side"
        )));
    }
    if part.range().is_none() {
        return Err(refused("none of its cells has an elevation".to_owned()));
    }
    Ok(part.into())
}

/// The bed with the window of the case around its cells.
fn curved(run: &RunPlan, plan: &Plan, bed: Arc<Raster>) -> Result<Terrain, StartError> {
    let [width, height] = [bed.columns, bed.rows].map(|count| count as f64 * bed.cell);
    if let Some(length) = plan.curvature.filter(|length| *length > width.min(height)) {
        let message = format!("a window of {length} m is wider than the terrain of {width} m x {height} m");
        let cure = format!("the window spans a few cells, for instance length = \"{} m\"", 3.0 * bed.cell);
        return Err(run.fault("terrain.curvature.length", message, &cure).into());
    }
    Ok(Terrain::new(bed, curvature_of(plan)))
}

/// The length over which a case takes the derivatives of the bed.
pub(super) fn curvature_of(plan: &Plan) -> Curvature {
    plan.curvature.map_or(Curvature::Off, Curvature::Length)
}
