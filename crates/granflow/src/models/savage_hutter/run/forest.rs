//! A forest that breaks under the pressure of the flow and resists it no more.

use super::between::BetweenSteps;
use super::parameters::InCells;
use super::supply::REACHES;
use crate::run::{Maps, Numbers};
use granflow_engine::simulation::Simulation;
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::friction::Parameters;
use granflow_model::savage_hutter::ground::Bed;
use granflow_model::scheme::Scheme;
use std::borrow::Cow;
use std::sync::Arc;

/// A forest that can break.
pub(super) struct Forest {
    /// Density of the flow \[kg/m^3\].
    density: f64,
    /// The dynamic pressure rho |V|^2 that breaks it \[Pa\].
    strength: f64,
    /// What stands in each cell at the start.
    parameters: Arc<InCells>,
    /// The time at which it broke in each cell; not a number where it stands or there is none.
    broken: Vec<f64>,
}

impl Forest {
    /// One that breaks under the pressure `strength` \[Pa\] of a flow of this density \[kg/m^3\].
    pub fn of(strength: f64, density: f64, parameters: Arc<InCells>) -> Self {
        let broken = vec![f64::NAN; parameters.count()];
        Forest { density, strength, parameters, broken }
    }
}

impl<S> BetweenSteps<2, S> for Forest
where
    S: Scheme<2, f64, State = Flow<2, f64>, Forcing = Parameters<f64>>,
    S::Ground: Bed<2, f64>,
{
    fn act(&mut self, simulation: &mut Simulation<2, S>, _dt: f64) {
        let (time, columns) = (simulation.time(), simulation.grid().cells[0]);
        let broken = simulation.of_moving(|[i, j], here| {
            let pressure = self.density * here.ground.square(here.state.velocity());
            let breaks = here.forcing.drag > 0.0
                && pressure > self.strength
                && here.ground.thickness(here.state.h) >= REACHES;
            breaks.then_some(j * columns + i)
        });
        for cell in &broken {
            self.broken[*cell] = time;
        }
        let grid = *simulation.grid();
        simulation.apply_to(broken.into_iter().map(|cell| grid.index(cell)), Parameters::on_bare_bed);
    }

    fn save(&self) -> Cow<'_, [f64]> {
        Cow::Borrowed(&self.broken)
    }

    fn restore(&mut self, simulation: &mut Simulation<2, S>, saved: &[f64]) -> bool {
        self.broken.copy_from_slice(saved);
        let columns = simulation.grid().cells[0];
        simulation.apply(|[i, j], _| {
            let cell = j * columns + i;
            let standing = self.parameters.at(cell);
            if self.broken[cell].is_nan() { standing } else { standing.on_bare_bed() }
        });
        true
    }

    fn numbers(&self, simulation: &Simulation<2, S>) -> Numbers {
        let cells = self.broken.iter().filter(|time| !time.is_nan()).count();
        vec![("forest_broken_area".to_owned(), cells as f64 * simulation.grid().measure())]
    }

    fn maps(&self) -> Maps {
        vec![("forest_broken", self.broken.clone())]
    }
}
