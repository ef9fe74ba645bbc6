//! A small mass that slides along a circular arc: the centripetal load, and the energy line (K).

use granflow::output::figures::{Axis, Style};
use granflow::run::Stepper;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::ground::Chute;
use granflow::scheme::Boundary;

use super::benchmark::{Benchmark, Check, Errors, Finding, Line, Piece, View};
use super::scheme::{
    GRAVITY, RESTING, Run, Scheme, Setting, Surface, component, failed, line, on_bed, on_chute, terrain,
};
use super::{benchmark::Size, ode};
use crate::failure::Failure;

/// The benchmarks of this file.
pub const BENCHMARKS: [Benchmark; 3] = [
    Benchmark {
        name: "K",
        title: "Energy line",
        about: "A layer of 0.1 mm, one cell wide, slides down a circular arc of terrain, radius 200 m, from 36°; μ = 0.3, curvature \
                left out of the friction. It has next to no pressure, so that z + |V|²/2g + μ s, averaged over the mass, stays \
                what it was; s is the horizontal length of the path.",
        pieces: |size| pieces(size, Bed::Terrain { curved: false }, (line_error, "m")),
        curves: Some(HEAD),
        errors: Some(HEAD_ERROR),
    },
    Benchmark {
        name: "K-curved",
        title: "Energy line under centripetal friction",
        about: "As K, with curvature in the friction: the line is lower by μ ∫ κ |V|² ds/g.",
        pieces: |size| pieces(size, Bed::Terrain { curved: true }, (line_error, "m")),
        curves: Some(HEAD),
        errors: Some(HEAD_ERROR),
    },
    Benchmark {
        name: "arc",
        title: "Centripetal load on a circular arc of a chute",
        about: "As K-curved, on a chute, where x is the length of the arc and N = g cos ζ + u²/R. Known answer: \
                du/dt = g sin ζ - μ (g cos ζ + u²/R), dx/dt = u; at 4 s.",
        pieces: |size| pieces(size, Bed::Chute, (speed_error, "m/s")),
        curves: None,
        errors: Some(View {
            x: Axis::new("cell size Δx", "m"),
            y: Axis::new("error of the mean speed", "m/s"),
            caption: "Error over cell size, both logarithmic; the grey lines have slope 1 and 2.",
        }),
    },
];

const HEAD: View = View {
    x: Axis::new("horizontal path s of the mass centre", "m"),
    y: Axis::new("z + |V|²/2g, less its start", "m"),
    caption: "Head of the mass over its path on the finest grid; the exact line falls by μ = 0.3, and by the centripetal part.",
};

const HEAD_ERROR: View = View {
    x: Axis::new("cell size Δx", "m"),
    y: Axis::new("largest distance from the energy line", "m"),
    caption: "Distance over cell size, both logarithmic; the grey lines have slope 1 and 2.",
};

const RADIUS: f64 = 200.0;
const MU: f64 = 0.3;
/// Slope angle where the mass starts.
const STEEPEST: f64 = 36.0;
const END: f64 = 4.0;
/// About what it has come to then \[m/s\]: an error of a thousandth of it is below what the thickness of the layer does.
const SPEED_AT_END: f64 = 17.0;

/// What the mass slides on.
#[derive(Clone, Copy)]
enum Bed {
    Terrain { curved: bool },
    Chute,
}

/// Means over the mass.
#[derive(Clone, Copy, Default)]
struct Mean {
    /// z + |V|²/2g.
    head: f64,
    /// Horizontal path.
    path: f64,
    /// Speed along the bed.
    speed: f64,
    /// Rate of the centripetal part, μ κ |V|³/g.
    centripetal: f64,
}

impl Bed {
    /// A run on so many cells, the mass at rest in one of them.
    fn run(self, scheme: Scheme, cells: usize) -> Result<Run, Failure> {
        let setting = Setting::coulomb(scheme, MU, 1e-15);
        let grid = line([-10.0, 110.0], cells, Boundary::Open);
        let size = grid.size[0];
        let start = move |x: f64| Flow::still(if x > 0.0 && x < size { 1e-4 } else { 0.0 });
        match self {
            Bed::Chute => {
                let ground = |[s]: [f64; 1]| {
                    let (sin, cos) = angle_along(s).sin_cos();
                    let cos = GRAVITY * cos;
                    Chute { tilt: [GRAVITY * sin], beta: cos, cos, curvature: 1.0 / RADIUS }
                };
                let grounds: Vec<_> = (0..cells).map(|i| ground(grid.centre([i]))).collect();
                on_chute(setting, grid, &grounds, |[x]| start(x))
            }
            Bed::Terrain { curved } => {
                let grounds = terrain(&grid, |[x]| {
                    let (sin, cos) = angle_over(x).sin_cos();
                    let bent = if curved { 1.0 / (RADIUS * cos.powi(3)) } else { 0.0 };
                    Some(Surface { z: RADIUS * (1.0 - cos), slope: [-sin / cos], bent: [[bent]] })
                });
                on_bed(setting, grid, &grounds, |[x], _| start(x))
            }
        }
    }

