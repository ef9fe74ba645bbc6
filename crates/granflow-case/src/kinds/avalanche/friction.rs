//! What flows, and what holds it back: friction laws, earth pressure, the material in plain numbers.

use std::f64::consts::FRAC_PI_2;

use granflow_model::savage_hutter::friction as law;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::CaseError;
use crate::look::Look;
use crate::units::{Angle, RADIANS};

/// What flows and what holds it back, in plain numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Name of the friction law, as the case file writes it.
    pub friction: &'static str,
    /// Coefficient of the friction that grows with the load, mu = tan(delta).
    pub mu: f64,
    /// The friction law.
    pub law: law::Law,
    /// The earth-pressure coefficient k.
    pub pressure_coefficient: f64,
    /// Gravity g: m/s^2 on terrain, 1 where times are scaled by sqrt(L/g).
    pub gravity: f64,
    /// Bulk density rho, kg/m^3 on terrain.
    pub density: f64,
}

/// The earth-pressure coefficient k in beta = epsilon k cos(zeta).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum EarthPressure {
    /// k = 1.
    #[default]
    Isotropic,
    /// k = 1 + 2 tan(delta)^2, internal friction equal to bed friction (Kaland & Struckmeier 2007).
    Kaland,
}

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

/// Pouliquen & Forterre's law; its values for glass beads of 0.5 mm are mu1 = 0.384, mu2 = 0.594, mu3 = 0.408, length = 6.5e-4.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PouliquenForterre {
    /// Tangent of the angle at which thick layers stop.
    pub mu1: f64,
    /// Tangent of the angle above which none stops.
    pub mu2: f64,
    /// Tangent of the angle at which thick layers start.
    pub mu3: f64,
    /// Length L over which the thickness matters, in m.
    pub length: f64,
    /// Froude number of the thinnest uniform flow (default 0.136).
    #[serde(default = "beta")]
    pub beta: f64,
    /// Exponent of slow flow (default 1e-3).
    #[serde(default = "gamma")]
    pub gamma: f64,
}

fn beta() -> f64 {
    0.136
}

fn gamma() -> f64 {
    1e-3
}

/// The law mu(I).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MuI {
    /// mu of slow flow.
    #[serde(alias = "mu1")]
    pub mu_s: f64,
    /// mu of fast flow.
    #[serde(alias = "mu2")]
    pub mu_2: f64,
    /// Inertial number half way between them.
    pub i0: f64,
    /// Diameter of the grains in m.
    pub grain: f64,
    /// Share of the volume that the grains fill (default 0.6).
    #[serde(default = "phi")]
    pub phi: f64,
}

fn phi() -> f64 {
    0.6
}

/// Bingham's law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bingham {
    /// Yield stress in Pa.
    #[serde(rename = "yield", alias = "tau0")]
    pub yield_stress: f64,
    /// Viscosity in Pa s.
    #[serde(alias = "eta")]
    pub viscosity: f64,
}

/// Herschel and Bulkley's law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct HerschelBulkley {
    /// Yield stress in Pa.
    #[serde(rename = "yield", alias = "tau0")]
    pub yield_stress: f64,
    /// Consistency k in Pa s^n.
    #[serde(alias = "k")]
    pub consistency: f64,
    /// Exponent n, from 0.3 to 1.5.
    #[serde(alias = "n")]
    pub exponent: f64,
}

/// The quadratic law of mud and debris.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Quadratic {
    /// Yield stress tau0 in Pa.
    pub tau0: f64,
    /// Viscosity eta in Pa s.
    pub eta: f64,
    /// Resistance parameter K of laminar flow (default 24, a wide smooth bed).
    #[serde(default = "wide")]
    pub k: f64,
    /// Manning's n in s/m^(1/3) (default 0).
    #[serde(default)]
    pub manning: f64,
}

fn wide() -> f64 {
    24.0
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
    pub mu: Option<f64>,
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
    pub mu: Option<f64>,
    /// Turbulent friction xi in m/s^2.
    pub xi: f64,
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
    pub mu: Option<f64>,
    /// Cohesion tau0 in Pa.
    pub tau0: f64,
}

