//! The friction laws as a case writes them.

use granflow_model::savage_hutter::friction::AnyLaw;
use granflow_model::scheme::Components;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameter::{Number, Parameter, Range};
use crate::fault::CaseError;
use crate::look::Look;
use crate::units::Angle;

/// The friction law: the acceleration that resists motion, per normal load N+ and thickness h.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Friction {
    /// Coulomb: mu N+.
    Coulomb(Coulomb),
    /// Voellmy: mu N+ + g |V|^2/(xi h).
    Voellmy(Voellmy),
    /// Coulomb with cohesion: mu N+ + tau0/(rho h).
    Cohesion(Cohesion),
    /// samosAT, the default law of AvaFrame: [tau0 + mu sigma (1 + rs0/(rs0 + Rs)) + rho |V|^2/(ln(h/r)/kappa + b)^2]/(rho h).
    Samosat(Samosat),
    /// Pouliquen & Forterre (2002): starts above one thickness, stops below a smaller one.
    #[serde(rename = "pouliquen", alias = "pouliquen_forterre")]
    PouliquenForterre(PouliquenForterre),
    /// mu(I), averaged over the depth (Gray & Edwards 2014).
    MuI(MuI),
    /// Bingham: a yield stress and a viscosity.
    Bingham(Bingham),
    /// Herschel-Bulkley: tau0 + k (rate of shear)^n.
    HerschelBulkley(HerschelBulkley),
    /// The quadratic law of mud and debris (O'Brien, Julien & Fullerton 1993).
    Quadratic(Quadratic),
}

impl Friction {
    /// The name a case file writes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Coulomb(_) => "coulomb",
            Self::Voellmy(_) => "voellmy",
            Self::Cohesion(_) => "cohesion",
            Self::Samosat(_) => "samosat",
            Self::PouliquenForterre(_) => "pouliquen",
            Self::MuI(_) => "mu_i",
            Self::Bingham(_) => "bingham",
            Self::HerschelBulkley(_) => "herschel_bulkley",
            Self::Quadratic(_) => "quadratic",
        }
    }

    /// mu of a law that holds no layer, however thin, on a bed steeper than mu; of a law without such a bound none.
    pub fn slipping(&self) -> Option<f64> {
        match self {
            Self::Coulomb(Coulomb { angle, mu }) | Self::Voellmy(Voellmy { angle, mu, .. }) => {
                angle.map(|angle| angle.radians().tan()).or(mu.as_ref().map(Parameter::usual))
            }
            _ => None,
        }
    }

    /// Does the friction grow with the load, by the first number?
    pub fn has_mu(&self) -> bool {
        !matches!(self, Self::Bingham(_) | Self::HerschelBulkley(_) | Self::Quadratic(_))
    }

    /// The numbers of the law in the order in which the model has them.
    pub fn numbers(&self, look: &Look, gravity: f64, density: f64) -> Result<Vec<Number<'_>>, CaseError> {
        Ok(match self {
            Self::Coulomb(Coulomb { angle, mu }) => vec![self.coefficient(look, *angle, mu.as_ref())?],
            Self::Voellmy(Voellmy { angle, mu, xi }) => vec![
                self.coefficient(look, *angle, mu.as_ref())?,
                Number::of("xi", xi, Range::Positive),
                Number::fixed(gravity),
            ],
            Self::Cohesion(Cohesion { angle, mu, tau0 }) => vec![
                self.coefficient(look, *angle, mu.as_ref())?,
                Number::of("tau0", tau0, Range::NotNegative).per(density),
            ],
            Self::Samosat(law) => law.numbers(density),
            Self::PouliquenForterre(law) => law.numbers(),
            Self::MuI(law) => law.numbers(),
            Self::Bingham(law) => law.numbers(density),
            Self::HerschelBulkley(law) => law.numbers(density),
            Self::Quadratic(law) => law.numbers(gravity, density),
        })
    }

    /// The law of these numbers.
    pub fn law(&self, numbers: &[f64]) -> AnyLaw {
        fn of<L: Components<f64>>(numbers: &[f64]) -> L {
            L::load(|k| numbers[k])
        }
        match self {
            Self::Coulomb(_) => AnyLaw::Coulomb(of(numbers)),
            Self::Voellmy(_) => AnyLaw::Voellmy(of(numbers)),
            Self::Cohesion(_) => AnyLaw::Cohesion(of(numbers)),
            Self::Samosat(_) => AnyLaw::SamosAt(of(numbers)),
            Self::PouliquenForterre(_) => AnyLaw::PouliquenForterre(of(numbers)),
            Self::MuI(_) => AnyLaw::MuI(of(numbers)),
            Self::Bingham(_) | Self::HerschelBulkley(_) => AnyLaw::HerschelBulkley(of(numbers)),
            Self::Quadratic(_) => AnyLaw::Quadratic(of(numbers)),
        }
    }
}

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
    /// Friction coefficient mu (default 0.155); give it or `size`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<Parameter>,
    /// AvaFrame's calibration for avalanches of this size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<AvalancheSize>,
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
        let [tau0, rs0, kappa, r, b] = [0.0, 0.222, 0.43, 0.05, 4.13].map(Parameter::Number);
        Self { mu: None, size: None, tau0, rs0, kappa, r, b }
    }
}

/// How large an avalanche is: AvaFrame's calibrations of samosAT (com1DFACfg.ini of AvaFrame 2.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AvalancheSize {
    /// By the released volume.
    Auto,
    /// Below 25,000 m^3: mu = 0.22.
    Small,
    /// Below 60,000 m^3: mu = 0.17.
    Medium,
    /// mu = 0.155.
    Large,
}

impl AvalancheSize {
    /// That of a released volume \[m^3\].
    #[must_use]
    pub fn of(volume: f64) -> Self {
        match volume {
            volume if volume < 25_000.0 => Self::Small,
            volume if volume < 60_000.0 => Self::Medium,
            _ => Self::Large,
        }
    }
    /// mu.
    #[must_use]
    pub fn mu(self) -> f64 {
        match self {
            Self::Small => 0.22,
            Self::Medium => 0.17,
            Self::Large | Self::Auto => 0.155,
        }
    }
}

// The numbers of each law in the order in which the model has them; a stress is divided by the density, for the model has accelerations.

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
        let size = self.size.unwrap_or(AvalancheSize::Large);
        let mu = self.mu.as_ref().map(|mu| Number::of("mu", mu, Range::NotNegative));
        vec![
            mu.unwrap_or(Number::fixed(size.mu())),
            Number::of("tau0", &self.tau0, Range::NotNegative).per(density),
            Number::of("rs0", &self.rs0, Range::NotNegative),
            Number::of("kappa", &self.kappa, Range::Positive),
            Number::of("r", &self.r, Range::Positive),
            Number::of("b", &self.b, Range::Positive),
        ]
    }
}
