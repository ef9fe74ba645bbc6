//! `[output]`: which files, how many instants, how many digits.

use crate::checked::{Ends, Frames};
use crate::fault::CaseError;
use crate::look::Look;
use crate::precision::Precision;
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

/// Frames of a run whose end is known.
const FRAMES: u32 = 20;

impl Output {
    /// When the state is written, which files, and how precise they are; `files` and `precision` are what is written where
    /// the case does not say. Files that need a place on the earth are refused unless they are among `files`.
    pub(crate) fn check(
        &self,
        look: &Look,
        ends: &Ends,
        files: &[FileKind],
        precision: Precision,
    ) -> Result<(Frames, Vec<FileKind>, Precision), CaseError> {
        if self.every.is_some() && self.steps.is_some() {
            let message = "both `every` and `steps` are given";
            return Err(look.fault("output.steps", message, "keep one of them"));
        }
        look.positive("output.every", self.every)?;
        look.not_zero("output.steps", self.steps)?;
        for (index, kind) in self.files.iter().flatten().enumerate() {
            if kind.needs_terrain() && !files.contains(kind) {
                return Err(look.fault(
                    &format!("output.files[{index}]"),
                    format!("`{}` needs [terrain]", kind.as_str()),
                    "on a grid: netcdf, csv, vtk, figures, animation",
                ));
            }
        }
        let frames = match (self.every, self.steps, ends.time, ends.steps) {
            (Some(every), ..) => Frames::Every(every),
            (None, Some(steps), ..) => Frames::Steps(steps),
            (None, None, Some(end), _) => Frames::Every(end / f64::from(FRAMES)),
            (None, None, None, Some(steps)) => Frames::Steps(steps.div_ceil(u64::from(FRAMES)).max(1)),
            (None, None, None, None) => Frames::Ends,
        };
        let files = self.files.clone().unwrap_or_else(|| files.to_vec());
        Ok((frames, files, self.precision.unwrap_or(precision)))
    }
}

/// Files of a case on a grid that does not say which.
pub(crate) const ON_A_GRID: &[FileKind] = &[FileKind::Netcdf, FileKind::Figures];

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
