//! `granflow check`: what a case would compute, and how large it is.

use granflow::case::{Axis, Case, Frames, Grid, Model, SchemeName, Side, Slope, Stepping, Until};
use granflow::hadeler_kuttler::scheme::HadelerKuttler;
use granflow::kernels::Kernel;
use granflow::results::Plane;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::ground::Bed;
use granflow::setup::{Sand, Scene, Visit};
use granflow::simulation::Simulation;
use granflow::terrain::Terrain;

use crate::failure::{Failure, print};

mod sandpile;

/// A fast avalanche \[m/s\].
const FAST: f64 = 30.0;

/// What the start of a run looks like.
struct Start {
    /// Largest sum over the axes of (|u| + sqrt(2 beta h))/dx: the Courant number of a step is dt times this.
    rate: f64,
    /// Largest pull as a share of what friction holds.
    margin: f64,
    /// Volume, or area in one dimension.
    volume: f64,
    /// Cells with a depth.
    wet: usize,
    /// Memory that the run will take.
    bytes: usize,
}

impl Start {
    fn of<const D: usize, S: Kernel<D>>(simulation: &mut Simulation<D, S>, maps: bool) -> Start {
        let totals = simulation.totals();
        Start {
            rate: simulation.rate(),
            margin: simulation.yield_ratios().into_iter().fold(0.0, f64::max),
            volume: totals.volume,
            wet: totals.wet,
            bytes: simulation.grid().count() * Simulation::<D, S>::bytes_per_cell(maps),
        }
    }
}

/// Looks at the simulation before its first step.
struct Look;

impl Visit for Look {
    type Output = Start;
    fn visit<const D: usize, S>(self, _plane: Plane, mut simulation: Simulation<D, S>) -> Start
    where
        S: granflow::run::model::Model<D> + Kernel<D, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        Start::of(&mut simulation, true)
    }

    fn visit_sand<const D: usize>(
        self,
        _sand: &Sand<D>,
        mut simulation: Simulation<D, HadelerKuttler>,
    ) -> Start {
        Start::of(&mut simulation, false)
    }
}

/// Prints the resolved case and the estimates.
pub fn check(case: &Case) -> Result<(), Failure> {
    let lines = match case.model {
        Model::SavageHutter => avalanche(case)?,
        Model::HadelerKuttler => sandpile::lines(case)?,
    };
    let text: String = lines.iter().map(|(name, value)| format!("{name:16} {value}\n")).collect();
    let notes: String = case.notes().iter().map(|note| format!("note: {note}\n")).collect();
    print(&format!(
        "{text}{notes}\nThe case is in order. Resolved (angles in radians):\n\n{}",
        case.to_toml()
    ))
}

/// The lines about an avalanche.
fn avalanche(case: &Case) -> Result<Vec<(&'static str, String)>, Failure> {
    let scene = Scene::load(case)?;
    let mut lines = describe(case);
    match (&scene, &case.grid) {
        (Scene::Mountain(mountain), _) => lines.extend(terrain_lines(&mountain.terrain)),
        (Scene::Chute { .. }, Some(grid)) => lines.extend(grid_lines(case, grid)?),
        _ => {}
    }
    let start = scene.simulate(case, Look);
    lines.push(("mass", format!("{:.6} in {} cells", start.volume, start.wet)));
    let verdict = if start.margin > 1.0 { "it will start" } else { "it rests" };
    lines.push(("pull", format!("at most {:.6} of what friction holds: {verdict}", start.margin)));
    lines.extend(effort(case, start.bytes, start.rate));
    Ok(lines)
}

/// Memory and steps, from the Courant number of a step of length 1 at the start.
fn effort(case: &Case, bytes: usize, rate: f64) -> Vec<(&'static str, String)> {
    let mut lines = vec![("memory", memory(bytes)), ("steps", steps(case, rate))];
    if let Stepping::Fixed(step) = case.scheme.stepping() {
        let (courant, limit) = (step * rate, case.scheme.name.courant_limit());
        let verdict = if courant <= limit { "in order" } else { "too large, the scheme is not stable there" };
        lines.push(("Courant number", format!("{courant:.4} at the start (at most {limit}): {verdict}")));
    }
    lines
}

