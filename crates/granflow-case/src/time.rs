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
    /// What to wait for: "rest" (savage_hutter) or "steady" (hadeler_kuttler).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<Until>,
    /// Speed below which the mass counts as resting; needed with until = "rest" for verfahren_1..5, say 1e-12.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_speed: Option<f64>,
    /// With until = "steady": the rates of change of both layers that count as steady (default 1e-8).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steady_rate: Option<f64>,
    /// With until = "steady": "direct" computes the equilibrium without stepping.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
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
    /// Both layers change more slowly than `steady_rate`.
    Steady,
}

/// How the end is found, if not by stepping.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// From the equations of the equilibrium.
    Direct,
}

impl Time {
    /// Bound on max|u_t| and max|v_t| below which a pile is steady.
    #[must_use]
    pub fn steady_rate(&self) -> f64 {
        self.steady_rate.unwrap_or(1e-8)
    }
}

/// A criterion that ends a run before rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Ends once the kinetic energy is below this share of its peak, say 0.01.
    pub kinetic_energy: f64,
}
