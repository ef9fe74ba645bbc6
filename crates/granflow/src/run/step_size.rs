//! The step of a run.

use granflow_case::{RunPlan, Stepping};
use granflow_engine::simulation::StepSize;

/// The step that a case asks for.
pub(crate) fn step_size(run: &RunPlan) -> StepSize {
    match run.stepping {
        Stepping::Fixed(dt) => StepSize::Fixed(dt),
        Stepping::Courant(courant) => StepSize::Courant(courant),
    }
}
