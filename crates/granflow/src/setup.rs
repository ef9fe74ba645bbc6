//! From a case file to a simulation: files read, geometry computed, the scheme chosen.

mod sand;

pub use sand::Sand;

use crate::case::{self, Case, CaseError, Model, SchemeName, Stepping};
use crate::grid::Grid;
use crate::hadeler_kuttler::scheme::HadelerKuttler;
use crate::raster::{Crs, Raster, RasterError};
use crate::release::{self, ReleaseError};
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Balanced;
use crate::savage_hutter::friction::{Cohesion, Coulomb, Law, SamosAt, Voellmy};
use crate::savage_hutter::ground::{self, Bed, Chute};
use crate::savage_hutter::kinetic::{
    Kinetic, VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5,
};
use crate::scheme::{Boundary, Scheme};
use crate::simulation::{Simulation, StepSize};
use crate::terrain::{Curvature, Terrain};
use crate::time::{EULER, SSP_RK2};

/// More cells than any machine holds.
const MOST_CELLS: f64 = (1_u64 << 36) as f64;

/// Why a case could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The case itself is wrong.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The terrain, or a raster of thicknesses, cannot be used.
    #[error(transparent)]
    Raster(Box<RasterError>),
    /// A release cannot be used.
    #[error(transparent)]
    Release(Box<ReleaseError>),
}

impl From<RasterError> for SetupError {
    fn from(error: RasterError) -> Self {
        SetupError::Raster(Box::new(error))
    }
}

impl From<ReleaseError> for SetupError {
    fn from(error: ReleaseError) -> Self {
        SetupError::Release(Box::new(error))
    }
}

/// What a case describes, with every file read.
#[derive(Debug)]
pub enum Scene {
    /// A chute in the papers' scaling, in one or two dimensions.
    Chute {
        /// Cells along x and y (1 in one dimension).
        cells: [usize; 2],
        /// Ground of every cell, x fastest.
        grounds: Vec<Chute<2, f64>>,
        /// Thickness and velocity of every cell.
        initial: case::InitialState,
    },
    /// A mountain, SI units.
    Mountain {
        /// Bed and its derivatives.
        terrain: Box<Terrain>,
        /// Ground of every cell, x fastest, the first row in the south.
        grounds: Vec<ground::Terrain<2, f64>>,
        /// Released volume per plan area H \[m\].
        release: Vec<f64>,
    },
    /// A table in one dimension, with what is poured on it.
    Line(Box<Sand<1>>),
    /// A table.
    Table(Box<Sand<2>>),
}

/// Work on a simulation of whatever dimension and scheme.
pub trait Visit {
    /// What the work gives.
    type Output;
    /// Do it.
    fn visit<const D: usize, S>(self, simulation: Simulation<D, S>) -> Self::Output
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>;
    /// Do it for a growing sandpile.
    fn visit_sand<const D: usize>(
        self,
        sand: &Sand<D>,
        simulation: Simulation<D, HadelerKuttler>,
    ) -> Self::Output;
}

impl Scene {
    /// Read what the case names and compute what does not change in time.
    ///
    /// # Errors
    /// [`SetupError`] at the first file or key that cannot be used.
    pub fn load(case: &Case) -> Result<Scene, SetupError> {
        case.check()?;
        match (&case.grid, &case.terrain) {
            (Some(grid), _) if case.model == Model::HadelerKuttler => Ok(match grid.y {
                None => Scene::Line(Box::new(Sand::load(case, grid)?)),
                Some(_) => Scene::Table(Box::new(Sand::load(case, grid)?)),
            }),
            (Some(grid), _) => Ok(Self::chute(case, grid)?),
            (None, Some(terrain)) => Self::mountain(case, terrain),
            (None, None) => {
                Err(case.fault("grid", "neither a grid nor a terrain", "add [grid] or [terrain]").into())
            }
        }
    }

    fn chute(case: &Case, grid: &case::Grid) -> Result<Scene, CaseError> {
        let (chute, material) = (case.chute()?, case.material());
        let cells = grid.cells();
        let gravity = case.gravity();
        let column = |i: usize| {
            let zeta = chute.zeta(grid.x.centre(i));
            let cos = gravity * zeta.cos();
            Chute {
                tilt: [gravity * zeta.sin(), 0.0],
                beta: material.epsilon() * material.pressure_coefficient() * cos,
                cos,
                curvature: material.eta() * chute.kappa(grid.x.face(i), grid.x.face(i + 1)),
            }
        };
        let row: Vec<_> = (0..cells[0]).map(column).collect();
        let grounds = (0..cells[1]).flat_map(|_| row.iter().copied()).collect();
        Ok(Scene::Chute { cells, grounds, initial: case.initial_state()? })
    }

