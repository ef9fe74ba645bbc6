//! A case that was checked: everything in plain numbers, evaluated once, for a run to take.

use super::kinds::Kind;
use super::plan::RunPlan;

/// A checked case: [`RunPlan`] is the same for every kind of case and cheap to copy, [`Kind`] holds the numbers of
/// every cell and is for the run to take apart.
#[derive(Debug)]
pub struct Checked {
    /// When the run ends, how it steps, and which files it writes.
    pub run: RunPlan,
    /// The state at the start and whatever else only this kind of case has.
    pub kind: Kind,
}