    fn mean(self, run: &dyn Stepper) -> Mean {
        let ([left, _], [size, _]) = (run.origin(), run.size());
        let (h, q) = (component(run, 0), component(run, 1));
        let (mut sum, mut mass) = (Mean::default(), 0.0);
        for (i, (h, q)) in h.into_iter().zip(q).enumerate().filter(|(_, (h, _))| *h > 0.0) {
            let x = left + (i as f64 + 0.5) * size;
            let angle = if let Bed::Chute = self { angle_along(x) } else { angle_over(x) };
            let speed = q / h / if let Bed::Chute = self { 1.0 } else { angle.cos() };
            sum.head += h * (RADIUS * (1.0 - angle.cos()) + speed * speed / (2.0 * GRAVITY));
            sum.path += h * RADIUS * (STEEPEST.to_radians().sin() - angle.sin());
            sum.speed += h * speed;
            if !matches!(self, Bed::Terrain { curved: false }) {
                sum.centripetal += h * MU * speed.powi(3) / (RADIUS * GRAVITY);
            }
            mass += h;
        }
        let Mean { head, path, speed, centripetal } = sum;
        Mean { head: head / mass, path: path / mass, speed: speed / mass, centripetal: centripetal / mass }
    }
}

/// Slope angle after the length `s` of the arc.
fn angle_along(s: f64) -> f64 {
    STEEPEST.to_radians() - s / RADIUS
}

/// Slope angle after the horizontal way `x`.
fn angle_over(x: f64) -> f64 {
    (STEEPEST.to_radians().sin() - x / RADIUS).asin()
}

/// What one run gives: its error, and the head over the path, computed and known.
struct Slid {
    error: f64,
    lines: [Vec<f64>; 3],
}

type Solve = fn(Scheme, Bed, usize) -> Result<Slid, Failure>;

fn pieces(size: Size, bed: Bed, (solve, unit): (Solve, &'static str)) -> Vec<Piece> {
    // The mass is too wide on coarser grids.
    let grids: &'static [usize] =
        if size == Size::Full { &[300, 600, 1200, 2400] } else { &[600, 1200, 2400] };
    RESTING
        .map(|scheme| Piece::new(scheme.name(), move || converge(scheme, bed, grids, (solve, unit))))
        .into()
}

fn converge(
    scheme: Scheme,
    bed: Bed,
    grids: &[usize],
    (solve, unit): (Solve, &str),
) -> Result<Finding, Failure> {
    let mut errors = Errors::default();
    let mut lines = [const { Vec::new() }; 3];
    for &cells in grids {
        let slid = solve(scheme, bed, cells)?;
        errors.cells.push(cells);
        errors.sizes.push(120.0 / cells as f64);
        errors.errors.push(slid.error);
        lines = slid.lines;
    }
    let (last, size) = (errors.errors[grids.len() - 1], errors.sizes[grids.len() - 1]);
    const PUMPS: &str = "without a law for the energy the scheme throws a mass of one cell apart in its first steps and gains head";
    let (most, reason) = match scheme {
        Scheme::Balanced => (40.0, PUMPS),
        Scheme::Balanced2 => (10.0, PUMPS),
        _ => (
            0.25,
            "the flux of energy is limited: what is left is the mixing of the mass's fast and slow parts",
        ),
    };
    let mut checks = vec![Check::error(
        format!("error on {} cells / ({unit})", grids[grids.len() - 1]),
        last,
        most * size,
        format!("{most} cells, where the mass falls 20 m and comes to 17 m/s: {reason}"),
    )];
    if last > 1e-3 * SPEED_AT_END {
        checks.push(Check::at_least(
            "order over all grids",
            errors.order(),
            [1.0, 0.4],
            "the width of the mass grows as √Δx: at least half an order",
        ));
    }
    let [x, y, known] = lines;
    let exact = Line { name: "exact".into(), x: x.clone(), y: known, style: Style::Dashed };
    let curve = Line { name: scheme.name().into(), x, y, style: Style::Solid };
    Ok(Finding {
        checks,
        errors: Some(errors),
        curves: vec![curve],
        exact: Some(exact),
        ..Finding::default()
    })
}

/// The largest distance from the energy line until the end.
fn line_error(scheme: Scheme, bed: Bed, cells: usize) -> Result<Slid, Failure> {
    let mut run = bed.run(scheme, cells)?;
    let start = bed.mean(&*run);
    let (mut error, mut lower, mut before) = (0.0_f64, 0.0, start);
    let mut lines = [vec![0.0], vec![0.0], vec![0.0]];
    while run.time() < END {
        let dt = run.advance(END).map_err(failed)?;
        let now = bed.mean(&*run);
        lower += 0.5 * dt * (before.centripetal + now.centripetal);
        let (path, head) = (now.path - start.path, now.head - start.head);
        let known = -MU * path - lower;
        error = error.max((head - known).abs());
        for (line, value) in lines.iter_mut().zip([path, head, known]) {
            line.push(value);
        }
        before = now;
    }
    Ok(Slid { error, lines })
}

/// The error of the mean speed at the end, against the slide of a point.
fn speed_error(scheme: Scheme, bed: Bed, cells: usize) -> Result<Slid, Failure> {
    let mut run = bed.run(scheme, cells)?;
    let middle = 60.0 / cells as f64;
    let [_, exact] = ode::solve([middle, 0.0], END, 20_000, |_, [s, u]| {
        let (sin, cos) = angle_along(s).sin_cos();
        [u, GRAVITY * sin - MU * (GRAVITY * cos + u * u / RADIUS)]
    });
    super::scheme::until(&mut *run, END)?;
    Ok(Slid { error: (bed.mean(&*run).speed - exact).abs(), lines: [const { Vec::new() }; 3] })
}
