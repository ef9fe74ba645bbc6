//! Flows in two dimensions: C, and Thacker's paraboloid of the water limit I.

use granflow::output::figures::Axis;
use granflow::savage_hutter::Flow as State;
use granflow::savage_hutter::exact::{SimilarityCap, ThackerParaboloid};
use granflow::scheme::Boundary;

use super::benchmark::{Benchmark, View};
use super::convergence::{Bound, Flow, Most, Over, Solved, cells};
use super::planes::release;
use super::scheme::Scheme::{Balanced, Balanced2, EnergyStable, EnergyStable2};
use super::scheme::{
    GRAVITY, Run, Scheme, Setting, Surface, depths, failed, grid, incline, on_bed, on_plane, terrain, until,
};
use crate::failure::Failure;

const fn errors(label: &'static str) -> Option<View> {
    Some(View {
        x: Axis::new("cell size Δx", "m"),
        y: Axis::new(label, ""),
        caption: "Error over cell size, both logarithmic; the grey lines have slope 1 and 2.",
    })
}

/// The benchmarks of this file.
pub const BENCHMARKS: [Benchmark; 2] = [
    Benchmark {
        name: "C",
        title: "Cap on a plane, 2-D",
        about: "The cap of B, round, on the same plane; at 5 s. Known answer: the similarity solution of Hutter, Siegel, Savage & \
                Nohguchi 1993. It linearises the friction across the slope: the schemes come close to it, not to the limit.",
        pieces: |size| CAP.pieces(size),
        curves: Some(View {
            x: Axis::new("distance down the slope x", "m"),
            y: Axis::new("depth h", "m"),
            caption: "Depth along the line of symmetry at 5 s on the finest grid.",
        }),
        errors: errors("L1 error of h / volume"),
    },
    Benchmark {
        name: "I-Thacker",
        title: "Water that circles in a paraboloid",
        about: "On terrain, radius 1 m, depth 0.1 mm, so that the bed is nearly flat, no friction; after one turn. Exact: Thacker 1981.",
        pieces: |size| THACKER.pieces(size),
        curves: Some(View {
            x: Axis::new("x", "m"),
            y: Axis::new("depth h", "m"),
            caption: "Depth along y = 0 after one turn on the finest grid.",
        }),
        errors: errors("L1 error of h / volume"),
    },
];

const LINEARISED: &str = "first order in Δx, and 0.5 % for the linearised friction of the known answer";

const CAP: Flow = Flow {
    coarsest: 60,
    // On a finer one only the error of the known answer would be left.
    grids: 3,
    quantity: "L1(h) / volume",
    formal: ([1.0, 1.0], "until the error is that of the known answer"),
    over: Over::Finest,
    bounds: &[
        Bound { scheme: EnergyStable, most: Most::Fixed(0.015, LINEARISED), order: Some(0.75) },
        Bound { scheme: EnergyStable2, most: Most::Fixed(0.01, LINEARISED), order: None },
        Bound { scheme: Balanced, most: Most::Fixed(0.015, LINEARISED), order: Some(0.8) },
        Bound { scheme: Balanced2, most: Most::Fixed(0.006, LINEARISED), order: None },
    ],
    solve: cap,
};

const THACKER: Flow = Flow {
    coarsest: 25,
    grids: 4,
    quantity: "L1(h) / volume",
    formal: (
        [1.0, 2.0],
        "the shore moves over dry cells, which costs a second-order scheme up to 0.7 and one of first order 0.25",
    ),
    over: Over::All,
    bounds: &[
        cells(EnergyStable, 0.73, 0.75),
        cells(EnergyStable2, 0.16, 1.3),
        cells(Balanced, 0.44, 0.75),
        cells(Balanced2, 0.1, 1.3),
    ],
    solve: thacker,
};

/// L1 error of h as a share of the volume; displaced is the exact flow by one cell along x.
fn compared(run: &Run, exact: impl Fn(f64, f64) -> f64) -> Solved {
    let ([columns, rows], [left, low], [size, _]) = (run.cells(), run.origin(), run.size());
    let h = depths(&**run);
    let x: Vec<f64> = (0..columns).map(|i| left + (i as f64 + 0.5) * size).collect();
    let (mut error, mut one_cell, volume) = (0.0, 0.0, h.iter().sum::<f64>());
    let (mut section, mut known) = (Vec::new(), Vec::new());
    for (j, row) in h.chunks(columns).enumerate() {
        let y = low + (j as f64 + 0.5) * size;
        let exact: Vec<f64> = x.iter().map(|x| exact(*x, y)).collect();
        error += row.iter().zip(&exact).map(|(h, exact)| (h - exact).abs()).sum::<f64>();
        one_cell += exact.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>();
        if j == rows / 2 {
            (section, known) = (row.to_vec(), exact);
        }
    }
    let (error, one_cell) = (error / volume, one_cell / volume);
    Solved { error, one_cell, size, section: [x.clone(), section], exact: [x, known] }
}

fn cap(scheme: Scheme, cells: usize) -> Result<Solved, Failure> {
    let exact = SimilarityCap::new(release(), 80.0, 1.0).map_err(failed)?;
    let setting = Setting::coulomb(scheme, release().friction.tan(), 1e-9);
    let sheet = grid([cells, cells], [-95.0, -120.0], 240.0 / cells as f64, Boundary::Open);
    let start = exact.at(0.0);
    let ground = incline(release().slope);
    let mut run = on_plane(setting, sheet, ground, |[x, y]| State::still(start.flow(x, y).h))?;
    until(&mut *run, 5.0)?;
    let end = exact.at(5.0);
    Ok(compared(&run, |x, y| end.flow(x, y).h))
}

fn thacker(scheme: Scheme, cells: usize) -> Result<Solved, Failure> {
    let exact = ThackerParaboloid::new(GRAVITY, 1.0, 0.5, 1e-4).map_err(failed)?;
    let sheet = grid([cells; 2], [-2.0; 2], 4.0 / cells as f64, Boundary::Absorbing);
    let bend = 2e-4;
    let grounds = terrain(&sheet, |[x, y]| {
        Some(Surface { z: exact.bed(x, y), slope: [bend * x, bend * y], bent: [[bend, 0.0], [0.0, bend]] })
    });
    let mut run = on_bed(Setting::coulomb(scheme, 0.0, 1e-12), sheet, &grounds, |[x, y], _| {
        let now = exact.flow(x, y, 0.0);
        State { h: now.h, q: [now.h * now.u, now.h * now.v] }
    })?;
    until(&mut *run, exact.period())?;
    Ok(compared(&run, |x, y| exact.flow(x, y, exact.period()).h))
}
