//! What an avalanche would compute: material, bed, mass, pull.

use super::chute::{self, Chuted, Part};
use super::laid::Laid;
#[cfg(feature = "geo")]
use super::loaded::{self, Loaded};
#[cfg(feature = "geo")]
use super::terrain;
use crate::StartError;
use crate::describe::{Line, axis, case, effort, range};
use crate::inputs::Inputs;
use crate::memory::{Drawn, Size, fits};
use crate::model::{At, Kind, Quantity};
use crate::run::Run;
use crate::watch::Watch;
use granflow_case::avalanche::Material;
use granflow_case::chute::Plan as OnChute;
#[cfg(feature = "geo")]
use granflow_case::terrain::{Entrainment, Plan as OnTerrain, TerrainScheme};
use granflow_case::{Axis, Durations, Frames, RunPlan, Side};
#[cfg(feature = "geo")]
use granflow_geo::terrain::{Pits, Survey};
use granflow_model::real::CompensatedSum;
#[cfg(feature = "geo")]
use granflow_model::savage_hutter::erosion::Erosion;

/// A fast avalanche \[m/s\].
#[cfg(feature = "geo")]
const FAST: f64 = 30.0;

/// The lines about an avalanche on a chute.
pub(crate) fn chute(run: &RunPlan, plan: &OnChute, inputs: &Inputs) -> Result<Vec<Line>, StartError> {
    let order = if run.scheme.ends_with("_2") && !run.scheme.starts_with("verfahren") {
        "second order"
    } else {
        "first order"
    };
    let mut lines = case(run, material(&plan.material), &format!("{order}, film {:e}, ", plan.scheme.film));
    lines.push(threshold(run, ""));
    let laid = Laid::of(plan, inputs)?;
    let mass = Mass::of(plan, &laid);
    lines.extend(grid(plan, &mass));
    lines.extend(start(run, &at_start(run, (plan, &laid), inputs, &mass)?));
    lines.extend(laid.remarks.iter().filter_map(|remark| {
        let (kind, text) = remark.split_once(": ")?;
        Some((if kind == "note" { "note" } else { "warning" }, text.to_owned()))
    }));
    Ok(lines)
}

/// The lines about an avalanche on a mountain.
#[cfg(feature = "geo")]
pub(crate) fn terrain(run: &RunPlan, plan: &OnTerrain, inputs: &Inputs) -> Result<Vec<Line>, StartError> {
    let order = match plan.scheme.name {
        TerrainScheme::EnergyStable | TerrainScheme::Balanced => "first order",
        TerrainScheme::EnergyStable2 | TerrainScheme::Balanced2 => "second order",
    };
    let mut loaded = loaded::load(run, plan, inputs, None)?;
    let mut lines = case(run, material(&loaded.material), &format!("{order}, film {:e}, ", plan.scheme.film));
    lines.push(threshold(run, " m"));
    lines.extend(mountain(&loaded, plan.material.gravity));
    lines.extend(
        plan.entrainment.as_ref().zip(loaded.layer.as_ref()).map(|(one, (_, volume))| erodible(one, *volume)),
    );
    let strength = plan.forest_breaks_at.map(|pascal| format!("it breaks at {} kPa", pascal / 1000.0));
    lines.extend(strength.map(|text| ("forest", text)));
    let remarks: Vec<Line> = loaded.remarks.iter().map(|one| (one.kind(), one.text().to_owned())).collect();
    let reading = loaded.reading as f64;
    // Mass and pull are those of all releases together.
    loaded.start_all();
    let mut mountain = terrain::simulate(run, plan, loaded)?;
    let mut begun = Start::of((run, inputs), &mut *mountain, READ, ON_MOUNTAIN, |_| true)?;
    begun.size.reading = reading;
    begun.size.shared = SHARED;
    if let Some(entrainment) = &plan.entrainment {
        // The layer, what was taken of it, its map at the end, and the bed where it sinks.
        begun.size.run += 24.0 + if entrainment.lower_bed { 8.0 } else { 0.0 };
        begun.size.saved += 8.0;
        begun.size.maps += 1;
    }
    if plan.forest_breaks_at.is_some() {
        begun.size.run += 16.0;
        begun.size.saved += 8.0;
        begun.size.maps += 1;
    }
    lines.extend(start(run, &begun));
    lines.extend(remarks);
    Ok(lines)
}

/// Bytes for each cell of what is read before a simulation of a mountain is made: its elevation.
#[cfg(feature = "geo")]
const READ: f64 = 8.0;
/// Bytes for each cell that the members of an ensemble share: elevation, its fits, the elevation that is shown.
#[cfg(feature = "geo")]
const SHARED: f64 = 56.0;
/// What pictures of a line, of a plane and of a mountain take: measured.
const ON_LINE: Drawn = Drawn { figure: 48e6, picture: 15e6, of_ensemble: 12e6, held: 10.0 };
const ON_PLANE: Drawn = Drawn { figure: 8e6, picture: 11e6, of_ensemble: 25e6, held: 0.0 };
#[cfg(feature = "geo")]
const ON_MOUNTAIN: Drawn = Drawn { figure: 25e6, picture: 28e6, of_ensemble: 54e6, held: 0.0 };

