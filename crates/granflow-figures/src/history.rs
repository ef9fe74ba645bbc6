//! What became of mass, energy and speed: panels one above the other that share the time.

use super::axes::{
    Axis, CAPTION_SIZE, Caption, Panel, RIM, Scale, bottom_room, extent, heading, heading_height, left_room,
    rounded,
};
use super::canvas::{Area, Canvas};
use super::curves::{Curve, draw_all, legend, taken};
use super::{Figure, FigureError, Picture};

/// One panel of a [`History`].
#[derive(Debug, Clone, Copy, Default)]
pub struct HistoryPanel<'a> {
    /// The quantity.
    pub y: Axis<'a>,
    /// Its curves over the time.
    pub curves: &'a [Curve<'a>],
}

/// Time series in stacked panels.
#[derive(Debug, Clone, Copy, Default)]
pub struct History<'a> {
    /// The heading.
    pub title: &'a str,
    /// A second, smaller line under it.
    pub subtitle: &'a str,
    /// The shared axis.
    pub time: Axis<'a>,
    /// The panels from top to bottom.
    pub panels: &'a [HistoryPanel<'a>],
}

impl Figure for History<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        let curves = || self.panels.iter().flat_map(|panel| panel.curves);
        curves().try_for_each(|curve| curve.check(self.title))?;
        let instants = extent(curves().flat_map(|curve| curve.x.iter().copied()));
        let range = self.time.range_of(instants.map(rounded), 0.0);
        let time = Scale::new(range.ok_or_else(|| FigureError::empty(self.title, "no finite instant"))?);
        let mut scales = Vec::new();
        for panel in self.panels {
            let values = extent(panel.curves.iter().flat_map(|curve| curve.y.iter().copied()));
            let none = || FigureError::empty(self.title, format!("no finite value of {}", panel.y.label));
            scales.push(Scale::new(panel.y.range_of(values, 0.07).ok_or_else(none)?));
        }

        let (each, gap, width) = (if scales.len() > 2 { 130.0 } else { 190.0 }, 14.0, 800.0);
        let caption = self.time.caption();
        let high = scales.len() as f64 * (each + gap) - gap;
        let head = heading_height(self.title, self.subtitle);
        let mut canvas = Canvas::new(width, head + high + bottom_room(&caption) + RIM);
        heading(&mut canvas, self.title, self.subtitle, width);
        let part_caption = Caption::new("y", "");
        let left =
            scales.iter().map(|y| left_room(&y.upright_ticks(each), &part_caption)).fold(0.0, f64::max) + RIM;
        for (k, (part, &y)) in self.panels.iter().zip(&scales).enumerate() {
            let area = Area {
                left,
                top: head + k as f64 * (each + gap),
                width: width - left - RIM - 10.0,
                height: each,
            };
            let last = k + 1 == scales.len();
            let below = if last { caption.clone() } else { Caption::default() };
            let mut panel =
                Panel::within(area, time, y, below, part.y.caption()).with_caption_at(RIM + CAPTION_SIZE);
            if !last {
                panel = panel.without_x_labels();
            }
            panel.draw_grid(&mut canvas);
            draw_all(&mut canvas, &panel, part.curves, &[]);
            panel.draw_frame(&mut canvas);
            let legend = legend(part.curves, &[]);
            let (place, _) = legend.best_place(panel.area, &taken(&panel, part.curves, &[]));
            legend.draw(&mut canvas, place);
        }
        Ok(canvas.finish())
    }
}
