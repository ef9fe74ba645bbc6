//! A run in memory, as it stands between two steps.

use super::Record;
use std::borrow::Cow;

/// Everything that a run needs to go on bit for bit: see [`Run::save`](super::Run::save).
#[derive(Clone, Debug, PartialEq)]
pub struct Saved<'a> {
    /// Cells along x and y.
    pub cells: [usize; 2],
    /// Time, steps and the ledger, as [`Stepper::clock`](granflow_engine::Stepper::clock) gives them.
    pub clock: Vec<f64>,
    /// The components of the state, padded.
    pub state: Vec<Cow<'a, [f64]>>,
    /// The maps of peaks and times, padded, by name.
    pub maps: Vec<(&'static str, Cow<'a, [f32]>)>,
    /// Every cell was at rest.
    pub at_rest: bool,
    /// How fast each component changed in the last step, as [`Run::drift`](super::Run::drift).
    pub drift: Vec<f64>,
    /// What the model keeps beside the state, as [`Physics::save`](super::Physics::save) gives it.
    pub model: Vec<Cow<'a, [f64]>>,
    /// What has passed each section, as a sum and its compensation.
    pub passed: Vec<[f64; 2]>,
    /// What the maps of durations are made of, two arrays each.
    pub durations: Vec<Cow<'a, [f64]>>,
    /// Peaks so far.
    pub record: Record,
}

impl Saved<'_> {
    /// The same with numbers of its own.
    #[must_use]
    pub fn into_owned(self) -> Saved<'static> {
        let Saved { cells, clock, state, maps, at_rest, drift, model, passed, durations, record } = self;
        Saved {
            cells,
            clock,
            state: state.into_iter().map(|part| Cow::Owned(part.into_owned())).collect(),
            maps: maps.into_iter().map(|(name, map)| (name, Cow::Owned(map.into_owned()))).collect(),
            at_rest,
            drift,
            model: model.into_iter().map(|part| Cow::Owned(part.into_owned())).collect(),
            passed,
            durations: durations.into_iter().map(|part| Cow::Owned(part.into_owned())).collect(),
            record,
        }
    }
}
