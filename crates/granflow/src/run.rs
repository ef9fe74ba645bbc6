//! A run that one can hold: stepped, looked into, saved and taken up again, whatever its model, dimension and scheme.
//!
//! [`Run`] is object-safe. A case gives one by [`Checked::start`](crate::Checked::start), a builder of
//! [`build`](crate::build) without any case, and [`Simulated`] makes one of every scheme that the engine can step. [`drive`]
//! steps a run to one of its [`Ends`] and lets [sinks](crate::sinks) look on.

mod checksum;
mod drive;
mod durations;
mod entry;
mod field_view;
mod frames;
mod law;
mod passage;
mod record;
mod saved;
mod simulated;
mod sink;
mod step_size;
mod trickle;

pub use crate::entry::{Entry, sum};
pub use crate::stop_reason::StopReason;
pub use checksum::checksums;
pub use drive::{DriveError, drive, reached, watch_for};
pub use durations::{Exceeded, What};
pub use entry::mass_error;
pub use field_view::FieldView;
pub(crate) use frames::after;
pub use frames::{FrameClock, Frames};
pub use granflow_case::{Ends, Until};
pub use granflow_engine::simulation::Face;
pub use granflow_engine::simulation::{Failure, Totals};
pub use law::{Broken, Laws, check_end, check_state};
pub use passage::Passage;
pub use record::Record;
pub use saved::Saved;
pub use simulated::{CellOf, Field, Numbers, Physics, Simulated, Value};
pub use sink::{Sink, SinkError};
pub(crate) use step_size::step_size;

pub use crate::model::Maps;
use crate::model::Plane;
pub use granflow_engine::Stepper;

/// A run under way.
pub trait Run: Send + Sync {
    /// Where the cells are, and on what; while a run computes the elevation of its bed is held by the engine alone, see
    /// [`Run::place`].
    fn plane(&self) -> &Plane;
    /// What steps it.
    fn stepper(&self) -> &dyn Stepper;
    /// What steps it, to be changed.
    fn stepper_mut(&mut self) -> &mut dyn Stepper;
    /// Name of the scheme, as the case file writes it.
    fn scheme(&self) -> &str;
    /// Volume at the start and the peaks so far.
    fn record(&self) -> &Record;
    /// The mass has a speed along its bed; else the largest speed of the totals is another quantity of the model.
    fn has_speed(&self) -> bool;
    /// Thickness that a layer must exceed to count in the maps of peaks and times (units of the thickness,
    /// normal to the bed); none where there are no such maps.
    fn threshold(&self) -> Option<f64> {
        self.stepper().maps().map(granflow_engine::Maps::threshold)
    }
    /// What its states promise; [`check_state`] holds them to it.
    fn laws(&self) -> Laws {
        Laws::default()
    }
    /// Keep the kinetic energy after every step, for an end by energy.
    fn track_energy(&mut self);
    /// Look now and then whether more than a trickle of this thickness moves, for an end at rest but for a trickle.
    fn track_trickle(&mut self, thickness: f64);

    /// Count from now on what passes these sections: each some faces, with 1 where passing towards larger coordinates counts,
    /// -1 where the other way does.
    fn track_passage(&mut self, sections: Vec<Vec<(Face, f64)>>);
    /// What has passed each section of [`Run::track_passage`] up to the time shown, by the scheme's own fluxes.
    fn passages(&self) -> Vec<Passage>;

    /// Keep maps from now on that say for how long each of these was exceeded; they are among [`Run::peaks`].
    fn track_durations(&mut self, exceeded: &[Exceeded]);

    /// Let what comes from outside at this time, a late release say, come now; the next step would do it at its begin.
    fn bring(&mut self) {}
    /// Nothing that acts from outside is still to come or to change.
    fn is_settled(&self) -> bool {
        true
    }
    /// The time at which something last came from outside.
    fn came(&self) -> f64 {
        0.0
    }