/// The lines about a terrain: size, steepness, curvature under a fast mass.
fn terrain_lines(terrain: &Terrain) -> Vec<(&'static str, String)> {
    let bed = &terrain.bed;
    let nodata = bed.values.iter().filter(|z| z.is_nan()).count();
    let steep = terrain.steepness(60_f64.to_radians());
    let (low, high) = bed.range().unwrap_or_default();
    // Where the bed is convex, N = g c + c w^T (D^2 b) w vanishes at |w|^2 = g/|smallest eigenvalue of D^2 b|.
    let convex = |h: &[f64; 3]| 0.5 * (h[0] + h[2]) - (0.25 * (h[0] - h[2]).powi(2) + h[1] * h[1]).sqrt();
    let flies = terrain.count(|fit| -convex(&fit.hessian) * FAST * FAST > 9.81);
    let valid = (bed.values.len() - nodata).max(1);
    vec![
        (
            "terrain",
            format!("{} x {} cells of {} m, {nodata} without elevation", bed.columns, bed.rows, bed.cell),
        ),
        ("", format!("{low:.1} to {high:.1} m")),
        (
            "steep",
            format!("{} cells above 60 deg, steepest {:.1} deg", steep.steeper, steep.max_slope.to_degrees()),
        ),
        (
            "curvature",
            format!(
                "{:.2} % of the cells throw a mass of {FAST} m/s into the air (N < 0)",
                100.0 * flies as f64 / valid as f64
            ),
        ),
    ]
}

/// What the case says, with its defaults.
fn describe(case: &Case) -> Vec<(&'static str, String)> {
    let files: Vec<&str> = case.files().iter().map(|kind| kind.as_str()).collect();
    let frames = match case.frames() {
        Frames::Every(time) => format!("every {time} in time"),
        Frames::Steps(steps) => format!("every {steps} steps"),
        Frames::Ends => "at the start and at the end".to_owned(),
    };
    let title = if case.title.is_empty() { "without a title" } else { &case.title };
    let mut lines = vec![
        ("case", format!("{title} ({})", case.source_name())),
        ("model", case.model.as_str().to_owned()),
    ];
    if let Some(material) = &case.material {
        let (friction, mu) = (&material.friction, material.friction.mu());
        let (pressure, density) = (material.pressure_coefficient(), material.density());
        lines.extend([
            ("friction", format!("{}, mu = {mu:.6} ({:.3} deg)", friction.name(), mu.atan().to_degrees())),
            ("material", format!("k = {pressure:.6}, gravity {}, density {density}", case.gravity())),
        ]);
    }
    lines.extend([
        ("scheme", scheme(case)),
        ("ends", ends(case)),
        ("output", format!("{} {frames}, {:?}", files.join(", "), case.precision()).to_lowercase()),
    ]);
    lines
}

fn scheme(case: &Case) -> String {
    let name = case.scheme.name;
    let (order, parameter) = match name {
        SchemeName::Balanced2 => ("second order", format!("film {:e}, ", case.scheme.film())),
        SchemeName::FirstOrder => ("first order", String::new()),
        SchemeName::SecondOrder => ("second order", String::new()),
        SchemeName::Adaptive => (
            "second order away from steady states",
            format!("theta_exponent {}, ", case.scheme.theta_exponent()),
        ),
        _ => ("first order", format!("film {:e}, ", case.scheme.film())),
    };
    format!("{}, {order}, {parameter}{}", name.as_str(), stepping(case.scheme.stepping()))
}

fn stepping(stepping: Stepping) -> String {
    match stepping {
        Stepping::Fixed(step) => format!("step {step}"),
        Stepping::Courant(courant) => format!("Courant number {courant}"),
    }
}

