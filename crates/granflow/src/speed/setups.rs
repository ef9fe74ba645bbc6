//! The runs: everything moves, nothing is dry unless asked for.

use super::{Begun, Load};
use crate::grid::Grid;
use crate::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER};
use crate::hadeler_kuttler::{self, Pile};
use crate::raster::Raster;
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Balanced;
use crate::savage_hutter::friction::{Coulomb, Law};
use crate::savage_hutter::ground::{self, Chute};
use crate::savage_hutter::kinetic::{FaceDepth, Kinetic, VERFAHREN_1, VERFAHREN_5, Variant};
use crate::scheme::Boundary;
use crate::simulation::{Simulation, StepSize};
use crate::terrain::{Curvature, Terrain};

/// A run to measure a scheme by.
pub struct Setup {
    /// What it is called: after its scheme.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// How many.
    pub dimensions: usize,
    /// May a part of it be dry? The published schemes lose positivity there, all but the first.
    pub dry: bool,
    begin: fn(Extent) -> Box<dyn Load>,
}

/// How large a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Cells along each axis.
    pub cells: usize,
    /// Share of the grid that is wet, a square in the middle; the rest is dry, or stands still, and may sleep.
    pub wet: f64,
}

impl Extent {
    /// Does the cell belong to the wet part?
    fn is_wet<const D: usize>(&self, index: [usize; D]) -> bool {
        let half = 0.5 * self.wet.powf(1.0 / D as f64) * self.cells as f64;
        index.iter().all(|k| (*k as f64 + 0.5 - 0.5 * self.cells as f64).abs() < half)
    }
    fn all(&self) -> bool {
        self.wet >= 1.0
    }
}

impl Setup {
    /// The run of this extent.
    pub fn begin(&self, extent: Extent) -> Box<dyn Load> {
        (self.begin)(extent)
    }
}

/// All of them.
pub const SETUPS: &[Setup] = &[
    Setup {
        name: "balanced",
        about: "first order, an inclined plane",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_plane::<2>(false, extent)),
    },
    Setup {
        name: "balanced_terrain",
        about: "first order, a bed of varying slope and curvature",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_terrain(false, extent)),
    },
    Setup {
        name: "balanced_2",
        about: "second order, two stages, an inclined plane",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_plane::<2>(true, extent)),
    },
    Setup {
        name: "balanced_2_terrain",
        about: "second order, two stages, a bed of varying slope and curvature",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_terrain(true, extent)),
    },
    Setup {
        name: "balanced_1d",
        about: "first order, an inclined plane",
        dimensions: 1,
        dry: true,
        begin: |extent| Box::new(on_plane::<1>(false, extent)),
    },
    Setup {
        name: "verfahren_1",
        about: "as published, an inclined plane",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(as_published(VERFAHREN_1, extent)),
    },
    Setup {
        name: "verfahren_5",
        about: "as published, an inclined plane",
        dimensions: 2,
        dry: false,
        begin: |extent| Box::new(as_published(VERFAHREN_5, extent)),
    },
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

const FRICTION: Coulomb = Coulomb { mu: 0.47 };
/// As cases have it.
const LAW: Law = Law::Coulomb(FRICTION);
const FILM: f64 = 1e-9;
const COURANT: StepSize = StepSize::Courant(0.4);

/// \[-1/2, 1/2\] along each axis.
fn grid<const D: usize>(cells: usize, boundary: Boundary) -> Grid<D> {
    Grid { cells: [cells; D], origin: [-0.5; D], size: [1.0 / cells as f64; D], boundary: [[boundary; 2]; D] }
}

fn plane<const D: usize>() -> Chute<D, f64> {
    let mut tilt = [0.0; D];
    tilt[0] = 0.3;
    Chute { tilt, beta: 0.9, cos: 0.954, curvature: 0.0 }
}

/// Depth of the layer.
const LAYER: f64 = 0.02;

