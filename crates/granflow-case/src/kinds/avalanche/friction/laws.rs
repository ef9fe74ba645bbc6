//! The friction laws as a case writes them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameter::{Number, Parameter, Range};
use crate::units::Angle;

/// Pouliquen & Forterre's law; its values for glass beads of 0.5 mm are mu1 = 0.384, mu2 = 0.594, mu3 = 0.408, length = 6.5e-4.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PouliquenForterre {
    /// Tangent of the angle at which thick layers stop.
    pub mu1: Parameter,
    /// Tangent of the angle above which none stops.
    pub mu2: Parameter,
    /// Tangent of the angle at which thick layers start.
    pub mu3: Parameter,
    /// Length L over which the thickness matters, in m.
    pub length: Parameter,
    /// Froude number of the thinnest uniform flow (default 0.136).
    #[serde(default = "beta")]
    pub beta: Parameter,
    /// Exponent of slow flow (default 1e-3).
    #[serde(default = "gamma")]
    pub gamma: Parameter,
}

fn beta() -> Parameter {
    Parameter::Number(0.136)
}

fn gamma() -> Parameter {
    Parameter::Number(1e-3)
}

/// The law mu(I).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MuI {
    /// mu of slow flow.
    #[serde(alias = "mu1")]
    pub mu_s: Parameter,
    /// mu of fast flow.
    #[serde(alias = "mu2")]
    pub mu_2: Parameter,
    /// Inertial number half way between them.
    pub i0: Parameter,
    /// Diameter of the grains in m.
    pub grain: Parameter,
    /// Share of the volume that the grains fill (default 0.6).
    #[serde(default = "phi")]
    pub phi: Parameter,
}

fn phi() -> Parameter {
    Parameter::Number(0.6)
}

/// Bingham's law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bingham {
    /// Yield stress in Pa.
    #[serde(rename = "yield", alias = "tau0")]
    pub yield_stress: Parameter,
    /// Viscosity in Pa s.
    #[serde(alias = "eta")]
    pub viscosity: Parameter,
}

/// Herschel and Bulkley's law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct HerschelBulkley {
    /// Yield stress in Pa.
    #[serde(rename = "yield", alias = "tau0")]
    pub yield_stress: Parameter,
    /// Consistency in Pa s^n.
    #[serde(alias = "k")]
    pub consistency: Parameter,
    /// Exponent n, from 0.2 to 4.
    #[serde(alias = "n")]
    pub exponent: Parameter,
}

/// The quadratic law of mud and debris.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Quadratic {
    /// Yield stress tau0 in Pa.
    pub tau0: Parameter,
    /// Viscosity eta in Pa s.
    pub eta: Parameter,
    /// Resistance parameter K of laminar flow (default 24, a wide smooth bed).
    #[serde(default = "wide")]
    pub k: Parameter,
    /// Manning's n in s/m^(1/3) (default 0).
    #[serde(default = "smooth")]
    pub manning: Parameter,
}

fn smooth() -> Parameter {
    Parameter::Number(0.0)
}

fn wide() -> Parameter {
    Parameter::Number(24.0)
}

/// Coulomb friction; give `angle` or `mu`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Coulomb {
    /// Friction angle delta, mu = tan(delta).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Angle>,
    /// Friction coefficient mu.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<Parameter>,
}

/// Voellmy friction; give `angle` or `mu`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Voellmy {
    /// Friction angle delta, mu = tan(delta).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Angle>,
    /// Friction coefficient mu.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<Parameter>,
    /// Turbulent friction xi in m/s^2.
    pub xi: Parameter,
}

/// Coulomb friction with cohesion; give `angle` or `mu`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Cohesion {
    /// Friction angle delta, mu = tan(delta).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Angle>,
    /// Friction coefficient mu.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<Parameter>,
    /// Cohesion tau0 in Pa.
    pub tau0: Parameter,
}

/// The samosAT law with AvaFrame's default values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Samosat {
    /// Friction coefficient mu (default 0.155).
    pub mu: Parameter,
    /// Yield stress tau0 in Pa (default 0).
    pub tau0: Parameter,
    /// Constant Rs0 of the fluidisation factor (default 0.222).
    pub rs0: Parameter,
    /// Karman constant kappa (default 0.43).
    pub kappa: Parameter,
    /// Roughness length R in m (default 0.05).
    pub r: Parameter,
    /// Constant B of the logarithmic profile (default 4.13).
    pub b: Parameter,
}

impl Default for Samosat {
    fn default() -> Self {
        let [mu, tau0, rs0, kappa, r, b] = [0.155, 0.0, 0.222, 0.43, 0.05, 4.13].map(Parameter::Number);
        Self { mu, tau0, rs0, kappa, r, b }
    }
}

/// The numbers of a law in the order in which the model has them; a stress is divided by the density, for the model has accelerations.
impl PouliquenForterre {
    pub fn numbers(&self) -> Vec<Number<'_>> {
        vec![
            Number::of("mu1", &self.mu1, Range::NotNegative),
            Number::of("mu2", &self.mu2, Range::AboveFirst("mu1")),
            Number::of("mu3", &self.mu3, Range::NotBelowFirst("mu1")),
            Number::of("length", &self.length, Range::Positive),
            Number::of("beta", &self.beta, Range::Positive),
            Number::of("gamma", &self.gamma, Range::Positive),
        ]
    }
}

impl MuI {
    pub fn numbers(&self) -> Vec<Number<'_>> {
        vec![
            Number::of("mu_s", &self.mu_s, Range::NotNegative),
            Number::of("mu_2", &self.mu_2, Range::AboveFirst("mu_s")),
            Number::of("i0", &self.i0, Range::Positive),
            Number::of("grain", &self.grain, Range::Positive),
            Number::of("phi", &self.phi, Range::Share),
        ]
    }
}

impl Bingham {
    pub fn numbers(&self, density: f64) -> Vec<Number<'_>> {
        vec![
            Number::of("yield", &self.yield_stress, Range::NotNegative).per(density),
            Number::of("viscosity", &self.viscosity, Range::Positive).per(density),
            Number::fixed(1.0),
        ]
    }
}

impl HerschelBulkley {
    pub fn numbers(&self, density: f64) -> Vec<Number<'_>> {
        vec![
            Number::of("yield", &self.yield_stress, Range::NotNegative).per(density),
            Number::of("consistency", &self.consistency, Range::Positive).per(density),
            Number::of("exponent", &self.exponent, Range::Exponent),
        ]
    }
}

impl Quadratic {
    pub fn numbers(&self, gravity: f64, density: f64) -> Vec<Number<'_>> {
        vec![
            Number::of("tau0", &self.tau0, Range::NotNegative).per(density),
            Number::of("eta", &self.eta, Range::NotNegative).per(density),
            Number::of("k", &self.k, Range::NotNegative),
            Number::of("manning", &self.manning, Range::NotNegative),
            Number::fixed(gravity),
        ]
    }
}

impl Samosat {
    pub fn numbers(&self, density: f64) -> Vec<Number<'_>> {
        vec![
            Number::of("mu", &self.mu, Range::NotNegative),
            Number::of("tau0", &self.tau0, Range::NotNegative).per(density),
            Number::of("rs0", &self.rs0, Range::NotNegative),
            Number::of("kappa", &self.kappa, Range::Positive),
            Number::of("r", &self.r, Range::Positive),
            Number::of("b", &self.b, Range::Positive),
        ]
    }
}
