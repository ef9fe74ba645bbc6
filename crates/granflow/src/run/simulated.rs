//! A simulation of the engine as a [`Run`]: what a model adds to its scheme is its [`Physics`].

mod exceeded;
mod physics;

pub use physics::{CellOf, Field, Numbers, Physics, Value};

use super::durations::{Duration as Exceedance, Exceeded};
use super::passage::Passages;
use super::{Face, Failure, FieldView, Laws, Maps, Passage, Record, Run, Saved, Totals, trickle};
use crate::model::Plane;
use granflow_engine::Stepper;
use granflow_engine::grid::Layout;
use granflow_engine::simulation::Simulation;
use granflow_model::scheme::Scheme;
use std::borrow::Cow;
use std::time::{Duration, Instant};

/// A simulation with its physics.
pub struct Simulated<const D: usize, P: Physics<D>> {
    simulation: Simulation<D, P::Scheme>,
    physics: P,
    fields: Vec<Field<D, P::Scheme>>,
    plane: Plane,
    record: Record,
    tracks_energy: bool,
    /// Thickness of a trickle, if that is looked for.
    trickle: Option<f64>,
    /// For how long thresholds were exceeded.
    durations: Vec<Exceedance>,
    /// What passes sections, where there are some.
    passages: Passages,
    /// The drift of the step before [`Run::restore`], until the next step.
    restored_drift: Option<Vec<f64>>,
}

impl<const D: usize, P: Physics<D>> Simulated<D, P> {
    /// The run of a simulation whose cells lie on `plane`.
    pub fn new(mut simulation: Simulation<D, P::Scheme>, physics: P, plane: Plane) -> Self {
        if physics.has_speed() {
            simulation.keep_maps(physics.threshold());
        }
        let totals = simulation.totals();
        let record = Record {
            initial: totals.volume,
            peak_speed: simulation.speed(),
            peak_energy: totals.energy,
            energy: totals.energy,
            flowed: 0.0,
            wet_cells: totals.wet,
            stepping: Duration::ZERO,
        };
        let fields = physics.fields();
        Simulated {
            simulation,
            physics,
            fields,
            plane,
            record,
            tracks_energy: false,
            trickle: None,
            durations: Vec::new(),
            passages: Passages::default(),
            restored_drift: None,
        }
    }

    /// A fixed step beyond the Courant number of the scheme: it keeps none of its laws there.
    fn too_long(&self) -> Option<Failure> {
        let simulation = &self.simulation;
        let (dt, max) = (simulation.wanted_step(), simulation.scheme().max_courant());
        let courant = dt * simulation.rate();
        let (step, time) = (simulation.step(), simulation.time());
        let beyond = !simulation.is_adaptive() && courant.is_finite() && courant > max * (1.0 + 1e-9);
        beyond.then_some(Failure::TooLong { step, time, dt, courant, max })
    }

    /// The kinetic energy of the state as it stands, into the record.
    fn note_energy(&mut self) {
        self.record.energy = self.simulation.totals().energy;
        self.record.peak_energy = self.record.peak_energy.max(self.record.energy);
    }

    /// Shape of a field: rows and columns.
    fn shape(&self, field: &Field<D, P::Scheme>) -> [usize; 2] {
        let Layout { columns, rows, .. } = *self.simulation.layout();
        [if D > 1 { rows - field.short } else { rows }, columns - field.short]
    }

    fn value(&self, field: &Field<D, P::Scheme>, from: usize, values: &mut [f64]) {
        let [_, columns] = self.shape(field);
        match &field.value {
            Value::Component(k) => {
                let part = &self.simulation.arrays().components()[*k];
                self.simulation.layout().by_rows(columns, from, values, |place, row| {
                    row.copy_from_slice(&part[place..][..row.len()]);
                });
            }
            Value::Of(fill) => fill(&self.simulation, columns, from, values),
        }
    }
}

