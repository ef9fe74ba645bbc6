//! A mountain and what is released on it, read for its cells.

use super::mountain::{Mountain, Mountains};
use super::parameters::{self, InCells};
use super::supply::{Inflow, Inlet, Late, Supply};
use crate::StartError;
use crate::inputs::Inputs;
use granflow_case::RunPlan;
use granflow_case::avalanche::Material;
use granflow_case::terrain::{
    Attribute, Entrainment, Extent, Measured, Over, Plan, Release, Starts, Thickness,
};
use granflow_geo::Remark;
use granflow_geo::raster::Crs;
use granflow_geo::release::{self, Sparse};
use granflow_geo::terrain::{Survey, Terrain};
use std::sync::Arc;

/// A mountain and what is released on it, as they were read.
pub(super) struct Loaded {
    pub terrain: Terrain,
    /// Released volume per plan area H \[m\].
    pub release: Sparse,
    /// Each release and inflow: the name of its file or kind and when it starts, the system of its file, and its volume \[m^3\].
    pub parts: Vec<(String, Option<String>, f64)>,
    /// What was decided while reading, and what looks wrong.
    pub remarks: Vec<Remark>,
    pub survey: Survey,
    /// The material; where mu is that of the volume, that.
    pub material: Material,
    /// What of the friction differs from cell to cell.
    pub parameters: Arc<InCells>,
    /// The depth of the erodible layer \[m\], if there is one, and its volume \[m^3\].
    pub layer: Option<(Vec<f64>, f64)>,
    /// What comes in the course of the run.
    pub supply: Supply,
    /// Bytes that were held while the elevation model was read.
    pub reading: usize,
}

impl Loaded {
    /// Let every release start with the run, so that one look shows all of them.
    pub(super) fn start_all(&mut self) {
        for late in std::mem::take(&mut self.supply.late) {
            self.release = std::mem::take(&mut self.release).plus(late.cells.into_iter().collect());
        }
    }
}

/// Reads the elevation and the releases.
pub(super) fn load(
    run: &RunPlan,
    plan: &Plan,
    inputs: &Inputs,
    mountains: Option<&Mountains>,
) -> Result<Loaded, StartError> {
    let mountain = match mountains {
        Some(mountains) => mountains.of(run, plan, inputs)?,
        None => Mountain::read(run, plan, inputs)?,
    };
    let Mountain { terrain, crs, survey, remarks, reading } = mountain;
    let (release, parts, supply) = (Sparse::default(), Vec::new(), Supply::default());
    let (material, parameters) = (plan.material.clone(), Arc::new(InCells::everywhere(&plan.material)));
    let mut loaded = Loaded {
        terrain,
        release,
        parts,
        remarks,
        survey,
        material,
        parameters,
        layer: None,
        supply,
        reading,
    };
    for one in &plan.releases {
        add(&mut loaded, one, inputs, crs.as_ref())?;
    }
    for (number, one) in plan.inflows.iter().enumerate() {
        let key = format!("inflow[{number}]");
        let inflow = inflow(run, one, &key, inputs, &mut loaded)?;
        loaded.supply.inflows.push(inflow);
    }
    let volume = loaded.parts.iter().map(|(_, _, volume)| volume).sum();
    let (material, size) = plan.material.of_volume(volume);
    if let (Some(size), Some(mu)) = (size, material.mu) {
        let size = format!("{size:?}").to_lowercase();
        let text = format!("samosat: {volume:.0} m3 are a {size} avalanche, mu = {mu}");
        loaded.remarks.push(Remark::Note(text));
    }
    let bed = loaded.terrain.bed.clone();
    let parameters = InCells::read(run, &material, inputs, (&bed, crs.as_ref()), &mut loaded.remarks)?;
    (loaded.material, loaded.parameters) = (material, Arc::new(parameters));
    if let Some(entrainment) = &plan.entrainment {
        loaded.layer = Some(layer(run, entrainment, inputs, crs.as_ref(), &mut loaded)?);
    }
    if mountains.is_none() {
        trim();
    }
    Ok(loaded)
}

/// The depth of the erodible layer in every cell \[m\], 0 outside the data, and its volume \[m^3\].
fn layer(
    run: &RunPlan,
    entrainment: &Entrainment,
    inputs: &Inputs,
    crs: Option<&Crs>,
    loaded: &mut Loaded,
) -> Result<(Vec<f64>, f64), StartError> {
    let terrain = &loaded.terrain;
    let bed = &terrain.bed;
    let first = |_| f64::NEG_INFINITY;
    let (mut depth, _) =
        parameters::read(run, &entrainment.layer, inputs, (bed, crs), first, &mut loaded.remarks)?;
    depth.iter_mut().filter(|depth| depth.is_nan()).for_each(|depth| *depth = 0.0);
    let volumes = depth.iter().enumerate().filter(|(_, depth)| **depth > 0.0);
    let volumes = volumes.map(|(cell, depth)| depth / terrain.fit(bed.place(cell)).cosine());
    let volume = volumes.sum::<f64>() * bed.cell * bed.cell;
    Ok((depth, volume))
}

