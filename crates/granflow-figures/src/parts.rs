//! Parts of the plane in colours of their own, over a mountain or over nothing.

use tiny_skia::Pixmap;

use super::axes::{Axis, Panel, RIM, Scale, bottom_room, heading, heading_height, left_room};
use super::canvas::{Area, Canvas};
use super::colours::{Rgb, WHITE, mix};
use super::contours::Contours;
use super::heat::Outline;
use super::lattice::paint;
use super::legend::{Key, Legend, along};
use super::relief::{Relief, ground};
use super::scale_bar::ScaleBar;
use super::view::{Extent, View, paper};
use super::{Figure, FigureError, Picture};

/// How much of the ground a part hides.
const COVER: f64 = 0.75;

/// A part of the plane: the cells that belong to it.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// Its colour.
    pub colour: Rgb,
    /// `ny` rows of `nx` cells.
    pub cells: &'a [bool],
}

/// Parts of the plane, each in its colour; where two have a cell the first shows.
#[derive(Debug, Clone, Copy, Default)]
pub struct Parts<'a> {
    /// The heading.
    pub title: &'a str,
    /// A second, smaller line under it.
    pub subtitle: &'a str,
    /// The horizontal axis (its range is that of the cells).
    pub x: Axis<'a>,
    /// The vertical axis.
    pub y: Axis<'a>,
    /// Where the cells lie; all of it is shown.
    pub extent: Extent,
    /// Elevation of the ground in the cells, white where not finite; empty for white paper.
    pub bed: &'a [f64],
    /// The parts.
    pub parts: &'a [Part<'a>],
    /// Lines over them.
    pub outlines: &'a [Outline<'a>],
}

impl Parts<'_> {
    fn check(&self) -> Result<(), FigureError> {
        let e = self.extent;
        if e.nx < 2 || e.ny < 2 || !(e.cell > 0.0 && e.cell.is_finite()) {
            return Err(FigureError::empty(self.title, "fewer than two cells along an axis"));
        }
        let cells = e.nx * e.ny;
        if !self.bed.is_empty() {
            FigureError::same_length(self.title, "the bed", self.bed.len(), cells)?;
        }
        let mut parts = self.parts.iter();
        parts.try_for_each(|part| FigureError::same_length(self.title, part.name, part.cells.len(), cells))
    }

    /// The part that shows in a cell.
    fn part(&self, column: usize, row: usize) -> Option<&Part<'_>> {
        self.parts.iter().find(|part| part.cells[row * self.extent.nx + column])
    }

    /// The pixels of the panel.
    fn image(&self, relief: Option<&Relief>, (columns, rows): (usize, usize)) -> Option<Pixmap> {
        let e = self.extent;
        paint((columns, rows), |column, row| {
            let pixel = row * columns + column;
            let under = relief.map_or(Some(WHITE), |relief| {
                let lit = relief.light[pixel].is_finite() && relief.elevation[pixel].is_finite();
                lit.then(|| ground(relief.light[pixel]))
            });
            let place = |k: usize, of: usize, cells: usize| ((2 * k + 1) * cells / (2 * of)).min(cells - 1);
            let part = self.part(place(column, columns, e.nx), place(rows - 1 - row, rows, e.ny));
            let colour = match part {
                Some(part) => mix(under.unwrap_or(WHITE), part.colour, COVER),
                None => under?,
            };
            let ink = relief.and_then(|relief| relief.ink.get(pixel));
            Some(ink.map_or(colour, |&ink| Contours::over_colour(colour, ink)))
        })
    }

    /// Outlines, scale bar and legend, where they hide least.
    fn draw_over(&self, canvas: &mut Canvas, panel: &Panel) {
        let (columns, rows) = panel.area.pixels();
        let e = self.extent;
        let (mut taken, mut legend) = (Vec::new(), Legend::default());
        for row in (0..rows).step_by(12) {
            for column in (0..columns).step_by(12) {
                if self.part(column * e.nx / columns, (rows - 1 - row) * e.ny / rows).is_some() {
                    taken.push(panel.area.at_pixel(column, row));
                }
            }
        }
        self.parts.iter().for_each(|part| legend.add(part.name, Key::Area(part.colour, COVER)));
        for outline in self.outlines {
            let line: Vec<_> = outline.points.iter().map(|&[x, y]| panel.place(x, y)).collect();
            along(&line, panel.area, &mut taken);
            legend.add(outline.name, Key::Line(outline.pen()));
            outline.draw(canvas, panel);
        }
        if self.x.unit == "m" {
            let ruler = ScaleBar::fit(panel, &taken);
            along(&ruler.area.corners(), panel.area, &mut taken);
            ruler.draw(canvas);
        }
        let (place, _) = legend.best_place(panel.area, &taken);
        legend.draw(canvas, place);
    }
}

