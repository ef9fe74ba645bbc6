//! An avalanche on a mountain, SI units: from a checked case to a run.

use super::super::TerrainDomain;
use super::flowing::Flowing;
use super::parameters::InCells;
use super::supply::{Inflow, Inlet, Late, Supply};
use crate::StartError;
use crate::memory::fits;
use crate::model::Plane;
use crate::run::{Run, Simulated, step_size};
use granflow_case::RunPlan;
use granflow_case::avalanche::Material;
use granflow_case::terrain::{Extent, Measured, Over, Plan, Release, Starts, TerrainScheme, Thickness};
use granflow_engine::grid::Grid;
use granflow_engine::kernels::Kernel;
use granflow_engine::simulation::Simulation;
use granflow_geo::Remark;
use granflow_geo::raster::{Crs, Raster, Reading};
use granflow_geo::release::{self, Sparse};
use granflow_geo::terrain::{Curvature, Survey, Terrain};
use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::{Flow, ground};
use granflow_model::scheme::Boundary;
use std::sync::Arc;

/// More cells than any machine holds.
const MAX_CELLS: f64 = (1_u64 << 36) as f64;

/// The run of a case on a mountain.
pub(crate) fn start(run: &RunPlan, plan: &Plan) -> Result<Box<dyn Run>, StartError> {
    simulate(run, plan, load(run, plan)?)
}

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
    pub parameters: InCells,
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

/// The run on a mountain that was read. The derivatives of the bed are fitted cell by cell as the simulation asks for its
/// grounds.
pub(super) fn simulate(
    run: &RunPlan,
    plan: &Plan,
    Loaded { terrain, release, remarks, material, parameters, supply, .. }: Loaded,
) -> Result<Box<dyn Run>, StartError> {
    let (bed, gravity) = (&terrain.bed, plan.material.gravity);
    let columns = bed.columns;
    let grid = Grid {
        cells: [bed.columns, bed.rows],
        origin: [bed.west, bed.south],
        size: [bed.cell; 2],
        boundary: [[Boundary::Absorbing; 2]; 2],
    };
    let all =
        supply.late.iter().fold(release.clone(), |all, late| all.plus(late.cells.iter().copied().collect()));
    let thickness = all.map(|cell, volume| volume * terrain.fit(bed.place(cell)).cosine());
    let inlets = supply.inflows.iter().flat_map(|inflow| &inflow.inlets).map(|inlet| inlet.cell);
    // The grounds hold the elevation from here on.
    let domain = TerrainDomain {
        raster: Arc::new(bed.with_values(Vec::new())),
        release: Arc::new(thickness),
        inlets: inlets.collect(),
        density: plan.material.density,
        threshold: run.output.threshold,
        curvature: curvature_of(plan),
        remarks,
    };
    let plane = Plane::of(&grid, Arc::new(domain));
    let film = plan.scheme.film;
    // What comes later brings a head of its own.
    let ceiling = if supply.is_empty() { gravity * ceiling(&terrain, &release) } else { f64::MAX };
    let ground = move |cell| ground_at(&terrain, gravity, cell);
    let state = move |[i, j]: [usize; 2]| Flow::still(release.get(j * columns + i));
    let chosen = material.mu.filter(|_| material.by_volume);
    let begin = Begin { run, film, grid, plane, supply, chosen };
    let Some(law) = material.law_in_loops() else {
        let law = material.law;
        let scheme = match plan.scheme.name {
            TerrainScheme::EnergyStable2 => EnergyStable::second(law, film),
            TerrainScheme::EnergyStable => EnergyStable::first(law, film),
            TerrainScheme::Balanced | TerrainScheme::Balanced2 => {
                unreachable!("a case with these schemes has a law of the loops")
            }
        };
        let of_cell = move |[i, j]: [usize; 2], _| parameters.at(j * columns + i);
        return begin.with(scheme.below(ceiling), ground, state, of_cell);
    };
    match plan.scheme.name {
        TerrainScheme::Balanced => begin.with(Balanced::first(law, film), ground, state, |_, ()| ()),
        TerrainScheme::Balanced2 => begin.with(Balanced::second(law, film), ground, state, |_, ()| ()),
        TerrainScheme::EnergyStable => {
            begin.with(EnergyStable::first(law, film).below(ceiling), ground, state, |_, ()| ())
        }
        TerrainScheme::EnergyStable2 => {
            begin.with(EnergyStable::second(law, film).below(ceiling), ground, state, |_, ()| ())
        }
    }
}

