//! `[scheme]`: which method, which time step, which films.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Model;

/// The numerical method.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scheme {
    /// Name of the method.
    #[serde(default)]
    pub name: SchemeName,
    /// A fixed time step; instead of `courant`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Courant number of the adaptive step: at most 1 (default 0.9) at first order, 0.5 (default 0.45) at second; for
    /// hadeler_kuttler the defaults are half of these.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub courant: Option<f64>,
    /// Thickness below which a cell is a film and is held (default 1e-6; 0 is allowed; without effect on verfahren_1..5).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub film: Option<f64>,
    /// Exponent m of Theta = E^2/(E^2 + h^m) in the scheme adaptive (default 2).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theta_exponent: Option<f64>,
}

/// The methods: for savage_hutter the five published ones (Kaland 2007) and the conservative ones, for hadeler_kuttler
/// those of Aggarwal, Veerappa Gowda & Sudarshan Kumar (2023).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SchemeName {
    /// Conservative, positive, exactly resting, first order: the default of savage_hutter.
    #[default]
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
    /// hadeler_kuttler at first order, well-balanced.
    FirstOrder,
    /// hadeler_kuttler at second order, not well-balanced.
    SecondOrder,
    /// hadeler_kuttler at second order away from steady states and well-balanced at them: the default there.
    Adaptive,
}

impl SchemeName {
    /// Every method.
    pub(super) const ALL: [Self; 10] = [
        Self::Balanced,
        Self::Balanced2,
        Self::Verfahren1,
        Self::Verfahren2,
        Self::Verfahren3,
        Self::Verfahren4,
        Self::Verfahren5,
        Self::FirstOrder,
        Self::SecondOrder,
        Self::Adaptive,
    ];

    /// The name a case file writes and the summary repeats.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Balanced => "balanced",
            Self::Balanced2 => "balanced_2",
            Self::Verfahren1 => "verfahren_1",
            Self::Verfahren2 => "verfahren_2",
            Self::Verfahren3 => "verfahren_3",
            Self::Verfahren4 => "verfahren_4",
            Self::Verfahren5 => "verfahren_5",
            Self::FirstOrder => "first_order",
            Self::SecondOrder => "second_order",
            Self::Adaptive => "adaptive",
        }
    }

    /// Number 1 to 5 of a published method.
    #[must_use]
    pub fn verfahren(self) -> Option<u8> {
        match self {
            Self::Balanced | Self::Balanced2 | Self::FirstOrder | Self::SecondOrder | Self::Adaptive => None,
            Self::Verfahren1 => Some(1),
            Self::Verfahren2 => Some(2),
            Self::Verfahren3 => Some(3),
            Self::Verfahren4 => Some(4),
            Self::Verfahren5 => Some(5),
        }
    }

    /// The model the method computes.
    #[must_use]
    pub fn model(self) -> Model {
        match self {
            Self::FirstOrder | Self::SecondOrder | Self::Adaptive => Model::HadelerKuttler,
            _ => Model::SavageHutter,
        }
    }

    /// The largest Courant number the method allows: 1 at first order, 0.5 at second.
    #[must_use]
    pub fn courant_limit(self) -> f64 {
        if matches!(self, Self::Balanced2 | Self::SecondOrder | Self::Adaptive) { 0.5 } else { 1.0 }
    }
}

/// How the time step is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepping {
    /// Always this step.
    Fixed(f64),
    /// The step that this Courant number allows.
    Courant(f64),
}

impl Scheme {
    /// How the time step is chosen; without a word of the case, the Courant number is 0.9 of its limit, for
    /// hadeler_kuttler 0.45 of it, as in the paper.
    #[must_use]
    pub fn stepping(&self) -> Stepping {
        match (self.step, self.courant) {
            (Some(step), _) => Stepping::Fixed(step),
            (None, Some(courant)) => Stepping::Courant(courant),
            (None, None) => {
                let share = if self.name.model() == Model::HadelerKuttler { 0.45 } else { 0.9 };
                Stepping::Courant(share * self.name.courant_limit())
            }
        }
    }

    /// Thickness below which a cell is a film; the published methods know none, so it is 0 for them.
    #[must_use]
    pub fn film(&self) -> f64 {
        let published = self.name.verfahren().is_some() || self.name.model() == Model::HadelerKuttler;
        if published { 0.0 } else { self.film.unwrap_or(1e-6) }
    }

    /// Exponent m of Theta = E^2/(E^2 + h^m).
    #[must_use]
    pub fn theta_exponent(&self) -> f64 {
        self.theta_exponent.unwrap_or(2.0)
    }
}
