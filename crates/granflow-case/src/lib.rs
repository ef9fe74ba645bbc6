//! The case file: what is simulated, in one TOML document.
//!
//! [`Case::load`] reads a file, [`Case::parse`] a text; both know the place of every key, so that each error names
//! file, line and key, what was found and what is allowed. [`Case::check`] then says everything that can be said
//! before work starts, and the evaluators ([`Case::chute`], [`Case::initial_state`], [`Case::table`],
//! [`Case::sources`], [`Case::frames`]) turn the words into plain numbers.
//!
//! ```
//! use granflow_case::Case;
//! let case = Case::parse(
//!     r#"
//!     title = "A silo breaks"
//!     model = "savage_hutter"
//!     grid.x = { from = -6.0, to = 6.0, cells = 240 }
//!     material.friction.coulomb = { angle = "18 deg" }
//!     initial.thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
//!     time.until = "rest"
//!     "#,
//!     "silo.toml",
//! )?;
//! case.check()?;
//! assert_eq!(case.initial_state()?.thickness[120], 2.3);
//! # Ok::<(), granflow_case::CaseError>(())
//! ```

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod array;
mod check;
mod choice;
mod fault;
mod formula;
mod grid;
mod initial;
mod material;
mod output;
mod plan;
mod region;
mod sand;
mod scheme;
mod slope;
mod source;
mod state;
mod table;
mod terrain;
mod time;
mod units;

mod precision;
pub use fault::{CaseError, CaseErrorKind, nearest};
pub use formula::{Formula, FormulaError};
pub use grid::{Axis, AxisSides, Boundary, Grid, Points, Side, SidePair};
pub use initial::{Cap, Centre, Cone, Initial, Parabola, Quantity, Shape, Steps};
pub use material::{Cohesion, Coulomb, EarthPressure, Friction, Material, Samosat, Voellmy};
pub use output::{FileKind, Frames, Output};
pub use plan::TablePlan;
pub use precision::Precision;
pub use region::{Disc, Region};
pub use sand::{Rate, SandSource, Sources, Varying};
pub use scheme::{Scheme, SchemeName, Stepping};
pub use slope::{Chute, Profile, Slope};
pub use source::Source;
pub use state::InitialState;
pub use table::{Edge, Table, Wall};
pub use terrain::{Attribute, Curvature, Measured, Off, Release, ReleaseCap, Terrain, Thickness, Window};
pub use time::{Method, Stop, Time, Until};
pub use units::{Angle, Length};

/// A case: a model on a grid or on terrain, from its start to its end.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "granflow case")]
pub struct Case {
    /// What the figures and the report are headed with.
    #[serde(default)]
    pub title: String,
    /// The model.
    #[serde(default)]
    pub model: Model,
    /// The grid of a scaled case; a case has `[grid]` or `[terrain]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
    /// The mountain; a case has `[grid]` or `[terrain]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub terrain: Option<Terrain>,
    /// The table of hadeler_kuttler: the whole grid, open at all edges, if the case does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// The sand that is poured on the table, hadeler_kuttler.
    #[serde(default, rename = "source", skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<SandSource>,
    /// The material; savage_hutter needs it, hadeler_kuttler has none: its slopes are in units of the angle of repose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
    /// The state at the start, on a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial: Option<Initial>,
    /// What is released at the start, on terrain.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub release: Vec<Release>,
    /// The method.
    #[serde(default)]
    pub scheme: Scheme,
    /// The end of the run.
    pub time: Time,
    /// The files.
    #[serde(default)]
    pub output: Output,
    /// The text the case was read from.
    #[serde(skip)]
    source: Source,
}

/// The models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// A granular avalanche, depth-averaged (Savage & Hutter 1989).
    #[default]
    SavageHutter,
    /// A growing sandpile, a standing and a rolling layer on a table (Hadeler & Kuttler 1999).
    HadelerKuttler,
}

impl Model {
    /// The name a case file writes.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::SavageHutter => "savage_hutter",
            Self::HadelerKuttler => "hadeler_kuttler",
        }
    }
}

impl Case {
    /// Reads a case from a text; `source_name` is what errors call it, and files are looked for beside it.
    ///
    /// # Errors
    /// [`CaseError`] at the first place that is not TOML, an unknown key, a wrong type or a missing key.
    pub fn parse(text: &str, source_name: &str) -> Result<Self, CaseError> {
        Self::parse_with(text, source_name, &[])
    }

