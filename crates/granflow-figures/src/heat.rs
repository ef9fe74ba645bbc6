//! A field seen from above: over a plane, or over space and time (the "Draufsicht" of the papers).

use tiny_skia::Pixmap;

use super::axes::{
    Axis, Panel, RIM, Scale, bottom_room, extent, heading, heading_height, left_room, widened,
};
use super::canvas::{Area, Canvas, Pen};
use super::colour_bar::ColourBar;
use super::colours::{Colours, INK, Rgb, WHITE, pick};
use super::contours::{Contours, Elevations};
use super::lattice::{Between, Lattice, paint};
use super::{Figure, FigureError, Picture};

/// What the two axes of a [`HeatMap`] are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// Two lengths at the same scale; coordinates are centres of cells, the picture reaches half a cell beyond them.
    #[default]
    Plane,
    /// Cell centres along x, instants along y; the picture reaches from the first instant to the last.
    SpaceTime,
    /// Instants along x, cell centres along y.
    TimeSpace,
}

/// A line over a map or a plane: a release area, the edge of a table, a path.
#[derive(Debug, Clone, Copy, Default)]
pub struct Outline<'a> {
    /// Its name in the legend; empty for none.
    pub name: &'a str,
    /// Its points in the coordinates of the axes.
    pub points: &'a [[f64; 2]],
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Whether it is dashed.
    pub dashed: bool,
    /// Its colour; dark grey where `None`.
    pub colour: Option<Rgb>,
    /// Its width in points; 1.8 between white rims where `None`.
    pub width: Option<f64>,
}

impl Outline<'_> {
    pub(super) fn pen(&self) -> Pen {
        let dashes: &'static [f32] = if self.dashed { &[6.0, 4.0] } else { &[] };
        Pen { dashes, ..Pen::new(self.colour.unwrap_or(INK), self.width.unwrap_or(1.8)) }
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, panel: &Panel) {
        let line: Vec<_> = self.points.iter().map(|&[x, y]| panel.place(x, y)).collect();
        let casing = Pen { alpha: 0.7, ..Pen::new(WHITE, 3.6) };
        let cased = self.width.is_none().then_some(casing);
        for pen in cased.into_iter().chain([self.pen()]) {
            if self.closed { canvas.ring(&line, pen) } else { canvas.line(&line, pen) }
        }
    }
}

/// A field z(x, y) or z(x, t) as colours, with colour bar.
#[derive(Debug, Clone, Copy, Default)]
pub struct HeatMap<'a> {
    /// The heading.
    pub title: &'a str,
    /// A second, smaller line under it.
    pub subtitle: &'a str,
    /// What the axes are.
    pub frame: Frame,
    /// The horizontal axis (its range is that of `xs`).
    pub x: Axis<'a>,
    /// The vertical axis (its range is that of `ys`).
    pub y: Axis<'a>,
    /// Increasing abscissae, at least two.
    pub xs: &'a [f64],
    /// Increasing ordinates, at least two.
    pub ys: &'a [f64],
    /// The field, `ys.len()` rows of `xs.len()` values; a value that is not finite stays white.
    pub values: &'a [f64],
    /// Name, unit and range of the field.
    pub quantity: Axis<'a>,
    /// The scale of colours.
    pub colours: Colours,
    /// Lines of equal height of a second field.
    pub levels: Option<Levels<'a>>,
    /// Lines over the field.
    pub outlines: &'a [Outline<'a>],
}

/// A field whose lines of equal height are drawn over another one, on points of its own.
#[derive(Debug, Clone, Copy)]
pub struct Levels<'a> {
    /// Increasing abscissae.
    pub xs: &'a [f64],
    /// Increasing ordinates.
    pub ys: &'a [f64],
    /// The field, `ys.len()` rows of `xs.len()` values.
    pub values: &'a [f64],
    /// From one line to the next; each fifth is stronger.
    pub interval: f64,
}

impl HeatMap<'_> {
    /// The range that the picture covers along coordinates.
    fn covered(coordinates: &[f64], cells: bool) -> [f64; 2] {
        let n = coordinates.len();
        let (first, last) = (coordinates[0], coordinates[n - 1]);
        if !cells {
            return [first, last];
        }
        let (before, after) = (coordinates[1] - first, last - coordinates[n - 2]);
        [first - 0.5 * before, last + 0.5 * after]
    }
}

/// Refuses coordinates that are fewer than two, not finite or not increasing.
pub(super) fn check_coordinates(figure: &str, what: &str, values: &[f64]) -> Result<(), FigureError> {
    if values.len() < 2 {
        return Err(FigureError::empty(figure, format!("fewer than two {what}")));
    }
    if values.windows(2).all(|w| w[0] < w[1]) && values.iter().all(|v| v.is_finite()) {
        return Ok(());
    }
    Err(FigureError::empty(figure, format!("{what} do not increase")))
}

