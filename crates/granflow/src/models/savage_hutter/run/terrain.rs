//! An avalanche on a mountain, SI units: from a checked case to a run.

use super::super::TerrainDomain;
use super::between::BetweenSteps;
use super::compression::Compression;
use super::erosion::Erodible;
use super::flowing::Flowing;
use super::forest::Forest;
use super::mountain::{Mountain, Mountains, curvature_of};
use super::parameters::{self, InCells};
use super::supply::{Inflow, Inlet, Late, Supply};
use crate::StartError;
use crate::inputs::Inputs;
use crate::memory::fits;
use crate::model::Plane;
use crate::run::{Run, Simulated, step_size};
use granflow_case::RunPlan;
use granflow_case::avalanche::Material;
use granflow_case::terrain::{
    Attribute, Entrainment, Extent, Measured, Over, Plan, Release, Starts, TerrainScheme, Thickness,
};
use granflow_engine::grid::Grid;
use granflow_engine::kernels::Kernel;
use granflow_engine::simulation::Simulation;
use granflow_geo::Remark;
use granflow_geo::raster::Crs;
use granflow_geo::release::{self, Sparse};
use granflow_geo::terrain::{Survey, Terrain};
use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::{Flow, ground};
use granflow_model::scheme::Boundary;
use std::sync::Arc;

/// The run of a case on a mountain.
pub(crate) fn start(
    run: &RunPlan,
    plan: &Plan,
    inputs: &Inputs,
    mountains: Option<&Mountains>,
) -> Result<Box<dyn Run>, StartError> {
    simulate(run, plan, load(run, plan, inputs, mountains)?)
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

/// The run on a mountain that was read. The derivatives of the bed are fitted cell by cell as the simulation asks for its
/// grounds.
pub(super) fn simulate(
    run: &RunPlan,
    plan: &Plan,
    Loaded { terrain, release, remarks, material, parameters, layer, supply, .. }: Loaded,
) -> Result<Box<dyn Run>, StartError> {
    let (bed, gravity) = (&terrain.bed, plan.material.gravity);
    let columns = bed.columns;
    let grid = Grid {
        cells: [bed.columns, bed.rows],
        origin: [bed.west, bed.south],
        size: [bed.cell; 2],
        boundary: [[Boundary::Absorbing; 2]; 2],
    };
    let plane = Plane::of(&grid, Arc::new(domain(run, plan, (&terrain, &release, &supply), remarks)));
    let film = plan.scheme.film;
    // What comes later and what is picked up bring a head of their own.
    let grows = !supply.is_empty() || layer.as_ref().is_some_and(|(_, volume)| *volume > 0.0);
    let Material { pressure_coefficient, passive_coefficient, .. } = plan.material;
    let ceiling = if grows { f64::MAX } else { gravity * ceiling(&terrain, pressure_coefficient, &release) };
    let compression = Compression::of([pressure_coefficient, passive_coefficient], film);
    let density = plan.material.density;
    let erodible = plan.entrainment.as_ref().zip(layer).map(|(entrainment, (whole, _))| {
        Erodible::of(entrainment, whole, (material.law, parameters.clone()), density, &terrain.bed)
    });
    let ground = move |cell| ground_at(&terrain, gravity, cell).with_pressure(pressure_coefficient);
    let state = move |[i, j]: [usize; 2]| Flow::still(release.get(j * columns + i));
    let chosen = material.mu.filter(|_| material.by_volume);
    let begin = Begin { run, film, grid, plane, supply, erodible, compression, chosen };
    let Some(law) = material.law_in_loops() else {
        let law = material.law;
        let scheme = match plan.scheme.name {
            TerrainScheme::EnergyStable2 => EnergyStable::second(law, film),
            TerrainScheme::EnergyStable => EnergyStable::first(law, film),
            TerrainScheme::Balanced | TerrainScheme::Balanced2 => {
                unreachable!("a case with these schemes has a law of the loops")
            }
        };
        let forest = plan.forest_breaks_at.map(|strength| Forest::of(strength, density, parameters.clone()));
        let forest = forest.map(|forest| Box::new(forest) as _);
        let of_cell = move |[i, j]: [usize; 2], _| parameters.at(j * columns + i);
        return begin.with(scheme.below(ceiling), ground, state, (of_cell, forest));
    };
    match plan.scheme.name {
        TerrainScheme::Balanced => begin.with(Balanced::first(law, film), ground, state, (|_, ()| (), None)),
        TerrainScheme::Balanced2 => {
            begin.with(Balanced::second(law, film), ground, state, (|_, ()| (), None))
        }
        TerrainScheme::EnergyStable => {
            begin.with(EnergyStable::first(law, film).below(ceiling), ground, state, (|_, ()| (), None))
        }
        TerrainScheme::EnergyStable2 => {
            begin.with(EnergyStable::second(law, film).below(ceiling), ground, state, (|_, ()| (), None))
        }
    }
}

/// What files and figures must know of a mountain.
fn domain(
    run: &RunPlan,
    plan: &Plan,
    (terrain, release, supply): (&Terrain, &Sparse, &Supply),
    remarks: Vec<Remark>,
) -> TerrainDomain {
    let bed = &terrain.bed;
    let all =
        supply.late.iter().fold(release.clone(), |all, late| all.plus(late.cells.iter().copied().collect()));
    let thickness = all.map(|cell, volume| volume * terrain.fit(bed.place(cell)).cosine());
    let inlets = supply.inflows.iter().flat_map(|inflow| &inflow.inlets).map(|inlet| inlet.cell);
    TerrainDomain {
        // The grounds hold the elevation.
        raster: Arc::new(bed.with_values(Vec::new())),
        release: Arc::new(thickness),
        inlets: inlets.collect(),
        density: plan.material.density,
        threshold: run.output.threshold,
        curvature: curvature_of(plan),
        remarks,
    }
}

/// A run that is to begin.
struct Begin<'a> {
    run: &'a RunPlan,
    film: f64,
    grid: Grid<2>,
    plane: Plane,
    supply: Supply,
    erodible: Option<Erodible>,
    compression: Option<Compression>,
    /// mu, if it was chosen by the volume.
    chosen: Option<f64>,
}