impl Figure for Parts<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        self.check()?;
        let e = self.extent;
        let view = View { x: [e.west, e.east()], y: [e.south, e.north()] };
        let scale = |range| Scale { coordinates: true, ..Scale::new(range) };
        let (x, y) = (scale(view.x), scale(view.y));
        let (wide, high) = paper(view);
        let (wide, high) = (wide.max(240.0), high.max(150.0));
        let (x_caption, y_caption) = (self.x.caption(), self.y.caption());
        let top = heading_height(self.title, self.subtitle);
        let left = RIM + left_room(&y.upright_ticks(high), &y_caption);
        let (width, height) = (left + wide + 10.0 + RIM, top + high + bottom_room(&x_caption) + RIM);
        let mut canvas = Canvas::new(width, height);
        heading(&mut canvas, self.title, self.subtitle, width);
        let area = Area { left, top, width: wide, height: high };
        let panel = Panel::within(area, x, y, x_caption, y_caption);
        let pixels = panel.area.pixels();
        let relief = (!self.bed.is_empty()).then(|| Relief::of(self.bed, e, true, view, pixels));
        if let Some(image) = self.image(relief.as_ref(), pixels) {
            canvas.image(&image, [panel.area.left, panel.area.top]);
        }
        canvas.clip(Some(panel.area));
        self.draw_over(&mut canvas, &panel);
        canvas.clip(None);
        panel.draw_frame(&mut canvas);
        Ok(canvas.finish())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: Extent = Extent { nx: 40, ny: 30, west: 0.0, south: 0.0, cell: 5.0 };

    fn left_half() -> Vec<bool> {
        (0..1200).map(|k| k % 40 < 20).collect()
    }

    #[test]
    fn a_part_has_its_colour_where_its_cells_are() {
        let cells = left_half();
        let part = Part { name: "hit", colour: [0, 158, 115], cells: &cells };
        let figure = Parts { extent: EXTENT, parts: &[part], ..Default::default() };
        let picture = figure.draw().unwrap();
        let wanted = mix(WHITE, part.colour, COVER);
        let count = picture.rgb.chunks_exact(3).filter(|pixel| **pixel == wanted).count();
        let (wide, high) = paper(View { x: [0.0, 200.0], y: [0.0, 150.0] });
        let half = 0.5 * (2.0 * wide) * (2.0 * high);
        // Frame, ticks and the swatch of the legend take and give a little.
        assert!((count as f64 / half - 1.0).abs() < 0.02, "{count} of {half}");
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let cells = left_half();
        let part = Part { name: "hit", colour: [0; 3], cells: &cells[1..] };
        let figure = Parts { extent: EXTENT, parts: &[part], ..Default::default() };
        assert!(matches!(figure.draw(), Err(FigureError::Shape { found: 1199, .. })));
        let bed = Parts { extent: EXTENT, bed: &[1.0; 3], ..Default::default() };
        assert!(matches!(bed.draw(), Err(FigureError::Shape { .. })));
        assert!(matches!(Parts::default().draw(), Err(FigureError::Empty { .. })));
    }
}
