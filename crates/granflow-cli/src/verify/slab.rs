//! Slabs on planes, ordinary differential equations: F, and the laws of friction.

use granflow::output::figures::{Axis, Style};
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::exact::SlidingSlab;
use granflow::savage_hutter::friction::{Cohesion, Coulomb, Law, SamosAt, Voellmy};
use granflow::scheme::Boundary;
use granflow::simulation::StepSize;

use super::benchmark::{Benchmark, Check, Errors, Finding, Line, Piece, View};
use super::ode;
use super::scheme::{
    GRAVITY, RESTING, Scheme, Setting, Surface, component, depths, failed, grid, incline, line, on_bed,
    on_plane, steps, terrain,
};
use crate::failure::Failure;

/// The benchmarks of this file.
pub const BENCHMARKS: [Benchmark; 5] = [
    Benchmark {
        name: "F",
        title: "A slab that friction stops",
        about: "A uniform layer on a plane of 20°, δ = 30°, begins at 5 m/s. Exact: u = u0 - g cos ζ (tan δ - tan ζ) t, and exactly 0 \
                from the first step beyond u = 0.",
        pieces: |_| RESTING.map(|scheme| Piece::new(scheme.name(), move || on_a_chute(scheme))).into(),
        curves: Some(SPEED),
        errors: None,
    },
    Benchmark {
        name: "F-terrain",
        title: "A slab on terrain that friction stops",
        about: "As F, on terrain that falls along x and, as a second case, 35° beside x: the middle of a slab so wide that its ends \
                are not felt.",
        pieces: |_| RESTING.map(|scheme| Piece::new(scheme.name(), move || on_terrain(scheme))).into(),
        curves: None,
        errors: None,
    },
    Benchmark {
        name: "law-Voellmy",
        title: "A slab under Voellmy's law",
        about: "A layer 1.5 m thick on a plane of 30°, μ = 0.2, ξ = 1500 m/s², begins at 1 m/s; at 10 s. Known answer: \
                du/dt = g sin ζ - μ g cos ζ - g u²/(ξ h) by the classical Runge-Kutta method.",
        pieces: |_| {
            by_law(Law::Voellmy(Voellmy { mu: 0.2, xi: 1500.0, gravity: GRAVITY }), |u| {
                0.2 * GRAVITY * SLOPE.cos() + GRAVITY * u * u / (1500.0 * THICKNESS)
            })
        },
        curves: None,
        errors: Some(STEP),
    },
    Benchmark {
        name: "law-cohesion",
        title: "A slab under Coulomb friction with cohesion",
        about: "As law-Voellmy, with μ = 0.2 and τ0/ρ = 0.5 m²/s²: du/dt = g sin ζ - μ g cos ζ - τ0/(ρ h), which any consistent \
                scheme solves to rounding.",
        pieces: |_| {
            by_law(Law::Cohesion(Cohesion { mu: 0.2, bond: 0.5 }), |_| {
                0.2 * GRAVITY * SLOPE.cos() + 0.5 / THICKNESS
            })
        },
        curves: None,
        errors: None,
    },
    Benchmark {
        name: "law-samosAT",
        title: "A slab under samosAT's law",
        about: "As law-Voellmy, with AvaFrame's defaults: du/dt = g sin ζ - μ N (1 + Rs0/(Rs0 + Rs)) - u²/((ln(h/R)/κ + B)² h), \
                N = g cos ζ, Rs = u²/(N h).",
        pieces: |_| {
            by_law(
                Law::SamosAt(SamosAt { mu: 0.155, bond: 0.0, rs0: 0.222, kappa: 0.43, r: 0.05, b: 4.13 }),
                |u| {
                    let load = GRAVITY * SLOPE.cos();
                    let rs = u * u / (load * THICKNESS);
                    let wall = (THICKNESS / 0.05).ln() / 0.43 + 4.13;
                    0.155 * load * (1.0 + 0.222 / (0.222 + rs)) + u * u / (wall * wall * THICKNESS)
                },
            )
        },
        curves: None,
        errors: Some(STEP),
    },
];

const SPEED: View = View {
    x: Axis::new("time t", "s"),
    y: Axis::new("speed u", "m/s"),
    caption: "Speed of the slab, steps of 0.0173 s: it falls on a straight line and stays exactly 0.",
};

