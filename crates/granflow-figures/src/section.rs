//! The section along a path: ground, deposit and greatest thickness above, greatest speed below.

use super::axes::{
    Axis, CAPTION_SIZE, Caption, Panel, RIM, Scale, bottom_room, extent, heading, heading_height, left_room,
};
use super::canvas::{Area, Canvas};
use super::curves::{Curve, Fill, Style, draw_all, legend, taken};
use super::ticks::{round_length, short};
use super::{Figure, FigureError, Picture};

/// A vertical section along a path down the mountain.
#[derive(Debug, Clone, Copy, Default)]
pub struct Section<'a> {
    /// The heading.
    pub title: &'a str,
    /// A second, smaller line under it.
    pub subtitle: &'a str,
    /// Distance along the path, increasing (m).
    pub distance: &'a [f64],
    /// Elevation of the ground, as many (m).
    pub bed: &'a [f64],
    /// Thickness at rest, as many (m).
    pub deposit: &'a [f64],
    /// Greatest thickness over the run, as many (m), not finite where nothing passed; may be empty.
    pub peak_thickness: &'a [f64],
    /// Greatest speed over the run, as many (m/s), not finite where nothing passed, which is drawn as 0; may
    /// be empty, then its panel is left out.
    pub peak_speed: &'a [f64],
    /// How many times too thick deposit and flow are drawn; where `None` a round number that makes the thickest layer
    /// about a tenth of the height of the ground. The figure always says it.
    pub exaggeration: Option<f64>,
}

const GROUND: [u8; 3] = [150, 140, 128];
const DEPOSIT: [u8; 3] = [0, 114, 178];
const FLOW: [u8; 3] = [213, 94, 0];

impl Section<'_> {
    /// How many times too thick the layers are drawn.
    fn factor(&self) -> f64 {
        if let Some(factor) = self.exaggeration {
            return factor;
        }
        let most = |values: &[f64]| extent(values.iter().copied()).map_or(0.0, |r| r[1]);
        let thickest = most(self.deposit).max(most(self.peak_thickness));
        let relief = extent(self.bed.iter().copied()).map_or(0.0, |[low, high]| high - low);
        if thickest > 0.0 && relief > 0.0 { round_length(0.12 * relief / thickest).max(1.0) } else { 1.0 }
    }
}

/// The layers of a section as drawn: heights, and names that say how much too thick they are.
struct Layers {
    surface: Vec<f64>,
    envelope: Vec<f64>,
    ground: &'static str,
    resting: String,
    passing: String,
}

