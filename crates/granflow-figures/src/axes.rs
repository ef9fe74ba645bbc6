//! Axes: ranges, the frame of a panel with its marks and captions, headings, the colour bar.

use super::canvas::{Area, Canvas, Lettering, Pen, SCALE};
use super::colours::{GREY, INK, PALE};
use super::ticks::{self, Ticks};
use super::typeface;

/// Sizes of type in points.
pub(super) const TICK_SIZE: f64 = 12.0;
pub(super) const CAPTION_SIZE: f64 = 13.0;
const TITLE_SIZE: f64 = 15.5;
/// Blank rim of every figure, points.
pub(super) const RIM: f64 = 14.0;
pub(super) const TICK_LENGTH: f64 = 4.0;
pub(super) const GAP: f64 = 5.0;

/// What an axis shows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Axis<'a> {
    /// The quantity, as "thickness" or "x".
    pub label: &'a str,
    /// Its unit, as "m"; empty for pure numbers.
    pub unit: &'a str,
    /// The least and greatest value shown; found from the data where `None`.
    pub range: Option<[f64; 2]>,
}

impl<'a> Axis<'a> {
    /// An axis whose range is found from the data.
    #[must_use]
    pub const fn new(label: &'a str, unit: &'a str) -> Self {
        Self { label, unit, range: None }
    }

    /// The same axis over `[low, high]`.
    #[must_use]
    pub const fn over(self, low: f64, high: f64) -> Self {
        Self { range: Some([low, high]), ..self }
    }

    pub(super) fn caption(&self) -> Caption {
        Caption::new(self.label, self.unit)
    }

    /// The given range, else that of `found` widened by `margin` of itself.
    pub(super) fn range_of(&self, found: Option<[f64; 2]>, margin: f64) -> Option<[f64; 2]> {
        match self.range {
            Some([low, high]) if low.is_finite() && high.is_finite() && low < high => Some([low, high]),
            _ => found.map(|range| widened(range, margin)),
        }
    }
}

/// What stands beside an axis: the quantity, and its unit in parentheses.
#[derive(Debug, Clone, Default)]
pub(super) struct Caption {
    label: String,
    unit: String,
}

impl Caption {
    pub fn new(label: &str, unit: &str) -> Self {
        Self { label: label.into(), unit: unit.into() }
    }

    pub fn is_empty(&self) -> bool {
        self.label.is_empty() && self.unit.is_empty()
    }

    /// The text, with the power of ten that the labels leave out counted to the unit: `energy (10⁹ J)`.
    pub fn text(&self, exponent: i32) -> String {
        let power = if exponent == 0 { String::new() } else { format!("10{}", ticks::superscript(exponent)) };
        let unit = [power.as_str(), &self.unit]
            .into_iter()
            .filter(|part| !part.is_empty())
            .collect::<Vec<_>>()
            .join(" ");
        if unit.is_empty() {
            self.label.clone()
        } else {
            format!("{} ({unit})", self.label).trim_start().into()
        }
    }
}

/// The least and greatest finite value.
pub(super) fn extent(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.into_iter().filter(|v| v.is_finite());
    finite.fold(None, |range, v| match range {
        None => Some([v, v]),
        Some([low, high]) => Some([f64::min(low, v), f64::max(high, v)]),
    })
}

/// A range with `margin` of itself added at both ends; a range no wider than rounding (a conserved mass) becomes one in
/// which the value stands in the middle.
pub(super) fn widened([low, high]: [f64; 2], margin: f64) -> [f64; 2] {
    let size = low.abs().max(high.abs());
    let span = high - low;
    if span <= 1e-9 * size || span == 0.0 {
        let half = if size > 0.0 { 0.1 * size } else { 1.0 };
        return [low - half, high + half];
    }
    [low - margin * span, high + margin * span]
}

