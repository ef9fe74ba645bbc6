//! The kinds of files that a case may ask for: each is one file of code and one line here.

use super::{FilesError, Finished};
use crate::case::FileKind;
#[cfg(feature = "figures")]
use crate::output::report::Figure;

/// All of them, in the order in which their files are named.
pub(super) static FORMATS: &[&Format] = &[
    &super::netcdf::NETCDF,
    #[cfg(feature = "figures")]
    &super::story::FIGURES,
    #[cfg(feature = "geo")]
    &super::rasters::GEOTIFF,
    #[cfg(feature = "geo")]
    &super::vector::VECTOR,
    &super::tables::CSV,
    &super::tables::VTK,
    #[cfg(feature = "figures")]
    &super::animation::ANIMATION,
    #[cfg(feature = "figures")]
    &super::report::REPORT,
];

/// What a case may ask for.
pub(crate) fn kinds() -> &'static [FileKind] {
    static KINDS: std::sync::LazyLock<Vec<FileKind>> =
        std::sync::LazyLock::new(|| FORMATS.iter().map(|format| format.kind).collect());
    &KINDS
}

/// A kind of file, and what writes it.
pub(super) struct Format {
    pub kind: FileKind,
    /// It shows pictures of the model.
    pub drawn: bool,
    /// It shows the files of the figures, which are drawn before.
    pub after_figures: bool,
    /// Writes the files of a finished run; returns their paths.
    pub write: fn(&Work) -> Result<Vec<std::path::PathBuf>, FilesError>,
}

impl Format {
    /// A kind without pictures.
    pub const fn of(
        kind: FileKind,
        write: fn(&Work) -> Result<Vec<std::path::PathBuf>, FilesError>,
    ) -> Format {
        Format { kind, drawn: false, after_figures: false, write }
    }
}

/// A finished run while its files are made.
pub(super) struct Work<'r> {
    pub run: &'r Finished,
    /// The run as its figures see it, where something is drawn.
    #[cfg(feature = "figures")]
    pub story: Option<super::Story<'r>>,
    /// The figures, once they are drawn.
    #[cfg(feature = "figures")]
    pub figures: std::sync::OnceLock<Vec<Figure>>,
}
