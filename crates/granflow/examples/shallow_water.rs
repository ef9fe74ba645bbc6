//! A third model from outside: the Saint-Venant equations with Manning friction, h_t + div(h u) = 0,
//! (h u)_t + div(h u u) + grad(g h^2/2) = -g h grad z - g n^2 |u| u h^(-1/3), by an HLL flux over a reconstructed bed
//! (Audusse et al., SIAM J. Sci. Comput. 25, 2004). Nothing of granflow knows it. A lake at rest stays so bit for bit; a dam
//! breaks as Stoker says; the flood is kept in memory and written as NetCDF.
//!
//! `cargo run --release -p granflow --example shallow_water`

use granflow::build::{Grid, StepSize};
use granflow::case::Frames;
use granflow::model::{Domain, Model, Plane, Quantity, Units, Words};
use granflow::real::{Real, dot, per_axis, total};
use granflow::run::{CellOf, Ends, Field, Physics, Run, Simulated, Value, drive};
use granflow::savage_hutter::exact::Riemann;
use granflow::scheme::{
    Cell, Diagnostics, Faces, Forecasts, Scheme, SchemeVisitor, Side, Spacing, Stencil, components,
};
use granflow::sinks::Memory;
use granflow::time::{EULER, Stages};
use std::sync::Arc;

/// Gravity \[m/s^2\].
const G: f64 = 9.81;
/// A thinner layer does not move \[m\].
const DRY: f64 = 1e-6;

/// Depth \[m\] and discharge h u \[m^2/s\].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Water<const D: usize, R> {
    h: R,
    q: [R; D],
}
components!([const D: usize, R: Real] Water<D, R> { h: R, q: [R; D] });

impl<const D: usize, R: Real> Water<D, R> {
    fn velocity(&self) -> [R; D] {
        let wet = R::splat(DRY).le(self.h);
        let inv = R::select(wet, R::splat(1.0) / R::select(wet, self.h, R::splat(1.0)), R::zero());
        per_axis!(k => self.q[k] * inv)
    }
}

/// Elevation of the bed \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bed<R> {
    z: R,
}
components!([R: Real] Bed<R> { z: R });

/// What a cell offers to its faces.
#[derive(Clone, Copy, Debug)]
struct Offer<const D: usize, R> {
    h: R,
    u: [R; D],
    z: R,
}
components!([const D: usize, R: Real] Offer<D, R> { h: R, u: [R; D], z: R });

/// What passes a face; the momentum as its two cells see it.
#[derive(Clone, Copy, Debug)]
struct Passing<const D: usize, R> {
    mass: R,
    left: [R; D],
    right: [R; D],
}
components!([const D: usize, R: Real] Passing<D, R> { mass: R, left: [R; D], right: [R; D] });

/// The scheme, with Manning's n \[s m^(-1/3)\].
#[derive(Clone, Copy, Debug)]
struct SaintVenant {
    n: f64,
}

/// The cube root of a number that is not negative, by Newton's method from above.
fn cube_root<R: Real>(x: R) -> R {
    let third = R::splat(1.0 / 3.0);
    let mut root = (x + R::splat(2.0)) * third;
    for _ in 0..24 {
        root = (root + root + x / (root * root)) * third;
    }
    root
}

