//! A parameter of a law: a number, or one that differs from place to place on a mountain.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::choice::{Plain, plain_or_table};
use crate::fault::CaseError;
use crate::look::Look;

/// A parameter of a law.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Parameter {
    /// The same everywhere.
    Number(f64),
    /// Another one in every cell of a terrain.
    InSpace(Box<Words>),
}

/// A parameter that differs from place to place: exactly one of `raster`, `polygons`, `by_elevation`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ParameterInSpace")]
pub(crate) struct Words {
    /// A raster of it: GeoTIFF or ESRI ASCII grid. A cell takes the value at its centre.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub raster: Option<PathBuf>,
    /// Polygons: a shapefile or GeoJSON. A cell takes the value of the polygon that covers most of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub polygons: Option<PathBuf>,
    /// The attribute of the polygons that holds it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attribute: Option<String>,
    /// Its value where the raster or the polygons give none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elsewhere: Option<f64>,
    /// Classes by the elevation of the bed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_elevation: Option<ByElevation>,
}

/// Classes by elevation: `values[k]` from `at[k-1]` up to below `at[k]` metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ByElevation {
    /// Elevations between the classes in m, growing.
    pub at: Vec<f64>,
    /// The values from the lowest class to the highest, one more than there are elevations.
    pub values: Vec<f64>,
}

/// Where a parameter that differs from place to place comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// A raster, and the value where it has none.
    Raster(PathBuf, Option<f64>),
    /// Polygons, the attribute that holds it, and the value beside them.
    Polygons(PathBuf, String, Option<f64>),
    /// Classes by elevation.
    ByElevation(ByElevation),
    /// One number for all cells.
    Everywhere(f64),
}

/// A parameter that differs from place to place.
#[derive(Debug, Clone, PartialEq)]
pub struct InSpace {
    /// Which number of the law it is.
    pub index: usize,
    /// Its key in the case file.
    pub key: String,
    /// Where it comes from.
    pub place: Place,
    /// What it may be.
    pub range: Range,
    /// The number of the law is the parameter over this.
    pub per: f64,
}

/// What a parameter may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// From 0 on.
    NotNegative,
    /// Above 0.
    Positive,
    /// Above 0, at most 1.
    Share,
    /// An exponent of shear.
    Exponent,
    /// Above the first parameter of the law, of this name.
    AboveFirst(&'static str),
    /// Not below the first parameter of the law, of this name.
    NotBelowFirst(&'static str),
    /// The depth of a layer in m.
    Depth,
}

/// No erodible layer is deeper \[m\].
const DEEPEST: f64 = 1000.0;

impl Range {
    /// Is it such a number, `first` being the first parameter of the law?
    #[must_use]
    pub fn fits(self, value: f64, first: f64) -> bool {
        value.is_finite()
            && match self {
                Self::NotNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::Share => value > 0.0 && value <= 1.0,
                Self::Exponent => (0.2..=4.0).contains(&value),
                Self::AboveFirst(_) => value > first,
                Self::NotBelowFirst(_) => value >= first,
                Self::Depth => (0.0..=DEEPEST).contains(&value),
            }
    }
    /// Is it compared with the first parameter?
    pub(crate) fn of_first(self) -> bool {
        matches!(self, Self::AboveFirst(_) | Self::NotBelowFirst(_))
    }
    /// In words.
    #[must_use]
    pub fn allowed(self) -> String {
        match self {
            Self::NotNegative => "a number >= 0".to_owned(),
            Self::Positive => "a number > 0".to_owned(),
            Self::Share => "a share above 0, at most 1".to_owned(),
            Self::Exponent => "an exponent from 0.2 to 4".to_owned(),
            Self::AboveFirst(name) => format!("a number above {name}"),
            Self::NotBelowFirst(name) => format!("a number not below {name}"),
            Self::Depth => format!("a number >= 0, at most {DEEPEST} m"),
        }
    }
}

/// A number of a law.
pub(crate) struct Number<'a> {
    /// The parameter that it is, if the case says it.
    pub given: Option<(&'static str, &'a Parameter, Range)>,
    /// The number is the parameter over this, or without one this.
    pub per: f64,
}

impl<'a> Number<'a> {
    /// A parameter.
    pub fn of(key: &'static str, value: &'a Parameter, range: Range) -> Self {
        Number { given: Some((key, value, range)), per: 1.0 }
    }
    /// A number that no key gives.
    pub fn fixed(value: f64) -> Self {
        Number { given: None, per: value }
    }
    /// The same over `per`.
    pub fn per(self, per: f64) -> Self {
        Number { per, ..self }
    }
}

