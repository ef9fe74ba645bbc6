//! What the files of a run show of each model, and how its sources flow.

use crate::hadeler_kuttler::scheme::HadelerKuttler;
use crate::output::summary::Summary;
use crate::results::Plane;
use crate::savage_hutter::Flow;
use crate::savage_hutter::ground::Bed;
use crate::scheme::Scheme;
use crate::setup::Sand;
use crate::simulation::Simulation;

/// Maps by name, x fastest.
pub(super) type Maps = Vec<(&'static str, Vec<f64>)>;

/// A model as a run sees it.
pub(super) trait Model<const D: usize>: Scheme<D, f64> + Sized {
    /// Are peaks and times of every cell kept?
    const PEAKS: bool;

    /// The fields of a frame, in the order of [`Plane::series`].
    fn frame(simulation: &Simulation<D, Self>, plane: &Plane) -> Vec<Vec<f64>>;
    /// The maps of the end, beyond peaks and times.
    fn maps(simulation: &mut Simulation<D, Self>, sand: Option<&Sand<D>>) -> Maps;
    /// The figures of the summary that only this model has, and those that it has not.
    fn sum_up(simulation: &Simulation<D, Self>, sand: Option<&Sand<D>>, summary: &mut Summary);
    /// Let the sources flow as they do at `time`.
    fn pour(simulation: &mut Simulation<D, Self>, sand: &Sand<D>, time: f64);
}

impl<const D: usize, S> Model<D> for S
where
    S: Scheme<D, f64, State = Flow<D, f64>>,
    S::Ground: Bed<D, f64>,
{
    const PEAKS: bool = true;

    fn frame(simulation: &Simulation<D, S>, plane: &Plane) -> Vec<Vec<f64>> {
        let mut series = vec![Vec::with_capacity(simulation.grid().count()); plane.series().len()];
        for number in 0..simulation.grid().count() {
            let cell = simulation.cell(simulation.grid().index(number));
            let u = cell.state.velocity();
            let thickness = cell.ground.thickness(cell.state.h);
            series[0].push(thickness);
            for k in 0..D {
                series[1 + k].push(u[k]);
            }
            if let Some(bed) = plane.bed() {
                let cos = cell.ground.thickness(1.0);
                series[1 + D].push(bed[number] + cos * thickness);
                series[2 + D].push(cell.ground.square(u).sqrt());
            }
        }
        series
    }
    fn maps(simulation: &mut Simulation<D, S>, _sand: Option<&Sand<D>>) -> Maps {
        let deposit = simulation.collect(|cell| cell.ground.thickness(cell.state.h));
        vec![("deposit", deposit), ("yield_margin", simulation.margins())]
    }
    fn sum_up(simulation: &Simulation<D, S>, _sand: Option<&Sand<D>>, summary: &mut Summary) {
        let totals = simulation.totals();
        summary.add("kinetic_energy_final", totals.energy);
        summary.add("moving_cells_final", totals.moving as f64);
        summary.add("film_share", if totals.volume == 0.0 { 0.0 } else { totals.film / totals.volume });
    }
    fn pour(_simulation: &mut Simulation<D, S>, _sand: &Sand<D>, _time: f64) {}
}

impl<const D: usize> Model<D> for HadelerKuttler {
    const PEAKS: bool = false;

    fn frame(simulation: &Simulation<D, Self>, plane: &Plane) -> Vec<Vec<f64>> {
        let table = plane.as_table();
        let mut u = simulation.collect(|cell| cell.state.u);
        let mut v = in_cells(simulation, |cell| cell.state.v);
        for layer in [&mut u, &mut v] {
            table.iter().for_each(|table| table.blank(layer));
        }
        vec![u, v]
    }
    fn maps(simulation: &mut Simulation<D, Self>, sand: Option<&Sand<D>>) -> Maps {
        let mut maps = vec![("source", in_cells(simulation, |cell| cell.ground.source.iter().sum()))];
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

/// A value of every cell of a table, of which the grid of the scheme has one more along each axis.
fn in_cells<const D: usize>(
    simulation: &Simulation<D, HadelerKuttler>,
    value: impl Fn(
        &crate::scheme::Cell<crate::hadeler_kuttler::Pile<f64>, crate::hadeler_kuttler::Ground<D, f64>>,
    ) -> f64,
) -> Vec<f64> {
    let grid = simulation.grid();
    let within = |index: &[usize; D]| (0..D).all(|k| index[k] + 1 < grid.cells[k]);
    let cells = (0..grid.count()).map(|number| grid.index(number)).filter(within);
    cells.map(|index| value(&simulation.cell(index))).collect()
}