impl<const D: usize, R: Real> Scheme<D, R> for SaintVenant {
    type State = Water<D, R>;
    type Ground = Bed<R>;
    type Primitives = [R; D];
    type Forecast = ();
    type FaceStates = Offer<D, R>;
    type Flux = Passing<D, R>;
    type Forcing = ();
    type Corner = ();

    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output {
        visitor.visit(self)
    }
    fn stages(&self) -> Stages {
        EULER
    }
    fn max_courant(&self) -> f64 {
        0.5
    }
    #[inline(always)]
    fn primitives(&self, here: &Cell<Water<D, R>, Bed<R>>) -> [R; D] {
        here.state.velocity()
    }
    #[inline(always)]
    fn forecast(&self, _stencil: &impl Stencil<D, R, Water<D, R>, Bed<R>>, _dt: R) {}
    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Water<D, R>, Bed<R>>,
        u: &[R; D],
        _forecasts: &Forecasts<D, ()>,
        _dt: R,
    ) -> Offer<D, R> {
        let Cell { state, ground, .. } = stencil.at([0; D]);
        Offer { h: state.h, u: *u, z: ground.z }
    }
    #[inline(always)]
    fn flux(&self, axis: usize, left: &Offer<D, R>, right: &Offer<D, R>, _lambda: R) -> Passing<D, R> {
        let (g, half) = (R::splat(G), R::splat(0.5));
        let sill = left.z.max(right.z);
        let (a, b) = ((left.h + left.z - sill).positive_part(), (right.h + right.z - sill).positive_part());
        let (u, v) = (left.u[axis], right.u[axis]);
        let (c, d) = ((g * a).sqrt(), (g * b).sqrt());
        // HLL with the signal speeds of Davis; both are 0 where both sides are dry.
        let low = (u - c).min(v - d).min(R::zero());
        let high = (u + c).max(v + d).max(R::zero());
        let still = (high - low).le(R::zero());
        let inv = R::select(still, R::zero(), R::splat(1.0) / R::select(still, R::splat(1.0), high - low));
        let hll = |fa: R, fb: R, ua: R, ub: R| (high * fa - low * fb + high * low * (ub - ua)) * inv;
        let mass = hll(a * u, b * v, a, b);
        let push = [g * a * a * half, g * b * b * half];
        let mut momentum: [R; D] =
            per_axis!(k => hll(a * u * left.u[k], b * v * right.u[k], a * left.u[k], b * right.u[k]));
        momentum[axis] = hll(a * u * u + push[0], b * v * v + push[1], a * u, b * v);
        // What the sill hides of each side's pressure presses on the bed there.
        let (mut to_left, mut to_right) = (momentum, momentum);
        to_left[axis] = to_left[axis] + (g * left.h * left.h * half - push[0]);
        to_right[axis] = to_right[axis] + (g * right.h * right.h * half - push[1]);
        Passing { mass, left: to_left, right: to_right }
    }
    #[inline(always)]
    fn corner(&self, _around: [[&Offer<D, R>; 2]; 2]) {}
    #[inline(always)]
    fn update(
        &self,
        stencil: &impl Stencil<D, R, Water<D, R>, Bed<R>>,
        _own: &Offer<D, R>,
        faces: &[Faces<Passing<D, R>>; D],
        _corners: &[[(); 2]; 2],
        dt: R,
    ) -> Water<D, R> {
        let (Cell { state, .. }, inv) = (stencil.at([0; D]), stencil.spacing().inv);
        let gone: [R; D] = per_axis!(k => dt * inv[k] * (faces[k].hi.mass - faces[k].lo.mass));
        let h = state.h - total(gone);
        let mut q: [R; D] = per_axis!(k => {
            let lost: [R; D] = per_axis!(axis => dt * inv[axis] * (faces[axis].hi.left[k] - faces[axis].lo.right[k]));
            state.q[k] - total(lost)
        });
        // Manning's friction, implicit: q (1 + dt g n^2 |u| h^(-4/3)) = q*.
        let dry = h.lt(R::splat(DRY));
        let depth = R::select(dry, R::splat(1.0), h);
        let speed = dot(q, q).sqrt() / depth;
        let drag = R::splat(G * self.n * self.n) * speed / (depth * cube_root(depth));
        let keep = R::select(dry, R::zero(), R::splat(1.0) / (R::splat(1.0) + dt * drag));
        q = per_axis!(k => q[k] * keep);
        Water { h, q }
    }

    fn mirror(&self, axis: usize, state: &Water<D, R>) -> Water<D, R> {
        let mut image = *state;
        image.q[axis] = -image.q[axis];
        image
    }
    fn mirror_ground(&self, _axis: usize, ground: &Bed<R>) -> Bed<R> {
        *ground
    }
    #[inline(always)]
    fn rate(&self, here: &Cell<Water<D, R>, Bed<R>>, spacing: &Spacing<D, R>) -> R {
        let (u, c) = (here.state.velocity(), (R::splat(G) * here.state.h.positive_part()).sqrt());
        let along: [R; D] = per_axis!(k => (u[k].abs() + c) * spacing.inv[k]);
        total(along)
    }
    /// Water does not hold itself; a tile sleeps where nothing moved in a step and its neighbours do not either.
    #[inline(always)]
    fn is_static(&self, here: &Cell<Water<D, R>, Bed<R>>) -> R::Mask {
        dot(here.state.q, here.state.q).equals(R::zero())
    }
    #[inline(always)]
    fn is_nodata(&self, _ground: &Bed<R>) -> R::Mask {
        R::zero().lt(R::zero())
    }
    #[inline(always)]
    fn outflow(&self, flux: &Passing<D, R>, _side: Side, lambda: R) -> R {
        lambda * flux.mass
    }
    fn yield_ratio(&self, _stencil: &impl Stencil<D, R, Water<D, R>, Bed<R>>) -> R {
        R::zero()
    }
    #[inline(always)]
    fn diagnostics(&self, here: &Cell<Water<D, R>, Bed<R>>) -> Diagnostics<R> {
        let u = here.state.velocity();
        let speed_squared = dot(u, u);
        Diagnostics {
            volume: here.state.h,
            speed_squared,
            energy: here.state.h * speed_squared * R::splat(0.5),
            thickness: here.state.h,
            film: R::select(here.state.h.lt(R::splat(DRY)), R::splat(1.0), R::zero()),
        }
    }
}