/// How the state at the start would move, and how large the run is.
struct Start {
    volume: f64,
    wet: usize,
    /// Largest pull by what friction holds, and the largest rate.
    pull: f64,
    rate: f64,
    size: Size,
    /// The lines about gauges and sections.
    watched: Vec<Line>,
}

impl Start {
    /// Of a run; `beside` are the bytes for each cell that set it up, `pictures` those of what is drawn. The pull is that of
    /// the cells whose numbers are `within`.
    fn of(
        (run, inputs): (&RunPlan, &Inputs),
        start: &mut dyn Run,
        beside: f64,
        pictures: Drawn,
        within: impl Fn(usize) -> bool,
    ) -> Result<Start, StartError> {
        let watch = Watch::of(run, inputs, start)?;
        let pulls = start.stepper_mut().yield_ratios().into_iter().enumerate();
        let pull =
            pulls.filter(|(number, _)| within(*number)).fold(0.0, |most: f64, (_, pull)| most.max(pull));
        let (totals, rate) = (start.totals(), start.stepper().rate());
        let cells: usize = start.stepper().cells().iter().product();
        // What passes a section is found from the state before a step, as what is shown of an instant within it.
        let instants =
            matches!(run.output.frames, Frames::Every(_) | Frames::Ends) || !watch.sections.is_empty();
        let Durations { thickness, speed, pressure } = run.output.durations;
        let durations = [thickness, speed, pressure].iter().flatten().count();
        let kept = |map: &Quantity| map.at == At::Cells && !map.on_demand;
        let watched = watched(run, start, &watch);
        let plane = start.plane();
        let line = plane.dimensions() == 1;
        let size = Size {
            cells,
            line,
            reading: 0.0,
            setup: start.stepper().bytes_per_cell(false) as f64 + beside,
            // Two arrays for each map of durations, and the map itself at the end.
            run: start.bytes_per_cell(instants) as f64 + 24.0 * durations as f64,
            shared: 0.0,
            // Components of the state, and four maps in single precision.
            saved: 8.0 * start.stepper().components() as f64 + 16.0 + 16.0 * durations as f64,
            maps: plane.model().of_kind(Kind::Map).filter(|map| kept(map)).count() + durations,
            frame: plane.series().iter().map(|field| field.length).sum(),
            drawn: if line { ON_LINE } else { pictures },
        };
        Ok(Start { volume: totals.volume, wet: totals.wet, pull, rate, size, watched })
    }
}

/// Cells of a chute that are looked at together, so that a look takes little memory however many there are.
const TOGETHER: usize = 1 << 18;

/// The start of a run on a chute; of a large one part by part, each with a cell more on every side. At a wall or a periodic edge
/// the pull is then that at an open one.
fn at_start(run: &RunPlan, chute: Chuted, inputs: &Inputs, mass: &Mass) -> Result<Start, StartError> {
    let (plan, laid) = chute;
    let [columns, rows] = plan.grid.cells();
    let cells = columns * rows;
    // Where a gauge or a section lies only the whole can say.
    if cells <= TOGETHER || !run.watched.is_empty() {
        return Start::of((run, inputs), &mut *chute::start(run, plan, laid)?, 0.0, ON_PLANE, |_| true);
    }
    let look = |part: Part, within: &dyn Fn(usize) -> bool| -> Result<Start, StartError> {
        Start::of((run, inputs), &mut *chute::part(run, chute, part)?, 0.0, ON_PLANE, within)
    };
    let few = look(Part { from: [0; 2], cells: [columns.min(3), rows.min(3)] }, &|_| true)?.size;
    fits(cells, few.setup as usize)?;
    let mut whole = Start {
        volume: mass.volume,
        wet: mass.wet,
        pull: 0.0,
        rate: 0.0,
        watched: Vec::new(),
        size: Size { cells, frame: few.frame / few.cells * cells, ..few },
    };
    let across = columns.min(TOGETHER);
    let along = (TOGETHER / across).max(1);
    for first in (0..rows).step_by(along).flat_map(|y| (0..columns).step_by(across).map(move |x| [x, y])) {
        let from = first.map(|cell| cell.saturating_sub(1));
        let to = [(first[0] + across + 1).min(columns), (first[1] + along + 1).min(rows)];
        let part = Part { from, cells: [to[0] - from[0], to[1] - from[1]] };
        let own = |number: usize| {
            let [x, y] = [from[0] + number % part.cells[0], from[1] + number / part.cells[0]];
            (first[0]..first[0] + across).contains(&x) && (first[1]..first[1] + along).contains(&y)
        };
        let one = look(part, &own)?;
        (whole.pull, whole.rate) = (whole.pull.max(one.pull), whole.rate.max(one.rate));
    }
    Ok(whole)
}

