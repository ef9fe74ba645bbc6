//! What is kept of the last step.

use crate::field::Field;
use crate::tiles::OUTLETS;

/// The last step, for what is shown from within it.
#[derive(Debug)]
pub(super) struct LastStep {
    /// Time at its begin, and its length; 0 if there was none.
    pub begin: f64,
    pub dt: f64,
    /// What left through each outlet, per cell measure, and what was poured in.
    pub out: [f64; OUTLETS.len()],
    pub poured: f64,
    /// The state at its begin, where the stages wrote over it and somebody asked; a single stage leaves it in `next`.
    pub before: Field,
    pub kept: bool,
    /// The time of that state, and of the last instant that was shown, which takes its place.
    pub at: f64,
    /// A step that ends at this time or later is one that somebody will look into.
    pub asked: f64,
    /// That instant is shown in place of the end of the step.
    pub shown: bool,
}

impl LastStep {
    /// There was none.
    pub fn none(time: f64) -> Self {
        LastStep {
            begin: time,
            dt: 0.0,
            out: [0.0; OUTLETS.len()],
            poured: 0.0,
            before: Field::default(),
            kept: false,
            at: time,
            asked: f64::INFINITY,
            shown: false,
        }
    }
}
