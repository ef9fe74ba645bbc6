//! Why a checked case gave no run.

use granflow_case::CaseError;
use granflow_case::memory::in_words;

/// Why a run could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The case itself is wrong.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The terrain, or a raster of thicknesses, cannot be used.
    #[cfg(feature = "geo")]
    #[error(transparent)]
    Raster(Box<granflow_geo::raster::RasterError>),
    /// A release cannot be used.
    #[cfg(feature = "geo")]
    #[error(transparent)]
    Release(Box<granflow_geo::release::ReleaseError>),
    /// A case begins with the result of a run that cannot be used.
    #[error("{}: {problem}; name the folder of a finished run on {place}, or its result.nc", path.display())]
    Result {
        /// The file.
        path: std::path::PathBuf,
        /// What the run must be on: `a terrain`, `a chute`.
        place: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// The numbers do not make a simulation.
    #[error(transparent)]
    Build(#[from] granflow_engine::simulation::BuildError),
    /// It does not fit into the memory.
    #[error(
        "{cells} cells need about {}, {} are free; take fewer or larger cells, or a machine with more memory",
        in_words(*needed), in_words(*available)
    )]
    Memory {
        /// Cells of the run.
        cells: usize,
        /// Bytes that they need.
        needed: f64,
        /// Bytes that are free.
        available: f64,
    },
    /// The library was built without a feature that this case needs.
    #[error("this needs granflow's feature `{feature}`: build with `--features {feature}`")]
    Feature {
        /// The feature.
        feature: &'static str,
    },
}

#[cfg(feature = "geo")]
impl From<granflow_geo::raster::RasterError> for StartError {
    fn from(error: granflow_geo::raster::RasterError) -> Self {
        StartError::Raster(Box::new(error))
    }
}

#[cfg(feature = "geo")]
impl From<granflow_geo::release::ReleaseError> for StartError {
    fn from(error: granflow_geo::release::ReleaseError) -> Self {
        StartError::Release(Box::new(error))
    }
}
