//! The inclination zeta(x) of a chute and its curvature kappa = -d zeta/dx.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::choice::{Plain, plain_or_table};
use crate::fault::{CaseError, PartFault};
use crate::formula::Formula;
use crate::grid::Axis;
use crate::look::Look;
use crate::units::{Angle, RADIANS};

/// The inclination of the chute, positive downhill along +x.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Slope {
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
pub(crate) struct Profile {
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
struct Curve {
    zeta: Zeta,
    kappa: Option<Formula>,
}

#[derive(Debug, Clone)]
enum Zeta {
    Constant(f64),
    Points(Vec<(f64, f64)>),
    Formula(Formula),
}

/// Slope and curvature of every column of cells, evaluated where they are asked for.
#[derive(Debug, Clone)]
pub struct Columns {
    curve: Arc<Curve>,
    axis: Axis,
}

impl Columns {
    /// Inclination zeta of a column of cells at its centre, in radians, positive downhill along +x.
    #[must_use]
    pub fn zeta(&self, column: usize) -> f64 {
        self.curve.zeta(self.axis.centre(column))
    }
    /// Mean curvature kappa = -d zeta/dx of a column.
    #[must_use]
    pub fn kappa(&self, column: usize) -> f64 {
        self.curve.kappa(self.axis.face(column), self.axis.face(column + 1))
    }
}

impl Slope {
    /// Evaluates the slope on the cells along x.
    pub fn check(&self, look: &Look, axis: &Axis) -> Result<Columns, CaseError> {
        let key = "material.slope";
        let fits = |v: f64| v.abs() < FRAC_PI_2;
        let steep = |key: &str, angle: &Angle| {
            let allowed = "an angle between -90 deg and 90 deg (1.5708 rad)";
            look.number(key, angle.radians(), fits, allowed).map_err(|error| error.help(RADIANS))
        };
        match self {
            Self::Constant(angle) => steep(key, angle)?,
            Self::Profile(profile) => {
                for (index, angle) in profile.angle.iter().flatten().enumerate() {
                    steep(&format!("{key}.angle[{index}]"), angle)?;
                }
                for (index, x) in profile.x.iter().flatten().enumerate() {
                    look.number(&format!("{key}.x[{index}]"), *x, |_| true, "a finite number")?;
                }
            }
        }
        let curve = Curve::new(self).map_err(|fault| look.part_fault(key, fault))?;
        let columns = Columns { curve: Arc::new(curve), axis: axis.clone() };
        for cell in 0..axis.cells {
            let (zeta, kappa) = (columns.zeta(cell), columns.kappa(cell));
            if !fits(zeta) || !kappa.is_finite() {
                let x = axis.centre(cell);
                let message = format!("at x = {x} the slope is {zeta} rad and its curvature {kappa}");
                let cure = "expected an angle between -90 deg and 90 deg and a finite curvature";
                return Err(look.fault(key, message, cure));
            }
        }
        Ok(columns)
    }
}

impl Curve {
    /// Prepares a slope for evaluation.
    fn new(slope: &Slope) -> Result<Self, PartFault> {
        let profile = match slope {
            Slope::Constant(angle) => return Ok(Self { zeta: Zeta::Constant(angle.radians()), kappa: None }),
            Slope::Profile(profile) => profile,
        };
        let zeta = match (&profile.x, &profile.angle, &profile.formula) {
            (None, None, Some(formula)) => Zeta::Formula(read("formula", formula)?),
            (Some(x), Some(angle), None) => {
                if x.len() != angle.len() {
                    return Err(PartFault::new(
                        "angle",
                        format!("{} angles for {} places x", angle.len(), x.len()),
                    ));
                }
                if x.len() < 2 {
                    return Err(PartFault::new(
                        "x",
                        format!("{} point(s), a profile needs at least 2", x.len()),
                    ));
                }
                if let Some(pair) = x.windows(2).find(|pair| pair[0] >= pair[1]) {
                    return Err(PartFault::new(
                        "x",
                        format!("{} comes after {}; the places must grow", pair[1], pair[0]),
                    ));
                }
                Zeta::Points(x.iter().zip(angle).map(|(x, angle)| (*x, angle.radians())).collect())
            }
            _ => {
                return Err(PartFault::new(
                    "",
                    "a profile is { x = [...], angle = [...] } or { formula = \"...\" }",
                ));
            }
        };
        let kappa = profile.curvature.as_ref().map(|text| read("curvature", text)).transpose()?;
        Ok(Self { zeta, kappa })
    }

    /// Inclination at x in radians.
    fn zeta(&self, x: f64) -> f64 {
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
    fn kappa(&self, low: f64, high: f64) -> f64 {
        match (&self.kappa, &self.zeta) {
            (Some(formula), _) => formula.at(&[0.5 * (low + high)]),
            (None, Zeta::Constant(_)) => 0.0,
            (None, _) => -(self.zeta(high) - self.zeta(low)) / (high - low),
        }
    }
}

fn read(key: &'static str, text: &str) -> Result<Formula, PartFault> {
    Formula::parse(text, &["x"]).map_err(|error| PartFault::formula(key, error))
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
        let curve = Curve::new(&Slope::Profile(profile)).ok().unwrap();
        assert_eq!([-1.0, 0.0, 2.0, 3.0, 9.0].map(|x| curve.zeta(x)), [0.6, 0.6, 0.2, 0.2, 0.2]);
        assert!((curve.zeta(1.0) - 0.4).abs() < 1e-15);
        assert!((curve.kappa(0.5, 1.5) - 0.2).abs() < 1e-15, "a chute that flattens has kappa > 0");
        assert!((curve.kappa(1.0, 3.0) - 0.1).abs() < 1e-15, "the mean over a cell with a kink");
    }

    #[test]
    fn a_formula() {
        let profile = Profile { formula: Some("0.5*exp(-x^2)".into()), ..Profile::default() };
        let curve = Curve::new(&Slope::Profile(profile.clone())).ok().unwrap();
        assert_eq!(curve.zeta(0.0), 0.5);
        assert!((curve.kappa(0.999, 1.001) - (-1f64).exp()).abs() < 1e-6);
        let wrong = Profile { curvature: Some("2*z".into()), ..profile };
        let fault = Curve::new(&Slope::Profile(wrong)).err().unwrap();
        assert_eq!((fault.key, fault.part), ("curvature", Some(2..3)));
    }
}