    /// Reads a case from a text with overrides `key.path=value` laid over it.
    ///
    /// # Errors
    /// As [`Case::parse`]; an error in an override names it.
    pub fn parse_with(text: &str, source_name: &str, overrides: &[String]) -> Result<Self, CaseError> {
        let source = Source::read(source_name, text, overrides)?;
        let document = source.document()?;
        let parsed = Self::deserialize(toml::de::Deserializer::from(document));
        let mut case = parsed.map_err(|error| source.explain(&error))?;
        // defaults that depend on the model
        match (case.model, &mut case.grid) {
            (Model::SavageHutter, Some(grid)) => _ = grid.boundary.get_or_insert_default(),
            (Model::HadelerKuttler, _) if !source.has("scheme.name") => {
                case.scheme.name = SchemeName::Adaptive
            }
            _ => {}
        }
        case.source = source;
        Ok(case)
    }

    /// Reads a case file.
    ///
    /// # Errors
    /// As [`Case::parse`]; a file that cannot be read is answered with the nearest name that exists.
    pub fn load(path: &Path) -> Result<Self, CaseError> {
        Self::load_with(path, &[])
    }

    /// Reads a case file with overrides `key.path=value` laid over it.
    ///
    /// # Errors
    /// As [`Case::load`]; an error in an override names it.
    pub fn load_with(path: &Path, overrides: &[String]) -> Result<Self, CaseError> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|error| check::missing(path, &error, &name))?;
        let text = String::from_utf8(bytes).map_err(|_| {
            CaseError::unreadable(&name, "this is not UTF-8 text, so it is no case file".to_owned())
        })?;
        Self::parse_with(&text, &name, overrides)
    }

    /// The text the case was read from, with its overrides as comment lines at the end.
    #[must_use]
    pub fn text(&self) -> String {
        self.source.text()
    }

    /// The name of the file the case was read from.
    #[must_use]
    pub fn source_name(&self) -> &str {
        self.source.name()
    }

    /// A path of the case, seen from the folder of the case file.
    #[must_use]
    pub fn resolve(&self, path: &Path) -> PathBuf {
        self.folder().join(path)
    }

    fn folder(&self) -> PathBuf {
        Path::new(self.source.name()).parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// An error at a key of this case, for what only shows later (a raster without a CRS, a missing attribute).
    #[must_use]
    pub fn fault(&self, key: &str, message: impl Into<String>, cure: &str) -> CaseError {
        self.source.fault(key, message).help(cure)
    }

    /// The case written as TOML, with angles in radians.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// The material; one without friction where the case has none.
    #[must_use]
    pub fn material(&self) -> &Material {
        self.material.as_ref().unwrap_or(&material::NONE)
    }

    /// Gravity: what the case says, else 9.81 m/s^2 on terrain and 1 on a grid.
    #[must_use]
    pub fn gravity(&self) -> f64 {
        self.material().gravity.unwrap_or(if self.terrain.is_some() { 9.81 } else { 1.0 })
    }

    /// The inclination of the chute along x; flat if the case does not say.
    ///
    /// # Errors
    /// [`CaseError`] for a profile that cannot be evaluated.
    pub fn chute(&self) -> Result<Chute, CaseError> {
        let slope = self.material().slope.clone().unwrap_or_default();
        Chute::new(&slope).map_err(|fault| {
            let dot = if fault.key.is_empty() { "" } else { "." };
            self.source.fault_in(&format!("material.slope{dot}{}", fault.key), fault.part, fault.message)
        })
    }

    /// When the state is written.
    #[must_use]
    pub fn frames(&self) -> Frames {
        const DEFAULT: u32 = 20;
        match (self.output.every, self.output.steps, self.time.end, self.time.steps) {
            (Some(every), ..) => Frames::Every(every),
            (None, Some(steps), ..) => Frames::Steps(steps),
            (None, None, Some(end), _) => Frames::Every(end / f64::from(DEFAULT)),
            (None, None, None, Some(steps)) => Frames::Steps(steps.div_ceil(u64::from(DEFAULT)).max(1)),
            (None, None, None, None) => Frames::Ends,
        }
    }

    /// The kinds of files to write.
    #[must_use]
    pub fn files(&self) -> Vec<FileKind> {
        let grid = [FileKind::Netcdf, FileKind::Figures];
        let more = [FileKind::Geotiff, FileKind::Vector, FileKind::Report];
        match &self.output.files {
            Some(files) => files.clone(),
            None if self.terrain.is_some() => grid.into_iter().chain(more).collect(),
            None => grid.to_vec(),
        }
    }

    /// Precision of the numbers in the files.
    #[must_use]
    pub fn precision(&self) -> Precision {
        self.output.precision.unwrap_or(if self.terrain.is_some() { Precision::F32 } else { Precision::F64 })
    }
}

/// The JSON Schema of the case file.
#[must_use]
pub fn json_schema() -> serde_json::Value {
    schemars::schema_for!(Case).to_value()
}

#[cfg(test)]
mod tests;
