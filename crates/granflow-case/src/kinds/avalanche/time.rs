//! `[time]` of an avalanche: when the run ends.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::SchemeName;
use crate::fault::CaseError;
use crate::look::Look;
use crate::plan::{Ends, Until};

/// The end of the run: at least one of `steps`, `end`, `until`, `stop`; the first that is reached ends it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "AvalancheTime")]
pub(crate) struct Time {
    /// Number of steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
    /// Simulated time (s on terrain); the limit of a run `until = "rest"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
    /// What to wait for: "rest".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<Rest>,
    /// Speed below which the mass counts as resting; needed with until = "rest" for verfahren_1..5, say 1e-12.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_speed: Option<f64>,
    /// Thickness of a trickle (default 0.01 m on terrain, else 1e-3; 0 waits for exact rest): the run `until = "rest"` also ends
    /// once nothing but a trickle has moved for half as long as the mass flowed before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trickle: Option<f64>,
    /// The classical criteria.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop: Option<Stop>,
}

/// What a run waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "AvalancheUntil")]
pub(crate) enum Rest {
    /// Every cell that is not a film is at rest and would stay so.
    Rest,
}

/// A criterion that ends a run before rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Stop {
    /// Ends once the kinetic energy is below this share of its peak, say 0.01.
    pub kinetic_energy: f64,
}

impl Time {
    /// What ends the run; `usual` is the thickness of a trickle where the case says none.
    pub fn check(&self, look: &Look, scheme: SchemeName, usual: f64) -> Result<Ends, CaseError> {
        let Self { steps, end, until, rest_speed, trickle, stop } = self;
        if steps.is_none() && end.is_none() && until.is_none() && stop.is_none() {
            let cure = "add steps = 1000, end = 10.0, until = \"rest\" or stop.kinetic_energy = 0.01";
            return Err(look.fault("time", "nothing ends the run", cure));
        }
        look.not_zero("time.steps", *steps)?;
        look.positive("time.end", *end)?;
        look.positive("time.rest_speed", *rest_speed)?;
        look.not_negative("time.trickle", *trickle)?;
        if let Some(stop) = stop {
            let fits = |share: f64| share > 0.0 && share < 1.0;
            let allowed = "a share of the peak, between 0 and 1";
            look.number("time.stop.kinetic_energy", stop.kinetic_energy, fits, allowed)?;
        }
        for (name, given) in [("rest_speed", rest_speed.is_some()), ("trickle", trickle.is_some())] {
            if given && until.is_none() {
                return Err(look.fault(
                    &format!("time.{name}"),
                    format!("`{name}` has no meaning without until = \"rest\""),
                    &format!("add until = \"rest\" or remove {name}"),
                ));
            }
        }
        if until.is_some() && scheme.is_published() && rest_speed.is_none() {
            let name = scheme.as_str();
            return Err(look.fault(
                "time.until",
                format!("{name} never reaches speed 0, so until = \"rest\" would never end"),
                "add rest_speed = 1e-12, or use the scheme energy_stable, which stops exactly",
            ));
        }
        let usual = if scheme.is_published() { 0.0 } else { usual };
        let trickle = Some(trickle.unwrap_or(usual)).filter(|thickness| *thickness > 0.0);
        Ok(Ends {
            steps: *steps,
            time: *end,
            until: until.map(|Rest::Rest| Until::Rest { speed: *rest_speed, trickle }),
            kinetic_energy: stop.as_ref().map(|stop| stop.kinetic_energy),
        })
    }
}