impl Begin<'_> {
    /// With a scheme, what acts on each cell, and what may change that.
    fn with<S>(
        self,
        scheme: S,
        ground: impl Fn([usize; 2]) -> ground::Terrain<2, f64> + Sync,
        state: impl Fn([usize; 2]) -> Flow<2, f64> + Sync,
        (forcing, forest): (
            impl Fn([usize; 2], S::Forcing) -> S::Forcing + Sync,
            Option<Box<dyn BetweenSteps<2, S>>>,
        ),
    ) -> Result<Box<dyn Run>, StartError>
    where
        S: Kernel<2, State = Flow<2, f64>, Ground = ground::Terrain<2, f64>> + 'static,
    {
        let Begin { run, film, grid, plane, supply, erodible, compression, chosen } = self;
        fits(grid.cells.iter().product(), Simulation::<2, S>::bytes_per_cell(false))?;
        let mut simulation = Simulation::new(scheme, grid, step_size(run), ground, state)?;
        simulation.apply(forcing);
        let supply = (!supply.is_empty()).then(|| Box::new(supply) as Box<dyn BetweenSteps<2, S>>);
        let erodible = erodible.map(|erodible| Box::new(erodible) as _);
        let compression = compression.map(|compression| Box::new(compression) as _);
        let between = supply.into_iter().chain(erodible).chain(forest).chain(compression).collect();
        let physics =
            Flowing::new(run.scheme, film, true).with_threshold(run.output.threshold).with(between, chosen);
        Ok(Box::new(Simulated::new(simulation, physics, plane)))
    }
}

/// The highest total head \[m\] that a mass released at rest can have: its highest surface and its greatest height c^2 H over
/// the bed, which a front gains; a depth counts by the earth-pressure coefficient `k`.
fn ceiling(terrain: &Terrain, k: f64, release: &Sparse) -> f64 {
    let (mut top, mut deepest) = (f64::NEG_INFINITY, 0.0_f64);
    for (cell, volume) in release.iter().filter(|(_, volume)| *volume > 0.0) {
        let [column, row] = terrain.bed.place(cell);
        let cos = terrain.fit([column, row]).cosine();
        let depth = k * (cos * cos * volume);
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
