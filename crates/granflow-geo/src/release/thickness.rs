//! How thick the features of a release are.

use super::vector::Feature;
use super::{ReleaseError, THICKEST};
use std::path::Path;

/// Where the thickness of a polygon comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Thickness {
    /// One thickness for all polygons \[m\].
    Value(f64),
    /// The attribute of this name, in metres.
    Attribute(String),
    /// The attribute of this name times a number.
    Scaled(String, f64),
    /// One thickness for each feature, in the order of the file \[m\]; features without a shape have none.
    Each(Vec<f64>),
}

impl Thickness {
    /// Are there as many thicknesses as features?
    pub(super) fn fits(&self, path: &Path, features: usize) -> Result<(), ReleaseError> {
        match self {
            Thickness::Each(values) if values.len() != features => {
                let count = values.len();
                let problem = format!(
                    "{features} features have a shape, and {count} thicknesses are given; give one for each"
                );
                Err(ReleaseError::Shape { path: path.into(), feature: features, problem })
            }
            _ => Ok(()),
        }
    }

    /// The thickness of a feature, which has this place among those with a shape.
    pub(super) fn of(&self, path: &Path, (place, feature): (usize, &Feature)) -> Result<f64, ReleaseError> {
        let (value, found, name) = match self {
            Thickness::Value(value) => (Some(*value), value.to_string(), "thickness"),
            Thickness::Each(values) => {
                (values.get(place).copied(), format!("{:?}", values.get(place)), "thickness")
            }
            Thickness::Scaled(name, factor) => {
                let (name, text, value) = attribute(path, feature, name)?;
                (value.map(|value: f64| value * factor), text.to_string(), name)
            }
            Thickness::Attribute(name) => {
                let (name, text, value) = attribute(path, feature, name)?;
                (value, text.to_string(), name)
            }
        };
        match value.filter(|value: &f64| (0.0..=THICKEST).contains(value)) {
            Some(value) => Ok(value),
            None => {
                let (path, name) = (path.into(), name.to_string());
                Err(ReleaseError::Thickness { path, feature: feature.number, name, found })
            }
        }
    }
}

/// An attribute of a feature as the file spells its name, its text, and the number that this is.
pub(super) fn attribute<'a>(
    path: &Path,
    feature: &'a Feature,
    name: &str,
) -> Result<(&'a str, &'a str, Option<f64>), ReleaseError> {
    let same = |(other, _): &&(String, String)| other.eq_ignore_ascii_case(name);
    let attributes = &feature.attributes;
    let exact = attributes.iter().find(|(other, _)| other == name).or(attributes.iter().find(same));
    let Some((name, text)) = exact else {
        return Err(ReleaseError::attribute(path, name, attributes));
    };
    let text = text.trim();
    let value = text.parse().ok().or_else(|| text.replacen(',', ".", 1).parse().ok());
    Ok((name, text, value))
}