const STEP: View = View {
    x: Axis::new("time step Δt", "s"),
    y: Axis::new("error of the speed", "m/s"),
    caption: "Error of the speed at 10 s over time step, both logarithmic; the grey lines have slope 1 and 2.",
};

const DELTA: f64 = 30.0;
const ROUNDING: &str =
    "rounding: the acceleration is constant, so that a step of any length is exact until it stops";
const STILL: &str = "rest is exact: friction stops what it can stop within a step, and holds it";

/// How far a slab is from its exact speed until it stops, beside the speed it has after that.
#[derive(Default)]
struct Stop {
    off: f64,
    beyond: f64,
    speeds: Line,
}

impl Stop {
    /// Looks at the speed `u` at time `t`, after a step in which friction takes `per_step`.
    fn look(&mut self, scheme: Scheme, exact: &SlidingSlab, t: f64, u: f64, per_step: f64) {
        let right = exact.velocity(t);
        // A step of two stages whose last one stops is at rest at its end.
        let early = scheme == Scheme::Balanced2 && u == 0.0 && right <= per_step;
        if !early {
            self.off = self.off.max((u - right).abs());
        }
        if t > exact.stopping_time() + 1e-12 {
            self.beyond = self.beyond.max(u.abs());
        }
        self.speeds.x.push(t);
        self.speeds.y.push(u);
    }

    fn checks(&self, case: &str, rounding: f64) -> Vec<Check> {
        vec![
            Check::error(
                format!("{case}: largest |u - exact| / (m/s) until it stops"),
                self.off,
                rounding,
                ROUNDING,
            ),
            Check::error(format!("{case}: speed beyond the exact time / (m/s)"), self.beyond, 0.0, STILL),
        ]
    }
}

fn on_a_chute(scheme: Scheme) -> Result<Finding, Failure> {
    let (zeta, delta) = (20.0_f64.to_radians(), DELTA.to_radians());
    let exact = SlidingSlab::new(GRAVITY, zeta, delta, 5.0).map_err(failed)?;
    let mut finding = Finding::default();
    // Only without a budget for the energy may a step be longer than the Courant condition allows.
    let long = matches!(scheme, Scheme::Balanced | Scheme::Balanced2).then_some(0.1);
    for step in long.into_iter().chain([0.01, 0.0173]) {
        let domain = line([0.0, 10.0], 40, Boundary::Periodic);
        let setting = Setting::coulomb(scheme, delta.tan(), 0.0).with_step(StepSize::Fixed(step));
        let mut run = on_plane(setting, domain, incline(zeta), |_| Flow { h: 1.0, q: [5.0] })?;
        let mut stop = Stop::default();
        while run.time() < 1.5 * exact.stopping_time() {
            steps(&mut *run, 1)?;
            let u = component(&*run, 1)
                .into_iter()
                .fold(0.0, |most: f64, u| if u.abs() > most.abs() { u } else { most });
            stop.look(scheme, &exact, run.time(), u, exact.velocity(0.0) - exact.velocity(step));
        }
        finding.checks.extend(stop.checks(&format!("Δt = {step} s"), 1e-12));
        let off = depths(&*run).into_iter().map(|h| (h - 1.0).abs()).fold(0.0, f64::max);
        finding.checks.push(Check::error(
            format!("Δt = {step} s: largest |h - 1 m| / m"),
            off,
            0.0,
            "a uniform layer has nothing to exchange",
        ));
        let x: Vec<f64> = (0..=200).map(|k| f64::from(k) / 200.0 * 1.5 * exact.stopping_time()).collect();
        let y = x.iter().map(|t| exact.velocity(*t)).collect();
        finding.exact = Some(Line { name: "exact".into(), x, y, style: Style::Dashed });
        finding.curves = vec![Line { name: scheme.name().into(), ..stop.speeds }];
    }
    Ok(finding)
}