    /// One step, not beyond time `until`; returns its length. It is infinite where nothing can move and `until` is
    /// infinite: the state is final.
    ///
    /// # Errors
    /// [`Failure`]; after [`Failure::NotFinite`] the state is of no use, after the others it is as before.
    fn step(&mut self, until: f64) -> Result<f64, Failure>;
    /// Nothing changes faster than `rate` and no source will change any more, or the state is an equilibrium.
    fn is_steady(&self, rate: f64) -> bool;
    /// The largest change of each component of the state per time in the last step, also of one before [`Run::restore`]; infinite
    /// where that is not known.
    fn drift(&self) -> &[f64];
    /// The state is an equilibrium that was computed without steps.
    fn is_equilibrium(&self) -> bool {
        false
    }

    /// A field by its name, in the units of the run: a view of the engine's own numbers where they are the field, else
    /// computed. Names are those of [`Plane::series`].
    fn field(&self, name: &str) -> Option<FieldView<'_>>;
    /// As many numbers of field number `field` of [`Plane::series`] as `values` holds, from number `from` on, x fastest.
    fn fill(&self, field: usize, from: usize, values: &mut [f64]);
    /// Sums over all cells, taken now and noted in the record.
    fn take_totals(&mut self) -> Totals;
    /// Sums over all cells as they stand.
    fn totals(&self) -> Totals {
        self.stepper().totals()
    }

    /// The maps of the state as it stands, beyond peaks and times.
    fn maps(&mut self) -> Maps;
    /// The maps of peaks and times so far that the model has a quantity for.
    fn peaks(&self) -> Maps;
    /// The maps of peaks and times. The fields of the run are freed first, and the maps copied one by one, so that this takes
    /// little memory.
    fn into_peaks(self: Box<Self>) -> Maps;
    /// The plane with the elevation of its bed.
    fn place(&self) -> Plane;
    /// The numbers of a summary that only this model has.
    fn numbers(&self) -> Numbers;

    /// The run as it stands, to be taken up again by [`Run::restore`]; nothing is copied.
    fn save(&self) -> Saved<'_>;
    /// Go on from what [`Run::save`] gave.
    ///
    /// # Errors
    /// What does not fit, in words.
    fn restore(&mut self, saved: Saved<'static>) -> Result<(), String>;

    /// Bytes that a cell takes while the run computes, with its maps; `instants` says whether sinks look into steps.
    fn bytes_per_cell(&self, instants: bool) -> usize;

    /// Time reached.
    fn time(&self) -> f64 {
        self.stepper().time()
    }
    /// Steps done.
    fn steps(&self) -> u64 {
        self.stepper().steps()
    }
    /// Every cell rests by the scheme's proof and the last step changed nothing, or nothing could send a signal, and nothing
    /// from outside is still to come: nothing will ever move.
    fn at_rest(&self) -> bool;
    /// Step until time `time`; a step that would go beyond is cut there, a fixed one too.
    ///
    /// # Errors
    /// [`Failure`] of the first step that cannot be taken.
    ///
    /// # Panics
    /// If `time` is not a number.
    fn until(&mut self, time: f64) -> Result<(), Failure> {
        assert!(!time.is_nan(), "the time to step to is not a number");
        self.stepper_mut().show_end();
        while self.time() < time && self.step(time)?.is_finite() {}
        self.bring();
        Ok(())
    }
    /// Step until everything is at rest, or to time `limit`; says whether it is at rest.
    ///
    /// # Errors
    /// [`Failure`] of the first step that cannot be taken.
    ///
    /// # Panics
    /// If `limit` is not a number.
    fn to_rest(&mut self, limit: f64) -> Result<bool, Failure> {
        assert!(!limit.is_nan(), "the time to step to is not a number");
        self.stepper_mut().show_end();
        self.bring();
        while !self.at_rest() && self.time() < limit && self.step(limit)?.is_finite() {
            self.bring();
        }
        Ok(self.at_rest())
    }
}

impl dyn Run + '_ {
    /// The run at multiples of `every`, from its present state on: see [`Frames`].
    ///
    /// # Panics
    /// If `every` is not positive.
    pub fn frames(&mut self, every: f64) -> Frames<'_> {
        Frames::new(self, every)
    }
}
