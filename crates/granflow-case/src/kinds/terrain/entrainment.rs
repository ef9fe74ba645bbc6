//! `[entrainment]`: a layer on the bed that the flow picks up.

use granflow_model::savage_hutter::erosion::Erosion;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::avalanche::{InSpace, LAYER, Parameter, Range};
use crate::fault::CaseError;
use crate::look::Look;

/// An erodible layer, in plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Entrainment {
    /// Its thickness normal to the bed \[m\].
    pub layer: InSpace,
    /// Its density \[kg/m^3\].
    pub density: f64,
    /// How it is picked up.
    pub law: Erosion,
    /// The bed sinks by what is picked up.
    pub lower_bed: bool,
}

/// A layer on the bed that the flow picks up, mass at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Entrainment")]
pub(super) struct Words {
    /// Its thickness normal to the bed in m: a number, or a table as for a parameter in space.
    layer: Parameter,
    /// How the flow picks it up.
    law: LawWords,
    /// Its density in kg/m^3 (default: that of the material).
    #[serde(skip_serializing_if = "Option::is_none")]
    density: Option<f64>,
    /// Lower the bed by what is picked up (default: no); its slope and curvature stay.
    #[serde(default)]
    lower_bed: bool,
}

/// How a flow picks up a layer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "ErosionLaw")]
enum LawWords {
    /// By speed: depth by time = coefficient |V| (Christen, Kowalski & Bartelt 2010).
    Speed {
        /// Depth of the layer by the length that the flow has moved.
        coefficient: f64,
    },
    /// By shear stress: where it exceeds the threshold, at a constant rate down to a depth that grows with the stress (Frank et al. 2015).
    Shear {
        /// The stress in Pa from which the layer erodes.
        threshold: f64,
        /// Depth in m by the stress above the threshold in Pa.
        depth_by_stress: f64,
        /// Speed at which the bed sinks in m/s.
        rate: f64,
    },
    /// By the work of the friction: mass by area and time = stress |V|/specific (AvaFrame's com1DFA).
    Energy {
        /// Specific erosion energy in J/kg.
        specific: f64,
    },
    /// By the front, which takes the whole layer while it crosses a cell.
    Plough,
}

/// The key of the layer.
const KEY: &str = "entrainment.layer";

impl Words {
    /// Checks the numbers; `density` is that of the flow.
    pub fn check(&self, look: &Look, density: f64) -> Result<Entrainment, CaseError> {
        look.usual("entrainment.density", self.density)?;
        let place = self.layer.in_place(look, KEY, Range::Depth)?;
        let layer = InSpace { index: LAYER, key: KEY.to_owned(), place, range: Range::Depth, per: 1.0 };
        Ok(Entrainment {
            layer,
            density: self.density.unwrap_or(density),
            law: self.law.check(look)?,
            lower_bed: self.lower_bed,
        })
    }
}

impl LawWords {
    fn check(&self, look: &Look) -> Result<Erosion, CaseError> {
        let positive = |key: &str, value: f64| {
            look.usual(&format!("entrainment.law.{key}"), Some(value)).map(|()| value)
        };
        Ok(match *self {
            Self::Speed { coefficient } => {
                Erosion::Speed { coefficient: positive("speed.coefficient", coefficient)? }
            }
            Self::Shear { threshold, depth_by_stress, rate } => {
                look.not_negative("entrainment.law.shear.threshold", Some(threshold))?;
                let depth_by_stress = positive("shear.depth_by_stress", depth_by_stress)?;
                Erosion::Shear { threshold, depth_by_stress, rate: positive("shear.rate", rate)? }
            }
            Self::Energy { specific } => Erosion::Energy { specific: positive("energy.specific", specific)? },
            Self::Plough => Erosion::Plough,
        })
    }
}
