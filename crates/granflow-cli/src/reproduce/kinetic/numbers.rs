//! The numbers that the papers state, and those that an independent transcription of their schemes gives, beside ours.

use granflow::output::tables::{Expected, Measure, Row};
use granflow::savage_hutter::exact::{Riemann, Wave};
use granflow::savage_hutter::flux;
use std::f64::consts::PI;

use super::computed::Runs;
use super::examples::Id;
use super::papers::Paper;

use Expected::{Exact, Independent, Published};
use Measure::{Absolute, AtLeast, AtMost};

struct Table<'a> {
    rows: Vec<Row>,
    paper: &'a Paper,
}

impl Table<'_> {
    /// A row named by what the paper of the page calls the place.
    fn row(
        &mut self,
        place: (&str, &str),
        what: &str,
        expected: Expected,
        got: f64,
        measure: Measure,
        within: f64,
    ) {
        let place = if self.paper.alias == "thesis" { place.1 } else { place.0 };
        self.rows.push(Row::new(
            format!("{}: {place}", self.paper.alias),
            what,
            expected,
            got,
            measure,
            within,
        ));
    }
}

/// I_3 of both papers for |a_1| < 1, with both misprints: `sin(a_1)` for `sin(4 arcsin a_1)`, and a minus sign before cos³.
fn misprinted_i3(h: f64, u: f64, beta: f64) -> f64 {
    let c = (2.0 * beta * h).sqrt();
    let a = -u / c;
    let (arc, root) = (a.asin(), (1.0 - a * a).sqrt());
    4.0 / PI * beta * h * h * (PI / 16.0 - arc / 8.0 + a.sin() / 32.0)
        - 4.0 / (3.0 * PI) * c * h * u * root.powi(3)
        + 2.0 / PI * h * u * u * (PI / 4.0 - arc / 2.0 - a * root / 2.0)
}

/// I_3 by the midpoint rule over the half circle: (2/π) h ∫ (u + c sin φ)² cos² φ dφ, from arcsin(-u/c) to π/2.
fn quadrature_i3(h: f64, u: f64, beta: f64) -> f64 {
    const PIECES: u32 = 20_000;
    let c = (2.0 * beta * h).sqrt();
    let from = (-u / c).asin();
    let width = (PI / 2.0 - from) / f64::from(PIECES);
    let at = |k: u32| from + (f64::from(k) + 0.5) * width;
    (0..PIECES).map(at).map(|p| (u + c * p.sin()).powi(2) * p.cos().powi(2)).sum::<f64>() * width * 2.0 / PI
        * h
}

/// Every number of a paper.
pub fn rows(paper: &Paper, runs: &Runs) -> Vec<Row> {
    let mut table = Table { rows: Vec::new(), paper };
    integrals(&mut table);
    if paper.alias == "thesis" {
        constant(&mut table, runs);
    }
    riemann(&mut table, runs);
    silo(&mut table, runs);
    inclined_silo(&mut table, runs);
    parabola(&mut table, runs);
    sine(&mut table, runs);
    table.rows
}

fn integrals(table: &mut Table) {
    let (h, u, beta) = (0.7, 0.3, 0.4);
    let place = ("integral I_3", "integral I_3");
    let printed = misprinted_i3(h, u, beta);
    let ours = flux::Density::new(h, h * u, beta).halves(h)[1].momentum(u);
    let quadrature = quadrature_i3(h, u, beta);
    let at = "at h = 0.7, u = 0.3, β = 0.4";
    table.row(place, &format!("as printed {at} (erratum 1: wrong)"), Exact(0.055), printed, Absolute, 5e-4);
    table.row(place, &format!("corrected {at}, three digits"), Exact(0.153), ours, Absolute, 5e-4);
    table.row(place, &format!("corrected {at}, against quadrature"), Exact(quadrature), ours, Absolute, 1e-9);
}

fn constant(table: &mut Table, runs: &Runs) {
    for example in [Id::Constant, Id::ConstantInclined] {
        for run in &runs.of(example)[..5] {
            let place = run.example.title;
            let what = |of: &str| format!("{of} after 2000 steps, {}", run.scheme.1);
            let end = run.end();
            table.row((place, place), &what("max |h - 1|"), Published(0.0), end.off(1.0), AtMost, 1e-15);
            table.row((place, place), &what("max |u|"), Published(0.0), end.speed(), AtMost, 1e-15);
        }
    }
}

