//! Many runs of one case with some of its values drawn: how probable it is that a place is reached, and how hard.
//!
//! [`Ensemble::sample`] says what a member changes in the case, a pure function of the case and the member's number.
//! [`Ensemble::compute`] runs a member, [`Reduced::add`] adds it up and forgets its maps, [`Reduced::merge`] joins what was added up
//! elsewhere, and [`Ensemble::maps`] makes maps of all. Not a bit of them depends on order, workers or parts. [`Ensemble::run`] does
//! all that on the cores of one machine.
//!
//! ```no_run
//! use granflow::{Case, ensemble::Ensemble};
//! use std::sync::atomic::AtomicBool;
//! let ensemble = Ensemble::of(&Case::read("avalanche.toml")?)?;
//! let mut reduced = ensemble.empty();
//! for number in 0..ensemble.plan().members {
//!     reduced.add(ensemble.compute(number, &AtomicBool::new(false)).expect("nobody stops it"));
//! }
//! for map in ensemble.maps(&reduced) {
//!     println!("{}: {:?}", map.name, map.values.iter().copied().fold(0.0, f64::max));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod classes;
mod figures;
mod files;
mod folder;
mod maps;
mod member;
mod part;
mod reduced;
mod table;
mod workers;

pub use folder::{Done, Options};
pub use granflow_case::Member;
pub use granflow_case::ensemble::{Column, Drawn, Sampling};
pub use maps::{Map, Measure};
pub use member::{Computed, Outcome};
pub use part::case_of_part;
pub use reduced::Reduced;
pub use workers::Progress;

use crate::StartError;
use crate::case::{Case, CaseError};
use crate::inputs::Inputs;
use crate::model::Plane;
use crate::models::Shared;
use crate::output;
use crate::output::checkpoint::Origin;
use crate::output::figures::PictureError;
use crate::raster::RasterError;
use crate::session::origin;
use granflow_case::RunPlan;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// An ensemble that is ready to be computed: its case, what the members share, and the cells that they are added up on.
#[derive(Debug)]
pub struct Ensemble {
    case: Case,
    run: RunPlan,
    inputs: Inputs,
    plan: Arc<granflow_case::Ensemble>,
    origin: Origin,
    shared: Shared,
    plane: Plane,
    /// The maps that are added up, the first of them says where a member came.
    names: Vec<String>,
}

/// Why an ensemble could not be computed or put together.
#[derive(Debug, thiserror::Error)]
pub enum EnsembleError {
    /// The case cannot be used.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The case or one of its files cannot be used.
    #[error(transparent)]
    Start(#[from] StartError),
    /// A file could not be read or written.
    #[error(transparent)]
    Output(#[from] output::Error),
    /// A raster could not be written.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// A figure could not be drawn or written.
    #[error(transparent)]
    Figure(#[from] PictureError),
    /// A part does not belong to the others, is there twice or is missing.
    #[error("{0}")]
    Parts(String),
    /// The threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(String),
    /// No member came to its end.
    #[error("all {count} members failed; member {number}: {failure}")]
    AllFailed {
        /// How many.
        count: usize,
        /// The first of them.
        number: u32,
        /// Why that failed.
        failure: String,
    },
}

impl Ensemble {
    /// The ensemble of a case with a table `[ensemble]`. The case itself is set up once, so that what no member could use is said now.
    ///
    /// # Errors
    /// [`EnsembleError`]: the case, one of its files, or no such table.
    pub fn of(case: &Case) -> Result<Ensemble, EnsembleError> {
        Self::with(case, &Inputs::default())
    }

    /// The same with files and rasters in memory that the case names.
    ///
    /// # Errors
    /// As [`Ensemble::of`].
    pub fn with(case: &Case, inputs: &Inputs) -> Result<Ensemble, EnsembleError> {
        let checked = case.check_with(inputs)?;
        let run = checked.plan().clone();
        let Some(plan) = run.ensemble.clone() else {
            let message = "the case has no table [ensemble]";
            let cure = "add one with members and vary, as in docs/ensemble.md; `granflow run` computes the case alone";
            return Err(run.fault("ensemble", message, cure).into());
        };
        let origin = origin(&run, inputs)?;
        let shared = Shared::default();
        let started = checked.start_among(&shared)?;
        let plane = started.place();
        let pressure = plane.domain.raster().is_some();
        let names = ["peak_thickness", "peak_speed", "peak_pressure"];
        let names = names[..2 + usize::from(pressure)].iter().map(|name| (*name).to_owned()).collect();
        Ok(Ensemble { case: case.clone(), inputs: inputs.clone(), run, plan, origin, shared, plane, names })
    }

    /// What the case asks for.
    #[must_use]
    pub fn plan(&self) -> &granflow_case::Ensemble {
        &self.plan
    }

    /// What every run of the case has.
    #[must_use]
    pub fn run_plan(&self) -> &RunPlan {
        &self.run
    }

    /// The cells, and what lies under them in the case as it stands.
    #[must_use]
    pub fn plane(&self) -> &Plane {
        &self.plane
    }

    /// What member `number` changes in the case.
    ///
    /// # Panics
    /// If there is no such member.
    #[must_use]
    pub fn sample(&self, number: u32) -> Member {
        self.plan.sample(number)
    }

    /// Of no member yet.
    #[must_use]
    pub fn empty(&self) -> Reduced {
        let thresholds = |name: &str| match name {
            "peak_thickness" => self.plan.exceed.peak_thickness.as_slice(),
            "peak_speed" => &self.plan.exceed.peak_speed,
            _ => &self.plan.exceed.peak_pressure,
        };
        let maps: Vec<_> = self.names.iter().map(|name| (name.as_str(), thresholds(name))).collect();
        let classes = (!self.plan.percentiles.is_empty()).then_some(self.plan.classes);
        Reduced::empty(self.plane.cells(), &maps, classes)
    }

    /// Computes member `number` on the threads of the pool that this is called in; none where `stop` ended it before its end. A member
    /// that fails is an outcome too.
    ///
    /// # Panics
    /// If there is no such member.
    #[must_use]
    pub fn compute(&self, number: u32, stop: &AtomicBool) -> Option<Outcome> {
        let member = self.sample(number);
        let work = || {
            let checked = self.case.check_member(&member.overrides, &self.inputs);
            let checked = checked.map_err(|error| error.to_string())?;
            let start = |checked: crate::Checked| checked.start_among(&self.shared);
            member::compute(checked, start, &self.names, [&self.plane.x, &self.plane.y], stop)
        };
        // A fault of the program in one member is no reason to lose the others.
        let result = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
            Err(format!("the program failed: {text}"))
        });
        let result = result.transpose()?;
        Some(Outcome { member, result })
    }
}