fn on_terrain(scheme: Scheme) -> Result<Finding, Failure> {
    let (steep, delta) = (20.0_f64.to_radians().tan(), DELTA.to_radians());
    let mut finding = Finding::default();
    for angle in [0.0, 35.0_f64] {
        let (sin, cos) = angle.to_radians().sin_cos();
        let sheet = grid([121, 121], [0.0; 2], 2.0, Boundary::Absorbing);
        // A slope that a grid keeps as it is.
        let fall = [-steep * cos, -steep * sin].map(|slope| f64::from(slope as f32));
        let tan = fall[0].hypot(fall[1]);
        let (zeta, down) = (tan.atan(), fall.map(|slope| -slope / tan));
        let exact = SlidingSlab::new(GRAVITY, zeta, delta, 5.0).map_err(failed)?;
        let grounds = terrain(&sheet, |[x, y]| {
            Some(Surface { z: 900.0 + fall[0] * x + fall[1] * y, slope: fall, bent: [[0.0; 2]; 2] })
        });
        let setting = Setting::coulomb(scheme, delta.tan(), 1e-6).with_step(StepSize::Fixed(0.03));
        let mut run = on_bed(setting, sheet, &grounds, |_, ground| {
            let h = 1.0 / ground.cos;
            Flow { h, q: down.map(|n| h * 5.0 * zeta.cos() * n) }
        })?;
        let mut stop = Stop::default();
        while run.time() < 1.2 * exact.stopping_time() {
            steps(&mut *run, 1)?;
            let [h, p, q] = [0, 1, 2].map(|k| run.component(k).get([60, 60]));
            // Along the bed: |V|² = w² + (slope . w)².
            let w = [p / h, q / h];
            let speed = (w[0] * w[0] + w[1] * w[1] + (fall[0] * w[0] + fall[1] * w[1]).powi(2)).sqrt();
            stop.look(scheme, &exact, run.time(), speed, exact.velocity(0.0) - exact.velocity(0.03));
        }
        finding.checks.extend(stop.checks(&format!("{angle}° beside x"), 1e-10));
    }
    Ok(finding)
}

/// Slope angle and thickness of the slab under other laws.
const SLOPE: f64 = std::f64::consts::PI / 6.0;
const THICKNESS: f64 = 1.5;

/// One piece of work for each scheme: the slab under `law`, whose deceleration at speed u is `friction`.
fn by_law(law: Law, friction: fn(f64) -> f64) -> Vec<Piece> {
    RESTING.map(|scheme| Piece::new(scheme.name(), move || under(scheme, law, friction))).into()
}

fn under(scheme: Scheme, law: Law, friction: fn(f64) -> f64) -> Result<Finding, Failure> {
    let (end, start) = (10.0, 1.0);
    let [exact] = ode::solve([start], end, 2000, |_, [u]| [GRAVITY * SLOPE.sin() - friction(u)]);
    let mut errors = Errors::default();
    for count in [50, 100, 200, 400] {
        let step = end / f64::from(count);
        let setting = Setting { law, ..Setting::coulomb(scheme, 0.0, 0.0) }.with_step(StepSize::Fixed(step));
        let domain = line([0.0, 40.0 * 400.0], 4, Boundary::Periodic);
        let mut run =
            on_plane(setting, domain, incline(SLOPE), |_| Flow { h: THICKNESS, q: [THICKNESS * start] })?;
        steps(&mut *run, count as usize)?;
        errors.cells.push(count as usize);
        errors.sizes.push(step);
        errors.errors.push((component(&*run, 1)[0] / THICKNESS - exact).abs());
    }
    let last = errors.errors[errors.errors.len() - 1];
    let constant = matches!(law, Law::Coulomb(Coulomb { .. }) | Law::Cohesion(_));
    if constant {
        let what = "error of the speed after 400 steps / (m/s)";
        return Ok(Finding { checks: vec![Check::error(what, last, 1e-11, ROUNDING)], ..Finding::default() });
    }
    let (what, order) = ("order from 200 to 400 steps", errors.last_order());
    let checks = vec![
        Check::error(
            "error of the speed after 400 steps / (m/s)",
            last,
            0.002 * exact,
            "half of the step over the 7 s in which the speed settles, 0.2 % of it",
        ),
        if scheme == Scheme::Balanced2 {
            Check::at_least(
                what,
                order,
                [2.0, 0.1],
                "two stages, which take friction to second order in time",
            )
        } else {
            let why = "friction that grows with the speed is taken at the end of a step: first order in time";
            Check::at_least(what, order, [1.0, 0.05], why)
        },
    ];
    Ok(Finding { checks, errors: Some(errors), ..Finding::default() })
}
