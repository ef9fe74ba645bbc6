//! `[scheme]` and `[time]` of a sandpile: which method, which time step, when the run ends.

use granflow_model::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::CaseError;
use crate::look::Look;
use crate::plan::{Ends, Stepping, Until};
use crate::stepping::StepLimits;

/// The numerical method.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "SandpileScheme")]
pub(super) struct Scheme {
    /// Name of the method.
    #[serde(default)]
    pub name: SchemeName,
    /// A fixed time step; instead of `courant`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Courant number of the adaptive step: at most 1 (default 0.45) at first order, 0.5 (default 0.225) at second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub courant: Option<f64>,
    /// Exponent m of Theta = E^2/(E^2 + h^m) in the scheme adaptive (default 2).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theta_exponent: Option<f64>,
}

/// The methods of Aggarwal, Veerappa Gowda & Sudarshan Kumar (2023).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "SandpileSchemeName")]
pub enum SchemeName {
    /// First order, well-balanced.
    FirstOrder,
    /// Second order, not well-balanced.
    SecondOrder,
    /// Second order away from steady states and well-balanced at them: the default.
    #[default]
    Adaptive,
}

/// The names of all methods.
pub(super) const NAMES: &[&str] =
    &[SchemeName::FirstOrder.as_str(), SchemeName::SecondOrder.as_str(), SchemeName::Adaptive.as_str()];

impl SchemeName {
    /// The name a case file writes and the summary repeats.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::FirstOrder => "first_order",
            Self::SecondOrder => "second_order",
            Self::Adaptive => "adaptive",
        }
    }

    /// What a case may say about the step.
    pub(super) fn limits(self) -> StepLimits {
        let scheme = match self {
            Self::FirstOrder => FIRST_ORDER,
            Self::SecondOrder => SECOND_ORDER,
            Self::Adaptive => HadelerKuttler { slopes: Slopes::Adaptive { exponent: 2.0 } },
        };
        StepLimits::of(self.as_str(), &scheme)
    }
}

impl Scheme {
    /// How the time step is chosen.
    pub fn check(&self, look: &Look) -> Result<Stepping, CaseError> {
        let stepping = look.stepping(self.step, self.courant, self.name.limits())?;
        look.positive("scheme.theta_exponent", self.theta_exponent)?;
        if self.theta_exponent.is_some() && self.name != SchemeName::Adaptive {
            return Err(look.fault(
                "scheme.theta_exponent",
                format!("`theta_exponent` has no meaning for {}", self.name.as_str()),
                "remove it, or use the scheme adaptive",
            ));
        }
        Ok(stepping)
    }
}

/// The end of the run: at least one of `steps`, `end`, `until`; the first that is reached ends it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "SandpileTime")]
pub(super) struct Time {
    /// Number of steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
    /// Simulated time; the limit of a run `until = "steady"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
    /// What to wait for: "steady".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<Steady>,
    /// With until = "steady": the rates of change of both layers that count as steady (default 1e-8).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steady_rate: Option<f64>,
    /// With until = "steady": "direct" computes the equilibrium without stepping.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
}

/// What a run waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "SandpileUntil")]
pub(super) enum Steady {
    /// Both layers change more slowly than `steady_rate`.
    Steady,
}

/// How the end is found, if not by stepping.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Method {
    /// From the equations of the equilibrium.
    Direct,
}

impl Time {
    /// What ends the run.
    pub fn check(&self, look: &Look) -> Result<Ends, CaseError> {
        let Self { steps, end, until, steady_rate, method } = self;
        if steps.is_none() && end.is_none() && until.is_none() {
            let cure = "add steps = 1000, end = 10.0 or until = \"steady\"";
            return Err(look.fault("time", "nothing ends the run", cure));
        }
        look.not_zero("time.steps", *steps)?;
        look.positive("time.end", *end)?;
        look.positive("time.steady_rate", *steady_rate)?;
        for (key, given) in [("steady_rate", steady_rate.is_some()), ("method", method.is_some())] {
            if given && until.is_none() {
                return Err(look.fault(
                    &format!("time.{key}"),
                    format!("`{key}` has no meaning without until = \"steady\""),
                    &format!("add until = \"steady\" or remove {key}"),
                ));
            }
        }
        let until = until.map(|Steady::Steady| match method {
            Some(Method::Direct) => Until::Equilibrium,
            None => Until::Steady { rate: steady_rate.unwrap_or(1e-8) },
        });
        Ok(Ends { steps: *steps, time: *end, until, kinetic_energy: None })
    }
}
