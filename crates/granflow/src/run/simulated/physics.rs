//! What a model adds to its scheme to be run and shown.

use crate::run::{Laws, Maps, Record};
use granflow_engine::simulation::Simulation;
use granflow_model::scheme::{Cell, Scheme};
use std::borrow::Cow;

/// A cell of a scheme: its state, ground and forcing.
pub type CellOf<const D: usize, S> =
    Cell<<S as Scheme<D, f64>>::State, <S as Scheme<D, f64>>::Ground, <S as Scheme<D, f64>>::Forcing>;

/// [`Simulation::fill`] with a function of the cell.
type Fill<const D: usize, S> = dyn Fn(&Simulation<D, S>, usize, usize, &mut [f64]) + Send + Sync;

/// Where the numbers of a field come from.
pub enum Value<const D: usize, S: Scheme<D, f64>> {
    /// A component of the state.
    Component(usize),
    /// A function of the cell: [`Value::of`].
    Of(Box<Fill<D, S>>),
}

impl<const D: usize, S: Scheme<D, f64>> Value<D, S> {
    /// A function of the cell, compiled into a loop of its own: a frame asks for it in every cell.
    pub fn of(value: impl Fn(&CellOf<D, S>) -> f64 + Send + Sync + 'static) -> Self {
        Value::Of(Box::new(move |simulation, columns, from, values| {
            simulation.fill(columns, from, values, &value);
        }))
    }
}

/// A field that a run shows, in the order of the frames.
pub struct Field<const D: usize, S: Scheme<D, f64>> {
    /// Its name, one of the model's quantities.
    pub name: &'static str,
    /// Its numbers.
    pub value: Value<D, S>,
    /// Columns and rows of the engine's grid that the field leaves out at the upper ends.
    pub short: usize,
}

/// Numbers of a summary by their keys.
pub type Numbers = Vec<(String, f64)>;

/// What a model adds to its scheme to be run and shown.
pub trait Physics<const D: usize>: Send + Sync + 'static {
    /// The scheme.
    type Scheme: Scheme<D, f64>;
    /// Its name, as the case file writes it.
    fn scheme(&self) -> &str;
    /// The fields that a run shows.
    fn fields(&self) -> Vec<Field<D, Self::Scheme>>;
    /// The mass has a speed along its bed, so that speeds, energies, and maps of peaks and times are kept.
    fn has_speed(&self) -> bool {
        true
    }
    /// Thickness that a layer must exceed to count in the maps of peaks and times (units of the thickness,
    /// normal to the bed).
    fn threshold(&self) -> f64 {
        0.0
    }
    /// What its states promise.
    fn laws(&self) -> Laws {
        Laws::default()
    }
    /// Set the forcing (sources) before a step that ends at `until` at the latest; returns the time at which it changes again.
    fn prepare(&mut self, _simulation: &mut Simulation<D, Self::Scheme>, _until: f64) -> f64 {
        f64::INFINITY
    }
    /// What decides how the run goes on beside state and ledger, such as the time from which the present forcing holds: always as
    /// many lists of numbers, each as long as before.
    fn save(&self) -> Vec<Cow<'_, [f64]>> {
        Vec::new()
    }
    /// Take up what [`Physics::save`] gave and set the forcing of then; state and ledger follow. False where it does not fit.
    fn restore(
        &mut self,
        _simulation: &mut Simulation<D, Self::Scheme>,
        saved: &[Cow<'static, [f64]>],
    ) -> bool {
        saved.is_empty()
    }
    /// Let what comes at the time of the simulation come.
    fn bring(&mut self, _simulation: &mut Simulation<D, Self::Scheme>) {}
    /// The time at which something last came.
    fn came(&self) -> f64 {
        0.0
    }
    /// Nothing that acts from outside, a source say, begins or changes after `time`.
    fn is_settled(&self, _time: f64) -> bool {
        true
    }
    /// Nothing moves, for it is held by what the scheme does not know.
    fn is_held(&self) -> bool {
        false
    }
    /// Fields have places without a value.
    fn blanks(&self) -> bool {
        false
    }
    /// Put "no value" (NaN) into those places, in a part of a field from number `from` on.
    fn blank(&self, _field: usize, _from: usize, _values: &mut [f64]) {}
    /// More than a trickle of this thickness moves.
    fn flows(&self, _simulation: &Simulation<D, Self::Scheme>, _trickle: f64) -> bool {
        true
    }
    /// Volume that moves in a mere trickle, of this thickness or, without one, of the usual; none of a model without trickles.
    fn trickle_volume(
        &self,
        _simulation: &Simulation<D, Self::Scheme>,
        _trickle: Option<f64>,
    ) -> Option<f64> {
        None
    }
    /// See [`Run::is_steady`](crate::run::Run::is_steady); `drift` is [`Run::drift`](crate::run::Run::drift).
    fn is_steady(&self, _simulation: &Simulation<D, Self::Scheme>, _drift: &[f64], _rate: f64) -> bool {
        false
    }
    /// See [`Run::is_equilibrium`](crate::run::Run::is_equilibrium).
    fn is_equilibrium(&self) -> bool {
        false
    }
    /// See [`Run::maps`](crate::run::Run::maps).
    fn maps(&self, _simulation: &mut Simulation<D, Self::Scheme>) -> Maps {
        Vec::new()
    }
    /// Elevation of the bed in every cell \[m\], where the engine holds it; empty elsewhere.
    fn elevation(&self, _simulation: &Simulation<D, Self::Scheme>) -> Vec<f64> {
        Vec::new()
    }
    /// See [`Run::numbers`](crate::run::Run::numbers); `drift` is [`Run::drift`](crate::run::Run::drift).
    fn numbers(
        &self,
        _simulation: &Simulation<D, Self::Scheme>,
        _drift: &[f64],
        _record: &Record,
    ) -> Numbers {
        Numbers::default()
    }
}
