//! Orders on flows that are smooth and move everywhere.

use granflow::grid::Grid;
use granflow::output::figures::Axis;
use granflow::savage_hutter::Flow;
use granflow::scheme::Boundary;
use granflow::simulation::StepSize;

use super::benchmark::{Benchmark, Check, Errors, Finding, Piece, View};
use super::scheme::{
    ALL, Run, Scheme, Setting, component, depths, grid, line, on_plane, plane, steps, until,
};
use crate::failure::Failure;

/// The benchmarks of this file.
pub const BENCHMARKS: [Benchmark; 3] = [
    Benchmark {
        name: "smooth-1D",
        title: "Smooth flow down an incline",
        about: "Waves of depth and speed on a plane with sin ζ = 0.3, tan δ = 0.5, periodic, moving everywhere; scaled, at \
                t = 0.3. No exact solution: the error of a grid is its difference from the next finer one.",
        pieces: |_| pieces([200, 400, 800, 1600], incline),
        curves: None,
        errors: view("L", "mean |h - h of the finer grid|", "H"),
    },
    Benchmark {
        name: "smooth-2D",
        title: "Smooth flow that turns",
        about: "Waves in two dimensions on a plane with sin ζ = 0.5 along x, moving across the slope under strong friction \
                (tan δ = 0.8), periodic; scaled, at t = 0.25. The error of a grid is its difference from the next finer one.",
        pieces: |_| pieces([48, 96, 192, 384], turning),
        curves: None,
        errors: view("L", "mean |h - h of the finer grid|", "H"),
    },
    Benchmark {
        name: "smooth-time",
        title: "A slab that turns: order in time",
        about: "A uniform layer moves across a slope of sin ζ = 0.5 and turns into it, tan δ = 0.4: an ordinary differential \
                equation, no error in space; scaled, at t = 1. Known answer: that equation by the classical Runge-Kutta \
                method with 10000 steps.",
        pieces: |_| ALL.map(|scheme| Piece::new(scheme.name(), move || slab_that_turns(scheme))).into(),
        curves: None,
        errors: Some(View {
            x: Axis::new("time step Δt", "√(L/g)"),
            y: Axis::new("error of the velocity", "√(Lg)"),
            caption: "Error over time step, both logarithmic; the grey lines have slope 1 and 2.",
        }),
    },
];

const fn view(unit: &'static str, label: &'static str, error_unit: &'static str) -> Option<View> {
    Some(View {
        x: Axis::new("cell size Δx", unit),
        y: Axis::new(label, error_unit),
        caption: "Difference over cell size, both logarithmic; the grey lines have slope 1 and 2.",
    })
}

/// A scheme must come within these of its order.
const SHORT: [f64; 2] = [0.05, 0.1];
const REASON: &str = "smooth and moving everywhere: the order of the scheme, less what the next term of the error leaves on \
                      such grids";

/// The check of the order between the two finest grids.
fn order(scheme: Scheme, errors: &Errors, what: &str) -> Check {
    let second = usize::from(scheme.is_second_order());
    let formal = [1.0, 2.0][second];
    Check::at_least(what, errors.last_order(), [formal, SHORT[second]], REASON)
}

/// One piece of work for each scheme; differences of neighbouring grids.
fn pieces(grids: [usize; 4], solve: fn(Scheme, usize) -> Result<Run, Failure>) -> Vec<Piece> {
    let by = move |scheme: Scheme| -> Result<Finding, Failure> {
        let runs = grids.into_iter().map(|cells| solve(scheme, cells)).collect::<Result<Vec<_>, _>>()?;
        let mut errors = Errors::default();
        for pair in runs.windows(2) {
            let (coarse, means) = (depths(&*pair[0]), halved(&pair[1]));
            let apart = coarse.iter().zip(&means).map(|(c, f)| (c - f).abs()).sum::<f64>();
            errors.cells.push(pair[0].cells()[0]);
            errors.sizes.push(pair[0].size()[0]);
            errors.errors.push(apart / means.len() as f64);
        }
        let what = format!("order from {} to {} cells along an axis", grids[1], grids[3]);
        let checks = vec![order(scheme, &errors, &what)];
        Ok(Finding { checks, errors: Some(errors), ..Finding::default() })
    };
    ALL.map(|scheme| Piece::new(scheme.name(), move || by(scheme))).into()
}

