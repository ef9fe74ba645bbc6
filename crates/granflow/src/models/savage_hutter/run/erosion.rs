//! An erodible layer, which a flow picks up between two steps: mass at rest, so that the momentum of the flow stays.

use super::between::BetweenSteps;
use super::parameters::InCells;
use super::supply::{REACHES, give};
use crate::run::{Maps, Numbers};
use granflow_case::terrain::Entrainment;
use granflow_engine::simulation::Simulation;
use granflow_geo::raster::Raster;
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::erosion::{ErodibleLayer, Erosion, FlowOver};
use granflow_model::savage_hutter::friction::{AnyLaw, LocalFriction};
use granflow_model::savage_hutter::ground::{Bed, Terrain};
use granflow_model::scheme::Scheme;
use std::borrow::Cow;
use std::sync::Arc;

/// An erodible layer on a mountain.
pub(super) struct Erodible {
    law: Erosion,
    /// What resists the flow at the bed.
    friction: AnyLaw,
    parameters: Arc<InCells>,
    /// Density of the flow and of the layer \[kg/m^3\].
    densities: [f64; 2],
    /// Depth of the layer at the start in every cell, normal to the bed \[m\]; 0 outside the data.
    whole: Vec<f64>,
    /// Depth taken so far \[m\].
    taken: Vec<f64>,
    /// Elevation of the bed at the start \[m\], where it sinks; empty where it does not.
    level: Vec<f64>,
}

impl Erodible {
    /// Of these depths, under a flow of this density \[kg/m^3\] and law.
    pub fn of(
        entrainment: &Entrainment,
        whole: Vec<f64>,
        (friction, parameters): (AnyLaw, Arc<InCells>),
        density: f64,
        bed: &Raster,
    ) -> Self {
        Erodible {
            law: entrainment.law,
            friction,
            parameters,
            densities: [density, entrainment.density],
            level: if entrainment.lower_bed { bed.values.clone() } else { Vec::new() },
            taken: vec![0.0; whole.len()],
            whole,
        }
    }

    /// The depth that the flow of a cell takes in `dt`, if it takes any.
    fn depth(
        &self,
        cell: usize,
        bed: &Terrain<2, f64>,
        state: &Flow<2, f64>,
        size: f64,
        dt: f64,
    ) -> Option<f64> {
        let [density, of_layer] = self.densities;
        let layer = ErodibleLayer { whole: self.whole[cell], taken: self.taken[cell], density: of_layer };
        let thickness = bed.thickness(state.h);
        if layer.taken >= layer.whole || thickness < REACHES {
            return None;
        }
        let velocity = state.velocity();
        let square = bed.square(velocity);
        let (speed, here) = (square.sqrt(), self.parameters.at(cell).on_bare_bed());
        let (load, weight) = (bed.normal_load(velocity), bed.weight_at_rest());
        let law = self.friction.resistance_with(&here, thickness, square, load, weight);
        // What grows with the speed is known as a step has it, by what it leaves of the speed.
        let kept = self.friction.kept(&here, &law, thickness, speed, dt);
        let stress = density * thickness * (law.dry + speed * (1.0 - kept) / dt);
        let depth = self.law.depth(&layer, &FlowOver { thickness, speed, stress, density, size }, dt);
        (depth > 0.0).then_some(depth)
    }

    /// The ground of a cell as it is after what was taken.
    fn ground(&self, cell: usize, bed: Terrain<2, f64>) -> Terrain<2, f64> {
        Terrain { level: self.level[cell] - self.taken[cell] / bed.thickness(1.0), ..bed }
    }

    /// Lower the bed in these cells, if it sinks.
    fn lower<S>(&self, simulation: &mut Simulation<2, S>, cells: impl Iterator<Item = usize>)
    where
        S: Scheme<2, f64, State = Flow<2, f64>, Ground = Terrain<2, f64>>,
    {
        if self.level.is_empty() {
            return;
        }
        let grid = *simulation.grid();
        let grounds: Vec<_> = cells
            .map(|cell| (grid.index(cell), self.ground(cell, simulation.ground(grid.index(cell)))))
            .collect();
        simulation.replace_grounds(grounds);
    }
}

impl<S> BetweenSteps<2, S> for Erodible
where
    S: Scheme<2, f64, State = Flow<2, f64>, Ground = Terrain<2, f64>>,
{
    fn act(&mut self, simulation: &mut Simulation<2, S>, dt: f64) {
        if dt <= 0.0 {
            return;
        }
        let columns = simulation.grid().cells[0];
        let size = simulation.grid().size[0];
        let taken = simulation.of_moving(|[i, j], here| {
            let cell = j * columns + i;
            let depth = self.depth(cell, &here.ground, &here.state, size, dt)?;
            // Not beyond the whole by a rounding.
            let all = (self.taken[cell] + depth).min(self.whole[cell]);
            let volume = (all - self.taken[cell]) / here.ground.thickness(1.0);
            let h = here.state.h + volume * (self.densities[1] / self.densities[0]);
            Some((cell, all, ([i, j], Flow { h, ..here.state })))
        });
        for (cell, all, _) in &taken {
            self.taken[*cell] = *all;
        }
        self.lower(simulation, taken.iter().map(|(cell, ..)| *cell));
        give(simulation, taken.into_iter().map(|(_, _, state)| state).collect());
    }

    fn save(&self) -> Cow<'_, [f64]> {
        Cow::Borrowed(&self.taken)
    }

    fn restore(&mut self, simulation: &mut Simulation<2, S>, saved: &[f64]) -> bool {
        self.taken.copy_from_slice(saved);
        self.lower(simulation, (0..self.whole.len()).filter(|cell| self.whole[*cell] > 0.0));
        true
    }

    fn numbers(&self, simulation: &Simulation<2, S>) -> Numbers {
        let grid = simulation.grid();
        let cells = self.taken.iter().enumerate().filter(|(_, depth)| **depth > 0.0);
        let volumes = cells.map(|(cell, depth)| depth / simulation.ground(grid.index(cell)).thickness(1.0));
        // The sum of none is -0.
        let volume = (0.0 + volumes.sum::<f64>()) * grid.measure();
        vec![("eroded_volume".to_owned(), volume), ("eroded_mass".to_owned(), volume * self.densities[1])]
    }

    fn maps(&self) -> Maps {
        let cells = self.taken.iter();
        vec![("eroded_depth", cells.map(|depth| if *depth > 0.0 { *depth } else { f64::NAN }).collect())]
    }
}