/// A range whose ends are moved outwards, by at most a hundredth, to rounder numbers: cell centres to the walls beside them.
pub(super) fn rounded([low, high]: [f64; 2]) -> [f64; 2] {
    let grain = if low < high { ticks::round_length(0.01 * (high - low)) } else { return [low, high] };
    [(low / grain + 1e-6).floor() * grain, (high / grain - 1e-6).ceil() * grain]
}

/// How values become a place between 0 and 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    pub range: [f64; 2],
    pub logarithmic: bool,
    /// Map coordinates: always written in full.
    pub coordinates: bool,
}

impl Scale {
    pub fn new(range: [f64; 2]) -> Self {
        Self { range, logarithmic: false, coordinates: false }
    }

    /// The scale of logarithms over the axis' range if that is positive, else over the positive ones of `values` and a
    /// `factor` beyond them; none where there are none.
    pub fn logarithmic(axis: &Axis, values: impl IntoIterator<Item = f64>, factor: f64) -> Option<Self> {
        let found = extent(values.into_iter().filter(|&v| v > 0.0)).map(|[low, high]| {
            let factor = if low < high { factor } else { 2.0 };
            [low / factor, high * factor]
        });
        let range = axis.range.filter(|r| r[0] > 0.0 && r[1] > r[0]).or(found)?;
        Some(Self { logarithmic: true, ..Self::new(range) })
    }

    pub fn place(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if self.logarithmic {
            return (value / low).ln() / (high / low).ln();
        }
        (value - low) / (high - low)
    }

    fn ticks(&self, most: usize) -> Ticks {
        if self.logarithmic {
            return ticks::logarithmic(self.range, most);
        }
        ticks::linear(self.range, most, self.coordinates)
    }

    /// Marks beside a vertical axis of this many points.
    pub fn upright_ticks(&self, length: f64) -> Ticks {
        self.ticks((length / 32.0).clamp(2.0, 11.0) as usize)
    }

    /// Marks under a horizontal axis, as many as their labels leave room for.
    pub fn level_ticks(&self, length: f64) -> Ticks {
        let roomy = |ticks: &Ticks| {
            let places: Vec<f64> = ticks.at.iter().map(|&v| length * self.place(v)).collect();
            let gap = places.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
            widest(ticks) + 16.0 <= gap
        };
        let most = (length / 55.0).clamp(2.0, 12.0) as usize;
        (2..=most).rev().map(|most| self.ticks(most)).find(roomy).unwrap_or_else(|| self.ticks(2))
    }
}

/// Width of the widest label.
pub(super) fn widest(ticks: &Ticks) -> f64 {
    ticks.labels.iter().map(|label| typeface::width(label, TICK_SIZE)).fold(0.0, f64::max)
}

/// Room that marks and caption take left of a panel.
pub(super) fn left_room(ticks: &Ticks, caption: &Caption) -> f64 {
    let caption = if caption.is_empty() { 0.0 } else { CAPTION_SIZE + 2.0 * GAP };
    TICK_LENGTH + GAP + widest(ticks) + caption
}

/// Room that marks and caption take below a panel.
pub(super) fn bottom_room(caption: &Caption) -> f64 {
    let caption = if caption.is_empty() { 0.0 } else { CAPTION_SIZE + 1.4 * GAP };
    TICK_LENGTH + GAP + TICK_SIZE + caption
}

/// One rectangle with a horizontal and a vertical scale.
pub(super) struct Panel {
    pub area: Area,
    pub x: Scale,
    pub y: Scale,
    x_ticks: Ticks,
    y_ticks: Ticks,
    x_caption: Caption,
    y_caption: Caption,
    /// Where the foot of the upright caption stands; beside the labels where `None`.
    caption_x: Option<f64>,
}

impl Panel {
    /// The panel that fills `outer` together with its marks and captions; an axis without caption still has its marks.
    pub fn fit(outer: Area, x: Scale, y: Scale, x_caption: Caption, y_caption: Caption) -> Self {
        let height = outer.height - bottom_room(&x_caption);
        let left = left_room(&y.upright_ticks(height), &y_caption);
        let right = 10.0; // half of the last label
        let area =
            Area { left: outer.left + left, top: outer.top, width: outer.width - left - right, height };
        Self::within(area, x, y, x_caption, y_caption)
    }

