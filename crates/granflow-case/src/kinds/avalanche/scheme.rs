//! `[scheme]` of an avalanche: which method, which time step, which films.

use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::friction::Coulomb;
use granflow_model::savage_hutter::ground::Chute;
use granflow_model::savage_hutter::kinetic::{
    VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5, Variant,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::CaseError;
use crate::look::Look;
use crate::plan::Stepping;
use crate::stepping::StepLimits;

/// The numerical method.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "AvalancheScheme")]
pub(crate) struct Scheme {
    /// Name of the method (default energy_stable_2 on terrain, energy_stable on a chute).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<SchemeName>,
    /// A fixed time step; instead of `courant`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Courant number of the adaptive step: at most 1 (default 0.9; energy_stable_2: 0.7), balanced_2: 0.5
    /// (default 0.45).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub courant: Option<f64>,
    /// Thickness below which a cell is a film and is held (default 1e-4 m on terrain, else 1e-6; 0 is allowed; without effect on
    /// verfahren_1..5).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub film: Option<f64>,
}

/// `[scheme]` with the method that it means.
pub(crate) struct Chosen<'a> {
    /// The method.
    pub name: SchemeName,
    words: &'a Scheme,
}

/// `[scheme]`, checked: the method, and what it is told beside the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method<N> {
    /// Which one.
    pub name: N,
    /// Thickness below which a cell is a film; the published methods know none, so it is 0 for them.
    pub film: f64,
}

/// The methods: the five published ones (Kaland 2007) and the conservative ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "AvalancheSchemeName")]
pub enum SchemeName {
    /// Conservative, positive, exactly resting; on terrain and straight chutes its energy falls in every step; first order.
    EnergyStable,
    /// The same at second order in space and time where the flow is smooth, with one stage a step.
    #[serde(rename = "energy_stable_2")]
    EnergyStable2,
    /// Conservative, positive, exactly resting, without a law for the energy; first order.
    Balanced,
    /// The same at second order in space and time.
    #[serde(rename = "balanced_2")]
    Balanced2,
    /// Kaland's Verfahren 1, Scheme 1 of Kaland & Struckmeier (2007); alias scheme_1.
    #[serde(rename = "verfahren_1", alias = "scheme_1")]
    Verfahren1,
    /// Kaland's Verfahren 2.
    #[serde(rename = "verfahren_2")]
    Verfahren2,
    /// Kaland's Verfahren 3.
    #[serde(rename = "verfahren_3")]
    Verfahren3,
    /// Kaland's Verfahren 4, Scheme 2 of Kaland & Struckmeier (2007); alias scheme_2.
    #[serde(rename = "verfahren_4", alias = "scheme_2")]
    Verfahren4,
    /// Kaland's Verfahren 5, Scheme 3 of Kaland & Struckmeier (2007); alias scheme_3.
    #[serde(rename = "verfahren_5", alias = "scheme_3")]
    Verfahren5,
}

/// The names of all methods.
pub(crate) const NAMES: &[&str] = &[
    SchemeName::EnergyStable.as_str(),
    SchemeName::EnergyStable2.as_str(),
    SchemeName::Balanced.as_str(),
    SchemeName::Balanced2.as_str(),
    SchemeName::Verfahren1.as_str(),
    SchemeName::Verfahren2.as_str(),
    SchemeName::Verfahren3.as_str(),
    SchemeName::Verfahren4.as_str(),
    SchemeName::Verfahren5.as_str(),
];

impl SchemeName {
    /// The name a case file writes and the summary repeats.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Balanced => "balanced",
            Self::Balanced2 => "balanced_2",
            Self::EnergyStable => "energy_stable",
            Self::EnergyStable2 => "energy_stable_2",
            Self::Verfahren1 => "verfahren_1",
            Self::Verfahren2 => "verfahren_2",
            Self::Verfahren3 => "verfahren_3",
            Self::Verfahren4 => "verfahren_4",
            Self::Verfahren5 => "verfahren_5",
        }
    }

    /// Whether it is one of the five published methods, which know neither films nor rest.
    #[must_use]
    pub fn is_published(self) -> bool {
        !matches!(self, Self::Balanced | Self::Balanced2 | Self::EnergyStable | Self::EnergyStable2)
    }

    /// What a case may say about the step.
    pub(crate) fn limits(self) -> StepLimits {
        let (name, friction) = (self.as_str(), Coulomb { mu: 0.0 });
        let published = |variant: Variant| StepLimits::of(name, &variant.with(friction));
        match self {
            Self::Balanced => StepLimits::of(name, &OnChute::first(friction, 0.0)),
            Self::Balanced2 => StepLimits::of(name, &OnChute::second(friction, 0.0)),
            Self::EnergyStable => StepLimits::of(name, &Stable::first(friction, 0.0)),
            Self::EnergyStable2 => StepLimits::of(name, &Stable::second(friction, 0.0)),
            Self::Verfahren1 => published(VERFAHREN_1),
            Self::Verfahren2 => published(VERFAHREN_2),
            Self::Verfahren3 => published(VERFAHREN_3),
            Self::Verfahren4 => published(VERFAHREN_4),
            Self::Verfahren5 => published(VERFAHREN_5),
        }
    }
}

/// The balanced schemes, whose limits depend on nothing but their order.
type OnChute = Balanced<Coulomb, Chute<1, f64>>;

/// The energy-stable schemes, likewise.
type Stable = EnergyStable<Coulomb, Chute<1, f64>>;

impl Scheme {
    /// With the method `usual` where the case names none.
    pub fn or(&self, usual: SchemeName) -> Chosen<'_> {
        Chosen { name: self.name.unwrap_or(usual), words: self }
    }
}

impl Chosen<'_> {
    /// How the time step is chosen.
    pub fn check(&self, look: &Look) -> Result<Stepping, CaseError> {
        let stepping = look.stepping(self.words.step, self.words.courant, self.name.limits())?;
        look.not_negative("scheme.film", self.words.film)?;
        Ok(stepping)
    }

    /// The method as the run takes it, under the name that its kind of case has for it, with the film of that kind.
    pub fn method<N>(&self, name: N, film: f64) -> Method<N> {
        Method { name, film: if self.name.is_published() { 0.0 } else { self.words.film.unwrap_or(film) } }
    }

    /// What has no effect, if anything.
    pub fn note(&self) -> Option<String> {
        let idle = self.name.is_published() && self.words.film.is_some_and(|film| film > 0.0);
        let name = self.name.as_str();
        idle.then(|| format!("{name} is computed as published, without films: scheme.film has no effect"))
    }
}
