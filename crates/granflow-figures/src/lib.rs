//! The figures: every picture of a run or a paper, drawn to PNG without fonts or graphics of the system.
//!
//! Each kind is a struct of plain slices and texts that implements [`Figure`]: [`Profiles`], [`HeatMap`] (a field over a
//! plane or over space and time), [`Surface`], [`Map`], [`Parts`], [`Section`], [`History`], [`Convergence`]. The typeface is compiled
//! in, so the same data give the same bytes on every machine.
//!
//! ```
//! use granflow_figures::{Axis, Curve, Figure, Profiles, Style};
//! let x = [0.0, 1.0, 2.0];
//! let figure = Profiles {
//!     title: "A slope",
//!     x: Axis::new("x", "m"),
//!     y: Axis::new("thickness", "m"),
//!     curves: &[Curve { name: "h", x: &x, y: &[2.0, 1.0, 0.0], style: Style::Solid, colour: None }],
//!     ..Default::default()
//! };
//! let picture = figure.draw()?;
//! assert_eq!((picture.width, picture.height), (1600, 1000));
//! # Ok::<(), granflow_figures::FigureError>(())
//! ```

mod axes;
mod canvas;
mod colour_bar;
mod colours;
mod contours;
mod convergence;
mod curves;
mod depth;
mod heat;
mod history;
mod lattice;
mod legend;
mod map;
mod parts;
mod perspective;
mod relief;
mod rows;
mod scale_bar;
mod section;
mod surface;
mod thin;
mod ticks;
mod typeface;
mod view;

use std::io;

pub use axes::Axis;
pub use colours::{Colours, Rgb, line_colour};
pub use convergence::{Convergence, ErrorSeries};
pub use curves::{Curve, Fill, Profiles, Style};
pub use heat::{Frame, HeatMap, Levels, Outline};
pub use history::{History, HistoryPanel};
pub use map::{Map, Overlay};
pub use parts::{Part, Parts};
pub use relief::Relief;
pub use section::Section;
pub use surface::{Paint, Surface};
pub use ticks::{round_length, short};
pub use view::Extent;

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// Two slices that belong together differ in length.
    #[error("figure `{figure}`: {what} has {found} values where {expected} are needed")]
    Shape {
        /// The title of the figure.
        figure: String,
        /// The slice, in words.
        what: String,
        /// Its length.
        found: usize,
        /// The length that fits the others.
        expected: usize,
    },
    /// There is no finite number to draw, or fewer points than the kind of figure needs.
    #[error("figure `{figure}`: {what}; nothing can be drawn")]
    Empty {
        /// The title of the figure.
        figure: String,
        /// What is missing.
        what: String,
    },
}

impl FigureError {
    fn empty(figure: &str, what: impl Into<String>) -> Self {
        Self::Empty { figure: figure.into(), what: what.into() }
    }

    /// Refuses a slice of another length than its partners.
    fn same_length(figure: &str, what: &str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        Err(Self::Shape { figure: figure.into(), what: what.into(), found, expected })
    }
}

/// A drawn figure: opaque RGB pixels, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `3 * width * height` bytes: red, green, blue of each pixel.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// Writes the picture as a PNG.
    ///
    /// # Errors
    /// What the encoder or `out` says.
    pub fn write_png(&self, out: &mut dyn io::Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let mut writer = encoder.write_header().map_err(io::Error::other)?;
        writer.write_image_data(&self.rgb).map_err(io::Error::other)?;
        writer.finish().map_err(io::Error::other)
    }
}

/// What every kind of figure can do.
pub trait Figure {
    /// Draws the figure.
    ///
    /// # Errors
    /// [`FigureError::Shape`] for slices that do not fit together, [`FigureError::Empty`] where nothing finite is given.
    fn draw(&self) -> Result<Picture, FigureError>;
}
