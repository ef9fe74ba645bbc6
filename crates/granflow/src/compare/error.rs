//! Why two sides could not be compared, each with its cure.

use crate::output::Error;
use crate::output::figures::FigureError;
use crate::raster::RasterError;
use crate::release::ReleaseError;
use crate::results::FilesError;
use std::path::PathBuf;

/// Why two sides could not be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A result could not be read.
    #[error(transparent)]
    Result(#[from] FilesError),
    /// A raster could not be read, or is in another system.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// An outline could not be read, or a raster has a thickness below zero.
    #[error(transparent)]
    Outline(#[from] ReleaseError),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] Error),
    /// The figure could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The file is none of the kinds that can be compared.
    #[error(
        "{}: this is no result of a run, no raster and no outline; give the folder or the result.nc of a run, a GeoTIFF or ESRI \
         ASCII grid of thickness, or polygons as GeoJSON or shapefile", path.display()
    )]
    Kind {
        /// The file.
        path: PathBuf,
    },
    /// The file could not be opened.
    #[error("{}: cannot read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The result has no such map.
    #[error("{}: it has no map `{map}`, so nothing of it can be compared; results of avalanches have one", path.display())]
    NoMap {
        /// The file.
        path: PathBuf,
        /// The map.
        map: &'static str,
    },
    /// The outlines of a run have none of what is compared.
    #[error("{}: it has outlines of {has}, not of {wanted}; {}", path.display(), cure(has))]
    NoOutline {
        /// The file.
        path: PathBuf,
        /// The names of its outlines.
        has: String,
        /// The name that was looked for.
        wanted: &'static str,
    },
    /// The sides lie in no common plane.
    #[error("{} and {}: {problem}", a.display(), b.display())]
    Apart {
        /// One file.
        a: PathBuf,
        /// The other file.
        b: PathBuf,
        /// Why, and what helps.
        problem: String,
    },
    /// The maps of a result begin above the threshold.
    #[error(
        "{}: its maps count a layer from {least} on (output.threshold of its case), so that a threshold of {threshold} cannot be \
         seen; write --threshold {least}, or run the case with a smaller output.threshold", path.display()
    )]
    TooThin {
        /// The file.
        path: PathBuf,
        /// The threshold asked for.
        threshold: f64,
        /// What its maps begin at.
        least: f64,
    },
    /// The threshold is no thickness.
    #[error("--threshold {threshold} is no thickness; allowed are numbers from 0 on")]
    Threshold {
        /// What was given.
        threshold: f64,
    },
    /// Both areas are empty.
    #[error("neither {} nor {} has a layer thicker than {threshold}; write a smaller --threshold", a.display(), b.display())]
    Nothing {
        /// The threshold.
        threshold: f64,
        /// One file.
        a: PathBuf,
        /// The other file.
        b: PathBuf,
    },
}

fn cure(has: &str) -> &'static str {
    match has {
        _ if has.contains("deposit") => "write --by deposit",
        _ if has.contains("peak_thickness") => "write --by footprint",
        _ => "give the outline that is meant in a file of its own",
    }
}
