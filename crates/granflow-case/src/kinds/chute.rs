//! An avalanche on a chute: savage_hutter on `[grid]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::avalanche::{self, EarthPressure, Friction, InSpace, Material, Method, SchemeName};
use super::{About, Foreign, Kind, Written, joined};
use crate::boundary::{Boundary, Side};
use crate::ensemble;
use crate::fault::CaseError;
use crate::grid::{Axis, Grid};
use crate::look::Look;
use crate::output::{Defaults, ON_A_GRID, Output};
use crate::plan::{Ends, RunPlan};
use crate::precision::Precision;
use crate::source::Missing;
use crate::watched::{self, Gauge, SectionWords};

mod initial;
mod slope;

use initial::Initial;
pub use initial::InitialState;
pub use slope::Columns;
use slope::Slope;

/// The film of a case that says none, in the unit of the depth.
pub const FILM: f64 = 1e-6;

/// The threshold on a chute where nobody says another one, in the unit of the thickness, which the papers
/// scale to order 1.
pub const THRESHOLD: f64 = 1e-3;

/// The thickness of a trickle on a chute where nobody says another one, in the unit of the thickness.
pub const TRICKLE: f64 = 1e-3;

/// An avalanche on a chute, in plain numbers.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The cells.
    pub grid: Grid,
    /// What happens at the low and the high edge along x and along y.
    pub sides: [[Side; 2]; 2],
    /// Slope and curvature of the columns of cells.
    pub columns: Columns,
    /// Ratio of the scales of height and length, epsilon = H/L.
    pub epsilon: f64,
    /// Characteristic curvature eta = L/R.
    pub eta: f64,
    /// What flows, and what holds it back.
    pub material: Material,
    /// The scheme.
    pub scheme: Method<SchemeName>,
    /// The state at the start.
    pub initial: InitialState,
}

impl Plan {
    /// Normal acceleration of a column of cells at rest, g cos(zeta).
    #[must_use]
    pub fn weight(&self, column: usize) -> f64 {
        self.material.gravity * self.columns.zeta(column).cos()
    }
    /// Pressure coefficient of a column of cells, beta = epsilon k g cos(zeta): the pressure is beta h^2/2.
    #[must_use]
    pub fn beta(&self, column: usize) -> f64 {
        self.epsilon * self.material.pressure_coefficient * self.weight(column)
    }
}

/// An avalanche in the papers' scaling, on a chute.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Chute")]
pub(crate) struct Words {
    /// What the figures and the report are headed with.
    #[serde(default)]
    title: String,
    /// The model.
    #[serde(default)]
    model: avalanche::Model,
    /// The cells.
    grid: Bounded,
    /// The material and the chute it flows down.
    material: OnChute,
    /// The state at the start.
    initial: Initial,
    /// The method.
    #[serde(default)]
    scheme: avalanche::Scheme,
    /// The end of the run.
    time: avalanche::Time,
    /// The files.
    #[serde(default)]
    output: Output,
    /// Places that are looked at.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    gauge: Vec<Gauge>,
    /// Lines through which the passing mass is counted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    section: Vec<SectionWords>,
    /// Many runs of this case, for `granflow ensemble`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ensemble: Option<ensemble::Words>,
}

/// A regular grid along x, and along y if the case is two-dimensional, in the case's unit of length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ChuteGrid")]
struct Bounded {
    /// The cells along x, down the chute.
    x: Axis,
    /// The cells along y, across the chute; without it the case is one-dimensional.
    #[serde(skip_serializing_if = "Option::is_none")]
    y: Option<Axis>,
    /// What happens at the edges: one word for all, or { x = ..., y = ... } with a word or a pair [low, high] each (default
    /// "open").
    #[serde(default)]
    boundary: Boundary,
}

