//! The sheet of paper: lines, areas, discs, texts and images in points, two pixels to the point.

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, PixmapPaint, Rect, Stroke,
    StrokeDash, Transform,
};

use super::colours::{INK, Rgb, WHITE};
use super::{Picture, typeface};

/// Pixels per point.
pub(super) const SCALE: f64 = 2.0;

/// A rectangle in points, y downwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    pub fn right(&self) -> f64 {
        self.left + self.width
    }
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }
    pub fn corners(&self) -> [[f64; 2]; 4] {
        let (l, t, r, b) = (self.left, self.top, self.right(), self.bottom());
        [[l, t], [r, t], [r, b], [l, b]]
    }
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }
    /// The middle of a pixel, counted from the top left corner.
    pub fn at_pixel(&self, column: usize, row: usize) -> [f64; 2] {
        [self.left + (column as f64 + 0.5) / SCALE, self.top + (row as f64 + 0.5) / SCALE]
    }
    /// Size in pixels.
    pub fn pixels(&self) -> (usize, usize) {
        (((self.width * SCALE).round() as usize).max(1), ((self.height * SCALE).round() as usize).max(1))
    }
}

/// How a line is drawn: colour, opacity, width in points, and dashes (on, off, ...) in points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub colour: Rgb,
    pub alpha: f64,
    pub width: f64,
    pub dashes: &'static [f32],
}

impl Pen {
    pub fn new(colour: Rgb, width: f64) -> Self {
        Self { colour, alpha: 1.0, width, dashes: &[] }
    }
}

/// How a text is set: size in points; `align` gives the point of the text that lies on the given place, (0, 0) the left end
/// of the baseline and (1, 1) the right end at the height of capitals; `angle` in degrees, counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lettering {
    pub size: f64,
    pub colour: Rgb,
    pub align: [f64; 2],
    pub angle: f64,
    pub halo: bool,
}

impl Lettering {
    pub fn new(size: f64, align: [f64; 2]) -> Self {
        Self { size, colour: INK, align, angle: 0.0, halo: false }
    }
}

fn paint(colour: Rgb, alpha: f64) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(colour[0], colour[1], colour[2], (alpha.clamp(0.0, 1.0) * 255.0).round() as u8);
    paint
}

/// A path through the points; a point that is not finite breaks the line, one far outside the sheet is moved to its edge.
fn path(points: &[[f64; 2]], close: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let mut open = false;
    for &[x, y] in points {
        if !(x.is_finite() && y.is_finite()) {
            open = false;
            continue;
        }
        let (x, y) = (x.clamp(-2e4, 2e4) as f32, y.clamp(-2e4, 2e4) as f32);
        if open {
            builder.line_to(x, y)
        } else {
            builder.move_to(x, y)
        }
        open = true;
    }
    if close {
        builder.close();
    }
    builder.finish()
}

pub(super) struct Canvas {
    pixels: Pixmap,
    clip: Option<Mask>,
}

impl Canvas {
    /// A white sheet, size in points (at least one pixel, at most 16384 pixels a side).
    pub fn new(width: f64, height: f64) -> Self {
        let side = |points: f64| (points * SCALE).round().clamp(1.0, 16384.0) as u32;
        let mut pixels =
            Pixmap::new(side(width), side(height)).expect("sides between 1 and 16384 make a pixmap");
        pixels.fill(Color::WHITE);
        Self { pixels, clip: None }
    }

    fn scale() -> Transform {
        Transform::from_scale(SCALE as f32, SCALE as f32)
    }

    /// Confines what follows to `area`; `None` frees it.
    pub fn clip(&mut self, area: Option<Area>) {
        self.clip = area.and_then(|area| {
            let mut mask = Mask::new(self.pixels.width(), self.pixels.height())?;
            mask.fill_path(&path(&area.corners(), true)?, FillRule::Winding, false, Self::scale());
            Some(mask)
        });
    }

    pub fn line(&mut self, points: &[[f64; 2]], pen: Pen) {
        if let Some(path) = path(points, false) {
            self.stroke(&path, pen);
        }
    }

    pub fn ring(&mut self, points: &[[f64; 2]], pen: Pen) {
        if let Some(path) = path(points, true) {
            self.stroke(&path, pen);
        }
    }

    fn stroke(&mut self, path: &Path, pen: Pen) {
        let stroke = Stroke {
            width: pen.width as f32,
            line_cap: if pen.dashes.is_empty() { LineCap::Round } else { LineCap::Butt },
            line_join: LineJoin::Round,
            dash: StrokeDash::new(pen.dashes.to_vec(), 0.0),
            ..Stroke::default()
        };
        self.pixels.stroke_path(
            path,
            &paint(pen.colour, pen.alpha),
            &stroke,
            Self::scale(),
            self.clip.as_ref(),
        );
    }

    pub fn fill(&mut self, points: &[[f64; 2]], colour: Rgb, alpha: f64) {
        if let Some(path) = path(points, true) {
            let paint = paint(colour, alpha);
            self.pixels.fill_path(&path, &paint, FillRule::Winding, Self::scale(), self.clip.as_ref());
        }
    }

    pub fn disc(&mut self, [x, y]: [f64; 2], radius: f64, colour: Rgb) {
        if let Some(path) = PathBuilder::from_circle(x as f32, y as f32, radius as f32) {
            let paint = paint(colour, 1.0);
            self.pixels.fill_path(&path, &paint, FillRule::Winding, Self::scale(), self.clip.as_ref());
        }
    }

    pub fn text(&mut self, text: &str, [x, y]: [f64; 2], how: Lettering) {
        let Some(path) = typeface::outline(text, how.size) else { return };
        let dx = -how.align[0] * typeface::width(text, how.size);
        let dy = how.align[1] * typeface::CAPITAL * how.size;
        let place = Self::scale()
            .pre_translate(x as f32, y as f32)
            .pre_rotate(-how.angle as f32)
            .pre_translate(dx as f32, dy as f32);
        if how.halo {
            let stroke = Stroke { width: 3.0, line_join: LineJoin::Round, ..Stroke::default() };
            self.pixels.stroke_path(&path, &paint(WHITE, 0.85), &stroke, place, self.clip.as_ref());
        }
        self.pixels.fill_path(&path, &paint(how.colour, 1.0), FillRule::Winding, place, self.clip.as_ref());
    }

    /// Lays a pixel image (premultiplied) with its top left corner at a point of the sheet.
    pub fn image(&mut self, image: &Pixmap, [x, y]: [f64; 2]) {
        let (x, y) = ((x * SCALE).round() as i32, (y * SCALE).round() as i32);
        let how = PixmapPaint::default();
        self.pixels.draw_pixmap(x, y, image.as_ref(), &how, Transform::identity(), self.clip.as_ref());
    }

    /// Fills a rectangle without softened edges, as colour bars need.
    pub fn block(&mut self, area: Area, colour: Rgb) {
        let (l, t) = (area.left as f32, area.top as f32);
        if let Some(rect) = Rect::from_xywh(l, t, area.width as f32, area.height as f32) {
            let paint = Paint { anti_alias: false, ..paint(colour, 1.0) };
            self.pixels.fill_rect(rect, &paint, Self::scale(), None);
        }
    }

    pub fn finish(self) -> Picture {
        let rgba = self.pixels.data().as_chunks::<4>().0;
        let mut rgb = vec![0; 3 * rgba.len()];
        rgb.as_chunks_mut::<3>().0.iter_mut().zip(rgba).for_each(|(out, &[r, g, b, _])| *out = [r, g, b]);
        Picture { width: self.pixels.width(), height: self.pixels.height(), rgb }
    }
}