/// Hands back to the system what reading has left: the allocator would keep it for more of the same, and none will come.
fn trim() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: only memory that is free is given back.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// Adds the volume per plan area of one release.
fn add(loaded: &mut Loaded, one: &Release, inputs: &Inputs, crs: Option<&Crs>) -> Result<(), StartError> {
    let bed = &loaded.terrain.bed;
    let (name, system, cells) = match &one.extent {
        Extent::Result(path) => {
            let (volume, system) = super::left::left_by(path, inputs, bed, &mut loaded.remarks)?;
            (path.display().to_string(), Some(described(system.as_ref())), volume)
        }
        Extent::Polygons { path, thickness } => {
            let thickness = match thickness {
                Thickness::Constant(value) => release::Thickness::Value(*value),
                Thickness::Attribute(Attribute { attribute, factor: None }) => {
                    release::Thickness::Attribute(attribute.clone())
                }
                Thickness::Attribute(Attribute { attribute, factor: Some(factor) }) => {
                    release::Thickness::Scaled(attribute.clone(), *factor)
                }
                Thickness::Features(each) => release::Thickness::Each(each.features.clone()),
            };
            let layer = inputs.layer(path)?;
            loaded.remarks.extend(layer.notes(bed));
            let system = Some(described(layer.crs()));
            (path.display().to_string(), system, layer.thickness(&thickness, bed)?)
        }
        Extent::Raster(path) => {
            let reading = inputs.thickness(path, bed.crs.as_ref().or(crs))?;
            loaded.remarks.extend(reading.notes);
            let system = Some(described(reading.raster.crs.as_ref()));
            (
                path.display().to_string(),
                system,
                release::carried(release::Form::Raster, path, &reading.raster, bed)?,
            )
        }
        Extent::Cap(cap) => {
            let cells = release::cap(cap.height, cap.centre, cap.radius, bed)?;
            ("cap".to_owned(), None, cells)
        }
    };
    let measured = match one.measured {
        // What a run left comes as its volume.
        _ if matches!(one.extent, Extent::Result(_)) => release::Measured::Vertical,
        Measured::Normal => release::Measured::Normal,
        Measured::Vertical => release::Measured::Vertical,
    };
    let volume = release::per_plan_area(cells, &loaded.terrain, measured);
    let total = volume.iter().map(|(_, height)| height).sum::<f64>() * bed.cell * bed.cell;
    let name = match one.starts {
        Starts::At(0.0) => name,
        Starts::At(time) => format!("{name} at {time} s"),
        Starts::Hit => format!("{name} when hit"),
    };
    loaded.parts.push((name, system, total));
    if one.starts == Starts::At(0.0) {
        loaded.release = std::mem::take(&mut loaded.release).plus(volume);
    } else {
        loaded.supply.late.push(Late { starts: one.starts, cells: volume.iter().collect(), came: false });
    }
    Ok(())
}

/// A system in words.
pub(super) fn described(crs: Option<&Crs>) -> String {
    crs.map_or("no coordinate reference system".to_owned(), Crs::describe)
}

/// The cells of an inflow, each with its share and the direction in which the mass moves there.
fn inflow(
    run: &RunPlan,
    one: &granflow_case::terrain::Inflow,
    key: &str,
    inputs: &Inputs,
    loaded: &mut Loaded,
) -> Result<Inflow, StartError> {
    let bed = &loaded.terrain.bed;
    let cells = match &one.over {
        Over::Line(points) => release::along(points, bed)?,
        Over::Polygons(path) => {
            let layer = inputs.layer(path)?;
            loaded.remarks.extend(layer.notes(bed));
            layer.cells(bed)?
        }
    };
    let moves = one.hydrograph.speed.iter().any(|speed| *speed > 0.0);
    let inlet = |(cell, share): (usize, f64)| {
        let [column, row] = bed.place(cell);
        let [down_x, down_y] = loaded.terrain.fit([column, row]).gradient.map(|slope| -slope);
        let [x, y] = one.direction.unwrap_or([down_x, down_y]);
        let length = x.hypot(y);
        if moves && length < LEVEL {
            let place = format!("({}, {})", bed.x(column), bed.y(row));
            let message =
                format!("the bed is level at {place}: there is no way down for a mass with a speed");
            return Err(run.fault(key, message, "say where it goes, as in direction = [1, 0]").into());
        }
        let direction = if length < LEVEL { [0.0; 2] } else { [x / length, y / length] };
        Ok(Inlet { cell, share, direction })
    };
    let inlets = cells.into_iter().map(inlet).collect::<Result<_, StartError>>()?;
    let volume = one.hydrograph.volume(f64::INFINITY);
    loaded.parts.push(("inflow".to_owned(), None, volume));
    Ok(Inflow { inlets, hydrograph: one.hydrograph.clone(), entered: 0.0, until: -1.0 })
}

/// A gentler slope has no direction.
const LEVEL: f64 = 1e-9;