    /// The panel whose frame is `area`.
    pub fn within(area: Area, x: Scale, y: Scale, x_caption: Caption, y_caption: Caption) -> Self {
        let round = |v: f64| (v * SCALE).round() / SCALE;
        let area = Area {
            left: round(area.left),
            top: round(area.top),
            width: round(area.width.max(10.0)),
            height: round(area.height.max(10.0)),
        };
        let (x_ticks, y_ticks) = (x.level_ticks(area.width), y.upright_ticks(area.height));
        Self { area, x, y, x_ticks, y_ticks, x_caption, y_caption, caption_x: None }
    }

    /// Leaves out the labels below: another panel beneath shares the axis.
    pub fn without_x_labels(mut self) -> Self {
        self.x_ticks.labels.clear();
        self.x_ticks.exponent = 0;
        self
    }

    /// Puts the upright caption at `x`, in one column with those of other panels.
    pub fn with_caption_at(mut self, x: f64) -> Self {
        self.caption_x = Some(x);
        self
    }

    pub fn place(&self, x: f64, y: f64) -> [f64; 2] {
        [
            self.area.left + self.area.width * self.x.place(x),
            self.area.bottom() - self.area.height * self.y.place(y),
        ]
    }

    pub fn line(&self, x: &[f64], y: &[f64]) -> Vec<[f64; 2]> {
        x.iter().zip(y).map(|(&x, &y)| self.place(x, y)).collect()
    }

    /// Pale lines through the labelled marks.
    pub fn draw_grid(&self, canvas: &mut Canvas) {
        let Area { left, top, .. } = self.area;
        let pen = Pen::new(PALE, 0.8);
        for &v in &self.x_ticks.at {
            let x = self.place(v, self.y.range[0])[0];
            canvas.line(&[[x, top], [x, self.area.bottom()]], pen);
        }
        for &v in &self.y_ticks.at {
            let y = self.place(self.x.range[0], v)[1];
            canvas.line(&[[left, y], [self.area.right(), y]], pen);
        }
    }

    /// Frame, marks, labels and captions.
    pub fn draw_frame(&self, canvas: &mut Canvas) {
        let Area { left, .. } = self.area;
        let bottom = self.area.bottom();
        let pen = Pen::new(INK, 1.0);
        canvas.ring(&self.area.corners(), pen);
        let label_y = bottom + TICK_LENGTH + GAP;
        for (k, &v) in self.x_ticks.at.iter().enumerate() {
            let x = self.place(v, self.y.range[0])[0];
            canvas.line(&[[x, bottom], [x, bottom + TICK_LENGTH]], pen);
            if let Some(label) = self.x_ticks.labels.get(k) {
                canvas.text(label, [x, label_y], Lettering::new(TICK_SIZE, [0.5, 1.0]));
            }
        }
        for (k, &v) in self.y_ticks.at.iter().enumerate() {
            let y = self.place(self.x.range[0], v)[1];
            canvas.line(&[[left - TICK_LENGTH, y], [left, y]], pen);
            if let Some(label) = self.y_ticks.labels.get(k) {
                canvas.text(label, [left - TICK_LENGTH - GAP, y], Lettering::new(TICK_SIZE, [1.0, 0.5]));
            }
        }
        for &v in &self.x_ticks.minor {
            let x = self.place(v, self.y.range[0])[0];
            canvas.line(&[[x, bottom], [x, bottom + 0.5 * TICK_LENGTH]], pen);
        }
        for &v in &self.y_ticks.minor {
            let y = self.place(self.x.range[0], v)[1];
            canvas.line(&[[left - 0.5 * TICK_LENGTH, y], [left, y]], pen);
        }
        let x_caption = self.x_caption.text(self.x_ticks.exponent);
        let y_caption = self.y_caption.text(self.y_ticks.exponent);
        let middle = left + 0.5 * self.area.width;
        let below = label_y + TICK_SIZE * typeface::CAPITAL + 1.6 * GAP;
        canvas.text(&x_caption, [middle, below], Lettering::new(CAPTION_SIZE, [0.5, 1.0]));
        let beside = left - TICK_LENGTH - GAP - widest(&self.y_ticks) - 1.6 * GAP;
        let place = [self.caption_x.unwrap_or(beside), self.area.top + 0.5 * self.area.height];
        upright_text(canvas, &y_caption, place, self.area.height);
    }
}