/// The samosAT law with AvaFrame's default values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Samosat {
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

impl EarthPressure {
    /// The coefficient k under a friction coefficient mu.
    fn coefficient(self, mu: f64) -> f64 {
        match self {
            Self::Isotropic => 1.0,
            Self::Kaland => 1.0 + 2.0 * mu.powi(2),
        }
    }
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
                angle.map(|angle| angle.radians().tan()).or(*mu)
            }
            _ => None,
        }
    }

    /// The law and what it acts on, in plain numbers.
    pub fn material(
        &self,
        look: &Look,
        pressure: EarthPressure,
        gravity: f64,
        density: f64,
    ) -> Result<Material, CaseError> {
        let mu = self.check(look)?;
        let law = match self {
            Self::Coulomb(_) => law::Law::Coulomb(law::Coulomb { mu }),
            Self::Voellmy(law) => law::Law::Voellmy(law::Voellmy { mu, xi: law.xi, gravity }),
            Self::Cohesion(law) => law::Law::Cohesion(law::Cohesion { mu, bond: law.tau0 / density }),
            Self::Samosat(Samosat { tau0, rs0, kappa, r, b, .. }) => {
                let bond = tau0 / density;
                law::Law::SamosAt(law::SamosAt { mu, bond, rs0: *rs0, kappa: *kappa, r: *r, b: *b })
            }
            Self::PouliquenForterre(PouliquenForterre { mu1, mu2, mu3, length, beta, gamma }) => {
                let mu = [*mu1, *mu2, *mu3];
                let law = law::PouliquenForterre { mu, length: *length, beta: *beta, gamma: *gamma };
                law::CellByCell::PouliquenForterre(law).into()
            }
            Self::MuI(MuI { mu_s, mu_2, i0, grain, phi }) => {
                law::CellByCell::MuI(law::MuI { mu1: *mu_s, mu2: *mu_2, i0: *i0, grain: *grain, phi: *phi })
                    .into()
            }
            Self::Bingham(Bingham { yield_stress, viscosity }) => {
                let (bond, consistency) = (yield_stress / density, viscosity / density);
                law::CellByCell::HerschelBulkley(law::HerschelBulkley { bond, consistency, n: 1.0 }).into()
            }
            Self::HerschelBulkley(HerschelBulkley { yield_stress, consistency, exponent }) => {
                let (bond, consistency) = (yield_stress / density, consistency / density);
                law::CellByCell::HerschelBulkley(law::HerschelBulkley { bond, consistency, n: *exponent })
                    .into()
            }
            Self::Quadratic(Quadratic { tau0, eta, k, manning }) => {
                law::CellByCell::Quadratic(law::Quadratic {
                    bond: tau0 / density,
                    viscosity: eta / density,
                    k: *k,
                    manning: *manning,
                    gravity,
                })
                .into()
            }
        };
        let pressure_coefficient = pressure.coefficient(mu);
        Ok(Material { friction: self.name(), mu, law, pressure_coefficient, gravity, density })
    }

    /// The ranges of the law's numbers; its mu = tan(delta).
    fn check(&self, look: &Look) -> Result<f64, CaseError> {
        let at = format!("material.friction.{}", self.name());
        let key = |name: &str| format!("{at}.{name}");
        let mu = match self {
            Self::Coulomb(Coulomb { angle, mu })
            | Self::Voellmy(Voellmy { angle, mu, .. })
            | Self::Cohesion(Cohesion { angle, mu, .. }) => self.coefficient(look, *angle, *mu)?,
            Self::Samosat(law) => self.coefficient(look, None, Some(law.mu))?,
            Self::PouliquenForterre(law) => law.mu1,
            Self::MuI(law) => law.mu_s,
            Self::Bingham(_) | Self::HerschelBulkley(_) | Self::Quadratic(_) => 0.0,
        };
        self.check_numbers(look, key)?;
        Ok(mu)
    }

    /// The ranges of the numbers of a law beside mu or an angle; `key` gives the key of one by its name.
    fn check_numbers(&self, look: &Look, key: impl Fn(&str) -> String) -> Result<(), CaseError> {
        match self {
            Self::Coulomb(_) => {}
            Self::Voellmy(law) => look.positive(&key("xi"), Some(law.xi))?,
            Self::Cohesion(law) => look.not_negative(&key("tau0"), Some(law.tau0))?,
            Self::Samosat(law) => {
                look.not_negative(&key("tau0"), Some(law.tau0))?;
                look.not_negative(&key("rs0"), Some(law.rs0))?;
                look.positive(&key("kappa"), Some(law.kappa))?;
                look.positive(&key("r"), Some(law.r))?;
                look.positive(&key("b"), Some(law.b))?;
            }
            Self::PouliquenForterre(law) => {
                look.not_negative(&key("mu1"), Some(law.mu1))?;
                let above = |mu: f64| mu > law.mu1 && mu.is_finite();
                look.number(&key("mu2"), law.mu2, above, "a number above mu1")?;
                let between = |mu: f64| mu >= law.mu1 && mu.is_finite();
                look.number(&key("mu3"), law.mu3, between, "a number not below mu1")?;
                look.positive(&key("length"), Some(law.length))?;
                look.positive(&key("beta"), Some(law.beta))?;
                look.positive(&key("gamma"), Some(law.gamma))?;
            }
            Self::MuI(law) => {
                look.not_negative(&key("mu_s"), Some(law.mu_s))?;
                let above = |mu: f64| mu > law.mu_s && mu.is_finite();
                look.number(&key("mu_2"), law.mu_2, above, "a number above mu_s")?;
                look.positive(&key("i0"), Some(law.i0))?;
                look.positive(&key("grain"), Some(law.grain))?;
                let share = |phi: f64| phi > 0.0 && phi <= 1.0;
                look.number(&key("phi"), law.phi, share, "a share above 0, at most 1")?;
            }
            Self::Bingham(law) => {
                look.not_negative(&key("yield"), Some(law.yield_stress))?;
                look.positive(&key("viscosity"), Some(law.viscosity))?;
            }
            Self::HerschelBulkley(law) => {
                look.not_negative(&key("yield"), Some(law.yield_stress))?;
                look.positive(&key("consistency"), Some(law.consistency))?;
                // The viscosity of a step is that of the speed before: beyond 2 that does not settle.
                let usual = |n: f64| (0.3..=1.5).contains(&n);
                look.number(&key("exponent"), law.exponent, usual, "an exponent from 0.3 to 1.5")?;
            }
            Self::Quadratic(law) => {
                look.not_negative(&key("tau0"), Some(law.tau0))?;
                look.not_negative(&key("eta"), Some(law.eta))?;
                look.not_negative(&key("k"), Some(law.k))?;
                look.not_negative(&key("manning"), Some(law.manning))?;
            }
        }
        Ok(())
    }

    /// mu from exactly one of the two ways to write it.
    fn coefficient(&self, look: &Look, angle: Option<Angle>, mu: Option<f64>) -> Result<f64, CaseError> {
        let name = self.name();
        let at = format!("material.friction.{name}");
        match (angle, mu) {
            (Some(_), Some(_)) => {
                let cure = format!(
                    "keep one of angle and mu = tan(angle); with --set replace the table: --set 'material.friction={{{name}={{mu=0.3}}}}'"
                );
                Err(look.fault(&format!("{at}.mu"), "both `angle` and `mu` are given", &cure))
            }
            (None, None) => {
                let cure = "add angle = \"25 deg\" or mu = 0.4";
                Err(look.fault(&at, "neither `angle` nor `mu` is given", cure))
            }
            (Some(angle), None) => {
                let allowed = "an angle from 0 to below 90 deg (1.5708 rad)";
                let fits = |v: f64| (0.0..FRAC_PI_2).contains(&v);
                look.number(&format!("{at}.angle"), angle.radians(), fits, allowed)
                    .map_err(|error| error.help(RADIANS))?;
                Ok(angle.radians().tan())
            }
            (None, Some(mu)) => look.not_negative(&format!("{at}.mu"), Some(mu)).map(|()| mu),
        }
    }
}