impl<const D: usize, P: Physics<D>> Run for Simulated<D, P> {
    fn plane(&self) -> &Plane {
        &self.plane
    }
    fn stepper(&self) -> &dyn Stepper {
        &self.simulation
    }
    fn stepper_mut(&mut self) -> &mut dyn Stepper {
        &mut self.simulation
    }
    fn scheme(&self) -> &str {
        self.physics.scheme()
    }
    fn record(&self) -> &Record {
        &self.record
    }
    fn has_speed(&self) -> bool {
        self.physics.has_speed()
    }
    fn laws(&self) -> Laws {
        self.physics.laws()
    }
    fn track_energy(&mut self) {
        if !std::mem::replace(&mut self.tracks_energy, true) {
            self.note_energy();
        }
    }
    fn track_trickle(&mut self, thickness: f64) {
        self.trickle = Some(thickness);
    }
    fn track_passage(&mut self, sections: Vec<Vec<(Face, f64)>>) {
        self.passages = Passages::through(sections);
    }
    fn track_durations(&mut self, exceeded: &[Exceeded]) {
        let cells = self.plane.cells();
        self.durations = exceeded.iter().map(|one| Exceedance::new(*one, cells)).collect();
        self.note_durations();
    }
    fn passages(&self) -> Vec<Passage> {
        self.passages.at(self.simulation.time())
    }
    fn at_rest(&self) -> bool {
        if self.simulation.is_shown() {
            return false;
        }
        let still = self.simulation.at_rest() || self.simulation.rate() == 0.0 || self.physics.is_held();
        still && self.is_settled()
    }
    fn bring(&mut self) {
        if !self.simulation.is_shown() {
            self.physics.bring(&mut self.simulation);
        }
    }
    fn is_settled(&self) -> bool {
        self.physics.is_settled(self.simulation.time())
    }
    fn came(&self) -> f64 {
        self.physics.came()
    }

    fn step(&mut self, until: f64) -> Result<f64, Failure> {
        self.simulation.show_end();
        let change = self.physics.prepare(&mut self.simulation, until);
        let until = if self.simulation.is_adaptive() { until.min(change) } else { until };
        if !self.simulation.wanted_step().is_finite() && !until.is_finite() {
            return Ok(f64::INFINITY);
        }
        if let Some(failure) = self.too_long() {
            return Err(failure);
        }
        if !self.passages.is_empty() {
            // The state before every step: what passed in it is found from that.
            self.simulation.expect(f64::NEG_INFINITY);
        }
        let (begin, begun) = (self.simulation.time(), Instant::now());
        let advanced = self.simulation.advance(until);
        self.record.stepping += begun.elapsed();
        self.restored_drift = None;
        let dt = advanced?;
        self.passages.take(&mut self.simulation, begin);
        self.note_durations();
        self.record.peak_speed = self.record.peak_speed.max(self.simulation.speed());
        if self.tracks_energy {
            self.simulation.take_sums();
            self.note_energy();
        }
        if let Some(thickness) = self.trickle
            && trickle::is_due(self.simulation.step())
            && self.physics.flows(&self.simulation, thickness)
        {
            self.record.flowed = self.simulation.time();
        }
        Ok(dt)
    }
    fn is_steady(&self, rate: f64) -> bool {
        self.physics.is_steady(&self.simulation, self.drift(), rate)
    }
    fn drift(&self) -> &[f64] {
        self.restored_drift.as_deref().unwrap_or_else(|| self.simulation.drift())
    }
    fn is_equilibrium(&self) -> bool {
        self.physics.is_equilibrium()
    }

