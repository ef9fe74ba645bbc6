//! Flows in one dimension on planes: A, B, D, the water limit of I, J.

use granflow::output::figures::Axis;
use granflow::savage_hutter::Flow as State;
use granflow::savage_hutter::exact::{CapRelease, Flow1, GranularJump, ParabolicCap, Riemann, SlopeDamBreak};
use granflow::scheme::Boundary;

use super::benchmark::{Benchmark, View};
use super::convergence::{Flow, Over, Solved, cells, mean};
use super::scheme::Scheme::{Balanced, Balanced2, EnergyStable, EnergyStable2, Verfahren};
use super::scheme::{
    GRAVITY, Run, Scheme, Setting, Surface, depths, failed, incline, line, on_bed, on_plane, plane, terrain,
    until,
};
use crate::failure::Failure;

/// Axes of a profile in the papers' scaling.
pub const SCALED: [Axis; 2] = [Axis::new("x / L", ""), Axis::new("depth h / H", "")];
const METRES: [Axis; 2] = [Axis::new("distance down the slope x", "m"), Axis::new("depth h", "m")];

/// The picture of the profiles.
pub const fn curves([x, y]: [Axis<'static>; 2], caption: &'static str) -> Option<View> {
    Some(View { x, y, caption })
}

/// The picture of errors over cell size.
pub const fn errors(unit: &'static str, label: &'static str, error_unit: &'static str) -> Option<View> {
    Some(View {
        x: Axis::new("cell size Δx", unit),
        y: Axis::new(label, error_unit),
        caption: "Error over cell size, both logarithmic; the grey lines have slope 1 and 2, the legend the order of a line through all grids.",
    })
}

/// What jumps and kinks do to an order.
pub const KINKS: ([f64; 2], &str) = (
    [1.0, 1.0],
    "beside a jump or a kink no scheme is better than first order; the kinks of a fan cost a first-order scheme up to half an order on such grids",
);

/// The benchmarks of this file.
pub const BENCHMARKS: [Benchmark; 8] = [A, B, B_TERRAIN, D, D_TERRAIN, RITTER, STOKER, J];

const A: Benchmark = Benchmark {
    name: "A",
    title: "Riemann problem without friction",
    about: "h = 1 at x < 0 and 0.5 at x > 0, at rest, β = 0.4, scaled; at t = 5. Exact: a fan, a constant state and a shock \
            (report, section 4, with erratum corrected; Toro 2001).",
    pieces: |size| FLOW_A.pieces(size),
    curves: curves(SCALED, "Depth at t = 5 √(L/g) on the finest grid."),
    errors: errors("L", "L1 error of h", "HL"),
};

const FLOW_A: Flow = Flow {
    coarsest: 400,
    grids: 4,
    quantity: "L1(h) / (HL)",
    formal: KINKS,
    over: Over::Finest,
    bounds: &[
        cells(EnergyStable, 2.7, 0.6),
        cells(EnergyStable2, 1.25, 0.6),
        cells(Balanced, 3.8, 0.6),
        cells(Balanced2, 0.8, 0.9),
        cells(Verfahren(1), 4.6, 0.6),
        cells(Verfahren(2), 4.6, 0.6),
        cells(Verfahren(3), 4.6, 0.6),
        cells(Verfahren(4), 4.6, 0.6),
        cells(Verfahren(5), 4.6, 0.6),
    ],
    solve: |scheme, cells| {
        let exact = Riemann::stoker(0.4, 1.0, 0.5).map_err(failed)?;
        two_states(scheme, cells, 0.4, &exact, 5.0)
    },
};

const RITTER: Benchmark = Benchmark {
    name: "I-Ritter",
    title: "Dam break onto a dry bed, no friction",
    about: "Water 1 m deep at x < 0, dry at x > 0; at 0.7 s. Exact: Ritter 1892, h = (2 √(g h0) - x/t)²/(9 g).",
    pieces: |size| FLOW_RITTER.pieces(size),
    curves: curves(METRES, "Depth at 0.7 s on the finest grid."),
    errors: errors("m", "L1 error of h", "m²"),
};

const FLOW_RITTER: Flow = Flow {
    coarsest: 200,
    grids: 4,
    quantity: "L1(h) / m²",
    formal: KINKS,
    over: Over::Finest,
    bounds: &[
        cells(EnergyStable, 1.6, 0.6),
        cells(EnergyStable2, 0.56, 0.9),
        cells(Balanced, 2.0, 0.6),
        cells(Balanced2, 0.24, 0.9),
    ],
    solve: |scheme, cells| {
        let exact = Riemann::ritter(GRAVITY, 1.0).map_err(failed)?;
        two_states(scheme, cells, GRAVITY, &exact, 0.7)
    },
};

const STOKER: Benchmark = Benchmark {
    name: "I-Stoker",
    title: "Dam break onto a wet bed, no friction",
    about: "Water 1 m deep at x < 0, 0.1 m at x > 0; at 1 s. Exact: Stoker 1957, a fan, a constant state and a bore. \
            Verfahren 2 to 4, which lose positivity, are left out.",
    pieces: |size| FLOW_STOKER.pieces(size),
    curves: curves(METRES, "Depth at 1 s on the finest grid."),
    errors: errors("m", "L1 error of h", "m²"),
};

const FLOW_STOKER: Flow = Flow {
    coarsest: 200,
    grids: 4,
    quantity: "L1(h) / m²",
    formal: KINKS,
    over: Over::Finest,
    bounds: &[
        cells(EnergyStable, 1.75, 0.6),
        cells(EnergyStable2, 0.8, 0.8),
        cells(Balanced, 2.2, 0.6),
        cells(Balanced2, 0.53, 0.8),
        cells(Verfahren(1), 2.5, 0.6),
        cells(Verfahren(5), 2.5, 0.6),
    ],
    solve: |scheme, cells| {
        let exact = Riemann::stoker(GRAVITY, 1.0, 0.1).map_err(failed)?;
        two_states(scheme, cells, GRAVITY, &exact, 1.0)
    },
};

const J: Benchmark = Benchmark {
    name: "J",
    title: "Granular jump",
    about: "On a plane of 30° with tan δ = tan ζ a layer of 0.3 m at 6 m/s runs into one of 1 m; at 1 s. Exact: jump conditions \
            of Tai, Noelle, Gray & Hutter 2002, speed (h⁻u⁻ - h⁺u⁺)/(h⁻ - h⁺).",
    pieces: |size| FLOW_J.pieces(size),
    curves: curves(
        [METRES[0].over(1.5, 1.9), METRES[1]],
        "Depth at 1 s on the finest grid, around the jump.",
    ),
    errors: errors("m", "L1 error of h", "m²"),
};

const FLOW_J: Flow = Flow {
    coarsest: 200,
    grids: 4,
    quantity: "L1(h) / m²",
    formal: (
        [1.0, 1.0],
        "a jump is first order; starting it from two states leaves a dent behind that a scheme does not forget, which costs up to half an order",
    ),
    over: Over::All,
    bounds: &[
        cells(EnergyStable, 0.8, 0.6),
        cells(EnergyStable2, 0.68, 0.5),
        cells(Balanced, 0.8, 0.6),
        cells(Balanced2, 0.57, 0.6),
        cells(Verfahren(1), 0.8, 0.6),
        cells(Verfahren(5), 0.8, 0.6),
    ],
    solve: |scheme, cells| {
        let zeta = 30.0_f64.to_radians();
        let ground = incline::<1>(zeta);
        let exact = GranularJump::new(ground.beta, Flow1 { h: 0.3, u: 6.0 }, 1.0).map_err(failed)?;
        let domain = line([-5.0, 5.0], cells, Boundary::Open);
        let run = on_plane(Setting::coulomb(scheme, zeta.tan(), 0.0), domain, ground, |[x]| {
            flow(exact.flow(x, 0.0))
        })?;
        compared(run, 1.0, |x| exact.flow(x, 1.0).h)
    },
};

const B: Benchmark = Benchmark {
    name: "B",
    title: "Parabolic cap on a plane, 1-D",
    about: "A cap 4 m high and 160 m long is released on a plane of 35°, δ = 25°; at 5 s. Exact: Savage & Hutter 1989, it stays a \
            parabola.",
    pieces: |size| FLOW_B.pieces(size),
    curves: curves(METRES, "Depth at 5 s on the finest grid."),
    errors: errors("m", "L1 error of h / volume", ""),
};

const B_TERRAIN: Benchmark = Benchmark {
    name: "B-terrain",
    title: "Parabolic cap on a plane of terrain, 1-D",
    about: "As B, over a horizontal grid: the equations of terrain in SI units; lengths and depths are given along the bed.",
    pieces: |size| Flow { solve: cap_on_terrain, ..FLOW_B }.pieces(size),
    ..B
};

const FLOW_B: Flow = Flow {
    coarsest: 400,
    grids: 4,
    quantity: "L1(h) / volume",
    formal: (
        [1.0, 2.0],
        "smooth but for the kink at its two ends, which costs a second-order scheme up to 0.4",
    ),
    over: Over::Finest,
    bounds: &[
        cells(EnergyStable, 0.49, 0.95),
        cells(EnergyStable2, 0.02, 1.6),
        cells(Balanced, 0.6, 0.95),
        cells(Balanced2, 0.01, 1.6),
    ],
    solve: cap_on_chute,
};

const D: Benchmark = Benchmark {
    name: "D",
    title: "Dam break on a slope with friction",
    about: "A reservoir 1 m deep on a plane of 22°, δ = 21°; at 5 s. Exact: Mangeney, Heinrich & Roche 2000; the slab above \
            slides as a whole.",
    pieces: |size| FLOW_D.pieces(size),
    curves: curves(METRES, "Depth at 5 s on the finest grid."),
    errors: errors("m", "L1 error of h", "m²"),
};

const D_TERRAIN: Benchmark = Benchmark {
    name: "D-terrain",
    title: "Dam break on a slope of terrain with friction",
    about: "As D, over a horizontal grid: the equations of terrain in SI units; lengths and depths are given along the bed, \
            beyond x = -30 m, since the slab ends at a wall.",
    pieces: |size| Flow { solve: dam_on_terrain, ..FLOW_D }.pieces(size),
    ..D
};

const FLOW_D: Flow = Flow {
    coarsest: 250,
    grids: 4,
    quantity: "L1(h) / m²",
    formal: KINKS,
    over: Over::All,
    bounds: &[
        cells(EnergyStable, 1.25, 0.6),
        cells(EnergyStable2, 0.375, 0.9),
        cells(Balanced, 1.66, 0.6),
        cells(Balanced2, 0.25, 0.9),
    ],
    solve: dam_on_chute,
};

fn flow(Flow1 { h, u }: Flow1) -> State<1, f64> {
    State { h, q: [h * u] }
}

/// Where the cells are along x.
pub fn places(run: &Run) -> Vec<f64> {
    let ([origin, _], [size, _], [cells, _]) = (run.origin(), run.size(), run.cells());
    (0..cells).map(|i| origin + (i as f64 + 0.5) * size).collect()
}

/// Steps a run to its end and compares its depths.
fn compared(mut run: Run, end: f64, exact: impl Fn(f64) -> f64) -> Result<Solved, Failure> {
    until(&mut *run, end)?;
    Ok(Solved::profile(places(&run), depths(&*run), exact, run.size()[0]))
}

/// A Riemann problem without friction or slope from -5 to 5.
fn two_states(scheme: Scheme, cells: usize, beta: f64, exact: &Riemann, end: f64) -> Result<Solved, Failure> {
    let domain = line([-5.0, 5.0], cells, Boundary::Open);
    let setting = Setting::coulomb(scheme, 0.0, 0.0);
    let run = on_plane(setting, domain, plane([0.0], beta), |[x]| flow(exact.flow(x, 0.0)))?;
    compared(run, end, |x| exact.flow(x, end).h)
}

/// Terrain that falls to larger x by the angle `zeta`; lengths along the bed are x/cos(zeta).
fn slope(zeta: f64) -> impl Fn([f64; 1]) -> Option<Surface<1>> {
    move |[x]| Some(Surface { z: 1000.0 - zeta.tan() * x, slope: [-zeta.tan()], bent: [[0.0]] })
}

/// The cap of benchmarks B and C.
pub fn release() -> CapRelease {
    CapRelease {
        height: 4.0,
        length: 80.0,
        slope: 35.0_f64.to_radians(),
        friction: 25.0_f64.to_radians(),
        earth_pressure: 1.0,
        gravity: GRAVITY,
    }
}

/// Area of the parabolic cap, 4 H L/3.
const CAP: f64 = 4.0 * 4.0 * 80.0 / 3.0;

fn cap_on_chute(scheme: Scheme, cells: usize) -> Result<Solved, Failure> {
    let exact = ParabolicCap::new(release()).map_err(failed)?;
    let setting = Setting::coulomb(scheme, release().friction.tan(), 1e-9);
    let domain = line([-120.0, 200.0], cells, Boundary::Open);
    let run = on_plane(setting, domain, incline(release().slope), |[x]| {
        State::still(mean(|x| exact.flow(x, 0.0).h, x, domain.size[0]))
    })?;
    Ok(compared(run, 5.0, |x| exact.flow(x, 5.0).h)?.relative_to(CAP))
}

fn cap_on_terrain(scheme: Scheme, cells: usize) -> Result<Solved, Failure> {
    let exact = ParabolicCap::new(release()).map_err(failed)?;
    let (zeta, cos) = (release().slope, release().slope.cos());
    let grid = line([-120.0 * cos, 200.0 * cos], cells, Boundary::Absorbing);
    let grounds = terrain(&grid, slope(zeta));
    let setting = Setting::coulomb(scheme, release().friction.tan(), 1e-9);
    let run = on_bed(setting, grid, &grounds, |[x], _| {
        State::still(mean(|x| exact.flow(x / cos, 0.0).h / cos, x, grid.size[0]))
    })?;
    Ok(along_the_bed(run, 5.0, cos, f64::NEG_INFINITY, |x| exact.flow(x, 5.0).h)?.relative_to(CAP))
}

/// Steps a run on terrain to its end and compares its depths normal to the bed, over the length along the bed beyond `from`.
fn along_the_bed(
    mut run: Run,
    end: f64,
    cos: f64,
    from: f64,
    exact: impl Fn(f64) -> f64,
) -> Result<Solved, Failure> {
    until(&mut *run, end)?;
    let cells = places(&run).into_iter().zip(depths(&*run)).map(|(x, h)| (x / cos, h * cos));
    let (x, h) = cells.filter(|(x, _)| *x >= from).unzip();
    Ok(Solved::profile(x, h, exact, run.size()[0] / cos))
}

fn dam() -> Result<(SlopeDamBreak, f64, f64), Failure> {
    let (zeta, delta) = (22.0_f64.to_radians(), 21.0_f64.to_radians());
    let exact = SlopeDamBreak::new(GRAVITY, 1.0, zeta, delta, 1.0).map_err(failed)?;
    Ok((exact, zeta, delta.tan()))
}

fn dam_on_chute(scheme: Scheme, cells: usize) -> Result<Solved, Failure> {
    let (exact, zeta, mu) = dam()?;
    let domain = line([-60.0, 60.0], cells, Boundary::Open);
    let setting = Setting::coulomb(scheme, mu, 1e-9);
    let run = on_plane(setting, domain, incline(zeta), |[x]| flow(exact.flow(x, 0.0)))?;
    compared(run, 5.0, |x| exact.flow(x, 5.0).h)
}

/// As on the chute, with an end of the slab far upstream of what is compared.
fn dam_on_terrain(scheme: Scheme, cells: usize) -> Result<Solved, Failure> {
    let (exact, zeta, mu) = dam()?;
    let cos = zeta.cos();
    let grid = line([-60.0 * cos, 60.0 * cos], cells, Boundary::Wall);
    let grounds = terrain(&grid, slope(zeta));
    let setting = Setting::coulomb(scheme, mu, 1e-9);
    let run = on_bed(setting, grid, &grounds, |[x], _| State::still(exact.flow(x / cos, 0.0).h / cos))?;
    along_the_bed(run, 5.0, cos, -30.0, |x| exact.flow(x, 5.0).h)
}
