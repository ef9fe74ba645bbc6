//! Why a file could not be made of a run.

use crate::output;
#[cfg(feature = "figures")]
use crate::output::figures::PictureError;
#[cfg(feature = "geo")]
use crate::raster::RasterError;
use granflow_case::FileKind;
use std::path::PathBuf;

/// Why a file could not be made of a run.
#[derive(Debug, thiserror::Error)]
pub enum FilesError {
    /// A file of the results could not be read or written.
    #[error(transparent)]
    Output(#[from] output::Error),
    /// A figure could not be drawn or written.
    #[cfg(feature = "figures")]
    #[error(transparent)]
    Figure(#[from] PictureError),
    /// A raster could not be written.
    #[cfg(feature = "geo")]
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// This kind of file cannot be made.
    #[error("output.files: {} cannot be written: {problem}, or take \"{}\" out of the list", kind.name, kind.name)]
    Kind {
        /// The kind.
        kind: FileKind,
        /// Why, and what helps.
        problem: String,
    },
    /// There is no such result.
    #[error("{}: cannot open: {source}; `granflow run CASE.toml` writes a result.nc", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is no result of granflow.
    #[error("{}: this is no result of granflow: {problem}; give the result.nc of a run", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
}
