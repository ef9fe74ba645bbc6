//! `granflow check`: what a case would compute, and how large it is.

use granflow::case::avalanche::Material;
use granflow::case::{
    Axis, Case, Checked, Frames, Kind, RunPlan, Side, Stepping, Until, chute, sandpile as piles,
};
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
            margin: simulation.margins().into_iter().fold(0.0, f64::max),
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
pub fn check(case: &Case, checked: Checked) -> Result<(), Failure> {
    let Checked { run, kind } = checked;
    let (head, tail) = match kind {
        Kind::Sandpile(plan) => {
            let scheme = match plan.scheme {
                piles::SchemeName::FirstOrder => "first order, ".to_owned(),
                piles::SchemeName::SecondOrder => "second order, ".to_owned(),
                piles::SchemeName::Adaptive => {
                    let exponent = plan.theta_exponent;
                    format!("second order away from steady states, theta_exponent {exponent}, ")
                }
            };
            (describe(&run, None, &scheme), sandpile::lines(&run, &plan))
        }
        kind => avalanche(&run, kind)?,
    };
    let lines = head.iter().chain(&tail);
    let text: String = lines.map(|(name, value)| format!("{name:16} {value}\n")).collect();
    let notes: String = run.notes.iter().map(|note| format!("note: {note}\n")).collect();
    print(&format!(
        "{text}{notes}\nThe case is in order. Resolved (angles in radians):\n\n{}",
        case.to_toml()
    ))
}

