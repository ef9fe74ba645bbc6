//! A growing sandpile as a run shows it: the two layers, and sources that flow, switch and move.

use super::super::TableDomain;
use super::sand::Sand;
use crate::model::Domain;
use crate::run::{CellOf, Field, Laws, Maps, Numbers, Physics, Record, Value};
use granflow_engine::simulation::Simulation;
use granflow_model::hadeler_kuttler::scheme::HadelerKuttler;
use std::borrow::Cow;
use std::sync::Arc;

/// A table with what is poured on it, since when that flows as it does now, and until when.
pub(crate) struct Pouring<const D: usize> {
    sand: Sand<D>,
    table: Arc<dyn Domain>,
    scheme: &'static str,
    poured_at: f64,
    changes_at: f64,
}

impl<const D: usize> Pouring<D> {
    pub fn new(sand: Sand<D>, table: Arc<dyn Domain>, scheme: &'static str) -> Self {
        Pouring { sand, table, scheme, poured_at: f64::NEG_INFINITY, changes_at: f64::NEG_INFINITY }
    }
    /// Let the sources flow as they do at `time`.
    fn pour(&mut self, simulation: &mut Simulation<D, HadelerKuttler>, time: f64) {
        self.sand.pour(simulation, time);
        self.poured_at = time;
    }
    /// The first time after `time` at which a source begins or ends.
    fn change_after(&self, time: f64) -> f64 {
        let changes = self.sand.sources.changes();
        changes.into_iter().find(|change| *change > time).unwrap_or(f64::INFINITY)
    }
}

impl<const D: usize> Physics<D> for Pouring<D> {
    type Scheme = HadelerKuttler;

    fn scheme(&self) -> &str {
        if self.is_equilibrium() { "direct" } else { self.scheme }
    }
    fn fields(&self) -> Vec<Field<D, HadelerKuttler>> {
        // The engine's grid has a column and a row for nodes only.
        vec![
            Field { name: "standing_layer", value: Value::Component(0), short: 0 },
            Field { name: "rolling_layer", value: Value::Component(1), short: 1 },
        ]
    }
    fn has_speed(&self) -> bool {
        false
    }

    /// Let the sources flow as they will in the next step.
    fn prepare(&mut self, simulation: &mut Simulation<D, HadelerKuttler>, until: f64) -> f64 {
        let (time, adaptive) = (simulation.time(), simulation.is_adaptive());
        // The middle of the step: second order where a rate varies, and the better side of a change within a fixed step.
        let half = 0.5 * simulation.wanted_step().min(until - time);
        if self.sand.sources.is_moving(time) {
            let next = self.change_after(time);
            let middle = if adaptive { time + half.min(0.5 * (next - time)) } else { time + half };
            self.pour(simulation, middle);
            return next;
        }
        let now = if adaptive { time } else { time + half };
        if now >= self.changes_at && self.sand.equilibrium.is_none() {
            self.pour(simulation, now);
            self.changes_at = self.change_after(now);
        }
        self.changes_at
    }

    fn save(&self) -> Vec<Cow<'_, [f64]>> {
        vec![Cow::Owned(vec![self.poured_at, self.changes_at])]
    }
    fn restore(
        &mut self,
        simulation: &mut Simulation<D, HadelerKuttler>,
        saved: &[Cow<'static, [f64]>],
    ) -> bool {
        let [times] = saved else { return false };
        let [poured_at, changes_at] = **times else { return false };
        if self.sand.equilibrium.is_none() {
            // Before its first step a pile has the sources of time 0.
            self.pour(simulation, poured_at.max(0.0));
        }
        (self.poured_at, self.changes_at) = (poured_at, changes_at);
        true
    }
    fn is_settled(&self, time: f64) -> bool {
        let sources = &self.sand.sources;
        !sources.is_moving(time) && sources.changes().iter().all(|change| *change <= time)
    }

    fn laws(&self) -> Laws {
        Laws { layers: 2, ..Laws::default() }
    }
    fn blanks(&self) -> bool {
        true
    }
    fn blank(&self, field: usize, from: usize, values: &mut [f64]) {
        let Some(table) = self.table.get::<TableDomain>() else { return };
        let length = if field == 0 { table.nodes() } else { table.inside.len() };
        table.blank_part(length, from, values);
    }
    fn is_steady(&self, simulation: &Simulation<D, HadelerKuttler>, drift: &[f64], rate: f64) -> bool {
        self.is_settled(simulation.time()) && drift.iter().all(|drift| *drift < rate)
    }
    fn is_equilibrium(&self) -> bool {
        self.sand.equilibrium.is_some()
    }

    fn maps(&self, simulation: &mut Simulation<D, HadelerKuttler>) -> Maps {
        let mut maps = vec![("source", self.sand.poured(simulation))];
        if let Some(found) = &self.sand.equilibrium {
            maps.push(("determined", found.determined.iter().map(|yes| f64::from(*yes)).collect()));
        }
        maps
    }
    fn numbers(&self, simulation: &Simulation<D, HadelerKuttler>, drift: &[f64], record: &Record) -> Numbers {
        let totals = simulation.totals();
        let standing = simulation.collect(|cell: &CellOf<D, HadelerKuttler>| cell.state.u);
        let [u, v] = match &self.sand.equilibrium {
            Some(_) => self.sand.residual(simulation),
            None => [drift[0], drift[1]],
        };
        // The largest "speed" of this scheme is the thickness of the rolling layer: its speed is the slope, at most 1.
        let mut numbers: Numbers = [
            ("rolling_layer_max_final", totals.speed),
            ("rolling_layer_max", record.peak_speed),
            ("standing_layer_max", standing.into_iter().fold(0.0, f64::max)),
            ("rolling_cells_final", totals.moving as f64),
            ("source_rate_final", simulation.supply()),
            ("standing_layer_rate", u),
            ("rolling_layer_rate", v),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .to_vec();
        let outflow = self.sand.outflow().into_iter().flatten();
        let names = ["left", "right", "bottom", "top", "hole"];
        numbers.extend(names.iter().zip(outflow).map(|(name, rate)| (format!("outflow_rate_{name}"), rate)));
        numbers
    }
}
