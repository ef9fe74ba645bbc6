//! `[[release]]`: what comes off the mountain.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::choice::{Plain, plain_or_table};
use crate::fault::CaseError;
use crate::look::{Look, result_of};

/// Mass that is released.
#[derive(Debug, Clone, PartialEq)]
pub struct Release {
    /// Where it is, and how thick.
    pub extent: Extent,
    /// How the thickness is measured.
    pub measured: Measured,
    /// When it starts.
    pub starts: Starts,
}

/// When a release starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Starts {
    /// At a time \[s\].
    At(f64),
    /// When flowing mass reaches it.
    Hit,
}

/// Where a release is and how thick.
#[derive(Debug, Clone, PartialEq)]
pub enum Extent {
    /// Polygons of a shapefile or GeoJSON.
    Polygons {
        /// The file.
        path: PathBuf,
        /// Thickness in them.
        thickness: Thickness,
    },
    /// Thickness in metres as a raster: GeoTIFF or ESRI ASCII grid.
    Raster(PathBuf),
    /// A parabolic cap.
    Cap(Cap),
    /// What lies at the end of another run, in its result.nc.
    Result(PathBuf),
}

/// Mass that is released: exactly one of `polygons`, `raster`, `cap`, `result`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Release")]
pub(super) struct Words {
    /// Polygons: a shapefile or GeoJSON.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub polygons: Option<PathBuf>,
    /// Thickness in metres as a raster: GeoTIFF or ESRI ASCII grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub raster: Option<PathBuf>,
    /// A parabolic cap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cap: Option<Cap>,
    /// What lies at the end of another run on terrain: its folder, or its result.nc.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub result: Option<PathBuf>,
    /// Thickness in the polygons: metres, { attribute = "name" }, or { features = [1.2, 0.8] } with one for each feature.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<Thickness>,
    /// How the thickness is measured.
    #[serde(default)]
    pub measured: Measured,
    /// Time in seconds at which it starts (default 0).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<f64>,
    /// What lets it start instead of a time: "hit", flowing mass that reaches it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub when: Option<When>,
}

/// What lets a secondary release start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// Flowing mass that reaches one of its cells.
    Hit,
}

/// A parabolic cap, height (1 - r^2/radius^2), r the horizontal distance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ReleaseCap")]
pub struct Cap {
    /// Thickness at the centre in metres.
    pub height: f64,
    /// Centre [x, y] in the raster's coordinates.
    pub centre: [f64; 2],
    /// Horizontal distance in metres at which the cap ends.
    pub radius: f64,
}

/// Thickness of a release in polygons.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Thickness {
    /// The same everywhere, in metres.
    Constant(f64),
    /// From an attribute of each polygon.
    Attribute(Attribute),
    /// One for each feature, in the order of the file.
    Features(Features),
}

/// An attribute of the polygons that holds the thickness in metres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Attribute {
    /// Its name.
    pub attribute: String,
    /// What it is multiplied by (default 1).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
}

/// A thickness for each feature.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Features {
    /// Metres, in the order of the file; features without a shape are left out.
    pub features: Vec<f64>,
}

/// The table by which a thickness is written, with the keys of all choices.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    attribute: Option<String>,
    factor: Option<f64>,
    features: Option<Vec<f64>>,
}

/// The same, once it is one choice.
#[derive(Deserialize)]
#[serde(try_from = "Keys")]
struct Chosen(Thickness);

impl TryFrom<Keys> for Chosen {
    type Error = &'static str;
    fn try_from(keys: Keys) -> Result<Self, Self::Error> {
        match keys {
            Keys { attribute: Some(attribute), factor, features: None } => {
                Ok(Self(Thickness::Attribute(Attribute { attribute, factor })))
            }
            Keys { attribute: None, factor: None, features: Some(features) } => {
                Ok(Self(Thickness::Features(Features { features })))
            }
            _ => Err("expected either attribute (with or without factor) or features"),
        }
    }
}

