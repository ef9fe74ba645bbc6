//! A quantity over a grid: a number, a shape, a formula or a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::array;
use super::choice::{Plain, plain_or_table};
use super::fault::{CaseError, PartFault};
use super::formula::Formula;
use super::grid::Points;
use super::look::{LARGEST, Look};

/// A quantity over the grid: a number, or one of the shapes.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Quantity {
    /// The same everywhere.
    Constant(f64),
    /// A shape.
    Shape(Shape),
}

/// The shapes a quantity may have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Constant between places along x.
    Steps(Steps),
    /// A parabolic cap, height (1 - r^2/radius^2) within its radius and 0 beyond.
    Cap(Cap),
    /// A parabola, max(floor, height - curvature r^2).
    Parabola(Parabola),
    /// A cone (a roof in one dimension), max(0, height - slope r).
    Cone(Cone),
    /// A formula in x and y, for instance "max(1 - x^2, 0)".
    Formula(String),
    /// A file with one number a cell (a node for what is given at nodes): .npy with shape (cells) or (cells of y, cells of
    /// x), or .csv with one row for each y.
    File(PathBuf),
}

/// Constant pieces along x: `values[k]` where `at[k-1]` < x <= `at[k]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Steps {
    /// Places of the jumps, growing.
    pub at: Vec<f64>,
    /// Values between the jumps, one more than there are jumps.
    pub values: Vec<f64>,
}

/// A parabolic cap, h = height (1 - r^2/radius^2).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cap {
    /// Thickness at the centre.
    pub height: f64,
    /// Centre: x, or [x, y].
    #[serde(default)]
    pub centre: Centre,
    /// Distance from the centre at which the cap ends.
    pub radius: f64,
}

/// A parabola on a floor, h = max(floor, height - curvature r^2).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Parabola {
    /// Thickness at the centre.
    pub height: f64,
    /// Factor of r^2.
    pub curvature: f64,
    /// Centre: x, or [x, y].
    #[serde(default)]
    pub centre: Centre,
    /// Least thickness (default 0).
    #[serde(default)]
    pub floor: f64,
}

/// A cone, h = max(0, height - slope r).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cone {
    /// Thickness at the tip.
    pub height: f64,
    /// Centre: x, or [x, y].
    #[serde(default)]
    pub centre: Centre,
    /// Loss of thickness per length, the gradient dh/dr in the case's units (a number, not an angle).
    pub slope: f64,
}

/// A place on the grid: x, or [x, y] in two dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a centre: x, or [x, y]")]
pub enum Centre {
    /// On the x axis, y = 0.
    X(f64),
    /// In the plane.
    Xy([f64; 2]),
}

impl Default for Centre {
    fn default() -> Self {
        Self::X(0.0)
    }
}

impl Centre {
    /// Distance of (x, y) from the centre.
    pub(crate) fn distance(self, x: f64, y: f64) -> f64 {
        match self {
            // in one dimension y is 0 and the root of a square is exact
            Self::X(cx) => (x - cx).hypot(y),
            Self::Xy([cx, cy]) => (x - cx).hypot(y - cy),
        }
    }
}

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let expected = "a number or one of steps, cap, parabola, cone, formula, file";
        let read = |value: Plain| match value {
            Plain::Number(number) => Ok(Self::Constant(number)),
            Plain::Text(text) => Err(format!(
                "found the text \"{text}\", expected {expected}; a formula is written .formula = \"{text}\", a file .file = \"...\""
            )),
        };
        plain_or_table(from, expected, read, Self::Shape)
    }
}

impl Quantity {
    /// What can be said about the numbers without evaluating anything.
    pub(crate) fn verify(&self) -> Result<(), PartFault> {
        let positive = |key, value: f64| {
            if value > 0.0 {
                Ok(())
            } else {
                Err(PartFault::new(key, format!("found {value}, expected a number > 0")))
            }
        };
        match self {
            Self::Shape(Shape::Steps(Steps { at, values })) => {
                if values.len() != at.len() + 1 {
                    let message =
                        format!("{} values for {} jumps, expected {}", values.len(), at.len(), at.len() + 1);
                    return Err(PartFault::new("steps.values", message));
                }
                match at.windows(2).find(|pair| pair[0] >= pair[1]) {
                    Some(pair) => {
                        let message = format!("{} comes after {}; the jumps must grow", pair[1], pair[0]);
                        Err(PartFault::new("steps.at", message))
                    }
                    None => Ok(()),
                }
            }
            Self::Shape(Shape::Cap(cap)) => positive("cap.radius", cap.radius),
            Self::Shape(Shape::Cone(cone)) => positive("cone.slope", cone.slope),
            Self::Shape(Shape::Parabola(parabola)) => positive("parabola.curvature", parabola.curvature),
            Self::Shape(Shape::Formula(text)) => compile(text).map(|_| ()),
            Self::Constant(_) | Self::Shape(Shape::File(_)) => Ok(()),
        }
    }

