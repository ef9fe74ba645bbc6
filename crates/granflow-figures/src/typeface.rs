//! Letters as outlines: DejaVu Sans, compiled in.

use std::sync::LazyLock;

use tiny_skia::{Path, PathBuilder, Transform};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The one typeface of all figures; the crate ships it, so it parses or nothing was ever tested.
static FACE: LazyLock<Option<Face<'static>>> = LazyLock::new(|| Face::parse(dejavu::sans::regular(), 0).ok());

/// Height of a capital letter over the size of the type.
pub(super) const CAPITAL: f64 = 0.729;

struct Pen<'a> {
    path: &'a mut PathBuilder,
    scale: f32,
    x: f32,
}

impl Pen<'_> {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, -y * self.scale)
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }
    fn close(&mut self) {
        self.path.close();
    }
}

/// Distance that the pair moves together, in font units.
fn kerning(face: &Face, left: GlyphId, right: GlyphId) -> i16 {
    let tables = face.tables().kern.into_iter().flat_map(|kern| kern.subtables);
    tables.filter(|table| table.horizontal).find_map(|table| table.glyphs_kerning(left, right)).unwrap_or(0)
}

/// Calls `each(glyph, x)` along a line of text of the given size and returns the line's width.
fn set_line(text: &str, size: f64, mut each: impl FnMut(&Face, GlyphId, f64)) -> f64 {
    let Some(face) = FACE.as_ref() else { return 0.0 };
    let scale = size / f64::from(face.units_per_em());
    let (mut x, mut before) = (0.0, None);
    for letter in text.chars() {
        let glyph = face.glyph_index(letter).unwrap_or_default();
        if let Some(before) = before {
            x += f64::from(kerning(face, before, glyph)) * scale;
        }
        each(face, glyph, x);
        x += f64::from(face.glyph_hor_advance(glyph).unwrap_or(0)) * scale;
        before = Some(glyph);
    }
    x
}

/// Width of a line of text.
pub(super) fn width(text: &str, size: f64) -> f64 {
    set_line(text, size, |_, _, _| ())
}

/// Outline of a line of text that starts at the origin of its baseline, y downwards; `None` if it has no ink.
pub(super) fn outline(text: &str, size: f64) -> Option<Path> {
    let mut path = PathBuilder::new();
    set_line(text, size, |face, glyph, x| {
        let scale = (size / f64::from(face.units_per_em())) as f32;
        face.outline_glyph(glyph, &mut Pen { path: &mut path, scale, x: x as f32 });
    });
    path.finish()?.transform(Transform::identity())
}