impl<'de> Deserialize<'de> for Thickness {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let expected = "a number (metres) or { attribute = \"thickness\" }";
        let read = |value: Plain| match value {
            Plain::Number(number) => Ok(Self::Constant(number)),
            Plain::Text(text) => Err(format!("found the text \"{text}\", expected {expected}")),
        };
        plain_or_table(from, expected, read, |Chosen(thickness)| thickness)
    }
}

/// How a thickness is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Measured {
    /// At right angles to the bed.
    #[default]
    Normal,
    /// Along the vertical.
    Vertical,
}

impl Thickness {
    fn check(&self, look: &Look, key: &str) -> Result<(), CaseError> {
        match self {
            Self::Constant(value) => look.positive(key, Some(*value)),
            Self::Attribute(attribute) => look.usual(&format!("{key}.factor"), attribute.factor),
            Self::Features(Features { features }) => {
                let mut values = features.iter().enumerate();
                values.try_for_each(|(k, value)| {
                    look.not_negative(&format!("{key}.features[{k}]"), Some(*value))
                })
            }
        }
    }
}

impl Words {
    /// Checks the numbers; the files may be missing yet.
    pub fn check(&self, look: &Look, key: &str) -> Result<Release, CaseError> {
        let thickness_key = format!("{key}.thickness");
        let (measured, starts) = (self.measured, self.starts(look, key)?);
        let extent = match (&self.polygons, &self.raster, &self.cap, &self.result) {
            (Some(path), None, None, None) => {
                let Some(thickness) = self.thickness.clone() else {
                    return Err(look.fault(
                        &thickness_key,
                        "the key `thickness` is missing",
                        "add thickness = 1.0 (metres) or thickness = { attribute = \"thickness\" }",
                    ));
                };
                thickness.check(look, &thickness_key)?;
                return Ok(Release {
                    extent: Extent::Polygons { path: look.locate(path), thickness },
                    measured,
                    starts,
                });
            }
            (None, Some(path), None, None) => Extent::Raster(look.locate(path)),
            (None, None, Some(cap), None) => Extent::Cap(cap.clone()),
            (None, None, None, Some(path)) => Extent::Result(look.locate(&result_of(path))),
            _ => {
                return Err(look.fault(
                    key,
                    "a release has exactly one of polygons, raster, cap, result",
                    "split it into several [[release]] tables, or remove what is too much",
                ));
            }
        };
        if self.thickness.is_some() {
            return Err(look.fault(
                &thickness_key,
                "`thickness` belongs to polygons",
                "remove it: a raster, a cap or a result has its own thickness",
            ));
        }
        if self.result.is_some() && measured == Measured::Vertical {
            return Err(look.fault(
                &format!("{key}.measured"),
                "`measured` has no meaning for a result",
                "remove it: the result knows its own slopes",
            ));
        }
        if let Extent::Cap(cap) = &extent {
            look.positive(&format!("{key}.cap.height"), Some(cap.height))?;
            look.positive(&format!("{key}.cap.radius"), Some(cap.radius))?;
            for (index, value) in cap.centre.iter().enumerate() {
                look.number(&format!("{key}.cap.centre[{index}]"), *value, |_| true, "a finite number")?;
            }
        }
        Ok(Release { extent, measured, starts })
    }

    fn starts(&self, look: &Look, key: &str) -> Result<Starts, CaseError> {
        match (self.at, self.when) {
            (None, None) => Ok(Starts::At(0.0)),
            (Some(at), None) => {
                look.not_negative(&format!("{key}.at"), Some(at))?;
                Ok(Starts::At(at))
            }
            (None, Some(When::Hit)) => Ok(Starts::Hit),
            (Some(_), Some(_)) => Err(look.fault(
                &format!("{key}.when"),
                "both `at` and `when` are given",
                "keep one: a time, or when = \"hit\"",
            )),
        }
    }

    /// The files must exist.
    pub fn check_files(&self, look: &Look, key: &str) -> Result<(), CaseError> {
        let stored = self.result.as_deref().map(result_of);
        for (name, path) in [("polygons", &self.polygons), ("raster", &self.raster), ("result", &stored)] {
            path.iter().try_for_each(|path| look.file(&format!("{key}.{name}"), path))?;
        }
        Ok(())
    }
}