    fn mountain(case: &Case, terrain: &case::Terrain) -> Result<Scene, SetupError> {
        let crs = match &terrain.crs {
            Some(text) => Some(Crs::parse(text).map_err(|error| {
                case.fault("terrain.crs", error.to_string(), "write it as crs = \"EPSG:31287\"")
            })?),
            None => None,
        };
        let mut bed = Raster::read_in(&case.resolve(&terrain.dem), crs.as_ref())?;
        let [width, height] = [bed.columns, bed.rows].map(|count| count as f64 * bed.cell);
        if let Some(cell) = terrain.cell {
            let [columns, rows] = [width / cell, height / cell];
            if columns < 3.0 || rows < 3.0 || columns * rows > MOST_CELLS {
                let message = format!(
                    "cells of {cell} m cut the terrain of {width} m x {height} m into {columns:.1} x {rows:.1}"
                );
                let cure = "allowed are at least 3 along each side, and not more than a machine holds";
                return Err(case.fault("terrain.cell", message, cure).into());
            }
            bed = bed.resample(cell);
        }
        if let Some(length) = terrain.curvature.length().filter(|length| *length > width.min(height)) {
            let message =
                format!("a window of {length} m is wider than the terrain of {width} m x {height} m");
            let cure = "the window spans a few cells, for instance length = \"20 m\"";
            return Err(case.fault("terrain.curvature.length", message, cure).into());
        }
        let curvature = terrain.curvature.length().map_or(Curvature::Off, Curvature::Length);
        let terrain = Terrain::new(bed, curvature);
        let mut release = vec![0.0; terrain.bed.values.len()];
        for (number, one) in case.release.iter().enumerate() {
            let volume = Self::release(case, one, number, &terrain)?;
            for (sum, part) in release.iter_mut().zip(volume) {
                *sum += part;
            }
        }
        let grounds = ground::Terrain::cells(&terrain, case.gravity());
        Ok(Scene::Mountain { terrain: Box::new(terrain), grounds, release })
    }

    /// Volume per plan area that one release gives to every cell.
    fn release(
        case: &Case,
        one: &case::Release,
        number: usize,
        terrain: &Terrain,
    ) -> Result<Vec<f64>, SetupError> {
        let thickness = match &one.thickness {
            Some(case::Thickness::Constant(value)) => Some(release::Thickness::Value(*value)),
            Some(case::Thickness::Attribute(name)) => {
                Some(release::Thickness::Attribute(name.attribute.clone()))
            }
            None => None,
        };
        let missing = || {
            case.fault(
                &format!("release.{number}"),
                "the release says neither where nor how thick",
                "give polygons with a thickness, a raster, or a cap",
            )
        };
        let cells = match (&one.polygons, &one.raster, &one.cap) {
            (Some(path), None, None) => {
                release::polygons(&case.resolve(path), &thickness.ok_or_else(missing)?, &terrain.bed)?
            }
            (None, Some(path), None) => release::raster(&case.resolve(path), &terrain.bed)?,
            (None, None, Some(cap)) => release::cap(cap.height, cap.centre, cap.radius, &terrain.bed)?,
            _ => return Err(missing().into()),
        };
        let measured = match one.measured {
            case::Measured::Normal => release::Measured::Normal,
            case::Measured::Vertical => release::Measured::Vertical,
        };
        Ok(release::per_plan_area(&cells, terrain, measured))
    }

