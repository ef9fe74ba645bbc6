//! From a case file to a simulation: files read, geometry computed, the scheme chosen.

mod mountain;
mod sand;

pub use mountain::{Mountain, ground_at};
pub use sand::Sand;

use crate::case::{self, Case, CaseError, Model, SchemeName, Stepping};
use crate::grid::Grid;
use crate::hadeler_kuttler::scheme::HadelerKuttler;
use crate::kernels::Kernel;
use crate::model::Plane;
use crate::models::savage_hutter::ChuteDomain;
use crate::raster::RasterError;
use crate::release::ReleaseError;
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Balanced;
use crate::savage_hutter::friction::{Cohesion, Coulomb, Law, SamosAt, Voellmy};
use crate::savage_hutter::ground::{Bed, Chute};
use crate::savage_hutter::kinetic::{
    Kinetic, VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5,
};
use crate::scheme::Boundary;
use crate::simulation::{Simulation, StepSize};
use crate::time::{EULER, SSP_RK2};
use std::sync::Arc;

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
        /// Ground of every column of cells.
        grounds: Vec<Chute<2, f64>>,
        /// Thickness and velocity of every cell.
        initial: case::InitialState,
    },
    /// A mountain.
    Mountain(Mountain),
    /// A table in one dimension, with what is poured on it.
    Line(Box<Sand<1>>),
    /// A table.
    Table(Box<Sand<2>>),
}

/// Work on a simulation of whatever dimension and scheme.
pub trait Visit {
    /// What the work gives.
    type Output;
    /// Do it, where the cells lie on `plane`.
    fn visit<const D: usize, S>(self, plane: Plane, simulation: Simulation<D, S>) -> Self::Output
    where
        S: crate::run::model::Model<D> + Kernel<D, State = Flow<D, f64>>,
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
            (None, Some(terrain)) => Ok(Scene::Mountain(Mountain::load(case, terrain)?)),
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
        let grounds = (0..cells[0]).map(column).collect();
        Ok(Scene::Chute { cells, grounds, initial: case.initial_state()? })
    }

    /// Build the simulation that the case asks for and hand it to `work`; what the scene holds of every cell is given back
    /// before.
    pub fn simulate<V: Visit>(self, case: &Case, work: V) -> V::Output {
        match self {
            Scene::Line(sand) => work.visit_sand(&sand, sand.simulation(case)),
            Scene::Table(sand) => work.visit_sand(&sand, sand.simulation(case)),
            Scene::Mountain(mountain) => mountain.simulate(case, work),
            Scene::Chute { cells, .. } if cells[1] == 1 => self.on_chute::<1, V>(case, work),
            Scene::Chute { .. } => self.on_chute::<2, V>(case, work),
        }
    }

    fn on_chute<const D: usize, V: Visit>(self, case: &Case, work: V) -> V::Output {
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
        let plane = Plane::of(&grid, Arc::new(ChuteDomain));
        // Both own what they read: it is given back once the simulation is made.
        let ground = move |index: [usize; D]| {
            let Chute { tilt, beta, cos, curvature } = grounds[index[0]];
            Chute { tilt: std::array::from_fn(|k| tilt[k]), beta, cos, curvature }
        };
        let state = move |index: [usize; D]| {
            let n = number(index);
            let u = [initial.velocity_x[n], initial.velocity_y[n]];
            let h = initial.thickness[n];
            Flow { h, q: std::array::from_fn(|k| h * u[k]) }
        };
        let (step, law, film) = (step_size(case), law(case), case.scheme.film());
        let kinetic = |published: Kinetic| Kinetic {
            friction: Coulomb { mu: case.material().friction.mu() },
            ..published
        };
        let published = match case.scheme.name {
            SchemeName::Balanced => {
                let scheme = Balanced::first(law, film);
                return work.visit(plane, Simulation::new(scheme, grid, EULER, step, ground, state));
            }
            SchemeName::Balanced2 => {
                let scheme = Balanced::second(law, film);
                return work.visit(plane, Simulation::new(scheme, grid, SSP_RK2, step, ground, state));
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
        work.visit(plane, Simulation::new(kinetic(published), grid, EULER, step, ground, state))
    }
}

/// The friction of the case.
fn law(case: &Case) -> Law {
    let material = case.material();
    let (density, mu) = (material.density(), material.friction.mu());
    match &material.friction {
        case::Friction::Coulomb(_) => Law::Coulomb(Coulomb { mu }),
        case::Friction::Voellmy(law) => Law::Voellmy(Voellmy { mu, xi: law.xi, gravity: case.gravity() }),
        case::Friction::Cohesion(law) => Law::Cohesion(Cohesion { mu, bond: law.tau0 / density }),
        case::Friction::Samosat(law) => {
            let case::Samosat { mu, tau0, rs0, kappa, r, b } = *law;
            Law::SamosAt(SamosAt { mu, bond: tau0 / density, rs0, kappa, r, b })
        }
    }
}

fn step_size(case: &Case) -> StepSize {
    match case.scheme.stepping() {
        Stepping::Fixed(dt) => StepSize::Fixed(dt),
        Stepping::Courant(courant) => StepSize::Courant(courant),
    }
}