/// A caption along a vertical axis, its foot at `place`, set smaller where `room` is short.
pub(super) fn upright_text(canvas: &mut Canvas, text: &str, place: [f64; 2], room: f64) {
    let size = CAPTION_SIZE.min(CAPTION_SIZE * room / typeface::width(text, CAPTION_SIZE).max(1.0));
    canvas.text(text, place, Lettering { angle: 90.0, ..Lettering::new(size, [0.5, 0.0]) });
}

/// Writes title and subtitle at the head of a figure `width` points wide and returns the height they take.
pub(super) fn heading(canvas: &mut Canvas, title: &str, subtitle: &str, width: f64) -> f64 {
    let mut y = RIM;
    let lines = [(title, TITLE_SIZE, INK), (subtitle, TICK_SIZE, GREY)];
    for (text, size, colour) in lines.into_iter().filter(|(text, ..)| !text.is_empty()) {
        let size = size.min(size * (width - 2.0 * RIM) / typeface::width(text, size).max(1.0));
        let how = Lettering { colour, ..Lettering::new(size, [0.5, 1.0]) };
        canvas.text(text, [0.5 * width, y], how);
        y += size * typeface::CAPITAL + 9.0;
    }
    if y > RIM { y + 2.0 } else { y }
}

/// Height that [`heading`] takes at full size.
pub(super) fn heading_height(title: &str, subtitle: &str) -> f64 {
    let line = |text: &str, size: f64| if text.is_empty() { 0.0 } else { size * typeface::CAPITAL + 9.0 };
    let lines = line(title, TITLE_SIZE) + line(subtitle, TICK_SIZE);
    RIM + lines + if lines > 0.0 { 2.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conserved_quantity_is_drawn_as_a_line_in_the_middle() {
        let [low, high] = widened([2.3, 2.3 + 1e-13], 0.05);
        assert!(low < 2.2 && high > 2.4);
        assert_eq!(widened([0.0, 0.0], 0.05), [-1.0, 1.0]);
        assert_eq!(widened([0.0, 10.0], 0.1), [-1.0, 11.0]);
        assert_eq!(extent([f64::NAN, 3.0, f64::INFINITY, -1.0]), Some([-1.0, 3.0]));
        assert_eq!(extent([f64::NAN]), None);
        assert_eq!(rounded([-5.985, 5.985]), [-6.0, 6.0]);
        assert_eq!(rounded([0.0, 10.0]), [0.0, 10.0]);
        assert_eq!(Caption::new("energy", "J").text(9), "energy (10⁹ J)");
        assert_eq!(Caption::new("x", "").text(0), "x");
        assert_eq!(Caption::new("h", "").text(-3), "h (10⁻³)");
    }

    #[test]
    fn labels_below_an_axis_never_touch() {
        for (range, length) in
            [([0.0, 1e-5], 500.0), ([1_230_000.0, 1_234_000.0], 250.0), ([-6.0, 6.0], 90.0)]
        {
            let scale = Scale { coordinates: true, ..Scale::new(range) };
            let ticks = scale.level_ticks(length);
            assert!(!ticks.at.is_empty());
            if ticks.at.len() > 2 {
                let gap = length * (scale.place(ticks.at[1]) - scale.place(ticks.at[0]));
                assert!(widest(&ticks) < gap, "{ticks:?}");
            }
        }
    }
}