impl Parameter {
    /// Where it comes from, if it differs from place to place; `key` is that of the parameter.
    pub fn place(&self, look: &Look, key: &str, range: Range) -> Result<Option<Place>, CaseError> {
        let Self::InSpace(words) = self else { return Ok(None) };
        let Words { raster, polygons, attribute, elsewhere, by_elevation } = &**words;
        if let Some(value) = elsewhere {
            look.number(
                &format!("{key}.elsewhere"),
                *value,
                |v| range.fits(v, f64::NEG_INFINITY),
                &range.allowed(),
            )?;
        }
        let stray = |name: &str, of: &str| {
            look.fault(&format!("{key}.{name}"), format!("`{name}` belongs to {of}"), "remove it")
        };
        match (raster, polygons, by_elevation) {
            (Some(path), None, None) => {
                if attribute.is_some() {
                    return Err(stray("attribute", "polygons"));
                }
                look.file(&format!("{key}.raster"), path)?;
                Ok(Some(Place::Raster(look.locate(path), *elsewhere)))
            }
            (None, Some(path), None) => {
                let Some(attribute) = attribute else {
                    let cure = "add attribute = \"mu\", the attribute of the polygons that holds it";
                    return Err(look.fault(key, "the key `attribute` is missing", cure));
                };
                look.file(&format!("{key}.polygons"), path)?;
                Ok(Some(Place::Polygons(look.locate(path), attribute.clone(), *elsewhere)))
            }
            (None, None, Some(classes)) => {
                if attribute.is_some() || elsewhere.is_some() {
                    let name = if attribute.is_some() { "attribute" } else { "elsewhere" };
                    return Err(stray(name, "a raster or polygons"));
                }
                classes.check(look, &format!("{key}.by_elevation"), range)?;
                Ok(Some(Place::ByElevation(classes.clone())))
            }
            _ => Err(look.fault(
                key,
                "a parameter that differs from place to place has exactly one of raster, polygons, by_elevation",
                "keep one of them, for instance { raster = \"mu.tif\" }",
            )),
        }
    }

    /// Where it comes from, also if it is the same everywhere; `key` is that of the parameter.
    pub fn in_place(&self, look: &Look, key: &str, range: Range) -> Result<Place, CaseError> {
        if let Some(place) = self.place(look, key, range)? {
            return Ok(place);
        }
        let number = self.usual();
        look.number(key, number, |v| range.fits(v, 0.0), &range.allowed())?;
        Ok(Place::Everywhere(number))
    }

    /// The number, or one that stands in for it where nothing is computed.
    pub fn usual(&self) -> f64 {
        match self {
            Self::Number(value) => *value,
            Self::InSpace(_) => 1.0,
        }
    }
}

impl ByElevation {
    fn check(&self, look: &Look, key: &str, range: Range) -> Result<(), CaseError> {
        let Self { at, values } = self;
        if at.is_empty() || !at.iter().all(|z| z.is_finite()) || !at.is_sorted_by(|a, b| a < b) {
            let message = format!("found {at:?}, expected growing elevations in m");
            return Err(look.fault(&format!("{key}.at"), message, "as in at = [1000, 1500]"));
        }
        if values.len() != at.len() + 1 {
            let message = format!(
                "found {} values for {} elevations, which part {} classes",
                values.len(),
                at.len(),
                at.len() + 1
            );
            let cure = "give one more value than elevations, the lowest class first";
            return Err(look.fault(&format!("{key}.values"), message, cure));
        }
        for (index, value) in values.iter().enumerate() {
            let fits = |v: f64| range.fits(v, f64::NEG_INFINITY);
            look.number(&format!("{key}.values[{index}]"), *value, fits, &range.allowed())?;
        }
        Ok(())
    }

    /// The value of the class of an elevation \[m\].
    #[must_use]
    pub fn at(&self, elevation: f64) -> f64 {
        self.values[self.at.partition_point(|z| *z <= elevation)]
    }
}

impl<'de> Deserialize<'de> for Parameter {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let expected = "a number, or a table as in { raster = \"mu.tif\" }";
        let read = |value: Plain| match value {
            Plain::Number(number) => Ok(Self::Number(number)),
            Plain::Text(text) => Err(format!("found the text \"{text}\", expected {expected}")),
        };
        plain_or_table(from, expected, read, |words| Self::InSpace(Box::new(words)))
    }
}
