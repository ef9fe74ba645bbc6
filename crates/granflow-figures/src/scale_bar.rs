//! The bar that says how long a length on the map is.

use super::axes::Panel;
use super::canvas::{Area, Canvas, Lettering};
use super::colours::{INK, WHITE};
use super::ticks::{number, round_length, short};

/// A round length on the map.
pub(super) struct ScaleBar {
    pub area: Area,
    points: f64,
    text: String,
}

impl ScaleBar {
    /// A bar in the lower corner where it hides less of `taken`.
    pub fn fit(panel: &Panel, taken: &[[f64; 2]]) -> Self {
        let across = panel.x.range[1] - panel.x.range[0];
        let length = round_length(0.28 * across);
        let points = panel.area.width * length / across;
        let text = if length >= 1000.0 {
            format!("{} km", number(length / 1000.0, 0))
        } else {
            format!("{} m", short(length))
        };
        let (width, height) = (points + 28.0, 34.0);
        let top = panel.area.bottom() - height - 8.0;
        let corners = [panel.area.left + 8.0, panel.area.right() - width - 8.0];
        let corners = corners.map(|left| Area { left, top, width, height });
        let hidden = |area: &Area| taken.iter().filter(|&&p| area.contains(p)).count();
        let area = if hidden(&corners[1]) < hidden(&corners[0]) { corners[1] } else { corners[0] };
        Self { area, points, text }
    }

    pub fn draw(&self, canvas: &mut Canvas) {
        canvas.fill(&self.area.corners(), WHITE, 0.9);
        let bar = Area {
            left: self.area.left + 14.0,
            top: self.area.bottom() - 12.0,
            width: self.points,
            height: 5.0,
        };
        let middle = bar.left + 0.5 * bar.width;
        canvas.fill(&bar.corners(), INK, 1.0);
        let bright = Area { left: middle, top: bar.top + 1.0, width: 0.5 * bar.width - 1.0, height: 3.0 };
        canvas.fill(&bright.corners(), WHITE, 1.0);
        canvas.text(&self.text, [middle, bar.top - 5.0], Lettering::new(12.0, [0.5, 0.0]));
    }
}
