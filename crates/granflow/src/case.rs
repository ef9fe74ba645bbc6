//! The case file of a run: what [`granflow_case`] reads, joined with the files of the world and the models.

use crate::disk::Disk;
use crate::registry;
use crate::run::Run;
pub use granflow_case::*;
use std::ops::Deref;
use std::path::Path;

/// A case file that was read; [`Case::check`] says everything that can be said before work starts.
#[derive(Debug, Clone)]
pub struct Case(granflow_case::Case);

/// A case that was checked; [`Checked::start`] gives the run.
#[derive(Debug)]
pub struct Checked(granflow_case::Checked);

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
        self.0.check(&Disk).map(Checked)
    }
}

impl Checked {
    /// What every kind of case has: ends, frames, files, notes.
    #[must_use]
    pub fn plan(&self) -> &RunPlan {
        &self.0.run
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
        let granflow_case::Checked { run, kind } = self.0;
        registry::start(&run, kind)
    }
    /// What would be computed, and how large it is: names and values, one line each.
    ///
    /// # Errors
    /// As [`Checked::start`].
    pub fn describe(self) -> Result<Vec<(&'static str, String)>, StartError> {
        let granflow_case::Checked { run, kind } = self.0;
        registry::describe(&run, kind)
    }
}

/// The JSON Schema of the case file, with the kinds of files that can be written.
#[cfg(feature = "files")]
#[must_use]
pub fn json_schema() -> serde_json::Value {
    granflow_case::json_schema(Disk.kinds())
}

/// Why a run could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The case itself is wrong.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The terrain, or a raster of thicknesses, cannot be used.
    #[cfg(feature = "geo")]
    #[error(transparent)]
    Raster(Box<granflow_geo::raster::RasterError>),
    /// A release cannot be used.
    #[cfg(feature = "geo")]
    #[error(transparent)]
    Release(Box<granflow_geo::release::ReleaseError>),
    /// The numbers do not make a simulation.
    #[error(transparent)]
    Build(#[from] granflow_engine::simulation::BuildError),
    /// The library was built without a feature that this case needs.
    #[error("this needs granflow's feature `{feature}`: build with `--features {feature}`")]
    Feature {
        /// The feature.
        feature: &'static str,
    },
}

#[cfg(feature = "geo")]
impl From<granflow_geo::raster::RasterError> for StartError {
    fn from(error: granflow_geo::raster::RasterError) -> Self {
        StartError::Raster(Box::new(error))
    }
}

#[cfg(feature = "geo")]
impl From<granflow_geo::release::ReleaseError> for StartError {
    fn from(error: granflow_geo::release::ReleaseError) -> Self {
        StartError::Release(Box::new(error))
    }
}
