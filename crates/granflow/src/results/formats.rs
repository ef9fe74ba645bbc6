//! The kinds of files that a case may ask for: each is one file of this folder, and is named here.

#[cfg(feature = "figures")]
mod animation;
#[cfg(feature = "figures")]
mod figures;
mod netcdf;
#[cfg(feature = "geo")]
mod rasters;
#[cfg(feature = "figures")]
mod report;
mod tables;
#[cfg(feature = "geo")]
mod vector;

use super::format::Format;
use granflow_case::FileKind;

/// All of them, in the order in which their files are named.
pub(super) static FORMATS: &[&Format] = &[
    &netcdf::NETCDF,
    #[cfg(feature = "figures")]
    &figures::FIGURES,
    #[cfg(feature = "geo")]
    &rasters::GEOTIFF,
    #[cfg(feature = "geo")]
    &vector::VECTOR,
    &tables::CSV,
    &tables::VTK,
    #[cfg(feature = "figures")]
    &animation::ANIMATION,
    #[cfg(feature = "figures")]
    &report::REPORT,
];

/// What a case may ask for.
pub(crate) fn kinds() -> &'static [FileKind] {
    static KINDS: std::sync::LazyLock<Vec<FileKind>> =
        std::sync::LazyLock::new(|| FORMATS.iter().map(|format| format.kind).collect());
    &KINDS
}
