//! The Savage-Hutter equations as a run shows them: thickness and velocity, peaks and times.

use super::between::BetweenSteps;
use crate::run::{CellOf, Field, Laws, Maps, Numbers, Physics, Record, Value};
use granflow_case::avalanche::SchemeName;
use granflow_case::{chute, terrain};
use granflow_engine::simulation::Simulation;
use granflow_model::real::CompensatedSum;
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::ground::Bed;
use granflow_model::scheme::Scheme;
use std::borrow::Cow;

/// Verfahren 5 does not conserve mass. The published runs gain up to 0.4 %; beyond ten times that nothing is left of its result.
const VERFAHREN_5: f64 = 0.04;

/// A scheme for flowing mass, under the name by which a case asks for it.
pub struct Flowing<const D: usize, S: Scheme<D, f64>> {
    name: &'static str,
    film: f64,
    threshold: f64,
    /// The bed has an elevation: surface and speed are shown too.
    on_terrain: bool,
    /// What acts between two steps, in this order.
    between: Vec<Box<dyn BetweenSteps<D, S>>>,
    /// The time up to which it has acted.
    until: f64,
    /// mu, if it was chosen by the volume.
    chosen: Option<f64>,
}

impl<const D: usize, S: Scheme<D, f64>> Flowing<D, S> {
    /// Under this name; a thinner layer than `film` is held. The threshold is the one of a case that says none.
    pub fn new(name: &'static str, film: f64, on_terrain: bool) -> Self {
        let threshold = if on_terrain { terrain::THRESHOLD } else { chute::THRESHOLD };
        Flowing { name, film, threshold, on_terrain, between: Vec::new(), until: 0.0, chosen: None }
    }
    /// The same, where a layer counts in peaks, times and deposit if it is thicker than `threshold` (units of
    /// the thickness, normal to the bed).
    #[must_use]
    pub fn with_threshold(self, threshold: f64) -> Self {
        Flowing { threshold, ..self }
    }
    /// The same with what acts between two steps, and with mu if that was chosen by the volume.
    pub(super) fn with(self, between: Vec<Box<dyn BetweenSteps<D, S>>>, chosen: Option<f64>) -> Self {
        Flowing { between, chosen, ..self }
    }
}

/// Thickness normal to the bed.
fn thickness<const D: usize, S>(cell: &CellOf<D, S>) -> f64
where
    S: Scheme<D, f64, State = Flow<D, f64>>,
    S::Ground: Bed<D, f64>,
{
    cell.ground.thickness(cell.state.h)
}