granflow::kernel!(saint_venant: SaintVenant);

/// What files say of the model.
static MODEL: Model = Model {
    name: "saint_venant",
    quantities: &[
        Quantity::series("depth", "depth of the water", ["1", "m"]),
        Quantity::series("discharge_x", "discharge along x", ["1", "m2 s-1"]),
        Quantity::map("peak_thickness", "largest depth", ["1", "m"]),
        Quantity::map("peak_speed", "largest speed", ["1", "m s-1"]),
    ],
    words: Words { wet: "wet cells", fastest: "speed" },
    ..Model::PLAIN
};

/// A river bed, in metres and seconds.
#[derive(Debug)]
struct River;

impl Domain for River {
    fn model(&self) -> &'static Model {
        &MODEL
    }
    fn units(&self) -> Units {
        Units::Si
    }
}

/// What a run shows.
struct Flood;

impl<const D: usize> Physics<D> for Flood {
    type Scheme = SaintVenant;
    fn scheme(&self) -> &str {
        "hll"
    }
    fn fields(&self) -> Vec<Field<D, SaintVenant>> {
        let discharge = |cell: &CellOf<D, SaintVenant>| cell.state.q[0];
        vec![
            Field { name: "depth", value: Value::Component(0), short: 0 },
            Field { name: "discharge_x", value: Value::of(discharge), short: 0 },
        ]
    }
}

/// A run from a bed and a depth at every place.
fn flood<const D: usize>(
    grid: Grid<D>,
    n: f64,
    bed: impl Fn([f64; D]) -> f64 + Sync,
    depth: impl Fn([f64; D]) -> f64 + Sync,
) -> Result<Box<dyn Run>, Box<dyn std::error::Error>> {
    let ground = |index| Bed { z: bed(grid.centre(index)) };
    let state = |index| Water { h: depth(grid.centre(index)), q: [0.0; D] };
    let step = StepSize::Courant(0.45);
    let simulation = granflow::simulation::Simulation::new(SaintVenant { n }, grid, step, ground, state)?;
    Ok(Box::new(Simulated::new(simulation, Flood, Plane::of(&grid, Arc::new(River)))))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A lake over a bump, its level 1 m: not a bit moves.
    let bump = |[x, y]: [f64; 2]| 0.5 * (-(x * x + y * y)).exp2();
    let lake = Grid::rectangle([-4.0, 4.0], [-4.0, 4.0], [60, 60]);
    let mut run = flood(lake, 0.03, bump, |place| 1.0 - bump(place))?;
    run.until(1.0)?;
    println!("lake: largest speed {:e} m/s after {} steps", run.stepper().speed(), run.steps());
    assert!(run.stepper().speed() < 1e-14);

    // A dam of 2 m against 0.5 m of water breaks, without friction.
    let canal = Grid::line([-50.0, 50.0], 1000);
    let mut run = flood(canal, 0.0, |_| 0.0, |[x]| if x < 0.0 { 2.0 } else { 0.5 })?;
    let volume = run.totals().volume;
    let ends = Ends { time: Some(5.0), steps: None, until: None, kinetic_energy: None };
    let mut memory = Memory::begin(&mut *run, Frames::Every(1.0), &[]);
    drive(&mut *run, &ends, &mut [&mut memory])?;
    let recording = memory.finish(&mut *run);
    let exact = Riemann::stoker(G, 2.0, 0.5)?;
    let end = &recording.field("depth").expect("it is kept")[5];
    let off = recording.plane.x.iter().zip(end).map(|(&x, h)| (h - exact.flow(x, 5.0).h).abs());
    let error = off.sum::<f64>() * 0.1 / 50.0;
    let out: f64 = run.stepper().outflow().iter().sum();
    println!(
        "dam break: mean error {error:.4} m, mass error {:e}",
        (run.totals().volume + out) / volume - 1.0
    );
    assert!(error < 0.02 && ((run.totals().volume + out) / volume - 1.0).abs() < 1e-13);

    let file = std::env::temp_dir().join("dam_break.nc");
    recording.write_netcdf(&file)?;
    println!("{} instants in {}", recording.times.len(), file.display());
    std::fs::remove_file(file)?;
    Ok(())
}
