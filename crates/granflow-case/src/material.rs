//! `[material]`: what flows, on which slope, under which friction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::slope::Slope;
use super::units::Angle;

/// The material and, on a grid, the chute it lies on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Ratio of the scales of height and length, epsilon = H/L, on a grid (default 1: heights and lengths in one unit).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub epsilon: Option<f64>,
    /// Inclination zeta of the chute on a grid, positive downhill along +x: an angle, or a profile over x (default 0).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<Slope>,
    /// Characteristic curvature eta = L/R of a curved chute, the factor of kappa u^2 in the friction (default 1).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eta: Option<f64>,
    /// Bulk density rho in kg/m^3; needed on terrain (default 1 on a grid).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// The friction law at the bed.
    pub friction: Friction,
    /// The earth-pressure coefficient k.
    #[serde(default)]
    pub earth_pressure: EarthPressure,
    /// Gravity g (default 9.81 m/s^2 on terrain; 1 on a grid, where times are scaled by sqrt(L/g)).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity: Option<f64>,
}

/// What a case without [material] has.
pub(super) static NONE: Material = Material {
    epsilon: None,
    slope: None,
    eta: None,
    density: None,
    friction: Friction::Coulomb(Coulomb { angle: None, mu: None }),
    earth_pressure: EarthPressure::Isotropic,
    gravity: None,
};

/// The earth-pressure coefficient k in beta = epsilon k cos(zeta).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EarthPressure {
    /// k = 1.
    #[default]
    Isotropic,
    /// k = 1 + 2 tan(delta)^2, internal friction equal to bed friction (Kaland & Struckmeier 2007).
    Kaland,
}

/// The friction law: the acceleration that resists motion, per normal load N+ and thickness h.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Friction {
    /// Coulomb: mu N+.
    Coulomb(Coulomb),
    /// Voellmy: mu N+ + g |V|^2/(xi h).
    Voellmy(Voellmy),
    /// Coulomb with cohesion: mu N+ + tau0/(rho h).
    Cohesion(Cohesion),
    /// samosAT, the default law of AvaFrame: [tau0 + mu sigma (1 + rs0/(rs0 + Rs)) + rho |V|^2/(ln(h/r)/kappa + b)^2]/(rho h).
    Samosat(Samosat),
}

/// Coulomb friction; give `angle` or `mu`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Coulomb {
    /// Friction angle delta, mu = tan(delta).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Angle>,
    /// Friction coefficient mu.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
}

/// Voellmy friction; give `angle` or `mu`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Voellmy {
    /// Friction angle delta, mu = tan(delta).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Angle>,
    /// Friction coefficient mu.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
    /// Turbulent friction xi in m/s^2.
    pub xi: f64,
}

/// Coulomb friction with cohesion; give `angle` or `mu`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cohesion {
    /// Friction angle delta, mu = tan(delta).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Angle>,
    /// Friction coefficient mu.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
    /// Cohesion tau0 in Pa.
    pub tau0: f64,
}

/// The samosAT law with AvaFrame's default values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Samosat {
    /// Friction coefficient mu (default 0.155).
    pub mu: f64,
    /// Yield stress tau0 in Pa (default 0).
    pub tau0: f64,
    /// Constant Rs0 of the fluidisation factor (default 0.222).
    pub rs0: f64,
    /// Karman constant kappa (default 0.43).
    pub kappa: f64,
    /// Roughness length R in m (default 0.05).
    pub r: f64,
    /// Constant B of the logarithmic profile (default 4.13).
    pub b: f64,
}

impl Default for Samosat {
    fn default() -> Self {
        Self { mu: 0.155, tau0: 0.0, rs0: 0.222, kappa: 0.43, r: 0.05, b: 4.13 }
    }
}

impl Friction {
    /// The name a case file writes.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Coulomb(_) => "coulomb",
            Self::Voellmy(_) => "voellmy",
            Self::Cohesion(_) => "cohesion",
            Self::Samosat(_) => "samosat",
        }
    }

    /// What the case writes of `angle` and `mu`.
    pub(super) fn written(&self) -> (Option<Angle>, Option<f64>) {
        match self {
            Self::Coulomb(law) => (law.angle, law.mu),
            Self::Voellmy(law) => (law.angle, law.mu),
            Self::Cohesion(law) => (law.angle, law.mu),
            Self::Samosat(law) => (None, Some(law.mu)),
        }
    }

    /// Coefficient of the part that grows with the load, mu = tan(delta).
    #[must_use]
    pub fn mu(&self) -> f64 {
        let (angle, mu) = self.written();
        mu.or(angle.map(|angle| angle.radians().tan())).unwrap_or(0.0)
    }
}

impl Material {
    /// The ratio epsilon = H/L, 1 if the case does not say.
    #[must_use]
    pub fn epsilon(&self) -> f64 {
        self.epsilon.unwrap_or(1.0)
    }

    /// The characteristic curvature eta = L/R, 1 if the case does not say.
    #[must_use]
    pub fn eta(&self) -> f64 {
        self.eta.unwrap_or(1.0)
    }

    /// The density, 1 if the case does not say (a grid only; on terrain it must).
    #[must_use]
    pub fn density(&self) -> f64 {
        self.density.unwrap_or(1.0)
    }

    /// The earth-pressure coefficient k.
    #[must_use]
    pub fn pressure_coefficient(&self) -> f64 {
        match self.earth_pressure {
            EarthPressure::Isotropic => 1.0,
            EarthPressure::Kaland => 1.0 + 2.0 * self.friction.mu().powi(2),
        }
    }
}