/// A run that is to begin.
struct Begin<'a> {
    run: &'a RunPlan,
    film: f64,
    grid: Grid<2>,
    plane: Plane,
    supply: Supply,
    /// mu, if it was chosen by the volume.
    chosen: Option<f64>,
}

impl Begin<'_> {
    /// With a scheme, and what acts on each cell.
    fn with<S>(
        self,
        scheme: S,
        ground: impl Fn([usize; 2]) -> ground::Terrain<2, f64> + Sync,
        state: impl Fn([usize; 2]) -> Flow<2, f64> + Sync,
        forcing: impl Fn([usize; 2], S::Forcing) -> S::Forcing + Sync,
    ) -> Result<Box<dyn Run>, StartError>
    where
        S: Kernel<2, State = Flow<2, f64>, Ground = ground::Terrain<2, f64>> + 'static,
    {
        let Begin { run, film, grid, plane, supply, chosen } = self;
        fits(grid.cells.iter().product(), Simulation::<2, S>::bytes_per_cell(false))?;
        let mut simulation = Simulation::new(scheme, grid, step_size(run), ground, state)?;
        simulation.apply(forcing);
        let physics =
            Flowing::new(run.scheme, film, true).with_threshold(run.output.threshold).with(supply, chosen);
        Ok(Box::new(Simulated::new(simulation, physics, plane)))
    }
}

/// The highest total head \[m\] that a mass released at rest can have: its highest surface and its greatest height c^2 H over
/// the bed, which a front gains.
fn ceiling(terrain: &Terrain, release: &Sparse) -> f64 {
    let (mut top, mut deepest) = (f64::NEG_INFINITY, 0.0_f64);
    for (cell, volume) in release.iter().filter(|(_, volume)| *volume > 0.0) {
        let [column, row] = terrain.bed.place(cell);
        let cos = terrain.fit([column, row]).cosine();
        let depth = cos * cos * volume;
        top = top.max(terrain.bed.at(column, row) + depth);
        deepest = deepest.max(depth);
    }
    top + deepest
}

/// The ground of a cell of a mountain under `gravity` \[m/s^2\], by column and row, the first row in the south.
pub(crate) fn ground_at(
    mountain: &Terrain,
    gravity: f64,
    [column, row]: [usize; 2],
) -> ground::Terrain<2, f64> {
    let level = mountain.bed.at(column, row);
    if level.is_nan() {
        return ground::Terrain::nothing(gravity);
    }
    let fit = mountain.fit([column, row]);
    ground::Terrain::of(level, fit.gradient, fit.cosine(), fit.hessian, gravity)
}