fn ends(case: &Case) -> String {
    let time = &case.time;
    let mut ways = Vec::new();
    ways.extend(time.until.map(|until| match (until, time.method, time.rest_speed) {
        (Until::Steady, Some(_), _) => "at the equilibrium, computed directly".to_owned(),
        (Until::Steady, None, _) => format!("steady, changes below {:e} in time", time.steady_rate()),
        (Until::Rest, _, Some(speed)) => format!("below speed {speed:e}"),
        (Until::Rest, _, None) => "at rest".to_owned(),
    }));
    ways.extend(
        time.stop.as_ref().map(|stop| format!("at {} of the peak kinetic energy", stop.kinetic_energy)),
    );
    ways.extend(time.end.map(|end| format!("at time {end}")));
    ways.extend(time.steps.map(|steps| format!("after {steps} steps")));
    ways.join(", or ")
}

fn grid_lines(case: &Case, grid: &Grid) -> Result<Vec<(&'static str, String)>, Failure> {
    let with_sides = |name: &str, axis: &Axis, sides: [Side; 2]| {
        let [low, high] = sides.map(|side| format!("{side:?}").to_lowercase());
        format!("{}, {low} | {high}", axis_line(name, axis))
    };
    let sides = grid.sides();
    let mut lines = vec![("grid", with_sides("x", &grid.x, sides[0]))];
    lines.extend(grid.y.as_ref().map(|y| ("", with_sides("y", y, sides[1]))));

    let chute = case.chute()?;
    let slopes: Vec<f64> = grid.x.centres().iter().map(|x| chute.zeta(*x)).collect();
    let (low, high) = range(&slopes);
    lines.push(match case.material().slope {
        Some(Slope::Profile(_)) => {
            ("slope", format!("{:.4} to {:.4} deg", low.to_degrees(), high.to_degrees()))
        }
        _ => ("slope", format!("{:.4} deg", low.to_degrees())),
    });

    let state = case.initial_state()?;
    let (low, high) = range(&state.thickness);
    let area = grid.x.width() * grid.y.as_ref().map_or(1.0, Axis::width);
    let wet = state.thickness.iter().filter(|h| **h > case.scheme.film()).count();
    let mass = state.thickness.iter().sum::<f64>() * area;
    lines.push(("thickness", format!("{low} to {high}, mass {mass:.6}, {wet} wet cells")));
    Ok(lines)
}

fn axis_line(name: &str, axis: &Axis) -> String {
    format!("{name} from {} to {}, {} cells of {}", axis.from, axis.to, axis.cells, axis.width())
}

fn range(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)))
}

fn memory(bytes: usize) -> String {
    let bytes = bytes as f64;
    let (value, unit) = if bytes < 1e6 {
        (bytes / 1e3, "kB")
    } else if bytes < 1e9 {
        (bytes / 1e6, "MB")
    } else {
        (bytes / 1e9, "GB")
    };
    format!("about {value:.1} {unit} while computing")
}

/// Number of steps, exact for a fixed step, from the step at the start for an adaptive one.
fn steps(case: &Case, rate: f64) -> String {
    let (step, about) = match case.scheme.stepping() {
        Stepping::Fixed(step) => (step, ""),
        Stepping::Courant(courant) if rate > 0.0 => (courant / rate, "about "),
        Stepping::Courant(_) => return "unknown: nothing is there to move".to_owned(),
    };
    let by_time = case.time.end.map(|end| (end / step).ceil());
    match (by_time, case.time.steps) {
        (None, None) => format!("unknown, {about}{step:.3e} in time each at the start"),
        (Some(count), None) => format!(
            "{about}{count} of {step:.3e} in time{}",
            if about.is_empty() { "" } else { ", as at the start" }
        ),
        (None, Some(steps)) => format!("{steps}, {about}{:.4} in time", steps as f64 * step),
        (Some(count), Some(steps)) => format!("at most {}", count.min(steps as f64)),
    }
}
