//! An avalanche without a case file.

use super::super::ChuteDomain;
#[cfg(feature = "geo")]
use super::super::TerrainDomain;
use super::flowing::Flowing;
use crate::check_value::check_value;
use crate::model::{Domain, Plane};
use crate::run::{Run, Simulated};
use granflow_case::avalanche::GRAVITY;
use granflow_engine::grid::Grid;
use granflow_engine::kernels::Kernel;
use granflow_engine::simulation::{BuildError, Simulation, StepSize};
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::friction::{AnyLaw, Coulomb, Law, LocalFriction, Resistance};
use granflow_model::savage_hutter::ground::{Bed, Chute};
use std::sync::Arc;

type Field<'a, const D: usize, T> = Box<dyn Fn([f64; D]) -> T + Sync + 'a>;

/// An avalanche to be started: SI units, the default scheme, mu = 0.4, nothing on the bed.
pub struct Avalanche<'a, const D: usize, B> {
    grid: Grid<D>,
    bed: B,
    law: AnyLaw,
    second_order: bool,
    film: f64,
    threshold: f64,
    step: Option<StepSize>,
    thickness: Field<'a, D, f64>,
    velocity: Field<'a, D, [f64; D]>,
}

/// A plane that falls along +x.
pub struct Slope {
    angle: f64,
    gravity: f64,
    epsilon: f64,
}

impl<'a, const D: usize, B> Avalanche<'a, D, B> {
    fn over(grid: Grid<D>, bed: B, second_order: bool, film: f64, threshold: f64) -> Self {
        Avalanche {
            grid,
            bed,
            law: AnyLaw::Coulomb(Coulomb { mu: 0.4 }),
            second_order,
            film,
            threshold,
            step: None,
            thickness: Box::new(|_| 0.0),
            velocity: Box::new(|_| [0.0; D]),
        }
    }
    /// Thickness normal to the bed at the start, in metres, at a place of the plane.
    #[must_use]
    pub fn thickness(mut self, thickness: impl Fn([f64; D]) -> f64 + Sync + 'a) -> Self {
        self.thickness = Box::new(thickness);
        self
    }
    /// Horizontal velocity at the start \[m/s\].
    #[must_use]
    pub fn velocity(mut self, velocity: impl Fn([f64; D]) -> [f64; D] + Sync + 'a) -> Self {
        self.velocity = Box::new(velocity);
        self
    }
    /// Coulomb friction with mu = tan(delta).
    #[must_use]
    pub fn mu(self, mu: f64) -> Self {
        self.friction(AnyLaw::Coulomb(Coulomb { mu }))
    }
    /// The friction law.
    #[must_use]
    pub fn friction(self, law: impl Into<AnyLaw>) -> Self {
        Avalanche { law: law.into(), ..self }
    }
    /// First order: the scheme `energy_stable`, the default on a plane.
    #[must_use]
    pub fn first_order(self) -> Self {
        Avalanche { second_order: false, ..self }
    }
    /// Second order in smooth flow: the scheme `energy_stable_2`, the default on terrain.
    #[must_use]
    pub fn second_order(self) -> Self {
        Avalanche { second_order: true, ..self }
    }
    /// Thickness below which a cell is a film and is held \[m\]: 1e-4 on terrain and 1e-6 on a plane unless it is said.
    #[must_use]
    pub fn film(self, film: f64) -> Self {
        Avalanche { film, ..self }
    }
    /// Thickness normal to the bed that a layer must exceed to count in peaks, times and deposit \[m\]: 0.01
    /// on terrain and 1e-3 on a plane unless it is said. It changes nothing of what is computed.
    #[must_use]
    pub fn threshold(self, threshold: f64) -> Self {
        Avalanche { threshold, ..self }
    }
    /// Another step than the scheme suggests.
    #[must_use]
    pub fn step(self, step: StepSize) -> Self {
        Avalanche { step: Some(step), ..self }
    }

    /// The run on grounds of a kind, one for each cell.
    fn run<G>(
        self,
        domain: impl Domain,
        on_terrain: bool,
        ground: impl Fn([usize; D]) -> G + Sync,
    ) -> Result<Box<dyn Run>, BuildError>
    where
        G: Bed<D, f64> + 'static,
        EnergyStable<Law, G>: Kernel<D, State = Flow<D, f64>, Ground = G>,
        EnergyStable<AnyLaw, G>: Kernel<D, State = Flow<D, f64>, Ground = G>,
    {
        let (law, film) = (self.law, self.film);
        let second = self.second_order;
        let name = if second { "energy_stable_2" } else { "energy_stable" };
        match law.in_loops() {
            Some(law) => self.run_by(name, of_order::<Law, G>(second, law, film), domain, on_terrain, ground),
            None => self.run_by(name, of_order::<AnyLaw, G>(second, law, film), domain, on_terrain, ground),
        }
    }

    /// The same with a scheme.
    fn run_by<G: Bed<D, f64> + 'static, S>(
        self,
        name: &'static str,
        scheme: S,
        domain: impl Domain,
        on_terrain: bool,
        ground: impl Fn([usize; D]) -> G + Sync,
    ) -> Result<Box<dyn Run>, BuildError>
    where
        S: Kernel<D, State = Flow<D, f64>, Ground = G> + 'static,
    {
        let Avalanche { grid, law, film, threshold, step, thickness, velocity, .. } = self;
        let step = step.unwrap_or(StepSize::Courant(scheme.suggested_courant()));
        check_law(law)?;
        check_value("threshold", threshold, "a finite number >= 0", |threshold| threshold >= 0.0)?;
        for number in 0..grid.count() {
            let place = grid.centre(grid.index(number));
            check_value("thickness", thickness(place), "a finite number >= 0 at every place", |h| h >= 0.0)?;
            for u in velocity(place) {
                check_value("velocity", u, "a finite number at every place", |_| true)?;
            }
        }
        let state = |index| {
            let place = grid.centre(index);
            let h = thickness(place) / ground(index).thickness(1.0);
            let h = if h.is_finite() { h } else { 0.0 };
            Flow { h, q: velocity(place).map(|u| h * u) }
        };
        let simulation = Simulation::new(scheme, grid, step, &ground, state)?;
        let plane = Plane::of(&grid, Arc::new(domain));
        let physics = Flowing::<D, S>::new(name, film, on_terrain).with_threshold(threshold);
        Ok(Box::new(Simulated::new(simulation, physics, plane)))
    }
}

