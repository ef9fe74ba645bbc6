//! What the files of a run show of each model, and how its sources flow.

use crate::hadeler_kuttler::scheme::HadelerKuttler;
use crate::hadeler_kuttler::{Ground, Pile, Source};
use crate::kernels::Kernel;
use crate::output::summary::Summary;
use crate::results::Plane;
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Balanced;
use crate::savage_hutter::friction::Law;
use crate::savage_hutter::ground::{Bed, Chute, Terrain};
use crate::savage_hutter::kinetic::Kinetic;
use crate::scheme::Cell;
use crate::setup::Sand;
use crate::simulation::Simulation;

/// Maps by name, x fastest.
pub type Maps = Vec<(&'static str, Vec<f64>)>;

/// A model as a run sees it.
pub trait Model<const D: usize>: Kernel<D> + Sized {
    /// Are peaks and times of every cell kept?
    const PEAKS: bool;

    /// As many numbers of a field of a frame as `values` holds, from number `from` on; fields as in [`Plane::series`].
    fn fill(simulation: &Simulation<D, Self>, plane: &Plane, field: usize, from: usize, values: &mut [f64]);
    /// Elevation of the bed under every cell \[m\], where the grounds know it.
    fn elevation(_simulation: &Simulation<D, Self>) -> Vec<f64> {
        Vec::new()
    }
    /// The maps of the end, beyond peaks and times.
    fn maps(simulation: &mut Simulation<D, Self>, sand: Option<&Sand<D>>) -> Maps;
    /// The figures of the summary that only this model has, and those that it has not.
    fn sum_up(simulation: &Simulation<D, Self>, sand: Option<&Sand<D>>, summary: &mut Summary);
    /// Let the sources flow as they do at `time`.
    fn pour(simulation: &mut Simulation<D, Self>, sand: &Sand<D>, time: f64);
}

macro_rules! flows {
    ($($scheme:ty),*) => {$(
impl<const D: usize> Model<D> for $scheme {
    const PEAKS: bool = true;

    fn fill(simulation: &Simulation<D, Self>, _plane: &Plane, field: usize, from: usize, values: &mut [f64]) {
        let columns = simulation.grid().cells[0];
        match field {
            0 => simulation.fill(columns, from, values, thickness),
            k if k <= D => simulation.fill(columns, from, values, |cell| cell.state.velocity()[k - 1]),
            k if k == D + 1 => simulation.fill(columns, from, values, |cell| {
                cell.ground.elevation() + cell.ground.thickness(1.0) * thickness(cell)
            }),
            _ => {
                simulation
                    .fill(columns, from, values, |cell| cell.ground.square(cell.state.velocity()).sqrt());
            }
        }
    }
    fn elevation(simulation: &Simulation<D, Self>) -> Vec<f64> {
        simulation.map(|cell| cell.ground.elevation())
    }
    fn maps(simulation: &mut Simulation<D, Self>, _sand: Option<&Sand<D>>) -> Maps {
        let deposit = simulation.map(thickness);
        vec![("deposit", deposit), ("yield_margin", simulation.yield_ratios())]
    }
    fn sum_up(simulation: &Simulation<D, Self>, _sand: Option<&Sand<D>>, summary: &mut Summary) {
        let totals = simulation.totals();
        summary.add("kinetic_energy_final", totals.energy);
        summary.add("moving_cells_final", totals.moving as f64);
        summary.add("film_share", if totals.volume == 0.0 { 0.0 } else { totals.film / totals.volume });
    }
    fn pour(_simulation: &mut Simulation<D, Self>, _sand: &Sand<D>, _time: f64) {}
}
    )*};
}
flows!(Kinetic, Balanced<Law, Chute<D, f64>>, Balanced<Law, Terrain<D, f64>>);

impl<const D: usize> Model<D> for HadelerKuttler {
    const PEAKS: bool = false;

    fn fill(simulation: &Simulation<D, Self>, plane: &Plane, field: usize, from: usize, values: &mut [f64]) {
        let nodes = simulation.grid().cells[0];
        match field {
            0 => simulation.fill(nodes, from, values, |cell| cell.state.u),
            _ => simulation.fill(nodes - 1, from, values, |cell| cell.state.v),
        }
        if let Some(table) = plane.as_table() {
            let length = if field == 0 { table.nodes() } else { table.inside.len() };
            table.blank_part(length, from, values);
        }
    }
    fn maps(simulation: &mut Simulation<D, Self>, sand: Option<&Sand<D>>) -> Maps {
        let mut maps = vec![("source", in_cells(simulation, |cell| cell.forcing.split.iter().sum()))];
        if let Some(found) = sand.and_then(|sand| sand.equilibrium.as_ref()) {
            maps.push(("determined", found.determined.iter().map(|yes| f64::from(*yes)).collect()));
        }
        maps
    }
    fn sum_up(simulation: &Simulation<D, Self>, sand: Option<&Sand<D>>, summary: &mut Summary) {
        // A rolling layer has a thickness here; its speed is the slope, at most 1.
        let (v_end, v_most) = (summary.max_speed_final, summary.max_speed);
        (summary.max_speed_final, summary.max_speed) = (f64::NAN, f64::NAN);
        summary.add("rolling_layer_max_final", v_end);
        summary.add("rolling_layer_max", v_most);
        summary.add(
            "standing_layer_max",
            simulation.collect(|cell| cell.state.u).into_iter().fold(0.0, f64::max),
        );
        summary.add("rolling_cells_final", simulation.totals().moving as f64);
        summary.add("source_rate_final", simulation.supply());
        let direct = sand.filter(|sand| sand.equilibrium.is_some());
        let [u, v] = match direct {
            Some(sand) => sand.residual(simulation),
            None => [simulation.drift()[0], simulation.drift()[1]],
        };
        summary.add("standing_layer_rate", u);
        summary.add("rolling_layer_rate", v);
        if let Some(outflow) = direct.and_then(Sand::outflow) {
            let names = ["left", "right", "bottom", "top", "hole"];
            names
                .iter()
                .zip(outflow)
                .for_each(|(name, rate)| summary.add(&format!("outflow_rate_{name}"), rate));
        }
    }
    fn pour(simulation: &mut Simulation<D, Self>, sand: &Sand<D>, time: f64) {
        sand.pour(simulation, time);
    }
}

/// Thickness normal to the bed.
fn thickness<const D: usize, G: Bed<D, f64>>(cell: &Cell<Flow<D, f64>, G>) -> f64 {
    cell.ground.thickness(cell.state.h)
}

/// A value of every cell of a table, of which the grid of the scheme has one more along each axis.
fn in_cells<const D: usize>(
    simulation: &Simulation<D, HadelerKuttler>,
    value: impl Fn(&Cell<Pile<f64>, Ground<D, f64>, Source<D, f64>>) -> f64,
) -> Vec<f64> {
    let cells = simulation.grid().cells.map(|nodes| nodes - 1);
    let mut values = vec![0.0; cells.iter().product()];
    simulation.fill(cells[0], 0, &mut values, value);
    values
}