/// The material and the chute it flows down.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ChuteMaterial")]
struct OnChute {
    /// Ratio of the scales of height and length, epsilon = H/L (default 1: heights and lengths in one unit).
    #[serde(skip_serializing_if = "Option::is_none")]
    epsilon: Option<f64>,
    /// Inclination zeta of the chute, positive downhill along +x: an angle, or a profile over x (default 0).
    #[serde(skip_serializing_if = "Option::is_none")]
    slope: Option<Slope>,
    /// Characteristic curvature eta = L/R of a curved chute, the factor of kappa u^2 in the friction (default 1).
    #[serde(skip_serializing_if = "Option::is_none")]
    eta: Option<f64>,
    /// Bulk density rho (default 1).
    #[serde(skip_serializing_if = "Option::is_none")]
    density: Option<f64>,
    /// The friction law at the bed.
    friction: Friction,
    /// The earth-pressure coefficient k.
    #[serde(default)]
    earth_pressure: EarthPressure,
    /// Gravity g (default 1: times are scaled by sqrt(L/g)).
    #[serde(skip_serializing_if = "Option::is_none")]
    gravity: Option<f64>,
}

impl Written for Words {
    const ABOUT: About = About {
        model: avalanche::MODEL,
        place: "grid",
        keys: &KEYS,
        foreign: FOREIGN,
        schemes: avalanche::SCHEMES,
        until: avalanche::UNTIL,
        missing: MISSING,
    };

    fn check(&self, look: &Look) -> Result<(RunPlan, Kind), CaseError> {
        let Self { title, grid, material, initial, time, output, .. } = self;
        let scheme = &self.scheme.or(SchemeName::EnergyStable);
        let cells = Grid { x: grid.x.clone(), y: grid.y.clone() };
        cells.check(look, STATE)?;
        let sides = grid.boundary.check(look, &cells)?;
        let (material, columns) = material.check(look, &cells.x)?;
        let stepping = scheme.check(look)?;
        if material.by_volume {
            let message = "`size = \"auto\"` needs the cubic metres of a [terrain]";
            return Err(look.fault("material.friction.samosat.size", message, "on a [grid] name the size"));
        }
        if let Some(InSpace { key, .. }) = material.in_space.first() {
            let message = "a parameter that differs from place to place needs a [terrain]";
            return Err(look.fault(key, message, "on a [grid] give one number"));
        }
        material.check_scheme(look, scheme.name)?;
        self.check_published(look, scheme.name)?;
        let ends = time.check(look, scheme.name, TRICKLE)?;
        self.check_rest(look, &ends, sides[0], &columns)?;
        check_pressure(look, &material, &sides)?;
        let written = output.check(look, &ends, &WRITTEN)?;
        if output.durations.is_some_and(|durations| durations.pressure.is_some()) {
            let message = "there is no pressure on a chute, only on [terrain]";
            return Err(look.fault(
                "output.durations.pressure",
                message,
                "write a threshold of the speed instead",
            ));
        }
        let watched = watched::check(
            look,
            &self.gauge,
            &self.section,
            output.series_every,
            1 + usize::from(cells.y.is_some()),
        )?;
        let initial = initial.check(look, &cells)?;
        let run = avalanche::plan(look, title, scheme, &material, stepping, ends, (written, watched));
        let kind = Kind::Chute(Plan {
            grid: cells,
            sides,
            columns,
            epsilon: self.material.epsilon.unwrap_or(1.0),
            eta: self.material.eta.unwrap_or(1.0),
            material,
            scheme: scheme.method(scheme.name, FILM),
            initial,
        });
        Ok((run, kind))
    }

    fn ensemble(&self) -> Option<(&ensemble::Words, bool)> {
        self.ensemble.as_ref().map(|words| (words, false))
    }
}

