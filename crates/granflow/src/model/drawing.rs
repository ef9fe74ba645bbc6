//! A figure that is still to be drawn: its name, its caption, and how.

use crate::output::figures::{FigureError, Picture, PictureError, save};
use crate::output::report;
use rayon::prelude::*;
use std::fmt;
use std::path::Path;

type Draw<'a> = Box<dyn Fn() -> Result<Picture, FigureError> + Send + Sync + 'a>;

/// A figure that is still to be drawn.
pub struct Drawing<'a> {
    /// Name of the file without its ending.
    pub name: &'static str,
    /// What one sees.
    pub caption: String,
    draw: Draw<'a>,
}

impl fmt::Debug for Drawing<'_> {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        to.debug_struct("Drawing").field("name", &self.name).finish_non_exhaustive()
    }
}

impl<'a> Drawing<'a> {
    /// A drawing called `name`, the file's name without its ending; words of `name` are parted by `_`.
    pub fn new(
        name: &'static str,
        caption: impl Into<String>,
        draw: impl Fn() -> Result<Picture, FigureError> + Send + Sync + 'a,
    ) -> Drawing<'a> {
        Drawing { name, caption: caption.into(), draw: Box::new(draw) }
    }
}

/// Draw all on all cores into `folder`, in their order; a figure of nothing finite is left out.
///
/// # Errors
/// [`PictureError`] naming the figure or the file.
pub fn save_all(drawings: &[Drawing], folder: &Path) -> Result<Vec<report::Figure>, PictureError> {
    let draw = |drawing: &Drawing| -> Result<_, PictureError> {
        match (drawing.draw)() {
            Err(FigureError::Empty { .. }) => Ok(None),
            Err(error) => Err(error.into()),
            Ok(picture) => {
                let path = folder.join(format!("{}.png", drawing.name));
                save(&picture, &path)?;
                let mut name = drawing.name.replace('_', " ");
                name[..1].make_ascii_uppercase();
                Ok(Some(report::Figure { name, caption: drawing.caption.clone(), path }))
            }
        }
    };
    let figures: Vec<Option<report::Figure>> = drawings.par_iter().map(draw).collect::<Result<_, _>>()?;
    Ok(figures.into_iter().flatten().collect())
}

/// The upper end of a range of colours: the greatest value, or where a few cells stand far above the others the
/// value that one in 500 exceeds; 1 of nothing.
pub fn colour_limit(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let Some(&greatest) = values.last() else { return 1.0 };
    let nearly = values[(values.len() - 1) * 499 / 500];
    if greatest > 1.25 * nearly { nearly } else { greatest }
}
