//! A kind of file that a case may ask for, and what writes it.

use super::{FilesError, Finished};
#[cfg(feature = "figures")]
use crate::output::report::Figure;
use granflow_case::FileKind;

/// A kind of file, and what writes it.
pub(crate) struct Format {
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
pub(crate) struct Work<'r> {
    pub run: &'r Finished,
    /// The run as its figures see it, where something is drawn.
    #[cfg(feature = "figures")]
    pub story: Option<super::Story<'r>>,
    /// The figures, once they are drawn.
    #[cfg(feature = "figures")]
    pub figures: std::sync::OnceLock<Vec<Figure>>,
}
