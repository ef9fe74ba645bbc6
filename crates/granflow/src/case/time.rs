//! `[time]`: when the run ends.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The end of the run: at least one of `steps`, `end`, `until`, `stop`; the first that is reached ends it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Number of steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
    /// Simulated time (s on terrain); the limit of a run `until = "rest"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
    /// What to wait for: "rest".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<Until>,
    /// Speed below which the mass counts as resting; needed with until = "rest" for verfahren_1..5, say 1e-12.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_speed: Option<f64>,
    /// The classical criteria.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop: Option<Stop>,
}

/// What a run waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Until {
    /// Every cell that is not a film is at rest and would stay so.
    Rest,
}

/// A criterion that ends a run before rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Ends once the kinetic energy is below this share of its peak, say 0.01.
    pub kinetic_energy: f64,
}
