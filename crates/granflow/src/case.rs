//! The case file of a run: what [`granflow_case`] reads, joined with the files of the world and the models.

use crate::access::Access;
#[cfg(feature = "files")]
use crate::access::file_kinds;
use crate::inputs::Inputs;
use crate::models::{self, Shared};
use crate::run::{Exceeded, Run, What};
pub use crate::start_error::StartError;
pub use granflow_case::*;
use std::ops::Deref;
use std::path::Path;

/// A case file that was read; [`Case::check`] says everything that can be said before work starts.
#[derive(Debug, Clone)]
pub struct Case(granflow_case::Case);

/// A case that was checked; [`Checked::start`] gives the run.
#[derive(Debug)]
pub struct Checked(granflow_case::Checked, Inputs);

impl Deref for Case {
    type Target = granflow_case::Case;
    fn deref(&self) -> &granflow_case::Case {
        &self.0
    }
}

impl Case {
    /// Reads a case file.
    ///
    /// # Errors
    /// [`CaseError`] at the first place that is not TOML, an unknown key, a wrong type or a missing key; a file that cannot be
    /// read is answered with the nearest name that exists.
    pub fn read(path: impl AsRef<Path>) -> Result<Case, CaseError> {
        Self::read_with(path, &[])
    }
    /// Reads a case file with overrides `key.path=value` laid over it.
    ///
    /// # Errors
    /// As [`Case::read`]; an error in an override names it.
    pub fn read_with(path: impl AsRef<Path>, overrides: &[String]) -> Result<Case, CaseError> {
        granflow_case::Case::read_with(path.as_ref(), overrides).map(Case)
    }
    /// Reads a case from a text; `name` is what errors call it, and files are looked for beside it.
    ///
    /// # Errors
    /// As [`Case::read`].
    pub fn parse(text: &str, name: &str) -> Result<Case, CaseError> {
        Self::parse_with(text, name, &[])
    }
    /// Reads a case from a text with overrides laid over it.
    ///
    /// # Errors
    /// As [`Case::read_with`].
    pub fn parse_with(text: &str, name: &str, overrides: &[String]) -> Result<Case, CaseError> {
        granflow_case::Case::parse_with(text, name, overrides).map(Case)
    }
    /// Checks ranges, combinations, formulas and that every file the case names exists, and evaluates what the run needs,
    /// once.
    ///
    /// # Errors
    /// [`CaseError`] for the first thing that is wrong; its kind is `File` where a file cannot be read.
    pub fn check(&self) -> Result<Checked, CaseError> {
        self.check_with(&Inputs::default())
    }
    /// The same with files and rasters in memory that the case names.
    ///
    /// # Errors
    /// As [`Case::check`].
    pub fn check_with(&self, inputs: &Inputs) -> Result<Checked, CaseError> {
        Ok(Checked(self.0.check(&Access(inputs))?, inputs.clone()))
    }
    /// One member of the ensemble of the case: overrides laid over it, and of the ensemble itself nothing is asked.
    ///
    /// # Errors
    /// As [`Case::read_with`].
    pub fn member(&self, overrides: &[String]) -> Result<Case, CaseError> {
        self.0.member(overrides).map(Case)
    }
    /// The case with overrides laid over it, as a member of its ensemble has them, checked.
    ///
    /// # Errors
    /// As [`Case::read_with`] and [`Case::check`].
    pub fn check_member(&self, overrides: &[String], inputs: &Inputs) -> Result<Checked, CaseError> {
        Ok(Checked(self.0.check_with(overrides, &Access(inputs))?, inputs.clone()))
    }
}

impl Checked {
    /// What every kind of case has: ends, frames, files, notes.
    #[must_use]
    pub fn plan(&self) -> &RunPlan {
        &self.0.run
    }
    /// The files in memory that it may name.
    #[cfg(feature = "files")]
    pub(crate) fn inputs(&self) -> &Inputs {
        &self.1
    }
    /// What only this kind of case has.
    #[must_use]
    pub fn kind(&self) -> &Kind {
        &self.0.kind
    }
    /// Sets the run up: reads elevation and releases, fits slopes, fills the fields. Nothing is computed yet.
    ///
    /// # Errors
    /// [`StartError`] at the first file or key that cannot be used.
    pub fn start(self) -> Result<Box<dyn Run>, StartError> {
        self.started(None)
    }
    /// As [`Checked::start`], for one of several runs on the same ground: that is read and fitted once.
    ///
    /// # Errors
    /// As [`Checked::start`].
    pub fn start_among(self, shared: &Shared) -> Result<Box<dyn Run>, StartError> {
        self.started(Some(shared))
    }
    fn started(self, shared: Option<&Shared>) -> Result<Box<dyn Run>, StartError> {
        let Checked(granflow_case::Checked { run, kind }, inputs) = self;
        let mut started = models::start(&run, kind, &inputs, shared)?;
        started.track_durations(&exceeded(&run.output.durations));
        Ok(started)
    }
    /// What would be computed, and how large it is: names and values, one line each.
    ///
    /// # Errors
    /// As [`Checked::start`].
    pub fn describe(self) -> Result<Vec<(&'static str, String)>, StartError> {
        let Checked(granflow_case::Checked { run, kind }, inputs) = self;
        let mut lines = models::describe(&run, kind, &inputs)?;
        lines.extend(run.ensemble.iter().map(|ensemble| ("ensemble", ensemble.to_string())));
        Ok(lines)
    }
}

/// The thresholds of which maps say for how long they were exceeded.
fn exceeded(durations: &Durations) -> Vec<Exceeded> {
    let Durations { thickness, speed, pressure } = *durations;
    [(What::Thickness, thickness), (What::Speed, speed), (What::Pressure, pressure)]
        .into_iter()
        .filter_map(|(what, threshold)| Some(Exceeded { what, threshold: threshold? }))
        .collect()
}

/// The JSON Schema of the case file, with the kinds of files that can be written.
#[cfg(feature = "files")]
#[must_use]
pub fn json_schema() -> serde_json::Value {
    granflow_case::json_schema(file_kinds())
}