impl<const D: usize, S> Physics<D> for Flowing<D, S>
where
    S: Scheme<D, f64, State = Flow<D, f64>> + 'static,
    S::Ground: Bed<D, f64>,
{
    type Scheme = S;

    fn scheme(&self) -> &str {
        self.name
    }
    fn fields(&self) -> Vec<Field<D, S>> {
        let field = |name, value: Value<D, S>| Field { name, value, short: 0 };
        // On a chute the thickness is the first unknown itself.
        let own = Value::Component(0);
        let mut fields =
            vec![field("thickness", if self.on_terrain { Value::of(thickness::<D, S>) } else { own })];
        fields.push(field("velocity_x", Value::<D, S>::of(|cell| cell.state.velocity()[0])));
        if D > 1 {
            fields.push(field("velocity_y", Value::<D, S>::of(|cell| cell.state.velocity()[D - 1])));
        }
        if self.on_terrain {
            let surface = |cell: &CellOf<D, S>| {
                cell.ground.elevation() + cell.ground.thickness(1.0) * thickness::<D, S>(cell)
            };
            fields.push(field("surface", Value::of(surface)));
            let speed = |cell: &CellOf<D, S>| cell.ground.square(cell.state.velocity()).sqrt();
            fields.push(field("speed", Value::of(speed)));
        }
        fields
    }
    fn threshold(&self) -> f64 {
        self.threshold
    }
    fn prepare(&mut self, simulation: &mut Simulation<D, S>, _until: f64) -> f64 {
        self.bring(simulation);
        self.between.iter().map(|one| one.next(simulation)).fold(f64::INFINITY, f64::min)
    }
    fn bring(&mut self, simulation: &mut Simulation<D, S>) {
        let dt = simulation.time() - self.until;
        self.until = simulation.time();
        self.between.iter_mut().for_each(|one| one.act(simulation, dt));
    }
    fn came(&self) -> f64 {
        self.between.iter().map(|one| one.came()).fold(0.0, f64::max)
    }
    fn save(&self) -> Vec<Cow<'_, [f64]>> {
        if self.between.is_empty() {
            return Vec::new();
        }
        let until = Cow::Owned(vec![self.until]);
        std::iter::once(until).chain(self.between.iter().map(|one| one.save())).collect()
    }
    fn restore(&mut self, simulation: &mut Simulation<D, S>, saved: &[Cow<'static, [f64]>]) -> bool {
        let fits = self.save().iter().map(|list| list.len()).eq(saved.iter().map(|list| list.len()));
        if !fits {
            return false;
        }
        let Some((until, lists)) = saved.split_first() else { return true };
        self.until = until[0];
        self.between.iter_mut().zip(lists).all(|(one, list)| one.restore(simulation, list))
    }
    fn is_settled(&self, time: f64) -> bool {
        self.between.iter().all(|one| one.is_settled(time))
    }
    fn is_held(&self) -> bool {
        self.between.iter().any(|one| one.is_held())
    }
    fn laws(&self) -> Laws {
        // It chooses a flux for each cell, so that the two sides of a face may differ (errata, 5).
        let changes = self.name == SchemeName::Verfahren5.as_str();
        let laws = Laws { layers: 1, ..Laws::default() };
        if changes { Laws { mass_error: VERFAHREN_5, ..laws } } else { laws }
    }
    fn flows(&self, simulation: &Simulation<D, S>, trickle: f64) -> bool {
        simulation.any(|cell| !cell.state.is_still() && !cell.state.is_trickle(&cell.ground, trickle))
    }
    fn trickle_volume(&self, simulation: &Simulation<D, S>, trickle: Option<f64>) -> Option<f64> {
        let usual = if self.on_terrain { terrain::TRICKLE } else { chute::TRICKLE };
        let thickness = trickle.unwrap_or(usual);
        let grid = simulation.grid();
        let (mut volume, mut part) = (CompensatedSum::default(), [0.0; 4096]);
        for from in (0..grid.count()).step_by(part.len()) {
            let values = &mut part[..(grid.count() - from).min(4096)];
            simulation.fill(grid.cells[0], from, values, |cell| {
                let trickles = !cell.state.is_still() && cell.state.is_trickle(&cell.ground, thickness);
                if trickles { cell.state.h } else { 0.0 }
            });
            values.iter().for_each(|value| volume.add(*value));
        }
        Some(volume.value() * grid.measure())
    }
    fn elevation(&self, simulation: &Simulation<D, S>) -> Vec<f64> {
        simulation.map(|cell| cell.ground.elevation())
    }
    fn maps(&self, simulation: &mut Simulation<D, S>) -> Maps {
        let threshold = self.threshold;
        let deposit = simulation.map(|cell| match thickness::<D, S>(cell) {
            h if h > threshold => h,
            _ => f64::NAN,
        });
        let mut margin = simulation.yield_ratios();
        for (margin, _) in margin.iter_mut().zip(&deposit).filter(|(_, h)| h.is_nan()) {
            *margin = f64::NAN;
        }
        let own = [("deposit", deposit), ("yield_margin", margin)];
        own.into_iter().chain(self.between.iter().flat_map(|one| one.maps())).collect()
    }
    fn numbers(&self, simulation: &Simulation<D, S>, _drift: &[f64], record: &Record) -> Numbers {
        let totals = simulation.totals();
        let whole = record.initial + simulation.poured();
        let share = if whole == 0.0 { 0.0 } else { totals.film / whole };
        let mut numbers = vec![
            ("film".to_owned(), self.film),
            ("film_share".to_owned(), share),
            ("kinetic_energy_final".to_owned(), totals.energy),
            ("moving_cells_final".to_owned(), totals.moving as f64),
            ("moving_volume_final".to_owned(), totals.moving_volume),
        ];
        numbers.extend(self.chosen.map(|mu| ("friction_mu".to_owned(), mu)));
        numbers.extend(self.between.iter().flat_map(|one| one.numbers(simulation)));
        if record.flowed > 0.0 {
            numbers.push(("flowed_until".to_owned(), record.flowed));
        }
        numbers
    }
}