    /// Build the simulation that the case asks for and hand it to `work`.
    pub fn simulate<V: Visit>(&self, case: &Case, work: V) -> V::Output {
        match self {
            Scene::Line(sand) => return work.visit_sand(sand, sand.simulation(case)),
            Scene::Table(sand) => return work.visit_sand(sand, sand.simulation(case)),
            Scene::Chute { .. } | Scene::Mountain { .. } => {}
        }
        let material = case.material();
        let density = material.density();
        let mu = material.friction.mu();
        let friction = match &material.friction {
            case::Friction::Coulomb(_) => Law::Coulomb(Coulomb { mu }),
            case::Friction::Voellmy(law) => Law::Voellmy(Voellmy { mu, xi: law.xi, gravity: case.gravity() }),
            case::Friction::Cohesion(law) => Law::Cohesion(Cohesion { mu, bond: law.tau0 / density }),
            case::Friction::Samosat(law) => {
                let case::Samosat { mu, tau0, rs0, kappa, r, b } = *law;
                Law::SamosAt(SamosAt { mu, bond: tau0 / density, rs0, kappa, r, b })
            }
        };
        let film = case.scheme.film();
        let second = case.scheme.name == SchemeName::Balanced2;
        match self {
            Scene::Mountain { terrain, grounds, release } => {
                let bed = &terrain.bed;
                let grid = Grid {
                    cells: [bed.columns, bed.rows],
                    origin: [bed.west, bed.south],
                    size: [bed.cell; 2],
                    boundary: [[Boundary::Nothing; 2]; 2],
                };
                let number = |[i, j]: [usize; 2]| j * bed.columns + i;
                work.visit(Simulation::new(
                    if second { Balanced::second(friction, film) } else { Balanced::first(friction, film) },
                    grid,
                    if second { SSP_RK2 } else { EULER },
                    step_size(case),
                    |index| grounds[number(index)],
                    |index| Flow::still(release[number(index)]),
                ))
            }
            Scene::Chute { cells, .. } if cells[1] == 1 => self.on_chute::<1, V>(case, friction, work),
            _ => self.on_chute::<2, V>(case, friction, work),
        }
    }

    fn on_chute<const D: usize, V: Visit>(&self, case: &Case, friction: Law, work: V) -> V::Output {
        let (Scene::Chute { cells, grounds, initial }, Some(description)) = (self, &case.grid) else {
            unreachable!("a chute comes from a case with a grid")
        };
        let axes = [Some(&description.x), description.y.as_ref()];
        let sides = description.sides();
        let grid = Grid::<D> {
            cells: std::array::from_fn(|k| cells[k]),
            origin: std::array::from_fn(|k| axes[k].map_or(0.0, |axis| axis.from)),
            size: std::array::from_fn(|k| axes[k].map_or(1.0, case::Axis::width)),
            boundary: std::array::from_fn(|k| {
                sides[k].map(|side| match side {
                    case::Side::Open => Boundary::Open,
                    case::Side::Wall => Boundary::Wall,
                    case::Side::Periodic => Boundary::Periodic,
                })
            }),
        };
        let number = |index: [usize; D]| if D > 1 { index[D - 1] * cells[0] + index[0] } else { index[0] };
        let ground = |index: [usize; D]| {
            let Chute { tilt, beta, cos, curvature } = grounds[number(index)];
            Chute { tilt: std::array::from_fn(|k| tilt[k]), beta, cos, curvature }
        };
        let state = |index: [usize; D]| {
            let n = number(index);
            let u = [initial.velocity_x[n], initial.velocity_y[n]];
            let h = initial.thickness[n];
            Flow { h, q: std::array::from_fn(|k| h * u[k]) }
        };
        let step = step_size(case);
        let film = case.scheme.film();
        let kinetic = |published: Kinetic| Kinetic {
            friction: Coulomb { mu: case.material().friction.mu() },
            ..published
        };
        let published = match case.scheme.name {
            SchemeName::Balanced => {
                return work.visit(Simulation::new(
                    Balanced::first(friction, film),
                    grid,
                    EULER,
                    step,
                    ground,
                    state,
                ));
            }
            SchemeName::Balanced2 => {
                return work.visit(Simulation::new(
                    Balanced::second(friction, film),
                    grid,
                    SSP_RK2,
                    step,
                    ground,
                    state,
                ));
            }
            SchemeName::Verfahren1 => VERFAHREN_1,
            SchemeName::Verfahren2 => VERFAHREN_2,
            SchemeName::Verfahren3 => VERFAHREN_3,
            SchemeName::Verfahren4 => VERFAHREN_4,
            SchemeName::Verfahren5 => VERFAHREN_5,
            SchemeName::FirstOrder | SchemeName::SecondOrder | SchemeName::Adaptive => {
                unreachable!("Case::check refuses schemes of another model")
            }
        };
        work.visit(Simulation::new(kinetic(published), grid, EULER, step, ground, state))
    }
}

fn step_size(case: &Case) -> StepSize {
    match case.scheme.stepping() {
        Stepping::Fixed(dt) => StepSize::Fixed(dt),
        Stepping::Courant(courant) => StepSize::Courant(courant),
    }
}
