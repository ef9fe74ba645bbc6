//! `[terrain]` and `[[release]]`: the mountain and what comes off it.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::choice::{Plain, plain_or_table};
use super::units::Length;

/// The elevation model; lengths in metres, times in seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Terrain {
    /// Elevation in metres: GeoTIFF or ESRI ASCII grid, square cells, a projected CRS in metres.
    pub dem: PathBuf,
    /// Coordinate reference system where the file has none, for instance "EPSG:31287".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crs: Option<String>,
    /// Size of the cells in metres, if the raster is to be resampled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cell: Option<f64>,
    /// Span of the window that gradient and curvature of the bed come from, or "off" for no curvature in the friction.
    #[serde(default)]
    pub curvature: Curvature,
}

/// The curvature of the bed in the friction: { length = "20 m" } or "off".
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Curvature {
    /// Friction feels the centripetal load of a bed smoothed over this span.
    Window(Window),
    /// Friction feels gravity only.
    Off(Off),
}

/// The word "off".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Off {
    /// No curvature in the friction.
    Off,
}

/// The window of the curvature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Window {
    /// Its span; at least 3 x 3 cells are taken (default 20 m).
    pub length: Length,
}

impl Default for Curvature {
    fn default() -> Self {
        Self::Window(Window { length: Length(20.0) })
    }
}

impl<'de> Deserialize<'de> for Curvature {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let expected = "{ length = \"20 m\" } or \"off\"";
        let read = |value: Plain| match value {
            Plain::Text("off") => Ok(Self::Off(Off::Off)),
            Plain::Text(text) => Err(format!("found the text \"{text}\", expected {expected}")),
            Plain::Number(number) => Err(format!("found the number {number}, expected {expected}")),
        };
        plain_or_table(from, expected, read, Self::Window)
    }
}

impl Curvature {
    /// Span of the window in metres, `None` if the curvature is off.
    #[must_use]
    pub fn length(self) -> Option<f64> {
        match self {
            Self::Window(window) => Some(window.length.0),
            Self::Off(_) => None,
        }
    }
}

/// Mass that is released at the start: exactly one of `polygons`, `raster`, `cap`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Release {
    /// Polygons: a shapefile or GeoJSON.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub polygons: Option<PathBuf>,
    /// Thickness in metres as a raster: GeoTIFF or ESRI ASCII grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub raster: Option<PathBuf>,
    /// A parabolic cap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cap: Option<ReleaseCap>,
    /// Thickness in the polygons: metres, or { attribute = "name" }.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<Thickness>,
    /// How the thickness is measured.
    #[serde(default)]
    pub measured: Measured,
}

/// A parabolic cap, height (1 - r^2/radius^2), r the horizontal distance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReleaseCap {
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
}

/// An attribute of the polygons that holds the thickness in metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Attribute {
    /// Its name.
    pub attribute: String,
}

impl<'de> Deserialize<'de> for Thickness {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let expected = "a number (metres) or { attribute = \"thickness\" }";
        let read = |value: Plain| match value {
            Plain::Number(number) => Ok(Self::Constant(number)),
            Plain::Text(text) => Err(format!("found the text \"{text}\", expected {expected}")),
        };
        plain_or_table(from, expected, read, Self::Attribute)
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
