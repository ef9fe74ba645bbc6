//! A figure that is still to be drawn: its name, its caption, and how.

use crate::output::figures::{FigureError, Picture, PictureError, save};
use crate::output::report;
use rayon::prelude::*;
use std::fmt;
use std::path::Path;

type Draw<'a> = Box<dyn Fn() -> Result<Picture, FigureError> + Send + Sync + 'a>;

/// A figure that is still to be drawn.
pub(super) struct Drawing<'a> {
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
    pub fn new(
        name: &'static str,
        caption: impl Into<String>,
        draw: impl Fn() -> Result<Picture, FigureError> + Send + Sync + 'a,
    ) -> Drawing<'a> {
        Drawing { name, caption: caption.into(), draw: Box::new(draw) }
    }
}

/// Draw all on all cores into `folder`, in their order; a figure of nothing finite is left out.
pub(super) fn save_all(drawings: &[Drawing], folder: &Path) -> Result<Vec<report::Figure>, PictureError> {
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