/// What lies on a chute at the start.
struct Mass {
    /// The thinnest and the thickest layer.
    range: [f64; 2],
    volume: f64,
    /// Cells with a depth, and those with more than a film.
    wet: usize,
    thick: usize,
}

impl Mass {
    fn of(plan: &OnChute, laid: &Laid) -> Mass {
        let (mut mass, mut sum) =
            (Mass { range: [f64::INFINITY, 0.0], volume: 0.0, wet: 0, thick: 0 }, CompensatedSum::default());
        for (cell, own) in plan.initial.thickness.iter().enumerate() {
            let h = laid.with(cell, own);
            mass.range = [mass.range[0].min(h), mass.range[1].max(h)];
            mass.wet += usize::from(h > 0.0);
            mass.thick += usize::from(h > plan.scheme.film);
            sum.add(h);
        }
        let cell = plan.grid.x.width() * plan.grid.y.as_ref().map_or(1.0, Axis::width);
        Mass { volume: sum.value() * cell, ..mass }
    }
}

fn start(run: &RunPlan, start: &Start) -> Vec<Line> {
    let Start { volume, wet, pull, rate, size, watched } = start;
    let verdict = if *pull > 1.0 { "it will start" } else { "it rests" };
    let mut lines = match wet {
        0 => vec![("mass", "nothing lies there at the start".to_owned())],
        wet => vec![
            ("mass", format!("{volume:.6} in {wet} cells")),
            ("pull", format!("at most {pull:.6} of what friction holds: {verdict}")),
        ],
    };
    lines.extend(watched.iter().cloned());
    lines.extend(effort(run, size, *rate));
    lines
}

/// Where it is looked at, and how often.
fn watched(run: &RunPlan, start: &dyn Run, watch: &Watch) -> Vec<Line> {
    let plane = start.plane();
    let at = |cell: usize| {
        let (x, y) = (plane.x[cell % plane.x.len()], plane.y.get(cell / plane.x.len()));
        y.map_or(format!("{x}"), |y| format!("{x}, {y}"))
    };
    let gauges = watch.gauges.iter();
    let mut lines: Vec<Line> =
        gauges.map(|(name, cell)| ("gauge", format!("{name}, the cell at ({})", at(*cell)))).collect();
    let sections = watch.sections.iter();
    lines.extend(
        sections.map(|one| ("section", format!("{}, the faces of {} cells", one.name, one.cells.len()))),
    );
    if !watch.is_empty() {
        let often =
            run.watched.every.map_or("after every step".to_owned(), |every| format!("every {every} in time"));
        lines.push(("", format!("looked at {often}, and at the instants of the frames")));
    }
    lines.extend(watch.notes.iter().map(|note| ("note", note.clone())));
    lines
}

/// What counts in the results.
fn threshold(run: &RunPlan, unit: &str) -> Line {
    let threshold = run.output.threshold;
    ("counted", format!("layers thicker than {threshold}{unit}, in peaks, times and deposit"))
}

fn material(material: &Material) -> Vec<Line> {
    let Material {
        friction, mu, in_space, pressure_coefficient, passive_coefficient, gravity, density, ..
    } = material;
    let passive = if passive_coefficient > pressure_coefficient {
        format!(" where it is stretched, {passive_coefficient:.6} where it is compressed")
    } else {
        String::new()
    };
    let first = match in_space.first() {
        Some(first) if first.index == 0 => {
            let name = first.key.rsplit('.').next().unwrap_or_default();
            format!(", {name} differs from place to place")
        }
        _ => mu.map(|mu| format!(", mu = {mu:.6} ({:.3} deg)", mu.atan().to_degrees())).unwrap_or_default(),
    };
    vec![
        ("friction", format!("{friction}{first}")),
        ("material", format!("k = {pressure_coefficient:.6}{passive}, gravity {gravity}, density {density}")),
    ]
}

/// The cells of a chute, its slope, and the mass on it.
fn grid(plan: &OnChute, mass: &Mass) -> Vec<Line> {
    let with_sides = |name: &str, along: &Axis, sides: [Side; 2]| {
        let [low, high] = sides.map(|side| format!("{side:?}").to_lowercase());
        format!("{}, {low} | {high}", axis(name, along))
    };
    let mut lines = vec![("grid", with_sides("x", &plan.grid.x, plan.sides[0]))];
    lines.extend(plan.grid.y.as_ref().map(|y| ("", with_sides("y", y, plan.sides[1]))));
    let (low, high) = range((0..plan.grid.x.cells).map(|column| plan.columns.zeta(column)));
    lines.push(if low < high {
        ("slope", format!("{:.4} to {:.4} deg", low.to_degrees(), high.to_degrees()))
    } else {
        ("slope", format!("{:.4} deg", low.to_degrees()))
    });
    let Mass { range: [low, high], volume, thick, .. } = mass;
    lines.push(("thickness", format!("{low} to {high}, mass {volume:.6}, {thick} wet cells")));
    lines
}

