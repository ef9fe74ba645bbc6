//! What flows, and what holds it back: friction laws, earth pressure, the material in plain numbers.

use std::f64::consts::FRAC_PI_2;

use granflow_model::savage_hutter::earth_pressure;
use granflow_model::savage_hutter::friction::{AnyLaw, Law, SamosAt};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod laws;
mod parameter;

use parameter::Number;

pub(crate) use parameter::Parameter;

pub use laws::AvalancheSize;
pub(crate) use laws::Friction;
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
    /// Coefficient of the friction that grows with the load, mu = tan(delta), in a law that has one.
    pub mu: Option<f64>,
    /// The friction law; a parameter that differs from place to place has a number that stands in for it.
    pub law: AnyLaw,
    /// The parameters that differ from place to place.
    pub in_space: Vec<InSpace>,
    /// mu is that of the released volume ([`AvalancheSize::of`]).
    pub by_volume: bool,
    /// The earth-pressure coefficient k; of active and passive pressure that of stretching.
    pub pressure_coefficient: f64,
    /// That of compression.
    pub passive_coefficient: f64,
    /// Gravity g: m/s^2 on terrain, 1 where times are scaled by sqrt(L/g).
    pub gravity: f64,
    /// Bulk density rho, kg/m^3 on terrain.
    pub density: f64,
}

/// The earth-pressure coefficient k in beta = epsilon k cos(zeta).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum EarthPressure {
    /// k = 1.
    #[default]
    Isotropic,
    /// k = 1 + 2 tan(delta)^2, internal friction equal to bed friction (Kaland & Struckmeier 2007).
    Kaland,
    /// k_act where the mass is stretched along an axis, k_pas where it is compressed (Savage & Hutter 1989).
    ActivePassive {
        /// The angle of internal friction phi, not below that of the bed.
        internal: Angle,
    },
}

impl Material {
    /// The same for a released volume \[m^3\], in which mu may have been that of the volume; and the size, if it was.
    #[must_use]
    pub fn of_volume(&self, volume: f64) -> (Material, Option<AvalancheSize>) {
        let (AnyLaw::SamosAt(law), true) = (self.law, self.by_volume) else { return (self.clone(), None) };
        let size = AvalancheSize::of(volume);
        let law = AnyLaw::SamosAt(SamosAt { mu: size.mu(), ..law });
        (Material { law, mu: Some(size.mu()), ..self.clone() }, Some(size))
    }

    /// The law with one set of parameters for all cells, as the loops of all schemes have it; none for another one.
    #[must_use]
    pub fn law_in_loops(&self) -> Option<Law> {
        if self.in_space.is_empty() { self.law.in_loops() } else { None }
    }

    /// A law that is computed cell by cell needs a scheme that does so.
    pub(crate) fn check_scheme(&self, look: &Look, scheme: SchemeName) -> Result<(), CaseError> {
        let published = !matches!(
            scheme,
            SchemeName::EnergyStable
                | SchemeName::EnergyStable2
                | SchemeName::Balanced
                | SchemeName::Balanced2
        );
        if published && self.passive_coefficient != self.pressure_coefficient {
            let message = format!("{} knows one earth-pressure coefficient only", scheme.as_str());
            let cure =
                "use energy_stable_2, energy_stable, balanced or balanced_2, or earth_pressure = \"kaland\"";
            return Err(look.fault(PRESSURE, message, cure));
        }
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

/// The number of [`InSpace::index`] that is no parameter of the law but the drag of a forest.
pub const FOREST: usize = 6;

/// The number of [`InSpace::index`] that is the thickness of an erodible layer.
pub const LAYER: usize = 7;

impl Material {
    /// The same in a forest with this drag, if there is one.
    pub(crate) fn in_forest(mut self, look: &Look, drag: Option<&Parameter>) -> Result<Material, CaseError> {
        let (Some(drag), key, range) = (drag, "material.forest", Range::NotNegative) else { return Ok(self) };
        let place = drag.in_place(look, key, range)?;
        self.in_space.push(InSpace { index: FOREST, key: key.to_owned(), place, range, per: 1.0 });
        Ok(self)
    }
}

/// The key of the earth pressure.
const PRESSURE: &str = "material.earth_pressure";

impl EarthPressure {
    /// k of stretching and of compression under the friction coefficient `mu` of a law, if it has one for all cells.
    fn coefficients(self, look: &Look, friction: &str, mu: Option<f64>) -> Result<[f64; 2], CaseError> {
        let needed = || {
            mu.ok_or_else(|| {
                let message = format!(
                    "`{}` needs the one friction angle of a law, and {friction} has none here",
                    self.name()
                );
                look.fault(PRESSURE, message, "write earth_pressure = \"isotropic\"")
            })
        };
        match self {
            Self::Isotropic => Ok([1.0; 2]),
            Self::Kaland => needed().map(|mu| [1.0 + 2.0 * mu.powi(2); 2]),
            Self::ActivePassive { internal } => {
                let (mu, key) = (needed()?, format!("{PRESSURE}.active_passive.internal"));
                let allowed = "an angle from 0 to below 90 deg (1.5708 rad)";
                look.number(&key, internal.radians(), |v| (0.0..FRAC_PI_2).contains(&v), allowed)
                    .map_err(|error| error.help(RADIANS))?;
                earth_pressure::coefficients(internal.radians().tan(), mu).ok_or_else(|| {
                    let [internal, bed] = [internal.radians(), mu.atan()].map(f64::to_degrees);
                    let message = format!(
                        "the angle of internal friction, {internal:.3} deg, is below that of the bed, {bed:.3} deg"
                    );
                    look.fault(&key, message, "give one that is not, for instance internal = \"35 deg\"")
                })
            }
        }
    }

    /// As a case writes it.
    fn name(self) -> &'static str {
        match self {
            Self::Isotropic => "isotropic",
            Self::Kaland => "kaland",
            Self::ActivePassive { .. } => "active_passive",
        }
    }
}

impl Friction {
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
                None if in_space.first().is_some_and(|first| first.index == 0) && range.of_first() => {
                    in_space.push(InSpace {
                        index,
                        key,
                        place: Place::Everywhere(value.usual()),
                        range,
                        per,
                    });
                }
                None => look.number(&key, value.usual(), |v| range.fits(v, first), &range.allowed())?,
            }
            of_law.push(value.usual() / per);
        }
        let mu = self.has_mu().then_some(first);
        let by_volume = self.by_volume(look)?;
        let one_mu = mu.filter(|_| !by_volume && in_space.iter().all(|parameter| parameter.index != 0));
        let [pressure_coefficient, passive_coefficient] = pressure.coefficients(look, self.name(), one_mu)?;
        let law = self.law(&of_law);
        Ok(Material {
            friction: self.name(),
            mu,
            law,
            in_space,
            by_volume,
            pressure_coefficient,
            passive_coefficient,
            gravity,
            density,
        })
    }

    /// Is mu that of the released volume?
    fn by_volume(&self, look: &Look) -> Result<bool, CaseError> {
        let Self::Samosat(law) = self else { return Ok(false) };
        if law.mu.is_some() && law.size.is_some() {
            let message = "both `mu` and `size` are given";
            return Err(look.fault("material.friction.samosat.size", message, "keep one of them"));
        }
        Ok(law.size == Some(AvalancheSize::Auto))
    }

    /// mu from exactly one of the two ways to write it.
    pub(super) fn coefficient<'a>(
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