    /// The quantity ready to be evaluated: formulas are read, files too.
    pub(crate) fn prepare(&self, points: &Points, look: &Look) -> Result<Prepared, PartFault> {
        self.verify()?;
        let shape = match self {
            Self::Constant(value) => return Ok(Prepared::Constant(*value)),
            Self::Shape(shape) => shape.clone(),
        };
        Ok(match shape {
            Shape::Steps(steps) => Prepared::Steps(steps),
            Shape::Cap(cap) => Prepared::Cap(cap),
            Shape::Parabola(parabola) => Prepared::Parabola(parabola),
            Shape::Cone(cone) => Prepared::Cone(cone),
            Shape::Formula(text) => Prepared::Formula(compile(&text)?),
            Shape::File(path) => {
                let path = look.source.folder().join(path);
                let values = array::read(look.files, &path, points.counts())
                    .map_err(|message| PartFault::new("file", message).file())?;
                Prepared::Values(values)
            }
        })
    }

    /// Whether evaluating needs a file.
    pub(crate) fn needs_file(&self) -> Option<&Path> {
        match self {
            Self::Shape(Shape::File(path)) => Some(path),
            _ => None,
        }
    }
}

/// A quantity that can be evaluated at any point.
#[derive(Debug, Clone)]
pub(crate) enum Prepared {
    Constant(f64),
    Steps(Steps),
    Cap(Cap),
    Parabola(Parabola),
    Cone(Cone),
    Formula(Formula),
    Values(Vec<f64>),
}

impl Prepared {
    /// The value at point number `index`; where the point is, is found only if it matters.
    fn at(&self, index: usize, points: &Points) -> f64 {
        let place = || points.at(index);
        let distance = |centre: &Centre| {
            let [x, y] = place();
            centre.distance(x, y)
        };
        match self {
            Self::Constant(value) => *value,
            Self::Values(values) => values[index],
            Self::Formula(formula) => formula.at(&place()),
            Self::Steps(Steps { at, values }) => {
                let [x, _] = place();
                values[at.partition_point(|jump| *jump < x)]
            }
            Self::Cap(Cap { height, centre, radius }) => {
                (height * (1.0 - (distance(centre) / radius).powi(2))).max(0.0)
            }
            Self::Parabola(Parabola { height, curvature, centre, floor }) => {
                (height - curvature * distance(centre).powi(2)).max(*floor)
            }
            Self::Cone(Cone { height, centre, slope }) => (height - slope * distance(centre)).max(0.0),
        }
    }
}

/// A quantity that was checked at every point, to be evaluated where it is asked for: it takes no memory but for what a file holds.
#[derive(Debug, Clone)]
pub struct Values {
    quantity: Prepared,
    points: Arc<Points>,
}

impl Values {
    /// The value at point number `index`, x fastest.
    #[must_use]
    pub fn at(&self, index: usize) -> f64 {
        self.quantity.at(index, &self.points)
    }

    /// The values at all points in their order.
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        let count: usize = self.points.counts().iter().product();
        (0..count).map(|index| self.at(index))
    }
}

impl Look<'_> {
    /// A quantity at all points, 0 where the case does not say; every value is finite and of a usual size.
    pub fn evaluate(
        &self,
        points: &Points,
        key: &str,
        quantity: Option<&Quantity>,
    ) -> Result<Values, CaseError> {
        let quantity = quantity.unwrap_or(&Quantity::Constant(0.0));
        let quantity = quantity.prepare(points, self).map_err(|fault| self.part_fault(key, fault))?;
        let values = Values { quantity, points: Arc::new(points.clone()) };
        let usual = |value: f64| value.abs() <= LARGEST;
        let wrong = values.iter().position(|value| !usual(value));
        match wrong {
            None => Ok(values),
            Some(index) => Err(self.fault(
                key,
                format!("the value is {:?} at {}", values.at(index), points.place(index)),
                "every cell needs a finite number, between -1e12 and 1e12",
            )),
        }
    }

    /// A quantity that is never negative.
    pub fn layer(
        &self,
        points: &Points,
        key: &str,
        quantity: Option<&Quantity>,
    ) -> Result<Values, CaseError> {
        let values = self.evaluate(points, key, quantity)?;
        let wrong = values.iter().position(|value| value < 0.0);
        match wrong {
            None => Ok(values),
            Some(index) => {
                let name = key.rsplit('.').next().unwrap_or(key).replace('_', " ");
                let message = format!("the {name} is {} at {}", values.at(index), points.place(index));
                let cure = format!("a {name} is never negative; max(..., 0) cuts a formula off");
                Err(self.fault(key, message, &cure))
            }
        }
    }
}

fn compile(text: &str) -> Result<Formula, PartFault> {
    Formula::parse(text, &["x", "y"]).map_err(|error| PartFault::formula("formula", error))
}