impl Section<'_> {
    fn check(&self) -> Result<(), FigureError> {
        let parts = [
            ("bed", self.bed),
            ("deposit", self.deposit),
            ("peak thickness", self.peak_thickness),
            ("peak speed", self.peak_speed),
        ];
        parts.into_iter().try_for_each(|(what, values)| {
            let optional = values.is_empty() && what.starts_with("peak");
            let expected = if optional { 0 } else { self.distance.len() };
            FigureError::same_length(self.title, what, values.len(), expected)
        })
    }

    fn layers(&self) -> Layers {
        let n = self.distance.len();
        let factor = self.factor();
        let raised = |layer: &[f64]| -> Vec<f64> {
            let height = |(bed, h): (&f64, &f64)| bed + factor * if h.is_finite() { h.max(0.0) } else { 0.0 };
            self.bed.iter().zip(layer).map(height).collect()
        };
        let (surface, mut envelope) = (raised(self.deposit), raised(self.peak_thickness));
        // Where nothing ever passed there is no envelope.
        for (k, height) in envelope.iter_mut().enumerate() {
            let near = &self.peak_thickness[k.saturating_sub(1)..(k + 2).min(n)];
            if near.iter().all(|&h| h.is_nan() || h <= 0.0) {
                *height = f64::NAN;
            }
        }
        let times = if factor == 1.0 { String::new() } else { format!("× {}", short(factor)) };
        let ground = if times.is_empty() { "ground" } else { "ground (true height)" };
        let named = |layer: &str, thick: &str| {
            if times.is_empty() { layer.into() } else { format!("{layer} ({thick}{times})") }
        };
        let (resting, passing) = (named("deposit", "thickness "), named("greatest thickness", ""));
        Layers { surface, envelope, ground, resting, passing }
    }

    /// The scales of distance and elevation.
    fn scales(&self, layers: &Layers) -> Result<[Scale; 2], FigureError> {
        let none = |what: &str| FigureError::empty(self.title, format!("no finite {what}"));
        let along = extent(self.distance.iter().copied());
        let along = Axis::default().range_of(along, 0.0).ok_or_else(|| none("distance"))?;
        let heights = extent(self.bed.iter().chain(&layers.surface).chain(&layers.envelope).copied());
        let heights = Axis::default().range_of(heights, 0.05);
        Ok([Scale::new(along), Scale::new(heights.ok_or_else(|| none("elevation of the ground"))?)])
    }

    /// The scale of the speed, if it is drawn.
    fn speeds(&self) -> Option<Scale> {
        let [_, high] = extent(self.peak_speed.iter().copied())?;
        Some(Scale::new([0.0, if high > 0.0 { 1.08 * high } else { 1.0 }]))
    }

    fn draw_speed(&self, canvas: &mut Canvas, panel: &Panel) {
        let speeds: Vec<f64> = self.peak_speed.iter().map(|&u| if u.is_finite() { u } else { 0.0 }).collect();
        let (x, y) = (self.distance, speeds.as_slice());
        panel.draw_grid(canvas);
        let speed = Curve { name: "", x, y, style: Style::Solid, colour: Some(FLOW) };
        draw_all(
            canvas,
            panel,
            &[speed],
            &[Fill { name: "", x, lower: None, upper: y, colour: [240, 190, 150] }],
        );
        panel.draw_frame(canvas);
    }

    fn draw_layers(&self, canvas: &mut Canvas, panel: &Panel, layers: &Layers) {
        let Layers { surface, envelope, ground, resting, passing } = layers;
        let x = self.distance;
        let curves = [
            Curve { name: ground, x, y: self.bed, style: Style::Solid, colour: Some([70, 62, 54]) },
            Curve { name: passing, x, y: envelope, style: Style::Dashed, colour: Some(FLOW) },
        ];
        let curves = &curves[..if envelope.is_empty() { 1 } else { 2 }];
        let fills = [
            Fill { name: "", x, lower: None, upper: self.bed, colour: GROUND },
            Fill { name: resting, x, lower: Some(self.bed), upper: surface, colour: DEPOSIT },
        ];
        panel.draw_grid(canvas);
        draw_all(canvas, panel, curves, &fills);
        panel.draw_frame(canvas);
        let legend = legend(curves, &fills);
        let (place, _) = legend.best_place(panel.area, &taken(panel, curves, &fills));
        legend.draw(canvas, place);
    }
}

impl Figure for Section<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        self.check()?;
        let layers = self.layers();
        let [distance, elevation] = self.scales(&layers)?;
        let speeds = self.speeds();
        let (width, upper, lower, gap) = (840.0, 330.0, 130.0, 14.0);
        let caption = Caption::new("distance along the path", "m");
        let (heights_of, speeds_of) = (Caption::new("elevation", "m"), Caption::new("greatest speed", "m/s"));
        let head = heading_height(self.title, self.subtitle);
        let below = if speeds.is_some() { lower + gap } else { 0.0 };
        let mut canvas = Canvas::new(width, head + upper + below + bottom_room(&caption) + RIM);
        heading(&mut canvas, self.title, self.subtitle, width);
        let mut left = left_room(&elevation.upright_ticks(upper), &heights_of);
        if let Some(speeds) = speeds {
            left = left.max(left_room(&speeds.upright_ticks(lower), &speeds_of));
        }
        let area =
            Area { left: left + RIM, top: head, width: width - left - 2.0 * RIM - 10.0, height: upper };
        let panel = |area, y, x_caption: Caption, y_caption: Caption| {
            Panel::within(area, distance, y, x_caption, y_caption).with_caption_at(RIM + CAPTION_SIZE)
        };
        let under = if speeds.is_some() { Caption::default() } else { caption.clone() };
        let mut top = panel(area, elevation, under, heights_of);
        if let Some(speeds) = speeds {
            top = top.without_x_labels();
            let area = Area { top: head + upper + gap, height: lower, ..area };
            self.draw_speed(&mut canvas, &panel(area, speeds, caption, speeds_of));
        }
        self.draw_layers(&mut canvas, &top, &layers);
        Ok(canvas.finish())
    }
}
