//! `[terrain]`: the elevation model.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::choice::{Plain, plain_or_table};
use crate::fault::CaseError;
use crate::look::Look;
use crate::units::Length;

/// The elevation model; lengths in metres, times in seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Terrain")]
pub(super) struct Elevation {
    /// Elevation in metres: GeoTIFF or ESRI ASCII grid, square cells, a projected CRS in metres.
    pub dem: PathBuf,
    /// Coordinate reference system where the file has none, for instance "EPSG:31287".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crs: Option<String>,
    /// The part of the raster that is computed on: [x0, x1, y0, y1]; all cells whose centres lie in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<[f64; 4]>,
    /// Size of the cells in metres, if the raster is to be resampled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cell: Option<f64>,
    /// Span of the window that gradient and curvature of the bed come from, or "off" for no curvature in the friction.
    #[serde(default)]
    curvature: Curvature,
}

/// The curvature of the bed in the friction: { length = "20 m" } or "off".
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub(super) enum Curvature {
    /// Friction feels the centripetal load of a bed smoothed over this span.
    Window(Window),
    /// Friction feels gravity only.
    Off(Off),
}

/// The word "off".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Off {
    /// No curvature in the friction.
    Off,
}

/// The window of the curvature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Window {
    /// Its span; at least 3 x 3 cells are taken (default 20 m).
    pub length: Length,
}

impl Default for Curvature {
    fn default() -> Self {
        Self::Window(Window { length: Length(super::CURVATURE) })
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
    fn length(self) -> Option<f64> {
        match self {
            Self::Window(window) => Some(window.length.0),
            Self::Off(_) => None,
        }
    }
}

impl Elevation {
    /// Checks the numbers; the span of the window of the curvature.
    pub fn check(&self, look: &Look) -> Result<Option<f64>, CaseError> {
        let length = self.curvature.length();
        look.positive("terrain.cell", self.cell)?;
        look.positive("terrain.curvature.length", length)?;
        if let Some([x0, x1, y0, y1]) = self.region {
            for (k, value) in [x0, x1, y0, y1].into_iter().enumerate() {
                look.number(&format!("terrain.region[{k}]"), value, |_| true, "a finite number")?;
            }
            if x0 >= x1 || y0 >= y1 {
                let message = format!("[{x0}, {x1}, {y0}, {y1}] has no inside");
                return Err(look.fault(
                    "terrain.region",
                    message,
                    "write [x0, x1, y0, y1] with x0 < x1 and y0 < y1",
                ));
            }
        }
        Ok(length)
    }
}
