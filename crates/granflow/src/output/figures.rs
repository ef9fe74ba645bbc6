//! Figures as PNG files; the kinds of figures are those of [`granflow_figures`].

use super::{Error, whole_file};
pub use granflow_figures::*;
use std::path::Path;

/// Why the file of a figure could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// It could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// It could not be written.
    #[error(transparent)]
    File(#[from] Error),
}

/// Writes a picture as a PNG; under `path` stands the old file or the whole new one at every instant.
///
/// # Errors
/// [`Error`] naming the path.
pub fn save(picture: &Picture, path: &Path) -> Result<(), Error> {
    whole_file(path, |out| picture.write_png(out))
}

/// Figures that can be drawn into a file.
pub trait Save: Figure {
    /// Draws the figure and writes it as a PNG (see [`save`]).
    ///
    /// # Errors
    /// [`PictureError`].
    fn save(&self, path: &Path) -> Result<(), PictureError> {
        Ok(save(&self.draw()?, path)?)
    }
}

impl<F: Figure + ?Sized> Save for F {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let figure = HeatMap { xs: &[0.0, 1.0], ys: &[0.0, 1.0], values: &[1.0; 4], ..Default::default() };
        let message = figure.save(&file.join("inside.png")).unwrap_err().to_string();
        assert!(message.contains("inside.png"), "{message}");
    }
}