/// The scheme of an order.
fn of_order<F, G>(second: bool, law: F, film: f64) -> EnergyStable<F, G> {
    if second { EnergyStable::second(law, film) } else { EnergyStable::first(law, film) }
}

/// Friction is a finite resistance, never a push.
fn check_law(law: AnyLaw) -> Result<(), BuildError> {
    let own = law.parameters();
    let Resistance { dry, viscous, drag, holding } = law.resistance_with(&own, 1.0, 1.0, 1.0, 1.0);
    let kept = law.kept(&own, &law.resistance_with(&own, 1.0, 1.0, 1.0, 1.0), 1.0, 1.0, 1.0);
    [dry, viscous, drag, holding, kept].into_iter().try_for_each(|part| {
        check_value("friction of the law", part, "parameters that give a finite number >= 0", |part| {
            part >= 0.0
        })
    })
}

impl<'a, const D: usize> Avalanche<'a, D, Slope> {
    /// On a plane of this inclination \[radians\], downhill along +x, under gravity.
    #[must_use]
    pub fn on_plane(grid: Grid<D>, angle: f64) -> Self {
        let slope = Slope { angle, gravity: GRAVITY, epsilon: 1.0 };
        Self::over(grid, slope, false, granflow_case::chute::FILM, granflow_case::chute::THRESHOLD)
    }
    /// In the papers' scaling: lengths by L, heights by H = epsilon L, times by sqrt(L/g).
    #[must_use]
    pub fn scaled(mut self, epsilon: f64) -> Self {
        self.bed = Slope { gravity: 1.0, epsilon, ..self.bed };
        self
    }
    /// The run; nothing is computed yet.
    ///
    /// # Errors
    /// [`BuildError`] for a grid without cells, a step that the scheme does not take, a thickness or a law out of range.
    pub fn start(self) -> Result<Box<dyn Run>, BuildError> {
        let Slope { angle, gravity, epsilon } = self.bed;
        let cos = gravity * angle.cos();
        let mut tilt = [0.0; D];
        tilt[0] = gravity * angle.sin();
        let ground = Chute { tilt, beta: epsilon * cos, cos, curvature: 0.0 };
        self.run(ChuteDomain::default(), false, |_| ground)
    }
}

#[cfg(feature = "geo")]
impl<'a> Avalanche<'a, 2, granflow_geo::terrain::Terrain> {
    /// On the terrain z = b(x, y) whose elevations \[m\] are given for square cells, x fastest, the first row in the south, not a
    /// number outside the data. Slopes and curvatures are fitted over `window` \[m\].
    ///
    /// # Panics
    /// If there are not as many elevations as cells, or the cells are not squares.
    #[must_use]
    pub fn on_terrain(grid: Grid<2>, elevations: Vec<f64>, window: f64) -> Self {
        assert_eq!(elevations.len(), grid.count(), "one elevation for each cell");
        assert_eq!(grid.size[0].to_bits(), grid.size[1].to_bits(), "square cells");
        let bed = granflow_geo::raster::Raster {
            columns: grid.cells[0],
            rows: grid.cells[1],
            west: grid.origin[0],
            south: grid.origin[1],
            cell: grid.size[0],
            values: elevations,
            crs: None,
        };
        let curvature = granflow_geo::terrain::Curvature::Length(window);
        let edges = [[granflow_model::scheme::Boundary::Absorbing; 2]; 2];
        let grid = Grid { boundary: edges, ..grid };
        Self::over(
            grid,
            granflow_geo::terrain::Terrain::new(bed, curvature),
            true,
            granflow_case::terrain::FILM,
            granflow_case::terrain::THRESHOLD,
        )
    }
    /// The run; nothing is computed yet.
    ///
    /// # Errors
    /// [`BuildError`] for a grid without cells, a step that the scheme does not take, a thickness or a law out of range.
    pub fn start(mut self) -> Result<Box<dyn Run>, BuildError> {
        let empty = granflow_geo::raster::Raster {
            columns: 0,
            rows: 0,
            values: Vec::new(),
            ..(*self.bed.bed).clone()
        };
        let none = granflow_geo::terrain::Terrain::new(empty, granflow_geo::terrain::Curvature::Off);
        let terrain = std::mem::replace(&mut self.bed, none);
        let columns = self.grid.cells[0];
        let thickness = &self.thickness;
        let at = |k: usize| thickness(self.grid.centre([k % columns, k / columns]));
        let release = granflow_geo::release::Sparse::of((0..self.grid.count()).map(at));
        let domain = TerrainDomain {
            raster: Arc::new(terrain.bed.with_values(Vec::new())),
            release: Arc::new(release),
            inlets: Arc::default(),
            density: f64::NAN,
            threshold: self.threshold,
            curvature: terrain.curvature(),
            remarks: Vec::new(),
        };
        self.run(domain, true, |cell| super::terrain::ground_at(&terrain, GRAVITY, cell))
    }
}