impl HeatMap<'_> {
    /// The range of the colours.
    fn range(&self) -> Result<[f64; 2], FigureError> {
        let none = || FigureError::empty(self.title, "no finite value in the field");
        let found = extent(self.values.iter().copied());
        let flat = found.is_some_and(|[low, high]| high - low <= 1e-9 * high.abs().max(low.abs()));
        let range = self.quantity.range_of(found.map(|r| if flat { widened(r, 0.0) } else { r }), 0.0);
        Ok(self.colours.range(range.ok_or_else(none)?))
    }

    /// Width and height of the panel: two lengths keep their proportions.
    fn size(&self, x: Scale, y: Scale) -> (f64, f64) {
        if self.frame != Frame::Plane {
            return (590.0, 400.0);
        }
        let ratio = (y.range[1] - y.range[0]) / (x.range[1] - x.range[0]);
        let (wide, high) = if ratio < 0.9 { (620.0, 620.0 * ratio) } else { (560.0 / ratio, 560.0) };
        (wide.max(150.0), high.max(110.0)) // beyond 4 to 1 the scales part
    }

    /// The colours of the panel's pixels, with the lines of equal height.
    fn image(&self, pixels: Pixels, range: [f64; 2]) -> Result<Option<Pixmap>, FigureError> {
        let (across, up) = pixels.among(self.xs, self.ys);
        let field = Lattice { values: self.values, nx: self.xs.len() };
        let table = self.colours.table();
        let Pixels { columns, rows, .. } = pixels;
        let heights = self.levels.map_or(Ok(Vec::new()), |levels| levels.heights(self.title, pixels))?;
        let surface = Elevations { elevation: &heights, columns, rows };
        Ok(paint((columns, rows), |column, row| {
            let value = field.at(across[column], up[row]);
            let colour = value.is_finite().then(|| pick(&table, value, range))?;
            let Some(levels) = &self.levels else { return Some(colour) };
            let (height, slope) = (heights[row * columns + column], surface.slope(column, row));
            let lines = Contours { interval: levels.interval };
            Some(lines.against_colour(colour, height, slope))
        }))
    }
}

impl Levels<'_> {
    /// The field at every pixel.
    fn heights(&self, title: &str, pixels: Pixels) -> Result<Vec<f64>, FigureError> {
        FigureError::same_length(title, "the levels", self.values.len(), self.xs.len() * self.ys.len())?;
        let lattice = Lattice { values: self.values, nx: self.xs.len() };
        let (along, up) = pixels.among(self.xs, self.ys);
        Ok(up.into_iter().flat_map(|up| along.iter().map(move |&along| lattice.at(along, up))).collect())
    }
}

/// The pixels of a panel: how many, and the ranges that they cover.
#[derive(Debug, Clone, Copy)]
struct Pixels {
    columns: usize,
    rows: usize,
    x: [f64; 2],
    y: [f64; 2],
}

impl Pixels {
    /// Where the columns and the rows are among coordinates.
    fn among(self, xs: &[f64], ys: &[f64]) -> (Vec<Between>, Vec<Between>) {
        let Self { columns, rows, x, y } = self;
        let at = |k: usize, n: usize, [low, high]: [f64; 2]| low + (high - low) * (k as f64 + 0.5) / n as f64;
        let across = (0..columns).map(|k| Between::among(at(k, columns, x), xs)).collect();
        let up = (0..rows).map(|k| Between::among(at(rows - 1 - k, rows, y), ys)).collect();
        (across, up)
    }
}

impl Figure for HeatMap<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        check_coordinates(self.title, "abscissae", self.xs)?;
        check_coordinates(self.title, "ordinates", self.ys)?;
        let cells = self.xs.len() * self.ys.len();
        FigureError::same_length(self.title, "the field", self.values.len(), cells)?;
        let range = self.range()?;
        let x = Scale::new(Self::covered(self.xs, self.frame != Frame::TimeSpace));
        let y = Scale::new(Self::covered(self.ys, self.frame != Frame::SpaceTime));
        let (x_caption, y_caption) = (self.x.caption(), self.y.caption());
        let bar = ColourBar { colours: self.colours, range, caption: self.quantity.caption() };
        let top = heading_height(self.title, self.subtitle);
        let (wide, high) = self.size(x, y);
        let left = RIM + left_room(&y.upright_ticks(high), &y_caption);
        let room = 16.0 + bar.room(high);
        let (width, height) = (left + wide + room + RIM, top + high + bottom_room(&x_caption) + RIM);

        let mut canvas = Canvas::new(width, height);
        heading(&mut canvas, self.title, self.subtitle, width);
        let area = Area { left, top, width: wide, height: high };
        let panel = Panel::within(area, x, y, x_caption, y_caption);
        let (columns, rows) = panel.area.pixels();
        let pixels = Pixels { columns, rows, x: x.range, y: y.range };
        if let Some(image) = self.image(pixels, range)? {
            canvas.image(&image, [panel.area.left, panel.area.top]);
        }
        canvas.clip(Some(panel.area));
        self.outlines.iter().for_each(|outline| outline.draw(&mut canvas, &panel));
        canvas.clip(None);
        panel.draw_frame(&mut canvas);
        bar.draw(&mut canvas, panel.area.right() + 16.0, panel.area.top, panel.area.height);
        Ok(canvas.finish())
    }
}