impl Words {
    /// What the published schemes cannot do.
    fn check_published(&self, look: &Look, scheme: SchemeName) -> Result<(), CaseError> {
        if !scheme.is_published() {
            return Ok(());
        }
        let name = scheme.as_str();
        let refuse = |key: &str, what: &str| {
            let cure = "use the scheme energy_stable, which can";
            Err(look.fault(key, format!("{name} {what}"), cure))
        };
        let friction = &self.material.friction;
        if !matches!(friction, Friction::Coulomb(_)) {
            return refuse(&format!("material.friction.{}", friction.name()), "knows Coulomb friction only");
        }
        if matches!(self.material.slope, Some(Slope::Profile(_))) {
            return refuse("material.slope", "works on a constant slope only");
        }
        Ok(())
    }
}

impl Words {
    /// A run that waits for rest on a periodic chute steeper than friction everywhere would never end.
    fn check_rest(
        &self,
        look: &Look,
        ends: &Ends,
        along: [Side; 2],
        columns: &Columns,
    ) -> Result<(), CaseError> {
        let waits = ends.until.is_some() && ends.time.is_none() && ends.steps.is_none();
        let Some(mu) = self.material.friction.slipping().filter(|_| waits && along[0] == Side::Periodic)
        else {
            return Ok(());
        };
        let steep = |sign: f64| (0..self.grid.x.cells).all(|column| sign * columns.zeta(column).tan() > mu);
        if !steep(1.0) && !steep(-1.0) {
            return Ok(());
        }
        let message = format!(
            "the chute is steeper than friction everywhere (mu = {mu:.4}) and has no end: nothing ever rests"
        );
        Err(look.fault(
            "time.until",
            message,
            "add an end, for instance end = 10.0, or take a gentler material.slope",
        ))
    }
}

impl OnChute {
    fn check(&self, look: &Look, axis: &Axis) -> Result<(Material, Columns), CaseError> {
        look.usual("material.epsilon", self.epsilon)?;
        look.usual("material.gravity", self.gravity)?;
        look.usual("material.density", self.density)?;
        look.not_negative("material.eta", self.eta)?;
        let (gravity, density) = (self.gravity.unwrap_or(1.0), self.density.unwrap_or(1.0));
        let material = self.friction.material(look, self.earth_pressure, gravity, density)?;
        let columns = self.slope.clone().unwrap_or_default().check(look, axis)?;
        Ok((material, columns))
    }
}

/// Passive earth pressure is found from end to end of a line.
fn check_pressure(look: &Look, material: &Material, sides: &[[Side; 2]; 2]) -> Result<(), CaseError> {
    let passive = material.passive_coefficient > material.pressure_coefficient;
    if passive && sides.iter().flatten().any(|side| *side == Side::Periodic) {
        let message = "active and passive earth pressure does not go round periodic ends";
        let cure = "use open ends or walls, or earth_pressure = \"kaland\"";
        return Err(look.fault("grid.boundary", message, cure));
    }
    Ok(())
}

/// Bytes of the state of a cell in two dimensions, before anything is computed.
const STATE: f64 = 24.0;

/// What is written where the case does not say.
const WRITTEN: Defaults = Defaults { files: ON_A_GRID, precision: Precision::F64, threshold: THRESHOLD };

/// Keys that not every model has.
const KEYS: [&str; 15] = joined(
    avalanche::KEYS,
    ["grid.boundary", "initial.thickness", "initial.velocity_x", "initial.velocity_y", "initial.result"],
);

/// Keys of other kinds.
const FOREIGN: &[Foreign] = &[Foreign {
    key: "release",
    message: Some("[[release]] needs [terrain]"),
    cure: "on a grid write [initial] thickness instead",
}];

/// Keys that a case must have.
const MISSING: &[Missing] = &[
    Missing {
        key: "grid",
        message: Some("the case has neither [grid] nor [terrain]"),
        cure: "add [grid] for a scaled case, [terrain] for a mountain; `granflow new --list` shows cases to start from",
    },
    Missing {
        key: "initial",
        message: Some("a case with [grid] needs an [initial] thickness"),
        cure: "add for instance initial.thickness = 1.0",
    },
    avalanche::NO_MATERIAL,
    avalanche::NO_FRICTION,
    avalanche::NO_TIME,
];
