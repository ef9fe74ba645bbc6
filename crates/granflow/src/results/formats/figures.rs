//! The figures as PNG files.

use crate::results::format::Format;
use granflow_case::FileKind;

/// The figures.
pub(super) static FIGURES: Format = Format {
    kind: FileKind { name: "figures", about: "Figures, figures/*.png.", needs_terrain: false },
    drawn: true,
    after_figures: false,
    write: |work| {
        let Some(story) = &work.story else { return Ok(Vec::new()) };
        let figures = story.draw(&work.run.figures())?;
        if let Some(along) = &story.view.along {
            along.write(&work.run.directory.join("range_time.csv"))?;
        }
        Ok(work.figures.get_or_init(|| figures).iter().map(|figure| figure.path.clone()).collect())
    },
};
