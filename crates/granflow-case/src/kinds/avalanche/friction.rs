//! What flows, and what holds it back: friction laws, earth pressure, the material in plain numbers.

use std::f64::consts::FRAC_PI_2;

use granflow_model::savage_hutter::friction::{AnyLaw, Law};
use granflow_model::scheme::Components;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod laws;
mod parameter;

use laws::{
    Bingham, Cohesion, Coulomb, HerschelBulkley, MuI, PouliquenForterre, Quadratic, Samosat, Voellmy,
};
use parameter::{Number, Parameter};

pub use parameter::{ByElevation, InSpace, Place, Range};

use super::scheme::SchemeName;
use crate::fault::CaseError;
use crate::look::Look;
use crate::units::{Angle, RADIANS};

/// What flows and what holds it back, in plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name of the friction law, as the case file writes it.
    pub friction: &'static str,
    /// Coefficient of the friction that grows with the load, mu = tan(delta).
    pub mu: f64,
    /// The friction law; a parameter that differs from place to place has a number that stands in for it.
    pub law: AnyLaw,
    /// The parameters that differ from place to place.
    pub in_space: Vec<InSpace>,
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

impl Material {
    /// The law with one set of parameters for all cells, as the loops of all schemes have it; none for another one.
    #[must_use]
    pub fn law_in_loops(&self) -> Option<Law> {
        if self.in_space.is_empty() { self.law.in_loops() } else { None }
    }

    /// A law that is computed cell by cell needs a scheme that does so.
    pub(crate) fn check_scheme(&self, look: &Look, scheme: SchemeName) -> Result<(), CaseError> {
        if self.law_in_loops().is_some()
            || matches!(scheme, SchemeName::EnergyStable | SchemeName::EnergyStable2)
        {
            return Ok(());
        }
        let what = match self.in_space.first() {
            Some(parameter) => format!("{} differs from place to place", parameter.key),
            None => format!("the law {} is computed cell by cell", self.friction),
        };
        let message = format!("{what}, which {} cannot compute", scheme.as_str());
        Err(look.fault("scheme.name", message, "use energy_stable or energy_stable_2, which can"))
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

    /// The law and what it acts on, in plain numbers.
    pub fn material(
        &self,
        look: &Look,
        pressure: EarthPressure,
        gravity: f64,
        density: f64,
    ) -> Result<Material, CaseError> {
        let numbers = self.numbers(look, gravity, density)?;
        let first = numbers[0].given.map_or(numbers[0].per, |(_, value, _)| value.usual());
        let mut in_space = Vec::new();
        let mut of_law = Vec::new();
        for (index, Number { given, per }) in numbers.into_iter().enumerate() {
            let Some((key, value, range)) = given else {
                of_law.push(per);
                continue;
            };
            let key = format!("material.friction.{}.{key}", self.name());
            match value.place(look, &key, range)? {
                Some(place) => in_space.push(InSpace { index, key, place, range, per }),
                // Compared with a first parameter that differs from place to place once that is read.
                None if in_space.first().is_some_and(|first| first.index == 0) && range.of_first() => {}
                None => look.number(&key, value.usual(), |v| range.fits(v, first), &range.allowed())?,
            }
            of_law.push(value.usual() / per);
        }
        let mu = if self.has_mu() { first } else { 0.0 };
        let (law, pressure_coefficient) = (self.law(&of_law), pressure.coefficient(mu));
        Ok(Material { friction: self.name(), mu, law, in_space, pressure_coefficient, gravity, density })
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
    fn has_mu(&self) -> bool {
        !matches!(self, Self::Bingham(_) | Self::HerschelBulkley(_) | Self::Quadratic(_))
    }

    /// The numbers of the law in the order in which the model has them.
    fn numbers(&self, look: &Look, gravity: f64, density: f64) -> Result<Vec<Number<'_>>, CaseError> {
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
    fn law(&self, numbers: &[f64]) -> AnyLaw {
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

    /// mu from exactly one of the two ways to write it.
    fn coefficient<'a>(
        &'a self,
        look: &Look,
        angle: Option<Angle>,
        mu: Option<&'a Parameter>,
    ) -> Result<Number<'a>, CaseError> {
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
                Ok(Number::fixed(angle.radians().tan()))
            }
            (None, Some(mu)) => Ok(Number::of("mu", mu, Range::NotNegative)),
        }
    }
}
