//! The end at rest but for a trickle.
//!
//! Under a law with drag a thin layer drains ever more slowly, and on a bed steeper than mu a thin layer may flow for long after the
//! mass has come to rest. Such a trickle must not keep a run from ending. One look is no proof of its end: what a trickle fills may
//! give way again. So nothing but a trickle must have moved for half as long as the mass flowed before.

use super::{Record, Run};

/// So many steps lie between two looks; they are counted from the start of the run, so that nothing that is written and no
/// resuming moves a look.
const EVERY: u64 = 64;

/// Is a look due after so many steps?
pub(super) fn is_due(steps: u64) -> bool {
    steps.is_multiple_of(EVERY)
}

/// Has nothing but a trickle moved for long enough? Asked after a look.
pub(super) fn is_all(run: &dyn Run) -> bool {
    let Record { flowed, .. } = *run.record();
    let (time, came) = (run.time(), run.came());
    // Counted from when the last of the mass came; where that never flowed, from the start.
    let long = if flowed > came { time - came >= 1.5 * (flowed - came) } else { time >= 1.5 * came };
    // Where nothing moves at all the run is at rest, which the next step finds.
    is_due(run.steps()) && flowed > 0.0 && long && run.totals().moving > 0
}
