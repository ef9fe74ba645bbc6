//! A table with what is poured on it.

use super::super::TableDomain;
use super::site::Site;
use crate::StartError;
use crate::model::Plane;
use crate::run::CellOf;
use granflow_case::sandpile::{Pile, Sources as Written, TablePlan};
use granflow_case::{Axis, Grid, Points, RunPlan, Until};
use granflow_engine::simulation::{BuildError, Simulation, StepSize};
use granflow_model::hadeler_kuttler::direct::{Equilibrium, Unsteady};
use granflow_model::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler};
use granflow_model::scheme::Side;

/// Sand that is poured on the cells of a table.
pub trait Sources: Send + Sync {
    /// The rate f of every cell at time t \[thickness per time\], x fastest; 0 off the table.
    fn rate(&self, t: f64) -> Vec<f64>;
    /// The times after 0 at which a source begins or ends, growing.
    fn changes(&self) -> Vec<f64>;
    /// Rates change at `time` or later, between the times of [`Sources::changes`].
    fn is_moving(&self, time: f64) -> bool;
    /// The rates of the sources that never end; `None` where one of them changes for ever.
    fn lasting(&self) -> Option<Vec<f64>>;
}

impl Sources for Written {
    fn rate(&self, t: f64) -> Vec<f64> {
        Written::rate(self, t)
    }
    fn changes(&self) -> Vec<f64> {
        Written::changes(self)
    }
    fn is_moving(&self, time: f64) -> bool {
        Written::is_moving(self, time)
    }
    fn lasting(&self) -> Option<Vec<f64>> {
        Written::lasting(self)
    }
}

/// Where the cells of a table have their centres and their nodes; nothing along y in one dimension.
pub(crate) struct Places {
    /// Centres along x and y.
    pub centres: [Vec<f64>; 2],
    /// Nodes along x and y.
    pub nodes: [Vec<f64>; 2],
}

impl Places {
    fn of<const D: usize>(plan: &TablePlan<D>) -> Places {
        let pair = |points: &Points| {
            [points.x.to_vec(), points.y.as_ref().map(granflow_case::Places::to_vec).unwrap_or_default()]
        };
        Places { centres: pair(&plan.centres), nodes: pair(&plan.nodes) }
    }
}

/// A table with what is poured on it.
pub(crate) struct Sand<const D: usize> {
    /// The table with sizes and heights.
    pub site: Site<D>,
    /// Where it is.
    pub places: Places,
    /// Standing layer at the nodes, and rolling layer in the cells, at the start.
    pub layers: [Vec<f64>; 2],
    /// What is poured, and when.
    pub sources: Box<dyn Sources>,
    /// The equilibrium, where it is asked for without stepping.
    pub equilibrium: Option<Equilibrium<D>>,
}

impl<const D: usize> Sand<D> {
    pub fn new(
        run: &RunPlan,
        grid: &Grid,
        Pile { table: plan, sources }: Pile<D>,
    ) -> Result<Self, StartError> {
        let axes = [Some(&grid.x), grid.y.as_ref()];
        let size = std::array::from_fn(|k| axes[k].map_or(1.0, Axis::width));
        let origin = std::array::from_fn(|k| axes[k].map_or(0.0, |axis| axis.from));
        let places = Places::of(&plan);
        let TablePlan { table, height, standing, rolling, .. } = plan;
        let site = Site::new(table, origin, size, height);
        let (layers, sources) = ([standing, rolling], Box::new(sources));
        let mut sand = Sand { site, places, layers, sources, equilibrium: None };
        if run.ends.until == Some(Until::Equilibrium) {
            sand.equilibrium = Some(sand.steady(run)?);
        }
        Ok(sand)
    }

    fn steady(&self, run: &RunPlan) -> Result<Equilibrium<D>, StartError> {
        let fault = |key: &str, error: String| {
            run.fault(key, error, "or let it grow: time.until = \"steady\" with an end, and no method")
        };
        let Some(source) = self.sources.lasting() else {
            let message = "a source changes for ever, so nothing is ever steady";
            return Err(fault("time.method", message.into()).into());
        };
        let found = self.site.equilibrium(&source);
        let found = found.map_err(|error: Unsteady<D>| {
            let steep = matches!(error, Unsteady::Steep { .. });
            fault(if steep { "table.height" } else { "time.method" }, error.to_string())
        });
        Ok(found?)
    }

    /// Where its cells and nodes are, for the files.
    pub fn plane(&self) -> Plane {
        let Places { centres: [x, y], nodes: [x_node, y_node] } = &self.places;
        let (table, counts) = (&self.site.table, [x.len(), y.len().max(1)]);
        let walls = |axis: usize| {
            let mut counts = counts;
            counts[axis] += 1;
            let mut walls = vec![false; counts[0] * counts[1]];
            for (edge, _) in table.edges().filter(|(edge, wall)| *wall && edge.axis == axis) {
                walls[edge.index.iter().rev().fold(0, |row, k| row * counts[0] + k)] = true;
            }
            if walls.contains(&true) { walls } else { Vec::new() }
        };
        let index =
            |cell: usize| std::array::from_fn(|k| if k == 0 { cell % x.len() } else { cell / x.len() });
        let flat = self.site.bed.iter().all(|height| *height == 0.0);
        TableDomain {
            x_node: x_node.clone(),
            y_node: y_node.clone(),
            inside: (0..counts[0] * counts[1]).map(|cell| table.inside(index(cell))).collect(),
            height: if flat { Vec::new() } else { self.site.bed.clone() },
            wall_x: walls(0),
            wall_y: if D > 1 { walls(1) } else { Vec::new() },
        }
        .plane(x.clone(), y.clone())
    }

    /// The simulation from the layers at the start, or at the equilibrium if that is known.
    pub fn simulation(
        &self,
        scheme: HadelerKuttler,
        step: StepSize,
    ) -> Result<Simulation<D, HadelerKuttler>, BuildError> {
        let (u, v, time) = match &self.equilibrium {
            Some(found) => (&found.u, &found.v, f64::INFINITY),
            None => (&self.layers[0], &self.layers[1], 0.0),
        };
        self.site.simulation(scheme, step, &self.rates(time), (u, v))
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

    /// The source f in every cell of the table, as it flows now.
    pub fn poured(&self, simulation: &Simulation<D, HadelerKuttler>) -> Vec<f64> {
        let cells = simulation.grid().cells.map(|nodes| nodes - 1);
        let mut values = vec![0.0; cells.iter().product()];
        simulation.fill(cells[0], 0, &mut values, |cell: &CellOf<D, HadelerKuttler>| {
            cell.forcing.split.iter().sum()
        });
        values
    }

    /// What one step of the first-order scheme would change at the equilibrium: max |u_t|, max |v_t|.
    pub fn residual(&self, simulation: &Simulation<D, HadelerKuttler>) -> [f64; 2] {
        let step = StepSize::Courant(0.45);
        let (ground, state) = (|index| simulation.ground(index), |index| simulation.state(index));
        let step = Simulation::new(FIRST_ORDER, self.site.grid(), step, ground, state);
        let Ok(mut step) = step else { return [f64::NAN; 2] };
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
