//! The inclination zeta(x) of a chute and its curvature kappa = -d zeta/dx.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::choice::{Plain, plain_or_table};
use super::formula::Formula;
use super::units::Angle;

/// The inclination of the chute, positive downhill along +x.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Slope {
    /// The same everywhere.
    Constant(Angle),
    /// A profile over x.
    Profile(Profile),
}

impl Default for Slope {
    fn default() -> Self {
        Self::Constant(Angle::default())
    }
}

/// A slope that varies along x: points (`x` and `angle`, straight between them, constant beyond) or a `formula` in x.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Places of the points, growing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<Vec<f64>>,
    /// Inclination at each point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Vec<Angle>>,
    /// Inclination in radians as a formula in x, instead of points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formula: Option<String>,
    /// Curvature kappa as a formula in x (default: the derivative of the slope, kappa = -d zeta/dx).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curvature: Option<String>,
}

impl<'de> Deserialize<'de> for Slope {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let expected = "an angle (\"18 deg\" or radians) or a profile { x = [...], angle = [...] } or { formula = \"...\" }";
        let read = |value: Plain| match value {
            Plain::Number(radians) => Ok(Self::Constant(Angle::from_radians(radians))),
            Plain::Text(text) => text.parse().map(Self::Constant),
        };
        plain_or_table(from, expected, read, Self::Profile)
    }
}

/// A slope that can be evaluated: zeta at a point, kappa as the mean over a cell.
#[derive(Debug, Clone)]
pub struct Chute {
    zeta: Zeta,
    kappa: Option<Formula>,
}

#[derive(Debug, Clone)]
enum Zeta {
    Constant(f64),
    Points(Vec<(f64, f64)>),
    Formula(Formula),
}

/// What is wrong with a profile: the key below `material.slope` (with the bytes of a formula) and the message.
pub(super) struct ProfileFault {
    pub key: &'static str,
    pub part: Option<std::ops::Range<usize>>,
    pub message: String,
}

impl Chute {
    /// Prepares a slope for evaluation.
    pub(super) fn new(slope: &Slope) -> Result<Self, ProfileFault> {
        let profile = match slope {
            Slope::Constant(angle) => return Ok(Self { zeta: Zeta::Constant(angle.radians()), kappa: None }),
            Slope::Profile(profile) => profile,
        };
        let fault = |key, message: String| ProfileFault { key, part: None, message };
        let zeta = match (&profile.x, &profile.angle, &profile.formula) {
            (None, None, Some(formula)) => Zeta::Formula(read("formula", formula)?),
            (Some(x), Some(angle), None) => {
                if x.len() != angle.len() {
                    return Err(fault("angle", format!("{} angles for {} places x", angle.len(), x.len())));
                }
                if x.len() < 2 {
                    return Err(fault("x", format!("{} point(s), a profile needs at least 2", x.len())));
                }
                if let Some(pair) = x.windows(2).find(|pair| pair[0] >= pair[1]) {
                    return Err(fault(
                        "x",
                        format!("{} comes after {}; the places must grow", pair[1], pair[0]),
                    ));
                }
                Zeta::Points(x.iter().zip(angle).map(|(x, angle)| (*x, angle.radians())).collect())
            }
            _ => {
                return Err(fault(
                    "",
                    "a profile is { x = [...], angle = [...] } or { formula = \"...\" }".to_owned(),
                ));
            }
        };
        let kappa = profile.curvature.as_ref().map(|text| read("curvature", text)).transpose()?;
        Ok(Self { zeta, kappa })
    }

    /// Inclination at x in radians.
    #[must_use]
    pub fn zeta(&self, x: f64) -> f64 {
        match &self.zeta {
            Zeta::Constant(angle) => *angle,
            Zeta::Formula(formula) => formula.at(&[x]),
            Zeta::Points(points) => {
                let right = points.partition_point(|(place, _)| *place <= x);
                if right == 0 || right == points.len() {
                    return points[right.saturating_sub(1)].1;
                }
                let ((x0, zeta0), (x1, zeta1)) = (points[right - 1], points[right]);
                zeta0 + (zeta1 - zeta0) * (x - x0) / (x1 - x0)
            }
        }
    }

    /// Curvature of the cell [low, high]: -(zeta(high) - zeta(low))/(high - low), the exact mean of -d zeta/dx over
    /// it, or the case's own formula at the centre.
    #[must_use]
    pub fn kappa(&self, low: f64, high: f64) -> f64 {
        match (&self.kappa, &self.zeta) {
            (Some(formula), _) => formula.at(&[0.5 * (low + high)]),
            (None, Zeta::Constant(_)) => 0.0,
            (None, _) => -(self.zeta(high) - self.zeta(low)) / (high - low),
        }
    }

    /// Whether the slope is the same everywhere.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        matches!(self.zeta, Zeta::Constant(_))
    }
}

fn read(key: &'static str, text: &str) -> Result<Formula, ProfileFault> {
    Formula::parse(text, &["x"]).map_err(|error| ProfileFault {
        key,
        part: Some(error.at..error.at + error.length),
        message: error.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_their_curvature() {
        let profile = Profile {
            x: Some(vec![0.0, 2.0, 4.0]),
            angle: Some([0.6, 0.2, 0.2].map(Angle::from_radians).to_vec()),
            ..Profile::default()
        };
        let chute = Chute::new(&Slope::Profile(profile)).ok().unwrap();
        assert_eq!([-1.0, 0.0, 2.0, 3.0, 9.0].map(|x| chute.zeta(x)), [0.6, 0.6, 0.2, 0.2, 0.2]);
        assert!((chute.zeta(1.0) - 0.4).abs() < 1e-15);
        assert!((chute.kappa(0.5, 1.5) - 0.2).abs() < 1e-15, "a chute that flattens has kappa > 0");
        assert!((chute.kappa(1.0, 3.0) - 0.1).abs() < 1e-15, "the mean over a cell with a kink");
    }

    #[test]
    fn a_formula() {
        let profile = Profile { formula: Some("0.5*exp(-x^2)".into()), ..Profile::default() };
        let chute = Chute::new(&Slope::Profile(profile.clone())).ok().unwrap();
        assert_eq!(chute.zeta(0.0), 0.5);
        assert!((chute.kappa(0.999, 1.001) - (-1f64).exp()).abs() < 1e-6);
        let wrong = Profile { curvature: Some("2*z".into()), ..profile };
        let fault = Chute::new(&Slope::Profile(wrong)).err().unwrap();
        assert_eq!((fault.key, fault.part), ("curvature", Some(2..3)));
    }
}
