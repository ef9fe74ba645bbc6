//! The bar beside a field that says which colour is which value.

use super::axes::{CAPTION_SIZE, Caption, GAP, Scale, TICK_LENGTH, TICK_SIZE, upright_text, widest};
use super::canvas::{Area, Canvas, Lettering, Pen, SCALE};
use super::colours::{Colours, INK};
use super::typeface;

/// A vertical scale of colours.
pub(super) struct ColourBar {
    pub colours: Colours,
    pub range: [f64; 2],
    pub caption: Caption,
}

const BAR_WIDTH: f64 = 15.0;

impl ColourBar {
    /// Width of the bar with its labels, `height` points high.
    pub fn room(&self, height: f64) -> f64 {
        let ticks = Scale::new(self.range).upright_ticks(height);
        BAR_WIDTH + TICK_LENGTH + GAP + widest(&ticks) + CAPTION_SIZE + 2.4 * GAP
    }

    pub fn draw(&self, canvas: &mut Canvas, left: f64, top: f64, height: f64) {
        let area = Area { left, top, width: BAR_WIDTH, height };
        let rows = area.pixels().1;
        for row in 0..rows {
            let colour = self.colours.at(1.0 - (row as f64 + 0.5) / rows as f64);
            canvas.block(Area { top: top + row as f64 / SCALE, height: 1.0 / SCALE, ..area }, colour);
        }
        let pen = Pen::new(INK, 1.0);
        canvas.ring(&area.corners(), pen);
        let scale = Scale::new(self.range);
        let ticks = scale.upright_ticks(height);
        for (&v, label) in ticks.at.iter().zip(&ticks.labels) {
            let y = area.bottom() - height * scale.place(v);
            canvas.line(&[[area.right(), y], [area.right() + TICK_LENGTH, y]], pen);
            let place = [area.right() + TICK_LENGTH + GAP, y];
            canvas.text(label, place, Lettering::new(TICK_SIZE, [0.0, 0.5]));
        }
        let caption = self.caption.text(ticks.exponent);
        let beside =
            area.right() + TICK_LENGTH + 2.4 * GAP + widest(&ticks) + CAPTION_SIZE * typeface::CAPITAL;
        upright_text(canvas, &caption, [beside, top + 0.5 * height], height + 30.0);
    }
}