/// A mountain: size, steepness, what looks odd, curvature under a fast mass, systems and releases.
#[cfg(feature = "geo")]
fn mountain(loaded: &Loaded, gravity: f64) -> Vec<Line> {
    let (bed, Survey { missing, range: [low, high], step, step_at, .. }) =
        (&loaded.terrain.bed, &loaded.survey);
    let share = |count: usize, all: usize| 100.0 * count as f64 / all.max(1) as f64;
    let (all, with) = (bed.values.len(), bed.values.len() - missing);
    let steep = loaded.terrain.steepness(60_f64.to_radians());
    let size = format!("{} x {} cells of {} m", bed.columns, bed.rows, bed.cell);
    let [x, y] = step_at;
    let mut lines = vec![
        ("terrain", format!("{size}, {missing} without elevation ({:.1} %)", share(*missing, all))),
        ("", loaded::described(bed.crs.as_ref())),
        ("", format!("{low:.1} to {high:.1} m, largest step between cells {step:.1} m at ({x:.1}, {y:.1})")),
        (
            "steep",
            format!(
                "{} cells above 60 deg ({:.1} %), steepest {:.1} deg",
                steep.steeper,
                share(steep.steeper, with),
                steep.max_slope.to_degrees()
            ),
        ),
        ("curvature", curvature(loaded, gravity, with)),
    ];
    let parts = loaded.parts.iter().zip(std::iter::once("release").chain(std::iter::repeat("")));
    lines.extend(parts.map(|((name, crs, volume), title)| {
        let crs = crs.as_ref().map(|crs| format!(", {crs}")).unwrap_or_default();
        (title, format!("{name}{crs}, {volume:.1} m3"))
    }));
    lines.extend(
        loaded
            .parameters
            .ranges
            .iter()
            .map(|(key, [least, largest])| ("parameter", format!("{key} from {least} to {largest}"))),
    );
    let released = loaded.parts.iter().map(|(_, _, volume)| volume).sum();
    lines.push(("pits", pits(&Pits::of(bed), released)));
    lines
}

/// The layer that the flow picks up, of this volume \[m^3\].
#[cfg(feature = "geo")]
fn erodible(entrainment: &Entrainment, volume: f64) -> Line {
    let Entrainment { density, law, lower_bed, .. } = entrainment;
    let law = match law {
        Erosion::Speed { coefficient } => format!("picked up by speed, {coefficient} of the way"),
        Erosion::Shear { threshold, depth_by_stress, rate } => format!(
            "picked up where the stress exceeds {threshold} Pa, at {rate} m/s to {depth_by_stress} m for each Pa beyond"
        ),
        Erosion::Energy { specific } => format!("picked up by the work of friction, {specific} J/kg"),
        Erosion::Plough => "taken whole by the front".to_owned(),
    };
    let bed = if *lower_bed { "; the bed sinks" } else { "" };
    ("erodible", format!("a layer of {volume:.1} m3 of {density} kg/m3, {law}{bed}"))
}

/// What cannot run out of the terrain, beside the release.
#[cfg(feature = "geo")]
fn pits(pits: &Pits, released: f64) -> String {
    if pits.cells == 0 {
        return "none".to_owned();
    }
    let Pits { cells, volume, depth, place: [x, y] } = pits;
    let share = 100.0 * volume / released;
    let hold = if *cells == 1 { "cell holds" } else { "cells hold" };
    format!(
        "{cells} {hold} up to {volume:.0} m3 ({share:.1} % of the release), the deepest {depth:.1} m at ({x:.1}, {y:.1})"
    )
}

/// Where a fast mass leaves the ground: where the bed is convex, N = g c + c w^T (D^2 b) w vanishes at |w|^2 = g/|smallest
/// eigenvalue of D^2 b|.
#[cfg(feature = "geo")]
fn curvature(loaded: &Loaded, gravity: f64, with: usize) -> String {
    let convex = |h: &[f64; 3]| 0.5 * (h[0] + h[2]) - (0.25 * (h[0] - h[2]).powi(2) + h[1] * h[1]).sqrt();
    let flies = loaded.terrain.count(|fit| -convex(&fit.hessian) * FAST * FAST > gravity);
    let share = 100.0 * flies as f64 / with.max(1) as f64;
    format!("{share:.2} % of the cells throw a mass of {FAST} m/s into the air (N < 0)")
}
