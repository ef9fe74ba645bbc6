//! What the kinds of avalanches share: friction, schemes and ends of savage_hutter.

use crate::shown::one_line;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod friction;
mod scheme;
mod time;

pub use friction::{AvalancheSize, ByElevation, FOREST, InSpace, LAYER, Material, Place, Range};
pub use scheme::{Method, SchemeName};

pub(super) use scheme::NAMES as SCHEMES;

pub(super) use friction::{EarthPressure, Friction, Parameter};
pub(super) use scheme::{Chosen, Scheme};
pub(super) use time::Time;

use crate::look::Look;
use crate::plan::{Ends, OutputPlan, RunPlan, Stepping, Until};
use crate::source::Missing;
use crate::watched::Watched;

/// Gravity on terrain where nobody says another one \[m/s^2\].
pub const GRAVITY: f64 = 9.81;

/// Name of the model.
pub(super) const MODEL: &str = "savage_hutter";

/// Keys that not every model has and both kinds of avalanches know.
pub(super) const KEYS: [&str; 10] = [
    "material",
    "scheme.film",
    "time.rest_speed",
    "time.trickle",
    "time.stop",
    "gauge",
    "section",
    "output.series_every",
    "output.durations",
    "ensemble",
];

/// What `time.until` may be.
pub(super) const UNTIL: &[&str] = &["rest"];

/// What an avalanche says of its run: title, scheme and step, ends, and what is written.
pub(super) fn plan(
    look: &Look,
    title: &str,
    scheme: &Chosen<'_>,
    material: &Material,
    stepping: Stepping,
    ends: Ends,
    (output, watched): (OutputPlan, Watched),
) -> RunPlan {
    RunPlan {
        title: one_line(title),
        model: MODEL,
        scheme: scheme.name.as_str(),
        stepping,
        max_courant: scheme.name.limits().max_courant,
        notes: scheme.note().into_iter().chain(ends.note()).chain(slow_rest(material, &ends)).collect(),
        ends,
        output,
        watched,
        inputs: Vec::new(),
        ensemble: None,
        source: look.source.clone(),
    }
}

/// What to know of a run that waits for rest under a law that lets thin layers creep.
fn slow_rest(material: &Material, ends: &Ends) -> Option<String> {
    let Some(Until::Rest { trickle, .. }) = ends.until else { return None };
    material.law.has_drag().then(|| {
        let until = match trickle {
            Some(_) => "the run ends before if nothing but a trickle has moved for long (time.trickle); time.end limits it",
            None => "set time.trickle, as in trickle = 0.01, or time.end for an end before",
        };
        format!(
            "{}: its drag lets thin layers drain ever more slowly, and exact rest can take thousands of seconds; {until}",
            material.friction
        )
    })
}

/// The law is missing.
pub(super) const NO_FRICTION: Missing = Missing {
    key: "material.friction",
    message: None,
    cure: "say a law, for instance friction.coulomb = { angle = \"25 deg\" }; none is friction.coulomb = { mu = 0.0 }",
};

/// The material is missing.
pub(super) const NO_MATERIAL: Missing =
    Missing { key: "material", message: None, cure: "add a table [material] with the friction law" };

/// The end is missing.
pub(super) const NO_TIME: Missing = Missing {
    key: "time",
    message: None,
    cure: "add a table [time] with steps, end, until = \"rest\" or stop.kinetic_energy",
};

/// The model of an avalanche.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Model {
    /// A granular avalanche, depth-averaged (Savage & Hutter 1989).
    #[default]
    SavageHutter,
}
