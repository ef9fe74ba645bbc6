//! The models of this library: each is one folder, and is named here, where it is found by a case and by a result.

pub mod hadeler_kuttler;
pub mod savage_hutter;

use crate::StartError;
use crate::describe::Line;
use crate::inputs::Inputs;
use crate::model::Model;
use crate::run::Run;
#[cfg(all(feature = "geo", feature = "threads"))]
use crate::speed::Setup;
use granflow_case::{Kind, RunPlan};

/// All models, by which a result file finds its own.
pub static MODELS: &[&Model] = &[
    &savage_hutter::MODEL, //
    &hadeler_kuttler::MODEL,
];

/// What was read for one run and serves others on the same ground too; it holds every ground that it was asked for.
#[derive(Debug, Default)]
pub struct Shared {
    #[cfg(feature = "geo")]
    mountains: savage_hutter::run::mountain::Mountains,
}

/// The run of a checked case; what others use too is kept in `shared`, where that is given.
pub(crate) fn start(
    run: &RunPlan,
    kind: Kind,
    inputs: &Inputs,
    shared: Option<&Shared>,
) -> Result<Box<dyn Run>, StartError> {
    #[cfg(not(feature = "geo"))]
    let _ = shared;
    match kind {
        Kind::Chute(plan) => {
            let laid = savage_hutter::run::laid::Laid::of(&plan, inputs)?;
            savage_hutter::run::chute::start(run, &plan, &laid)
        }
        #[cfg(feature = "geo")]
        Kind::Terrain(plan) => {
            savage_hutter::run::terrain::start(run, &plan, inputs, shared.map(|shared| &shared.mountains))
        }
        #[cfg(not(feature = "geo"))]
        Kind::Terrain(_) => Err(StartError::Feature { feature: "geo" }),
        Kind::Sandpile(plan) => hadeler_kuttler::run::start::start(run, plan),
    }
}

/// What a checked case would compute.
pub(crate) fn describe(run: &RunPlan, kind: Kind, inputs: &Inputs) -> Result<Vec<Line>, StartError> {
    match kind {
        Kind::Chute(plan) => savage_hutter::run::describe::chute(run, &plan, inputs),
        #[cfg(feature = "geo")]
        Kind::Terrain(plan) => savage_hutter::run::describe::terrain(run, &plan, inputs),
        #[cfg(not(feature = "geo"))]
        Kind::Terrain(_) => Err(StartError::Feature { feature: "geo" }),
        Kind::Sandpile(plan) => Ok(hadeler_kuttler::run::describe::lines(run, &plan)),
    }
}

/// The runs to measure by, of all models.
#[cfg(all(feature = "geo", feature = "threads"))]
pub fn setups() -> impl Iterator<Item = &'static Setup> + Clone {
    savage_hutter::run::speed::SETUPS.iter().chain(hadeler_kuttler::run::speed::SETUPS)
}