/// A cap of 0.2 on the layer, which spreads slowly and flows down fast enough for no cell to stop.
fn cap<const D: usize>(sheet: &Grid<D>, extent: Extent, index: [usize; D]) -> Flow<D, f64> {
    if !extent.is_wet(index) {
        return Flow::still(0.0);
    }
    let x = sheet.centre(index);
    let square: f64 = x.iter().map(|x| x * x).sum();
    let h = LAYER + 0.2 * (1.0 - square / 0.09).max(0.0);
    let mut u = x.map(|x| 0.2 * x);
    u[0] += 0.15;
    Flow { h, q: u.map(|u| h * u) }
}

fn balanced<B>(second: bool) -> Balanced<Law, B> {
    if second { Balanced::second(LAW, FILM) } else { Balanced::first(LAW, FILM) }
}

pub(super) fn on_plane<const D: usize>(
    second: bool,
    extent: Extent,
) -> Begun<D, Balanced<Law, Chute<D, f64>>> {
    let sheet = grid::<D>(extent.cells, Boundary::Open);
    let scheme = balanced(second);
    let start = |index| cap(&sheet, extent, index);
    Begun::new(
        Simulation::new(scheme, sheet, COURANT, |_| plane(), start).expect("a step that the scheme takes"),
        extent.all(),
    )
}

fn as_published(published: Variant, extent: Extent) -> Begun<2, Kinetic> {
    let sheet = grid::<2>(extent.cells, Boundary::Open);
    let scheme = published.with(FRICTION);
    // Beside dry ground a mean depth takes from a cell what it does not hold: there the layer goes on, at rest.
    let beside = if published.resting == FaceDepth::Mean { LAYER } else { 0.0 };
    let start = |index| if extent.is_wet(index) { cap(&sheet, extent, index) } else { Flow::still(beside) };
    Begun::new(
        Simulation::new(scheme, sheet, COURANT, |_| plane(), start).expect("a step that the scheme takes"),
        extent.all(),
    )
}

pub(super) fn on_terrain(second: bool, extent: Extent) -> Begun<2, Balanced<Law, ground::Terrain<2, f64>>> {
    let sheet = grid::<2>(extent.cells, Boundary::Absorbing);
    let height = |number: usize| {
        let [x, y] = sheet.centre(sheet.index(number));
        0.3 * x + 0.02 * (9.0 * x).sin() * (7.0 * y).cos()
    };
    let [west, south] = sheet.origin;
    let bed = Raster {
        columns: extent.cells,
        rows: extent.cells,
        west,
        south,
        cell: sheet.size[0],
        values: (0..sheet.count()).map(height).collect(),
        crs: None,
    };
    let terrain = Terrain::new(bed, Curvature::Length(3.0 * sheet.size[0]));
    let scheme = balanced(second);
    let ground = move |cell| crate::setup::ground_at(&terrain, 1.0, cell);
    let start = |index| cap(&sheet, extent, index);
    Begun::new(
        Simulation::new(scheme, sheet, COURANT, ground, start).expect("a step that the scheme takes"),
        extent.all(),
    )
}

/// A table half as high as it will be, with sand poured and rolling on it; the last column and row are nodes only.
fn on_table(scheme: HadelerKuttler, extent: Extent) -> Begun<2, HadelerKuttler> {
    let last = extent.cells - 1;
    let one = |yes: bool| if yes { 1.0 } else { 0.0 };
    let ground = |[i, j]: [usize; 2]| {
        let inside = i < last && j < last;
        hadeler_kuttler::Ground {
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
    let source = |[i, j]: [usize; 2], _| hadeler_kuttler::Source {
        split: [0.25 * one(i < last && j < last && extent.is_wet([i, j])); 2],
    };
    let sheet = grid::<2>(extent.cells, Boundary::Absorbing);
    let run = Simulation::new(scheme, sheet, COURANT, ground, start);
    let mut run = run.expect("a step that the scheme takes");
    run.apply(source);
    Begun::new(run, extent.all())
}
