//! A growing sandpile: hadeler_kuttler on `[grid]`.

use crate::shown::one_line;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{About, Foreign, Kind, Written};
use crate::fault::CaseError;
use crate::grid::Grid;
use crate::look::Look;
use crate::output::{Defaults, ON_A_GRID, Output};
use crate::plan::{RunPlan, Until};
use crate::precision::Precision;
use crate::quantity::Quantity;
use crate::source::Missing;
use crate::watched::Watched;

mod check;
mod layers;
mod method;
mod plan;
mod source;
mod table;

use method::{Scheme, Time};
use source::Words as SourceWords;
use table::Words as TableWords;

pub use method::SchemeName;
pub use plan::TablePlan;
pub use source::Sources;
pub use table::Edge;

/// A growing sandpile, in plain numbers.
#[derive(Debug)]
pub struct Plan {
    /// The cells.
    pub grid: Grid,
    /// The scheme.
    pub scheme: SchemeName,
    /// Exponent m of Theta = E^2/(E^2 + h^m) in the scheme adaptive.
    pub theta_exponent: f64,
    /// The table and what is poured on it.
    pub table: Poured,
}

/// A table and what is poured on it, in one dimension or two.
#[derive(Debug)]
pub enum Poured {
    /// In one dimension.
    Line(Box<Pile<1>>),
    /// In two dimensions.
    Plane(Box<Pile<2>>),
}

/// A table and what is poured on it.
#[derive(Debug)]
pub struct Pile<const D: usize> {
    /// The table, its height, and the layers at the start.
    pub table: TablePlan<D>,
    /// The sources.
    pub sources: Sources,
}

/// A growing sandpile, a standing and a rolling layer on a table.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Sandpile")]
pub(crate) struct Words {
    /// What the figures and the report are headed with.
    #[serde(default)]
    title: String,
    /// The model.
    model: Model,
    /// The cells.
    grid: Grid,
    /// The table: the whole grid, open at all edges, if the case does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    table: Option<TableWords>,
    /// The sand that is poured on the table.
    #[serde(default, rename = "source", skip_serializing_if = "Vec::is_empty")]
    sources: Vec<SourceWords>,
    /// The state at the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    initial: Option<Initial>,
    /// The method.
    #[serde(default)]
    scheme: Scheme,
    /// The end of the run.
    time: Time,
    /// The files.
    #[serde(default)]
    output: Output,
}

/// Name of the model.
const MODEL: &str = "hadeler_kuttler";

/// The model of a growing sandpile.
#[derive(Debug, Clone, Copy, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "SandpileModel")]
enum Model {
    /// A growing sandpile, a standing and a rolling layer on a table (Hadeler & Kuttler 1999).
    HadelerKuttler,
}

/// The two layers at time 0.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "SandpileInitial")]
struct Initial {
    /// Standing layer u at the corners of the cells, not negative (default 0).
    #[serde(skip_serializing_if = "Option::is_none")]
    standing_layer: Option<Quantity>,
    /// Rolling layer v at the centres of the cells, not negative (default 0).
    #[serde(skip_serializing_if = "Option::is_none")]
    rolling_layer: Option<Quantity>,
}

/// Bytes that a cell of a table takes while the case is checked: measured.
const TABLE: f64 = 80.0;

impl Written for Words {
    const ABOUT: About = About {
        model: MODEL,
        place: "grid",
        keys: KEYS,
        foreign: FOREIGN,
        schemes: method::NAMES,
        until: &["steady"],
        missing: MISSING,
    };

    fn check(&self, look: &Look) -> Result<(RunPlan, Kind), CaseError> {
        let Self { title, grid, scheme, time, output, .. } = self;
        grid.check(look, TABLE)?;
        let stepping = scheme.check(look)?;
        let ends = time.check(look)?;
        let output = output.check(look, &ends, &WRITTEN)?;
        self.check_files(look)?;
        let mut notes: Vec<String> = ends.note().into_iter().collect();
        let waits = matches!(ends.until, Some(Until::Steady { .. } | Until::Equilibrium));
        let table = match &grid.y {
            None => Poured::Line(Box::new(self.pile(look, waits, &mut notes)?)),
            Some(_) => Poured::Plane(Box::new(self.pile(look, waits, &mut notes)?)),
        };
        let run = RunPlan {
            watched: Watched::default(),
            title: one_line(title),
            model: MODEL,
            scheme: scheme.name.as_str(),
            stepping,
            max_courant: scheme.name.limits().max_courant,
            ends,
            output,
            notes,
            inputs: Vec::new(),
            ensemble: None,
            source: look.source.clone(),
        };
        let kind = Kind::Sandpile(Plan {
            grid: grid.clone(),
            scheme: scheme.name,
            theta_exponent: scheme.theta_exponent.unwrap_or(2.0),
            table,
        });
        Ok((run, kind))
    }
}

/// What is written where the case does not say.
const WRITTEN: Defaults = Defaults { files: ON_A_GRID, precision: Precision::F64, threshold: 0.0 };

/// Keys that not every model has.
const KEYS: &[&str] = &[
    "table",
    "source",
    "initial.standing_layer",
    "initial.rolling_layer",
    "scheme.theta_exponent",
    "time.steady_rate",
    "time.method",
];

/// A key that has no meaning here.
const fn no_meaning(key: &'static str, cure: &'static str) -> Foreign {
    Foreign { key, message: None, cure }
}

/// Keys of other kinds, and what a sandpile has instead.
const FOREIGN: &[Foreign] = &[
    no_meaning("terrain", "write [grid], and [table] with mask.file for a table of any shape"),
    no_meaning("release", "write [[source]], or initial.standing_layer"),
    no_meaning(
        "material",
        "remove it: slopes are in units of the angle of repose, nothing else is left to choose",
    ),
    no_meaning("grid.boundary", "use [table] open = [\"left\", ...]: the other edges are walls"),
    no_meaning("initial.thickness", "write initial.standing_layer or initial.rolling_layer"),
    no_meaning("initial.velocity_x", "remove it: the rolling layer rolls down the slope"),
    no_meaning("initial.velocity_y", "remove it: the rolling layer rolls down the slope"),
    no_meaning("scheme.film", "remove it: there are no films"),
    no_meaning(
        "output.threshold",
        "remove it: a sandpile has no maps of peaks and times for a layer to count in",
    ),
    no_meaning("time.rest_speed", "write until = \"steady\" and steady_rate"),
    no_meaning("time.trickle", "write until = \"steady\" and steady_rate"),
    no_meaning("time.stop", "write until = \"steady\" and steady_rate"),
];

/// Keys that a case must have.
const MISSING: &[Missing] = &[
    Missing {
        key: "grid",
        message: Some("the case has no [grid]"),
        cure: "add grid.x, and grid.y for two dimensions; `granflow new --list` shows cases to start from",
    },
    Missing { key: "time", message: None, cure: "add a table [time] with steps, end or until = \"steady\"" },
];
