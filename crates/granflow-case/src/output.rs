//! `[output]`: which files, how many instants, how many digits.

use crate::Precision;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is written.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// Simulated time between two instants (default: 20 instants up to the end).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every: Option<f64>,
    /// Steps between two instants; instead of `every`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
    /// Kinds of files (default: netcdf and figures; on terrain geotiff, vector and report as well).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub files: Option<Vec<FileKind>>,
    /// Precision of the numbers in the files (default f64 on a grid, f32 on terrain).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precision: Option<Precision>,
}

/// A kind of output file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FileKind {
    /// The fields over time: result.nc.
    Netcdf,
    /// The fields as tables.
    Csv,
    /// The fields for ParaView.
    Vtk,
    /// Summary maps, rasters/*.tif (terrain).
    Geotiff,
    /// Outlines of the deposit, outlines.geojson (terrain).
    Vector,
    /// Figures, figures/*.png.
    Figures,
    /// A film of the run.
    Animation,
    /// One page that shows it all, report.html (terrain).
    Report,
}

impl FileKind {
    /// The name a case file writes.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Netcdf => "netcdf",
            Self::Csv => "csv",
            Self::Vtk => "vtk",
            Self::Geotiff => "geotiff",
            Self::Vector => "vector",
            Self::Figures => "figures",
            Self::Animation => "animation",
            Self::Report => "report",
        }
    }

    /// Whether the kind needs a raster with a place on the earth.
    #[must_use]
    pub fn needs_terrain(self) -> bool {
        matches!(self, Self::Geotiff | Self::Vector | Self::Report)
    }
}

/// When the state is written; the first and the last instant always are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Frames {
    /// Every so much simulated time.
    Every(f64),
    /// Every so many steps.
    Steps(u64),
    /// At the start and at the end only, since the end is not known beforehand.
    Ends,
}
