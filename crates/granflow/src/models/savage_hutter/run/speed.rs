//! Avalanches to measure the schemes by.

use crate::speed::{Begun, COURANT, Extent, Setup, grid};
use granflow_engine::grid::Grid;
use granflow_engine::kernels::Kernel;
use granflow_engine::simulation::Simulation;
use granflow_geo::raster::Raster;
use granflow_geo::terrain::{Curvature, Terrain};
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::friction::{Coulomb, Law};
use granflow_model::savage_hutter::ground::{self, Chute};
use granflow_model::savage_hutter::kinetic::{FaceDepth, Kinetic, VERFAHREN_1, VERFAHREN_5, Variant};
use granflow_model::scheme::Boundary;

/// All of them.
pub(crate) const SETUPS: &[Setup] = &[
    Setup {
        name: "balanced",
        about: "first order, an inclined plane",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_plane::<2, _>(balanced(false), extent)),
    },
    Setup {
        name: "balanced_terrain",
        about: "first order, a bed of varying slope and curvature",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_terrain(balanced(false), extent)),
    },
    Setup {
        name: "balanced_2",
        about: "second order, two stages, an inclined plane",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_plane::<2, _>(balanced(true), extent)),
    },
    Setup {
        name: "balanced_2_terrain",
        about: "second order, two stages, a bed of varying slope and curvature",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_terrain(balanced(true), extent)),
    },
    Setup {
        name: "energy_stable",
        about: "first order, an inclined plane",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_plane::<2, _>(energy_stable(false), extent)),
    },
    Setup {
        name: "energy_stable_terrain",
        about: "first order, a bed of varying slope and curvature",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_terrain(energy_stable(false), extent)),
    },
    Setup {
        name: "energy_stable_2",
        about: "second order, an inclined plane",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_plane::<2, _>(energy_stable(true), extent)),
    },
    Setup {
        name: "energy_stable_2_terrain",
        about: "second order, a bed of varying slope and curvature",
        dimensions: 2,
        dry: true,
        begin: |extent| Box::new(on_terrain(energy_stable(true), extent)),
    },
    Setup {
        name: "balanced_1d",
        about: "first order, an inclined plane",
        dimensions: 1,
        dry: true,
        begin: |extent| Box::new(on_plane::<1, _>(balanced(false), extent)),
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
];

const FRICTION: Coulomb = Coulomb { mu: 0.47 };
/// As cases have it.
const LAW: Law = Law::Coulomb(FRICTION);
const FILM: f64 = 1e-9;

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

pub(crate) fn balanced<B>(second: bool) -> Balanced<Law, B> {
    if second { Balanced::second(LAW, FILM) } else { Balanced::first(LAW, FILM) }
}

fn energy_stable<B>(second: bool) -> EnergyStable<Law, B> {
    if second { EnergyStable::second(LAW, FILM) } else { EnergyStable::first(LAW, FILM) }
}

pub(crate) fn on_plane<const D: usize, S>(scheme: S, extent: Extent) -> Begun<D, S>
where
    S: Kernel<D, State = Flow<D, f64>, Ground = Chute<D, f64>, Forcing = ()>,
{
    let sheet = grid::<D>(extent.cells, Boundary::Open);
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

pub(crate) fn on_terrain<S>(scheme: S, extent: Extent) -> Begun<2, S>
where
    S: Kernel<2, State = Flow<2, f64>, Ground = ground::Terrain<2, f64>, Forcing = ()>,
{
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
    let ground = move |cell| super::terrain::ground_at(&terrain, 1.0, cell);
    let start = |index| cap(&sheet, extent, index);
    Begun::new(
        Simulation::new(scheme, sheet, COURANT, ground, start).expect("a step that the scheme takes"),
        extent.all(),
    )
}
