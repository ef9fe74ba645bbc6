//! What every kind of case says of its run: steps, ends, frames, files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::durations::Durations;
use super::ensemble::Ensemble;
use super::fault::CaseError;
use super::file_kind::FileKind;
use super::precision::Precision;
use super::source::Source;
use super::watched::Watched;

/// The part of a checked case that every kind has.
#[derive(Debug, Clone)]
pub struct RunPlan {
    /// Heading of figures and report; empty if the case has none.
    pub title: String,
    /// Name of the model, as the case file writes it.
    pub model: &'static str,
    /// Name of the scheme, as the case file writes it.
    pub scheme: &'static str,
    /// How the time step is chosen.
    pub stepping: Stepping,
    /// The largest Courant number that the scheme allows.
    pub max_courant: f64,
    /// What ends the run.
    pub ends: Ends,
    /// What is written.
    pub output: OutputPlan,
    /// Where it is looked at.
    pub watched: Watched,
    /// What is allowed but may surprise, one sentence each.
    pub notes: Vec<String>,
    /// Many runs of the case, if it asks for them.
    pub ensemble: Option<Arc<Ensemble>>,
    /// The files that the case names, seen from the working folder.
    pub inputs: Vec<PathBuf>,
    /// Where the case was read from.
    pub(crate) source: Source,
}

impl RunPlan {
    /// The text of the case file, with the overrides as comment lines at the end.
    #[must_use]
    pub fn text(&self) -> String {
        self.source.text()
    }

    /// The case as one TOML document that computes the same: the file's own text where there are no overrides, else
    /// its tables with the overrides laid in. Paths are relative to the folder of the case file.
    #[must_use]
    pub fn resolved(&self) -> String {
        self.source.resolved()
    }

    /// Name of the file the case was read from.
    #[must_use]
    pub fn source_name(&self) -> &str {
        self.source.name()
    }

    /// A path of the case, seen from the folder of the case file.
    #[must_use]
    pub fn locate(&self, path: &Path) -> PathBuf {
        self.source.folder().join(path)
    }

    /// A path as the case writes it: without the folder of the case file.
    #[must_use]
    pub fn as_written(&self, path: &Path) -> PathBuf {
        path.strip_prefix(self.source.folder()).unwrap_or(path).to_owned()
    }

    /// An error at a key of the case, for what shows only later (a raster without a CRS, a missing attribute).
    #[must_use]
    pub fn fault(&self, key: &str, message: impl Into<String>, cure: &str) -> CaseError {
        self.source.fault(key, message).help(cure)
    }
}

/// What is written: `[output]`, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputPlan {
    /// When the state is.
    pub frames: Frames,
    /// The kinds of files.
    pub files: Vec<FileKind>,
    /// Precision of the numbers in them.
    pub precision: Precision,
    /// Thickness normal to the bed that a layer must exceed to count in peaks, times and outlines (units of
    /// the thickness); 0 for a sandpile, which has none of these.
    pub threshold: f64,
    /// Thresholds of which maps say for how long they were exceeded.
    pub durations: Durations,
    /// A file with the path along which the run is shown over time; found where there is none.
    pub path: Option<PathBuf>,
    /// How wide what passes along it is looked at.
    pub path_width: f64,
}

/// What ends a run; the first that is reached does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends {
    /// Number of steps.
    pub steps: Option<u64>,
    /// Simulated time.
    pub time: Option<f64>,
    /// A state to wait for.
    pub until: Option<Until>,
    /// Share of the peak kinetic energy below which the run ends.
    pub kinetic_energy: Option<f64>,
}

impl Ends {
    /// A note on a run that steps until something happens, if it may never.
    pub(crate) fn note(&self) -> Option<String> {
        let limited = self.time.is_some() || self.steps.is_some() || self.until == Some(Until::Equilibrium);
        (!limited).then(|| "the run has no time limit; time.end sets one".to_owned())
    }
}

/// The state a run waits for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Until {
    /// Nothing moves.
    Rest {
        /// Speed below which the mass counts as resting too.
        speed: Option<f64>,
        /// Thickness (normal to the bed) of a trickle, which does not keep the run from ending.
        trickle: Option<f64>,
    },
    /// Nothing changes faster than `rate`.
    Steady {
        /// Bound on the rates of change.
        rate: f64,
    },
    /// The equilibrium, computed without stepping.
    Equilibrium,
}

/// How the time step is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepping {
    /// Always this step.
    Fixed(f64),
    /// The step that this Courant number allows.
    Courant(f64),
}

/// When the state is written; the first and the last instant always are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Frames {
    /// Every so much simulated time.
    Every(f64),
    /// Every so many steps.
    Steps(u64),
    /// At the start and at the end only, since the end is not known beforehand.
    Ends,
}

impl Frames {
    /// More frames than this are refused.
    pub const MOST: u64 = 100_000;

    /// How many frames a run with these ends has at most, first and last among them; `None` where its end is not known.
    #[must_use]
    pub fn count(&self, ends: &Ends) -> Option<u64> {
        let between = match *self {
            _ if ends.until == Some(Until::Equilibrium) => 0.0,
            Frames::Every(every) => (ends.time? / every).ceil(),
            Frames::Steps(every) => (ends.steps? as f64 / every as f64).ceil(),
            Frames::Ends => return None,
        };
        Some((between as u64).saturating_add(1)) // a float beyond u64 becomes its largest number
    }
}
