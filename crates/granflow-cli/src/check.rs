//! `granflow check`: what a case would compute, and how large it is.

use granflow::case::{Axis, Case, Frames, Grid, SchemeName, Side, Slope, Stepping};

use crate::failure::{Failure, print};

/// Bytes a cell takes while it is computed: thickness and momentum at two times and in one stage, ground and maps, 8
/// bytes each.
const BYTES_PER_CELL: usize = 8 * 16;

/// What is known of a terrain case once its raster and releases are loaded.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedTerrain {
    /// Cells along x and y.
    pub cells: [usize; 2],
    /// Size of a cell in metres.
    pub cell: f64,
    /// Cells without elevation.
    pub nodata: usize,
    /// Released volume in cubic metres.
    pub volume: f64,
    /// Cells that are released.
    pub released: usize,
    /// The largest a/dx + a/dy at the start, a = |w| + sqrt(2 beta H): the step is Courant number / rate.
    pub rate: f64,
    /// Everything else worth a line: N/(g c), steep cells, |F|/(mu g c).
    pub notes: Vec<(&'static str, String)>,
}

/// Prints the resolved case and the estimates.
pub fn check(case: &Case) -> Result<(), Failure> {
    let mut lines = describe(case);
    if let Some(grid) = &case.grid {
        lines.extend(grid_lines(case, grid)?);
    }
    if let Some(terrain) = &case.terrain {
        lines.push((
            "terrain",
            format!("{}, every file of the case is there", case.resolve(&terrain.dem).display()),
        ));
    }
    lines.extend(case.notes().into_iter().map(|note| ("note", note)));
    let text: String = lines.iter().map(|(name, value)| format!("{name:16} {value}\n")).collect();
    print(&format!("{text}\nThe case is in order. Resolved (angles in radians):\n\n{}", case.to_toml()))
}

/// The lines about a loaded terrain.
pub fn terrain_lines(case: &Case, loaded: &LoadedTerrain) -> Vec<(&'static str, String)> {
    let [nx, ny] = loaded.cells;
    let mut lines = vec![
        ("cells", format!("{nx} x {ny} of {} m, {} without elevation", loaded.cell, loaded.nodata)),
        ("release", format!("{:.1} m3 in {} cells", loaded.volume, loaded.released)),
        ("memory", memory(nx * ny)),
        ("steps", steps(case, loaded.rate)),
    ];
    lines.extend(loaded.notes.iter().cloned());
    lines
}

/// What the case says, with its defaults.
fn describe(case: &Case) -> Vec<(&'static str, String)> {
    let friction = &case.material.friction;
    let mu = friction.mu();
    let pressure = case.material.pressure_coefficient();
    let name = case.scheme.name;
    let order = if name == SchemeName::Balanced2 { "second" } else { "first" };
    let film = case.scheme.film();
    let files: Vec<&str> = case.files().iter().map(|kind| kind.as_str()).collect();
    let frames = match case.frames() {
        Frames::Every(time) => format!("every {time} in time"),
        Frames::Steps(steps) => format!("every {steps} steps"),
        Frames::Ends => "at the start and at the end".to_owned(),
    };
    vec![
        (
            "case",
            format!(
                "{} ({})",
                if case.title.is_empty() { "without a title" } else { &case.title },
                case.source_name()
            ),
        ),
        ("model", case.model.as_str().to_owned()),
        ("friction", format!("{}, mu = {mu:.6} ({:.3} deg)", friction.name(), mu.atan().to_degrees())),
        (
            "material",
            format!("k = {pressure:.6}, gravity {}, density {}", case.gravity(), case.material.density()),
        ),
        (
            "scheme",
            format!("{}, {order} order, film {film:e}, {}", name.as_str(), stepping(case.scheme.stepping())),
        ),
        ("ends", ends(case)),
        ("output", format!("{} {frames}, {:?}", files.join(", "), case.precision()).to_lowercase()),
    ]
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
    ways.extend(time.until.map(|_| match time.rest_speed {
        Some(speed) => format!("below speed {speed:e}"),
        None => "at rest".to_owned(),
    }));
    ways.extend(
        time.stop.as_ref().map(|stop| format!("at {} of the peak kinetic energy", stop.kinetic_energy)),
    );
    ways.extend(time.end.map(|end| format!("at time {end}")));
    ways.extend(time.steps.map(|steps| format!("after {steps} steps")));
    ways.join(", or ")
}

fn grid_lines(case: &Case, grid: &Grid) -> Result<Vec<(&'static str, String)>, Failure> {
    let axis = |name: &str, axis: &Axis, sides: [Side; 2]| {
        let [low, high] = sides.map(|side| format!("{side:?}").to_lowercase());
        format!(
            "{name} from {} to {}, {} cells of {}, {low} | {high}",
            axis.from,
            axis.to,
            axis.cells,
            axis.width()
        )
    };
    let sides = grid.sides();
    let mut lines = vec![("grid", axis("x", &grid.x, sides[0]))];
    lines.extend(grid.y.as_ref().map(|y| ("", axis("y", y, sides[1]))));

    let chute = case.chute()?;
    let slopes: Vec<f64> = grid.x.centres().iter().map(|x| chute.zeta(*x)).collect();
    let (low, high) = range(&slopes);
    lines.push(match case.material.slope {
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
    let [nx, ny] = grid.cells();
    lines.push(("cells", (nx * ny).to_string()));
    lines.push(("memory", memory(nx * ny)));

    let factor = case.gravity() * case.material.epsilon() * case.material.pressure_coefficient();
    let rate = (0..nx * ny)
        .filter(|cell| state.thickness[*cell] > 0.0)
        .map(|cell| {
            let wave = (2.0 * factor * slopes[cell % nx].cos() * state.thickness[cell]).sqrt();
            let across = grid.y.as_ref().map_or(0.0, |y| (state.velocity_y[cell].abs() + wave) / y.width());
            (state.velocity_x[cell].abs() + wave) / grid.x.width() + across
        })
        .fold(0.0, f64::max);
    lines.push(("steps", steps(case, rate)));
    if let Stepping::Fixed(step) = case.scheme.stepping() {
        let (courant, limit) = (step * rate, case.scheme.name.courant_limit());
        let verdict = if courant <= limit { "in order" } else { "too large, the scheme is not stable there" };
        lines.push(("Courant number", format!("{courant:.4} at the start (at most {limit}): {verdict}")));
    }
    Ok(lines)
}

fn range(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)))
}

fn memory(cells: usize) -> String {
    let bytes = cells as f64 * BYTES_PER_CELL as f64;
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
