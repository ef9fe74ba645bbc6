//! Sandpiles to measure the schemes by.

use crate::speed::{Begun, COURANT, Extent, Setup, grid};
use granflow_engine::simulation::Simulation;
use granflow_model::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER};
use granflow_model::hadeler_kuttler::{Ground, Pile, Source};
use granflow_model::scheme::Boundary;

/// All of them.
pub(crate) const SETUPS: &[Setup] = &[
    Setup {
        name: "first_order",
        about: "a sandpile, a square table",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_table(FIRST_ORDER, extent)),
    },
    Setup {
        name: "second_order",
        about: "a sandpile, two stages, a square table",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_table(SECOND_ORDER, extent)),
    },
    Setup {
        name: "adaptive",
        about: "a sandpile, two stages, a square table",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_table(ADAPTIVE, extent)),
    },
];

/// A table half as high as it will be, with sand poured and rolling on it; the last column and row are nodes only.
fn on_table(scheme: HadelerKuttler, extent: Extent) -> Begun<2, HadelerKuttler> {
    let last = extent.cells - 1;
    let one = |yes: bool| if yes { 1.0 } else { 0.0 };
    let ground = |[i, j]: [usize; 2]| {
        let inside = i < last && j < last;
        Ground {
            bed: 0.0,
            inside: one(inside),
            weight: one(i > 0 && j > 0 && i < last && j < last),
            wall: [0.0; 2],
            hole: 0.0,
        }
    };
    let start = |index: [usize; 2]| {
        let from_edge = index.map(|k| k.min(last - k)).into_iter().min().unwrap_or(0);
        let rolls = index.iter().all(|k| *k < last) && extent.is_wet(index);
        Pile { u: 0.5 * from_edge as f64 / extent.cells as f64, v: 0.1 * one(rolls) }
    };
    let source = |[i, j]: [usize; 2], _| Source {
        split: [0.25 * one(i < last && j < last && extent.is_wet([i, j])); 2],
    };
    let sheet = grid::<2>(extent.cells, Boundary::Absorbing);
    let run = Simulation::new(scheme, sheet, COURANT, ground, start);
    let mut run = run.expect("a step that the scheme takes");
    run.apply(source);
    Begun::new(run, extent.all())
}
