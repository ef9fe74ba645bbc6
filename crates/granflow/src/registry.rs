//! Which model runs which kind of case. Outside its own folder a model is named here, in the list of models, and among the
//! builders.

use crate::StartError;
use crate::describe::Line;
use crate::models::{hadeler_kuttler, savage_hutter};
use crate::run::Run;
#[cfg(all(feature = "geo", feature = "threads"))]
use crate::speed::Setup;
use granflow_case::{Kind, RunPlan};

/// The run of a checked case.
pub(crate) fn start(run: &RunPlan, kind: Kind) -> Result<Box<dyn Run>, StartError> {
    match kind {
        Kind::Chute(plan) => savage_hutter::run::chute::start(run, plan),
        #[cfg(feature = "geo")]
        Kind::Terrain(plan) => savage_hutter::run::terrain::start(run, &plan),
        #[cfg(not(feature = "geo"))]
        Kind::Terrain(_) => Err(StartError::Feature { feature: "geo" }),
        Kind::Sandpile(plan) => hadeler_kuttler::run::start::start(run, plan),
    }
}

/// What a checked case would compute.
pub(crate) fn describe(run: &RunPlan, kind: Kind) -> Result<Vec<Line>, StartError> {
    match kind {
        Kind::Chute(plan) => savage_hutter::run::describe::chute(run, plan),
        #[cfg(feature = "geo")]
        Kind::Terrain(plan) => savage_hutter::run::describe::terrain(run, &plan),
        #[cfg(not(feature = "geo"))]
        Kind::Terrain(_) => Err(StartError::Feature { feature: "geo" }),
        Kind::Sandpile(plan) => Ok(hadeler_kuttler::run::describe::lines(run, &plan)),
    }
}

/// The runs to measure the models by.
#[cfg(all(feature = "geo", feature = "threads"))]
pub(crate) fn setups() -> impl Iterator<Item = &'static Setup> + Clone {
    savage_hutter::run::speed::SETUPS.iter().chain(hadeler_kuttler::run::speed::SETUPS)
}
