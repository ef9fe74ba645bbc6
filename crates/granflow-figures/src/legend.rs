//! The key to the lines and areas of a panel, laid where it hides least.

use super::axes::TICK_SIZE;
use super::canvas::{Area, Canvas, Lettering, Pen};
use super::colours::{PALE, Rgb, WHITE};
use super::typeface;

/// What stands before a name.
#[derive(Debug, Clone, Copy)]
pub(super) enum Key {
    Line(Pen),
    Points(Rgb),
    Area(Rgb, f64),
}

#[derive(Debug, Default)]
pub(super) struct Legend {
    entries: Vec<(String, Key)>,
}

const ROW: f64 = 18.0;
const PAD: f64 = 7.0;
const KEY: f64 = 26.0;

impl Legend {
    /// Adds an entry; a nameless one is left out.
    pub fn add(&mut self, name: impl Into<String>, key: Key) {
        let name = name.into();
        if !name.is_empty() {
            self.entries.push((name, key));
        }
    }

    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    pub fn size(&self) -> [f64; 2] {
        let widest =
            self.entries.iter().map(|(name, _)| typeface::width(name, TICK_SIZE)).fold(0.0, f64::max);
        [widest + KEY + 3.0 * PAD, self.entries.len() as f64 * ROW + PAD]
    }

    /// The place within `area` that covers the fewest of `points`, and how many it covers.
    pub fn best_place(&self, area: Area, points: &[[f64; 2]]) -> (Area, usize) {
        let [width, height] = self.size();
        let gap = 8.0;
        let rows = [area.top + gap, area.bottom() - height - gap, area.top + 0.5 * (area.height - height)];
        let columns = [area.right() - width - gap, area.left + gap, area.left + 0.5 * (area.width - width)];
        let places =
            rows.iter().flat_map(|&top| columns.iter().map(move |&left| Area { left, top, width, height }));
        let covered = |place: &Area| {
            let rim = Area {
                left: place.left - 4.0,
                top: place.top - 4.0,
                width: width + 8.0,
                height: height + 8.0,
            };
            points.iter().filter(|&&p| rim.contains(p)).count()
        };
        places.map(|place| (place, covered(&place))).min_by_key(|&(_, n)| n).unwrap_or((area, 0))
    }

    pub fn draw(&self, canvas: &mut Canvas, area: Area) {
        if self.is_empty() {
            return;
        }
        canvas.fill(&area.corners(), WHITE, 0.95);
        canvas.ring(&area.corners(), Pen::new(PALE, 1.0));
        for (k, (name, key)) in self.entries.iter().enumerate() {
            let (left, y) = (area.left + PAD, area.top + 0.5 * PAD + (k as f64 + 0.5) * ROW);
            match *key {
                Key::Line(pen) => canvas.line(&[[left, y], [left + KEY, y]], pen),
                Key::Points(colour) => canvas.disc([left + 0.5 * KEY, y], 3.0, colour),
                Key::Area(colour, alpha) => {
                    let swatch = Area { left, top: y - 5.0, width: KEY, height: 10.0 };
                    canvas.fill(&swatch.corners(), colour, alpha);
                }
            }
            canvas.text(name, [left + KEY + PAD, y], Lettering::new(TICK_SIZE, [0.0, 0.5]));
        }
    }
}

/// Points about 4 points apart along a line within `area`, as what a legend should not cover.
pub(super) fn along(line: &[[f64; 2]], area: Area, into: &mut Vec<[f64; 2]>) {
    for pair in line.windows(2) {
        let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
        let length = (x1 - x0).hypot(y1 - y0);
        if !length.is_finite() {
            continue;
        }
        let steps = (length / 4.0).ceil().clamp(1.0, 500.0);
        let points =
            (0..=steps as usize).map(|k| k as f64 / steps).map(|t| [x0 + t * (x1 - x0), y0 + t * (y1 - y0)]);
        into.extend(points.filter(|&p| area.contains(p)));
    }
}
