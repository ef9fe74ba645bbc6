//! From a case file to a simulation: files read, geometry computed, the scheme chosen.

mod mountain;
mod sand;

pub use mountain::{Mountain, ground_at};
pub use sand::Sand;

use crate::case::avalanche::SchemeName;
use crate::case::sandpile::Poured;
use crate::case::{self, CaseError, Kind, RunPlan, Stepping, chute};
use crate::grid::Grid;
use crate::hadeler_kuttler::scheme::HadelerKuttler;
use crate::kernels::Kernel;
use crate::raster::RasterError;
use crate::release::{ReleaseError, Sparse};
use crate::results::{Plane, Under};
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Balanced;
use crate::savage_hutter::friction::Coulomb;
use crate::savage_hutter::ground::{Bed, Chute};
use crate::savage_hutter::kinetic::{
    Kinetic, VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5,
};
use crate::scheme::Boundary;
use crate::simulation::{Simulation, StepSize};
use crate::time::{EULER, SSP_RK2};

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
    Chute(Box<chute::Plan>),
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
    pub fn load(run: &RunPlan, kind: Kind) -> Result<Scene, SetupError> {
        match kind {
            Kind::Chute(plan) => Ok(Scene::Chute(Box::new(plan))),
            Kind::Terrain(plan) => Ok(Scene::Mountain(Mountain::load(run, plan)?)),
            Kind::Sandpile(plan) => {
                let scheme = sand::scheme(&plan);
                Ok(match plan.table {
                    Poured::Line(pile) => Scene::Line(Box::new(Sand::load(run, &plan.grid, scheme, *pile)?)),
                    Poured::Plane(pile) => {
                        Scene::Table(Box::new(Sand::load(run, &plan.grid, scheme, *pile)?))
                    }
                })
            }
        }
    }

    /// Thickness below which a cell is a film; 0 where there are none.
    pub fn film(&self) -> f64 {
        match self {
            Scene::Chute(plan) => plan.film,
            Scene::Mountain(mountain) => mountain.film,
            Scene::Line(_) | Scene::Table(_) => 0.0,
        }
    }

    /// Density of what flows; 1 where it has none.
    pub fn density(&self) -> f64 {
        match self {
            Scene::Chute(plan) => plan.material.density,
            Scene::Mountain(mountain) => mountain.material.density,
            Scene::Line(_) | Scene::Table(_) => 1.0,
        }
    }

    /// Build the simulation that the case asks for and hand it to `work`; what the scene holds of every cell is given back
    /// before.
    pub fn simulate<V: Visit>(self, run: &RunPlan, work: V) -> V::Output {
        let step = step_size(run);
        match self {
            Scene::Line(sand) => work.visit_sand(&sand, sand.simulation(step)),
            Scene::Table(sand) => work.visit_sand(&sand, sand.simulation(step)),
            Scene::Mountain(mountain) => mountain.simulate(step, work),
            Scene::Chute(plan) if plan.grid.y.is_none() => on_chute::<1, V>(*plan, step, work),
            Scene::Chute(plan) => on_chute::<2, V>(*plan, step, work),
        }
    }
}

/// The simulation of a chute, handed to `work`.
fn on_chute<const D: usize, V: Visit>(plan: chute::Plan, step: StepSize, work: V) -> V::Output {
    let chute::Plan { grid: description, sides, zeta, kappa, epsilon, eta, material, scheme, film, initial } =
        plan;
    let (cells, gravity) = (description.cells(), material.gravity);
    let column = |(zeta, kappa): (f64, f64)| {
        let cos = gravity * zeta.cos();
        Chute {
            tilt: [gravity * zeta.sin(), 0.0],
            beta: epsilon * material.pressure_coefficient * cos,
            cos,
            curvature: eta * kappa,
        }
    };
    let grounds: Vec<Chute<2, f64>> = zeta.into_iter().zip(kappa).map(column).collect();
    let axes = [Some(&description.x), description.y.as_ref()];
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
    let plane = Plane::of(&grid, Under::Chute, Sparse::of(initial.thickness.iter().copied()));
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
    let friction = Coulomb { mu: material.mu };
    let published = match scheme {
        SchemeName::Balanced => {
            let scheme = Balanced::first(material.law, film);
            return work.visit(plane, Simulation::new(scheme, grid, EULER, step, ground, state));
        }
        SchemeName::Balanced2 => {
            let scheme = Balanced::second(material.law, film);
            return work.visit(plane, Simulation::new(scheme, grid, SSP_RK2, step, ground, state));
        }
        SchemeName::Verfahren1 => VERFAHREN_1,
        SchemeName::Verfahren2 => VERFAHREN_2,
        SchemeName::Verfahren3 => VERFAHREN_3,
        SchemeName::Verfahren4 => VERFAHREN_4,
        SchemeName::Verfahren5 => VERFAHREN_5,
    };
    let scheme = Kinetic { friction, ..published };
    work.visit(plane, Simulation::new(scheme, grid, EULER, step, ground, state))
}

fn step_size(run: &RunPlan) -> StepSize {
    match run.stepping {
        Stepping::Fixed(dt) => StepSize::Fixed(dt),
        Stepping::Courant(courant) => StepSize::Courant(courant),
    }
}
