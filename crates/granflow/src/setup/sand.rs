//! From a case of growing sandpiles to a simulation: table, transport rays, sources, layers at the start.

use super::SetupError;
use crate::case::{self, Case, CaseError, Method, SchemeName, Sources, TablePlan};
use crate::hadeler_kuttler::direct::{Equilibrium, Unsteady};
use crate::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};
use crate::results::{self, Plane};
use crate::scheme::{Scheme, Side};
use crate::simulation::{Simulation, StepSize};
use crate::site::Site;

/// A table with what is poured on it.
#[derive(Debug)]
pub struct Sand<const D: usize> {
    /// The case's table in plain numbers.
    pub plan: TablePlan<D>,
    /// The table, laid out.
    pub site: Site<D>,
    /// What is poured, and when.
    pub sources: Sources,
    /// The equilibrium, where the case asks for it without stepping.
    pub equilibrium: Option<Equilibrium<D>>,
}

impl<const D: usize> Sand<D> {
    /// Evaluates what the case says.
    ///
    /// # Errors
    /// [`CaseError`] for a table or a source that cannot be used.
    pub(super) fn load(case: &Case, grid: &case::Grid) -> Result<Self, SetupError> {
        let plan = case.table()?;
        let sources = case.sources(&plan)?;
        let axes = [Some(&grid.x), grid.y.as_ref()];
        let size = std::array::from_fn(|k| axes[k].map_or(1.0, case::Axis::width));
        let origin = std::array::from_fn(|k| axes[k].map_or(0.0, |axis| axis.from));
        let site = Site::new(plan.table.clone(), origin, size, plan.height.clone());
        let mut sand = Sand { site, sources, equilibrium: None, plan };
        if case.time.method == Some(Method::Direct) {
            sand.equilibrium = Some(sand.steady(case)?);
        }
        Ok(sand)
    }

    fn steady(&self, case: &Case) -> Result<Equilibrium<D>, CaseError> {
        let fault = |key: &str, error: String| {
            case.fault(key, error, "or let it grow: time.until = \"steady\" with an end, and no method")
        };
        let Some(source) = self.sources.lasting() else {
            return Err(fault("time.method", "a source changes for ever, so nothing is ever steady".into()));
        };
        let found = self.site.equilibrium(&source);
        found.map_err(|error: Unsteady<D>| {
            let steep = matches!(error, Unsteady::Steep { .. });
            fault(if steep { "table.height" } else { "time.method" }, error.to_string())
        })
    }

    /// Where its cells and nodes lie, for the files.
    pub fn plane(&self) -> Plane {
        let (cells, nodes) = (&self.plan.centres, &self.plan.nodes);
        let walls = |axis: usize| {
            let mut counts = cells.counts();
            counts[axis] += 1;
            let mut walls = vec![false; counts[0] * counts[1]];
            for (edge, _) in self.plan.table.edges().filter(|(edge, wall)| *wall && edge.axis == axis) {
                walls[edge.index.iter().rev().fold(0, |row, k| row * counts[0] + k)] = true;
            }
            if walls.contains(&true) { walls } else { Vec::new() }
        };
        let flat = self.plan.height.iter().all(|height| *height == 0.0);
        Plane::table(
            cells.x.clone(),
            cells.y.clone().unwrap_or_default(),
            results::Table {
                x_node: nodes.x.clone(),
                y_node: nodes.y.clone().unwrap_or_default(),
                inside: (0..self.plan.rolling.len()).map(|cell| self.plan.inside(cell)).collect(),
                height: if flat { Vec::new() } else { self.plan.height.clone() },
                wall_x: walls(0),
                wall_y: if D > 1 { walls(1) } else { Vec::new() },
            },
        )
    }

    /// The simulation that the case asks for; at its equilibrium if that is known.
    pub fn simulation(&self, case: &Case) -> Simulation<D, HadelerKuttler> {
        let scheme = match case.scheme.name {
            _ if self.equilibrium.is_some() => FIRST_ORDER,
            SchemeName::FirstOrder => FIRST_ORDER,
            SchemeName::SecondOrder => SECOND_ORDER,
            _ => HadelerKuttler { slopes: Slopes::Adaptive { exponent: case.scheme.theta_exponent() } },
        };
        let (u, v, time) = match &self.equilibrium {
            Some(found) => (&found.u, &found.v, f64::INFINITY),
            None => (&self.plan.standing, &self.plan.rolling, 0.0),
        };
        let rates = self.rates(time);
        let simulation = self.site.simulation(scheme, super::step_size(case), &rates, (u, v));
        simulation.expect("Case::check refuses other grids and steps")
    }

    /// Rates of the sources at a time, in the cells; at infinity those that last.
    fn rates(&self, time: f64) -> Vec<f64> {
        if time.is_finite() { self.sources.rate(time) } else { self.sources.lasting().unwrap_or_default() }
    }

    /// Pour as the sources do at `time`.
    pub fn pour(&self, simulation: &mut Simulation<D, HadelerKuttler>, time: f64) {
        let rates = self.rates(time);
        simulation.apply(|index, _| self.site.source(index, &rates));
    }

    /// What one step of the first-order scheme would change at the equilibrium: max |u_t|, max |v_t|.
    pub fn residual(&self, simulation: &Simulation<D, HadelerKuttler>) -> [f64; 2] {
        let step = StepSize::Courant(Scheme::<D, f64>::suggested_courant(&FIRST_ORDER));
        let (ground, state) = (|index| simulation.ground(index), |index| simulation.state(index));
        let mut step = Simulation::new(FIRST_ORDER, self.site.grid(), step, ground, state)
            .expect("a table has a grid, and the scheme takes this step");
        step.apply(|index, _| simulation.forcing(index));
        let done = step.advance(f64::INFINITY);
        let drift = step.drift();
        if done.is_ok() { [drift[0], drift[1]] } else { [f64::NAN; 2] }
    }

    /// Volume per time that falls over the left, right, bottom and top edges and into holes at the equilibrium.
    pub fn outflow(&self) -> Option<[f64; 5]> {
        let mut sums = [0.0; 5];
        for (edge, rate) in &self.equilibrium.as_ref()?.outflow {
            let way = 2 * edge.axis + usize::from(edge.faces == Side::Right);
            sums[if edge.hole { 4 } else { way }] += rate;
        }
        Some(sums)
    }
}