/// Reads the elevation and the releases.
pub(super) fn load(run: &RunPlan, plan: &Plan) -> Result<Loaded, StartError> {
    let mut remarks = Vec::new();
    let (bed, crs, reading) = bed(run, plan, &mut remarks)?;
    let survey = Survey::of(&bed);
    remarks.extend(survey.warnings(&plan.dem.display().to_string()));
    let terrain = curved(run, plan, bed)?;
    let (release, parts, supply) = (Sparse::default(), Vec::new(), Supply::default());
    let (material, parameters) = (plan.material.clone(), InCells::everywhere(&plan.material));
    let mut loaded =
        Loaded { terrain, release, parts, remarks, survey, material, parameters, supply, reading };
    for one in &plan.releases {
        add(&mut loaded, one, crs.as_ref())?;
    }
    for (number, one) in plan.inflows.iter().enumerate() {
        let key = format!("inflow[{number}]");
        let inflow = inflow(run, one, &key, &mut loaded)?;
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
    loaded.parameters = InCells::read(run, &material, (&bed, crs.as_ref()), &mut loaded.remarks)?;
    loaded.material = material;
    trim();
    Ok(loaded)
}

/// Hands back to the system what reading has left: the allocator would keep it for more of the same, and none will come.
fn trim() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: only memory that is free is given back.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// The elevation on the cells that the case asks for, the system that the case gives, and the bytes that reading held.
fn bed(
    run: &RunPlan,
    plan: &Plan,
    remarks: &mut Vec<Remark>,
) -> Result<(Raster, Option<Crs>, usize), StartError> {
    let crs = match &plan.crs {
        Some(text) => Some(Crs::parse(text).map_err(|error| {
            run.fault("terrain.crs", error.to_string(), "write it as crs = \"EPSG:31287\"")
        })?),
        None => None,
    };
    let reading = Reading::of(&plan.dem, crs.as_ref())?;
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
    Ok((bed.resample(cell), crs, held))
}

/// The part of the elevation model that the case asks for.
fn part(run: &RunPlan, plan: &Plan, whole: Raster) -> Result<Raster, StartError> {
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
    Ok(part)
}

/// The bed with the window of the case around its cells.
fn curved(run: &RunPlan, plan: &Plan, bed: Raster) -> Result<Terrain, StartError> {
    let [width, height] = [bed.columns, bed.rows].map(|count| count as f64 * bed.cell);
    if let Some(length) = plan.curvature.filter(|length| *length > width.min(height)) {
        let message = format!("a window of {length} m is wider than the terrain of {width} m x {height} m");
        let cure = "the window spans a few cells, for instance length = \"20 m\"";
        return Err(run.fault("terrain.curvature.length", message, cure).into());
    }
    Ok(Terrain::new(bed, curvature_of(plan)))
}

/// The length over which a case takes the derivatives of the bed.
fn curvature_of(plan: &Plan) -> Curvature {
    plan.curvature.map_or(Curvature::Off, Curvature::Length)
}

/// Adds the volume per plan area of one release.
fn add(loaded: &mut Loaded, one: &Release, crs: Option<&Crs>) -> Result<(), StartError> {
    let bed = &loaded.terrain.bed;
    let (name, system, cells) = match &one.extent {
        Extent::Result(path) => {
            let (volume, system) = super::left::left_by(path, bed, &mut loaded.remarks)?;
            (path.display().to_string(), Some(described(system.as_ref())), volume)
        }
        Extent::Polygons { path, thickness } => {
            let thickness = match thickness {
                Thickness::Constant(value) => release::Thickness::Value(*value),
                Thickness::Attribute(name) => release::Thickness::Attribute(name.attribute.clone()),
            };
            let layer = release::Layer::read(path)?;
            loaded.remarks.extend(layer.notes(bed));
            let system = Some(described(layer.crs()));
            (path.display().to_string(), system, layer.thickness(&thickness, bed)?)
        }
        Extent::Raster(path) => {
            let reading = Reading::of(path, bed.crs.as_ref().or(crs))?;
            loaded.remarks.extend(reading.notes);
            let system = Some(described(reading.raster.crs.as_ref()));
            (path.display().to_string(), system, release::carried(path, &reading.raster, bed)?)
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
    loaded: &mut Loaded,
) -> Result<Inflow, StartError> {
    let bed = &loaded.terrain.bed;
    let cells = match &one.over {
        Over::Line(points) => release::along(points, bed)?,
        Over::Polygons(path) => {
            let layer = release::Layer::read(path)?;
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
