//! A case that was checked: everything in plain numbers, evaluated once, for a run to take.

use std::path::{Path, PathBuf};

use super::fault::CaseError;
use super::kinds::Kind;
use super::output::FileKind;
use super::precision::Precision;
use super::source::Source;

/// A checked case: [`RunPlan`] is the same for every kind of case and cheap to copy, [`Kind`] holds the numbers of
/// every cell and is for the run to take apart.
#[derive(Debug)]
pub struct Checked {
    /// When the run ends, how it steps, and which files it writes.
    pub run: RunPlan,
    /// The state at the start and whatever else only this kind of case has.
    pub kind: Kind,
}

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
    /// When the state is written.
    pub frames: Frames,
    /// The kinds of files to write.
    pub files: Vec<FileKind>,
    /// Precision of the numbers in the files.
    pub precision: Precision,
    /// What is allowed but may surprise, one sentence each.
    pub notes: Vec<String>,
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

    /// An error at a key of the case, for what shows only later (a raster without a CRS, a missing attribute).
    #[must_use]
    pub fn fault(&self, key: &str, message: impl Into<String>, cure: &str) -> CaseError {
        self.source.fault(key, message).help(cure)
    }
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

/// The state a run waits for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Until {
    /// Nothing moves.
    Rest {
        /// Speed below which the mass counts as resting too.
        speed: Option<f64>,
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

#[cfg(any())] // follows with the kinds
mod skeleton_of_the_kinds {
    /// One variant for each kind of case, from the list in `kinds.rs`.
    pub enum Kind {
        Chute(chute::Plan),
        Terrain(terrain::Plan),
        Sandpile(sandpile::Plan),
    }

    /// kinds/chute: savage_hutter on [grid].
    pub struct Plan {
        /// Cells along x and y.
        pub grid: Grid, // { x: Axis, y: Option<Axis> }
        /// What happens at the low and high end of x and y.
        pub sides: [[Side; 2]; 2],
        /// Slope zeta at the centre of every column of cells, in radians, and mean curvature kappa over it.
        pub zeta: Vec<f64>,
        pub kappa: Vec<f64>,
        pub material: Material, // plain numbers: epsilon, k, eta, gravity, density, law: granflow_model Law
        pub scheme: SchemeName, // avalanche::SchemeName: Balanced, Balanced2, Verfahren1..5
        pub film: f64,
        /// thickness, velocity_x, velocity_y of every cell, x fastest.
        pub initial: InitialState,
    }

    /// kinds/terrain: savage_hutter on [terrain].
    pub struct Plan {
        /// Paths are resolved against the case's folder.
        pub dem: PathBuf,
        pub crs: Option<String>,
        pub cell: Option<f64>,
        /// Span of the window of the curvature, `None` for "off".
        pub curvature: Option<f64>,
        pub releases: Vec<Release>, // { from: Polygons { path, thickness } | Raster(path) | Cap(cap), measured }
        pub gravity: f64,
        pub density: f64,
        pub law: Law,
        pub scheme: SchemeName, // Balanced | Balanced2 only
        pub film: f64,
    }

    /// kinds/sandpile: hadeler_kuttler on [grid].
    pub struct Plan {
        pub scheme: SchemeName, // FirstOrder | SecondOrder | Adaptive
        pub theta_exponent: f64,
        pub grid: Grid,
        pub poured: Poured, // Line(Box<Pile<1>>) | Plane(Box<Pile<2>>), Pile<D> { table: TablePlan<D>, sources: Sources }
    }
}