/// Lines by name.
type Lines = Vec<(&'static str, String)>;

/// The lines about an avalanche: what it is, and what it comes to.
fn avalanche(run: &RunPlan, kind: Kind) -> Result<(Lines, Lines), Failure> {
    let scene = Scene::load(run, kind)?;
    let order = if run.scheme == "balanced_2" { "second order" } else { "first order" };
    let scheme = format!("{order}, film {:e}, ", scene.film());
    let (head, mut lines) = match &scene {
        Scene::Mountain(mountain) => {
            (describe(run, Some(&mountain.material), &scheme), terrain_lines(&mountain.terrain))
        }
        Scene::Chute(plan) => (describe(run, Some(&plan.material), &scheme), grid_lines(plan)),
        Scene::Line(_) | Scene::Table(_) => Default::default(),
    };
    let start = scene.simulate(run, Look);
    lines.push(("mass", format!("{:.6} in {} cells", start.volume, start.wet)));
    let verdict = if start.margin > 1.0 { "it will start" } else { "it rests" };
    lines.push(("pull", format!("at most {:.6} of what friction holds: {verdict}", start.margin)));
    lines.extend(effort(run, start.bytes, start.rate));
    Ok((head, lines))
}

/// Memory and steps, from the Courant number of a step of length 1 at the start.
fn effort(run: &RunPlan, bytes: usize, rate: f64) -> Lines {
    let mut lines = vec![("memory", memory(bytes)), ("steps", steps(run, rate))];
    if let Stepping::Fixed(step) = run.stepping {
        let (courant, limit) = (step * rate, run.max_courant);
        let verdict = if courant <= limit { "in order" } else { "too large, the scheme is not stable there" };
        lines.push(("Courant number", format!("{courant:.4} at the start (at most {limit}): {verdict}")));
    }
    lines
}

/// The lines about a terrain: size, steepness, curvature under a fast mass.
fn terrain_lines(terrain: &Terrain) -> Lines {
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

/// What the case says, with its defaults; `scheme` are the words between the scheme's name and its step.
fn describe(run: &RunPlan, material: Option<&Material>, scheme: &str) -> Lines {
    let files: Vec<&str> = run.files.iter().map(|kind| kind.as_str()).collect();
    let frames = match run.frames {
        Frames::Every(time) => format!("every {time} in time"),
        Frames::Steps(steps) => format!("every {steps} steps"),
        Frames::Ends => "at the start and at the end".to_owned(),
    };
    let title = if run.title.is_empty() { "without a title" } else { &run.title };
    let mut lines =
        vec![("case", format!("{title} ({})", run.source_name())), ("model", run.model.to_owned())];
    if let Some(material) = material {
        let Material { friction, mu, pressure_coefficient, gravity, density, .. } = material;
        lines.extend([
            ("friction", format!("{friction}, mu = {mu:.6} ({:.3} deg)", mu.atan().to_degrees())),
            ("material", format!("k = {pressure_coefficient:.6}, gravity {gravity}, density {density}")),
        ]);
    }
    lines.extend([
        ("scheme", format!("{}, {scheme}{}", run.scheme, stepping(run.stepping))),
        ("ends", ends(run)),
        ("output", format!("{} {frames}, {:?}", files.join(", "), run.precision).to_lowercase()),
    ]);
    lines
}

fn stepping(stepping: Stepping) -> String {
    match stepping {
        Stepping::Fixed(step) => format!("step {step}"),
        Stepping::Courant(courant) => format!("Courant number {courant}"),
    }
}

fn ends(run: &RunPlan) -> String {
    let ends = &run.ends;
    let mut ways = Vec::new();
    ways.extend(ends.until.map(|until| match until {
        Until::Equilibrium => "at the equilibrium, computed directly".to_owned(),
        Until::Steady { rate } => format!("steady, changes below {rate:e} in time"),
        Until::Rest { speed: Some(speed) } => format!("below speed {speed:e}"),
        Until::Rest { speed: None } => "at rest".to_owned(),
    }));
    ways.extend(ends.kinetic_energy.map(|share| format!("at {share} of the peak kinetic energy")));
    ways.extend(ends.time.map(|end| format!("at time {end}")));
    ways.extend(ends.steps.map(|steps| format!("after {steps} steps")));
    ways.join(", or ")
}

fn grid_lines(plan: &chute::Plan) -> Lines {
    let with_sides = |name: &str, axis: &Axis, sides: [Side; 2]| {
        let [low, high] = sides.map(|side| format!("{side:?}").to_lowercase());
        format!("{}, {low} | {high}", axis_line(name, axis))
    };
    let grid = &plan.grid;
    let mut lines = vec![("grid", with_sides("x", &grid.x, plan.sides[0]))];
    lines.extend(grid.y.as_ref().map(|y| ("", with_sides("y", y, plan.sides[1]))));
    let (low, high) = range(&plan.zeta);
    let (low, high) = (low.to_degrees(), high.to_degrees());
    let slope = if low == high { format!("{low:.4} deg") } else { format!("{low:.4} to {high:.4} deg") };
    lines.push(("slope", slope));
    let thickness = &plan.initial.thickness;
    let (low, high) = range(thickness);
    let area = grid.x.width() * grid.y.as_ref().map_or(1.0, Axis::width);
    let wet = thickness.iter().filter(|h| **h > plan.film).count();
    let mass = thickness.iter().sum::<f64>() * area;
    lines.push(("thickness", format!("{low} to {high}, mass {mass:.6}, {wet} wet cells")));
    lines
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
fn steps(run: &RunPlan, rate: f64) -> String {
    let (step, about) = match run.stepping {
        Stepping::Fixed(step) => (step, ""),
        Stepping::Courant(courant) if rate > 0.0 => (courant / rate, "about "),
        Stepping::Courant(_) => return "unknown: nothing is there to move".to_owned(),
    };
    let by_time = run.ends.time.map(|end| (end / step).ceil());
    match (by_time, run.ends.steps) {
        (None, None) => format!("unknown, {about}{step:.3e} in time each at the start"),
        (Some(count), None) => format!(
            "{about}{count} of {step:.3e} in time{}",
            if about.is_empty() { "" } else { ", as at the start" }
        ),
        (None, Some(steps)) => format!("{steps}, {about}{:.4} in time", steps as f64 * step),
        (Some(count), Some(steps)) => format!("at most {}", count.min(steps as f64)),
    }
}