    fn field(&self, name: &str) -> Option<FieldView<'_>> {
        let number = self.fields.iter().position(|field| field.name == name)?;
        let field = &self.fields[number];
        let (shape, layout) = (self.shape(field), self.simulation.layout());
        if let (Value::Component(k), false) = (&field.value, self.physics.blanks()) {
            let values = Cow::Borrowed(self.simulation.arrays().components()[*k].as_slice());
            return Some(FieldView { values, start: layout.place(0, 0), shape, row: layout.stride });
        }
        let mut values = vec![0.0; shape[0] * shape[1]];
        self.fill(number, 0, &mut values);
        Some(FieldView { values: values.into(), start: 0, shape, row: shape[1] })
    }
    fn fill(&self, field: usize, from: usize, values: &mut [f64]) {
        self.value(&self.fields[field], from, values);
        self.physics.blank(field, from, values);
    }
    fn take_totals(&mut self) -> Totals {
        self.simulation.take_sums();
        let totals = self.simulation.totals();
        self.record.wet_cells = totals.wet;
        totals
    }

    fn maps(&mut self) -> Maps {
        self.physics.maps(&mut self.simulation)
    }
    fn peaks(&self) -> Maps {
        let (layout, maps) = (self.simulation.layout(), self.simulation.maps());
        let named = maps.into_iter().flat_map(granflow_engine::Maps::named);
        let known = named.filter(|(name, _)| self.plane.model().quantity(name).is_some());
        let peaks = known.map(|(name, map)| (name, layout.unpadded(map)));
        peaks.chain(self.exceedances()).collect()
    }
    fn into_peaks(self: Box<Self>) -> Maps {
        let exceedances = self.exceedances();
        let Simulated { simulation, plane, .. } = *self;
        let mut maps = simulation.into_maps();
        maps.retain(|(name, _)| plane.model().quantity(name).is_some());
        maps.extend(exceedances);
        maps
    }
    fn place(&self) -> Plane {
        self.plane.clone().with_bed(|| self.physics.elevation(&self.simulation))
    }
    fn numbers(&self) -> Numbers {
        let mut numbers = self.physics.numbers(&self.simulation, self.drift(), &self.record);
        let volume = self.physics.trickle_volume(&self.simulation, self.trickle);
        numbers.extend(volume.map(|volume| ("trickle_volume".to_owned(), volume)));
        numbers
    }

    fn bytes_per_cell(&self, instants: bool) -> usize {
        let maps = self.has_speed();
        if instants {
            return self.stepper().bytes_per_cell(maps);
        }
        Simulation::<D, P::Scheme>::bytes_per_cell(maps)
    }

    fn save(&self) -> Saved<'_> {
        let maps = self.simulation.maps().into_iter().flat_map(granflow_engine::Maps::named);
        Saved {
            cells: self.stepper().cells(),
            clock: self.simulation.clock(),
            state: self
                .simulation
                .arrays()
                .components()
                .iter()
                .map(|part| Cow::Borrowed(part.as_slice()))
                .collect(),
            maps: maps.map(|(name, map)| (name, Cow::Borrowed(map))).collect(),
            at_rest: self.simulation.at_rest(),
            drift: self.drift().to_vec(),
            model: self.physics.save(),
            passed: self.passages.save(),
            durations: self.durations.iter().flat_map(Exceedance::arrays).map(Cow::Borrowed).collect(),
            record: self.record,
        }
    }
    fn restore(&mut self, saved: Saved<'static>) -> Result<(), String> {
        let Saved { cells, clock, state, mut maps, at_rest, drift, model, passed, durations, record } = saved;
        let own = self.stepper().cells();
        if cells != own {
            let [[x, y], [own_x, own_y]] = [cells, own];
            return Err(format!("its state has {x} x {y} cells, the run has {own_x} x {own_y}"));
        }
        let held = self.simulation.arrays().components();
        let alike = state.iter().map(|part| part.len()).eq(held.iter().map(|part| part.len()));
        if !alike || drift.len() != self.drift().len() {
            return Err("its state has another number of components, or of numbers in them".to_owned());
        }
        for (name, map) in self.simulation.maps().into_iter().flat_map(granflow_engine::Maps::named) {
            if !maps.iter().any(|(own, values)| *own == name && values.len() == map.len()) {
                return Err(format!("its map {name} is missing or has another shape"));
            }
        }
        let state = granflow_engine::Field::of(state.into_iter().map(Cow::into_owned).collect());
        if !self.physics.restore(&mut self.simulation, &model) {
            return Err("what it keeps of the model does not fit".to_owned());
        }
        if !self.simulation.restore(&clock, state) {
            return Err("its state has another shape".to_owned());
        }
        if !self.passages.restore(&passed, self.simulation.time()) {
            return Err("it has another number of sections".to_owned());
        }
        let mut arrays = durations.into_iter().map(Cow::into_owned);
        for duration in &mut self.durations {
            let (Some(ended), Some(since)) = (arrays.next(), arrays.next()) else {
                return Err("it has fewer maps of durations".to_owned());
            };
            if !duration.restore([ended, since]) {
                return Err("its maps of durations have another shape".to_owned());
            }
        }
        self.restored_drift = Some(drift);
        if at_rest {
            self.simulation.sleep_all();
        }
        for (name, map) in self.simulation.maps_mut() {
            if let Some(k) = maps.iter().position(|(own, _)| *own == name) {
                map.copy_from_slice(&maps.swap_remove(k).1);
            }
        }
        self.record = Record { energy: self.simulation.totals().energy, ..record };
        Ok(())
    }
}