fn riemann(table: &mut Table, runs: &Runs) {
    let place = ("Fig. 1, Riemann problem", "Abb. 5.2 to 5.4, Riemann problem");
    let beta = runs.by(Id::Riemann, 5).beta;
    let exact = Riemann::stoker(beta, 1.0, 0.5).ok();
    let middle = exact.and_then(|exact| exact.middle());
    let shock = match exact.and_then(|exact| exact.right_wave()) {
        Some(Wave::Shock { speed }) => speed,
        _ => f64::NAN,
    };
    let (h_m, u_m) = middle.map_or((f64::NAN, f64::NAN), |middle| (middle.h, middle.u));
    table.row(place, "h_m of the exact solution", Exact(0.726_920_446_187_286_5), h_m, Absolute, 1e-14);
    table.row(place, "u_m of the exact solution", Exact(0.186_452_574_416_656_75), u_m, Absolute, 1e-14);
    table.row(
        place,
        "shock speed s of the exact solution",
        Exact(0.597_285_043_569_238_1),
        shock,
        Absolute,
        1e-14,
    );
    let expected = [
        (0.090_145_3, 0.5008),
        (0.073_900_2, 1.0276),
        (0.073_900_2, 1.0276),
        (0.073_900_2, 1.0276),
        (0.090_127_6, 0.5008),
    ];
    for (run, (l1, variation)) in runs.of(Id::Riemann).iter().zip(expected) {
        let what = |of: &str| format!("{of} after 5000 steps, {}", run.scheme.1);
        table.row(place, &what("L1(h)"), Independent(l1), run.l1().unwrap_or(f64::NAN), Absolute, 5e-8);
        table.row(
            place,
            &what("total variation of h"),
            Independent(variation),
            run.end().variation(),
            Absolute,
            5e-5,
        );
    }
    let oscillation = runs.by(Id::Riemann, 4).end().variation() - runs.by(Id::Riemann, 5).end().variation();
    let what = "Verfahren 4 oscillates, 5 does not: total variation of 4 beyond that of 5";
    if table.paper.alias == "thesis" {
        table.row(place, what, Published(0.5), oscillation, AtLeast, 0.0);
    }
    for run in &runs.of(Id::Riemann)[5..] {
        let variation = format!("total variation of h after 5000 steps, {}", run.scheme.1);
        table.row(place, &variation, Exact(0.5), run.end().variation(), AtMost, 2e-3);
    }
}

fn silo(table: &mut Table, runs: &Runs) {
    let place = ("Figs. 2 and 3, silo", "Abb. 5.5 to 5.7, silo");
    for verfahren in [4, 5] {
        let run = runs.by(Id::Silo, verfahren);
        let what = |of: &str| format!("{of}, {}", run.scheme.1);
        table.row(
            place,
            &what("stops: max |u| after 10000 steps"),
            Published(0.0),
            run.end().speed(),
            AtMost,
            1e-15,
        );
        let skew = run.frames.iter().map(super::computed::Frame::asymmetry).fold(0.0, f64::max);
        table.row(
            place,
            &what("spreads symmetrically: max |h(x) - h(-x)|"),
            Published(0.0),
            skew,
            AtMost,
            1e-14,
        );
    }
    for run in runs.of(Id::Silo) {
        let gain = 100.0 * run.mass_growth;
        match run.scheme.0 {
            "verfahren_5" => {
                let what = format!("mass gained in 10000 steps in %, {} (erratum 5)", run.scheme.1);
                table.row(place, &what, Independent(0.367), gain, Absolute, 5e-4);
            }
            name => {
                let within = if name.starts_with("verfahren") { 1e-2 } else { 1e-11 };
                let what = format!("mass gained in 10000 steps in %, {}", run.scheme.1);
                table.row(place, &what, Exact(0.0), gain, Absolute, within);
            }
        }
    }
}

fn inclined_silo(table: &mut Table, runs: &Runs) {
    let place = ("Fig. 4, silo on the slope", "Abb. 5.8 and 5.9, silo on the slope");
    let run = runs.by(Id::InclinedSilo, 5);
    let moved = run.centre(run.end(), 0.3) - run.centre(run.start(), 0.3);
    let what = "the mass moves more to the right: way of its centre in 8000 steps, Verfahren 5";
    table.row(place, what, Published(0.0), moved, AtLeast, 0.0);
    let what = "stops: max |u| after 8000 steps, Verfahren 5";
    table.row(place, what, Published(0.0), run.end().speed(), AtMost, 1e-14);
}

fn parabola(table: &mut Table, runs: &Runs) {
    let place = ("Fig. 5, parabola", "Abb. 5.10 and 5.11, parabola");
    let run = runs.by(Id::Parabola, 5);
    let skew = run.frames.iter().map(super::computed::Frame::asymmetry).fold(0.0, f64::max);
    let what = "spreads symmetrically: max |h(x) - h(-x)|, Verfahren 5";
    table.row(place, what, Published(0.0), skew, AtMost, 1e-14);
    let what = "stops: max |u| after 6000 steps, Verfahren 5";
    table.row(place, what, Published(0.0), run.end().speed(), AtMost, 1e-14);
}

fn sine(table: &mut Table, runs: &Runs) {
    let place = ("Fig. 6, sine", "Abb. 5.12, sine");
    let run = runs.by(Id::Sine, 5);
    let tops = run.end().tops(0.13);
    let what = "splits in two: tops after 4000 steps, Verfahren 5";
    table.row(place, what, Published(2.0), tops as f64, Absolute, 0.0);
    // The resultant of gravity and friction per mass: what a sliding block gains in a unit of time.
    let (zeta, delta) = (PI / 6.0, PI / 18.0);
    let block = zeta.sin() - zeta.cos() * delta.tan();
    for step in [1000, 2000, 3000] {
        let frame = run.at(step);
        let what = format!("gathers speed at a constant rate: mean u / t after {step} steps, Verfahren 5");
        let rate = frame.mean_velocity() / frame.time;
        table.row(place, &what, Exact(block), rate, Measure::Relative, 0.1);
    }
    for (verfahren, step) in [(2, 1570.0), (3, 1570.0), (4, 1567.0)] {
        let run = runs.by(Id::Sine, verfahren);
        let found = run.negative.as_ref().map_or(f64::NAN, |frame| frame.step as f64);
        let what = format!("first step with h < 0, {} (erratum 7)", run.scheme.1);
        table.row(place, &what, Independent(step), found, Absolute, 0.0);
    }
    for verfahren in [1, 5] {
        let run = runs.by(Id::Sine, verfahren);
        let what = format!("smallest h in 4000 steps, {}", run.scheme.1);
        table.row(place, &what, Independent(0.1), run.lowest, AtLeast, 1e-6);
    }
}