/// Depths of a run averaged over the cells of a grid half as fine, x fastest.
fn halved(fine: &Run) -> Vec<f64> {
    let ([columns, rows], h) = (fine.cells(), depths(&**fine));
    let along_y = if fine.dimensions() > 1 { 2 } else { 1 };
    let mut means = vec![0.0; columns / 2 * (rows / along_y)];
    for (number, h) in h.into_iter().enumerate() {
        let (i, j) = (number % columns, number / columns);
        means[j / along_y * (columns / 2) + i / 2] += h / (2 * along_y) as f64;
    }
    means
}

/// Averages over the cell of 1 + a sin(2 pi x), by two Gauss points.
fn wave(x: f64, size: f64, height: f64, phase: f64) -> f64 {
    let off = size / 12.0_f64.sqrt();
    let at = |x: f64| 1.0 + height * (std::f64::consts::TAU * x + phase).sin();
    (at(x - off) + at(x + off)) / 2.0
}

fn incline(scheme: Scheme, cells: usize) -> Result<Run, Failure> {
    let domain = line([0.0, 1.0], cells, Boundary::Periodic);
    let size = domain.size[0];
    let mut run = on_plane(Setting::coulomb(scheme, 0.5, 0.0), domain, plane([0.3], 0.4), |[x]| {
        let h = wave(x, size, 0.2, 0.0);
        Flow { h, q: [h * (0.7 + 0.1 * wave(x, size, 1.0, 1.0))] }
    })?;
    until(&mut *run, 0.3)?;
    Ok(run)
}

fn turning(scheme: Scheme, cells: usize) -> Result<Run, Failure> {
    let sheet: Grid<2> = grid([cells; 2], [0.0; 2], 1.0 / cells as f64, Boundary::Periodic);
    let size = sheet.size[0];
    let setting = Setting::coulomb(scheme, 0.8, 0.0);
    let mut run = on_plane(setting, sheet, plane([0.5, 0.0], 0.4), |[x, y]| {
        let h = wave(x, size, 0.1, 0.0) * wave(y, size, 0.1, 1.0);
        let u = [wave(y, size, 0.1, 0.3), 0.6 * wave(x, size, 0.1, 0.7)];
        Flow { h, q: u.map(|u| h * u) }
    })?;
    until(&mut *run, 0.25)?;
    Ok(run)
}

fn slab_that_turns(scheme: Scheme) -> Result<Finding, Failure> {
    let (tilt, mu, start) = (0.5, 0.4, [0.1, 0.9]);
    let ground = plane([tilt, 0.0], 0.4);
    let exact = super::ode::solve(start, 1.0, 10_000, |_, u: [f64; 2]| {
        let size = u[0].hypot(u[1]);
        [tilt - mu * ground.cos * u[0] / size, -mu * ground.cos * u[1] / size]
    });
    let mut errors = Errors::default();
    for count in [20, 40, 80, 160] {
        let sheet = grid([4, 4], [0.0; 2], 1.0, Boundary::Periodic);
        let step = 1.0 / count as f64;
        let setting = Setting::coulomb(scheme, mu, 0.0).with_step(StepSize::Fixed(step));
        let mut run = on_plane(setting, sheet, ground, |_| Flow { h: 1.0, q: start })?;
        steps(&mut *run, count)?;
        let [u, v] = [1, 2].map(|k| component(&*run, k)[0]);
        errors.cells.push(count);
        errors.sizes.push(step);
        errors.errors.push((u - exact[0]).hypot(v - exact[1]));
    }
    let checks = vec![order(scheme, &errors, "order from 80 to 160 steps")];
    Ok(Finding { checks, errors: Some(errors), ..Finding::default() })
}
