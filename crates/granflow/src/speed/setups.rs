//! The runs: everything moves, nothing is dry.

use super::{Begun, Load};
use crate::grid::Grid;
use crate::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER};
use crate::hadeler_kuttler::{self, Pile};
use crate::raster::Raster;
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Balanced;
use crate::savage_hutter::friction::Coulomb;
use crate::savage_hutter::ground::{self, Chute};
use crate::savage_hutter::kinetic::{Kinetic, VERFAHREN_1, VERFAHREN_5};
use crate::scheme::Boundary;
use crate::simulation::{Simulation, StepSize};
use crate::terrain::{Curvature, Terrain};
use crate::time::{EULER, SSP_RK2, Stages};

/// A run to measure a scheme by.
pub struct Setup {
    /// What it is called: after its scheme.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// How many.
    pub dimensions: usize,
    begin: fn(usize) -> Box<dyn Load>,
}

impl Setup {
    /// The run on so many cells along each axis.
    pub fn begin(&self, cells: usize) -> Box<dyn Load> {
        (self.begin)(cells)
    }
}

/// All of them.
pub const SETUPS: &[Setup] = &[
    Setup {
        name: "balanced",
        about: "first order, an inclined plane",
        dimensions: 2,
        begin: |n| Box::new(on_plane::<2>(false, n)),
    },
    Setup {
        name: "balanced_terrain",
        about: "first order, a bed of varying slope and curvature",
        dimensions: 2,
        begin: |n| Box::new(on_terrain(false, n)),
    },
    Setup {
        name: "balanced_2",
        about: "second order, two stages, an inclined plane",
        dimensions: 2,
        begin: |n| Box::new(on_plane::<2>(true, n)),
    },
    Setup {
        name: "balanced_2_terrain",
        about: "second order, two stages, a bed of varying slope and curvature",
        dimensions: 2,
        begin: |n| Box::new(on_terrain(true, n)),
    },
    Setup {
        name: "balanced_1d",
        about: "first order, an inclined plane",
        dimensions: 1,
        begin: |n| Box::new(on_plane::<1>(false, n)),
    },
    Setup {
        name: "verfahren_1",
        about: "as published, an inclined plane",
        dimensions: 2,
        begin: |n| Box::new(as_published(VERFAHREN_1, n)),
    },
    Setup {
        name: "verfahren_5",
        about: "as published, an inclined plane",
        dimensions: 2,
        begin: |n| Box::new(as_published(VERFAHREN_5, n)),
    },
    Setup {
        name: "first_order",
        about: "a sandpile, a square table",
        dimensions: 2,
        begin: |n| Box::new(on_table(FIRST_ORDER, n)),
    },
    Setup {
        name: "second_order",
        about: "a sandpile, two stages, a square table",
        dimensions: 2,
        begin: |n| Box::new(on_table(SECOND_ORDER, n)),
    },
    Setup {
        name: "adaptive",
        about: "a sandpile, two stages, a square table",
        dimensions: 2,
        begin: |n| Box::new(on_table(ADAPTIVE, n)),
    },
];

const FRICTION: Coulomb = Coulomb { mu: 0.47 };
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

/// A cap of 0.2 on a layer of 0.02, which spreads slowly.
fn cap<const D: usize>(x: [f64; D]) -> Flow<D, f64> {
    let square: f64 = x.iter().map(|x| x * x).sum();
    let h = 0.02 + 0.2 * (1.0 - square / 0.09).max(0.0);
    Flow { h, q: x.map(|x| h * 0.2 * x) }
}

fn balanced<B>(second: bool) -> (Balanced<Coulomb, B>, Stages) {
    match second {
        false => (Balanced::first(FRICTION, FILM), EULER),
        true => (Balanced::second(FRICTION, FILM), SSP_RK2),
    }
}

pub(super) fn on_plane<const D: usize>(
    second: bool,
    cells: usize,
) -> Begun<D, Balanced<Coulomb, Chute<D, f64>>> {
    let sheet = grid::<D>(cells, Boundary::Open);
    let (scheme, stages) = balanced(second);
    let start = |index| cap(sheet.centre(index));
    Begun::new(Simulation::new(scheme, sheet, stages, COURANT, |_| plane(), start))
}

fn as_published(published: Kinetic, cells: usize) -> Begun<2, Kinetic> {
    let sheet = grid::<2>(cells, Boundary::Open);
    let scheme = Kinetic { friction: FRICTION, ..published };
    let start = |index| cap(sheet.centre(index));
    Begun::new(Simulation::new(scheme, sheet, EULER, COURANT, |_| plane(), start))
}

fn on_terrain(second: bool, cells: usize) -> Begun<2, Balanced<Coulomb, ground::Terrain<2, f64>>> {
    let sheet = grid::<2>(cells, Boundary::Nothing);
    let height = |number: usize| {
        let [x, y] = sheet.centre(sheet.index(number));
        0.3 * x + 0.02 * (9.0 * x).sin() * (7.0 * y).cos()
    };
    let [west, south] = sheet.origin;
    let bed = Raster {
        columns: cells,
        rows: cells,
        west,
        south,
        cell: sheet.size[0],
        values: (0..sheet.count()).map(height).collect(),
        crs: None,
    };
    let grounds = ground::Terrain::cells(&Terrain::new(bed, Curvature::Length(3.0 * sheet.size[0])), 1.0);
    let (scheme, stages) = balanced(second);
    let ground = |[i, j]: [usize; 2]| grounds[j * cells + i];
    Begun::new(Simulation::new(scheme, sheet, stages, COURANT, ground, |index| cap(sheet.centre(index))))
}

/// A table half as high as it will be, with sand rolling and poured everywhere; the last column and row are nodes only.
fn on_table(scheme: HadelerKuttler, cells: usize) -> Begun<2, HadelerKuttler> {
    let last = cells - 1;
    let ground = |[i, j]: [usize; 2]| {
        let one = |yes: bool| if yes { 1.0 } else { 0.0 };
        let inside = one(i < last && j < last);
        let weight = one(i > 0 && j > 0 && i < last && j < last);
        hadeler_kuttler::Ground {
            source: [0.25 * inside; 2],
            bed: 0.0,
            inside,
            weight,
            wall: [0.0; 2],
            hole: 0.0,
        }
    };
    let start = |index: [usize; 2]| {
        let from_edge = index.map(|k| k.min(last - k)).into_iter().min().unwrap_or(0);
        Pile { u: 0.5 * from_edge as f64 / cells as f64, v: 0.1 * ground(index).inside }
    };
    let sheet = grid::<2>(cells, Boundary::Nothing);
    Begun::new(Simulation::new(scheme, sheet, scheme.stages(), COURANT, ground, start))
}
