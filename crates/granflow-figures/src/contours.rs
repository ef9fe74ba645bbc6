//! Contour lines, found pixel by pixel from the elevation and its slope, and their labels.

use super::axes::Panel;
use super::canvas::{Canvas, Lettering};
use super::colours::{INK, Rgb, WHITE, mix};
use super::ticks::{number, round_length};

/// Contour lines every `interval`, each fifth one stronger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contours {
    pub interval: f64,
}

impl Contours {
    pub const EACH: f64 = 5.0;
    const COLOUR: Rgb = [92, 64, 40];

    /// A round interval for about 25 lines over `relief`.
    pub fn over(relief: f64) -> Option<Self> {
        (relief > 0.0 && relief.is_finite()).then(|| Self { interval: round_length(relief / 18.0) })
    }

    /// `colour` with so much of a line drawn over it.
    pub fn over_colour(colour: Rgb, ink: f64) -> Rgb {
        mix(colour, Self::COLOUR, ink)
    }

    /// As [`Contours::over_colour`], dark over pale colours and white over dark ones.
    pub fn against_colour(&self, colour: Rgb, z: f64, slope: f64) -> Rgb {
        let [red, green, blue] = colour.map(f64::from);
        let pale = 0.3 * red + 0.6 * green + 0.1 * blue > 100.0;
        mix(colour, if pale { INK } else { WHITE }, self.ink(z, slope))
    }

    /// How much of a line passes here: the distance to it is |z - level| over the slope per pixel, so that lines are equally
    /// wide wherever they run.
    pub fn ink(&self, z: f64, slope: f64) -> f64 {
        if slope.is_nan() || slope <= 1e-12 * self.interval {
            return 0.0;
        }
        let strength = |interval: f64, half: f64, ink: f64| {
            let distance = (z - (z / interval).round() * interval).abs() / slope;
            let crowded = (interval / slope / 6.0).min(1.0); // lines closer than 6 pixels fade
            (half + 0.5 - distance).clamp(0.0, 1.0) * ink * crowded
        };
        let fine = strength(self.interval, 0.35, 0.42);
        let strong = strength(self.interval * Self::EACH, 0.9, 0.62);
        fine.max(strong)
    }
}

/// Elevations at the pixels of a map.
pub(super) struct Elevations<'a> {
    pub elevation: &'a [f64],
    pub columns: usize,
    pub rows: usize,
}

impl Elevations<'_> {
    /// Change of elevation per pixel to the right and downwards.
    fn gradient(&self, column: usize, row: usize) -> [f64; 2] {
        let z = |column: usize, row: usize| self.elevation[row * self.columns + column];
        let (left, right) = (column.saturating_sub(1), (column + 1).min(self.columns - 1));
        let (above, below) = (row.saturating_sub(1), (row + 1).min(self.rows - 1));
        let per = |a: f64, b: f64, n: usize| (b - a) / n.max(1) as f64;
        [
            per(z(left, row), z(right, row), right - left),
            per(z(column, above), z(column, below), below - above),
        ]
    }

    pub fn slope(&self, column: usize, row: usize) -> f64 {
        let [across, down] = self.gradient(column, row);
        let slope = (across * across + down * down).sqrt();
        if slope.is_finite() { slope } else { 0.0 }
    }

    /// Writes the elevation on strong contour lines where they run straight, are free, and not beside another.
    pub fn label(
        &self,
        canvas: &mut Canvas,
        panel: &Panel,
        contours: Contours,
        free: impl Fn(usize, usize) -> bool,
    ) {
        let interval = contours.interval * Contours::EACH;
        let mut placed: Vec<[f64; 2]> = Vec::new();
        let rim = 60;
        let z = |column: usize, row: usize| self.elevation[row * self.columns + column];
        for row in (rim..self.rows.saturating_sub(rim)).step_by(6) {
            for column in (rim..self.columns.saturating_sub(rim)).step_by(6) {
                let [across, down] = self.gradient(column, row);
                let slope = (across * across + down * down).sqrt();
                let level = (z(column, row) / interval).round() * interval;
                let crosses = (z(column, row) - level).abs() < 2.0 * slope;
                let roomy = slope * 26.0 < interval; // lines at least 13 points apart
                if !(crosses && roomy && slope > 0.0) {
                    continue;
                }
                // The ends of the text must lie on the same line.
                let along = [-down / slope, across / slope];
                let straight = [-1.0, -0.5, 0.5, 1.0].iter().all(|t| {
                    let (c, r) = (column as f64 + t * 44.0 * along[0], row as f64 + t * 44.0 * along[1]);
                    let (c, r) = (c as usize, r as usize);
                    c < self.columns && r < self.rows && (z(c, r) - level).abs() < 5.0 * slope && free(c, r)
                });
                let place = panel.area.at_pixel(column, row);
                let apart = placed.iter().all(|p| (p[0] - place[0]).hypot(p[1] - place[1]) > 120.0);
                if straight && apart && free(column, row) {
                    let angle = (-along[1] / along[0]).atan().to_degrees();
                    let colour = [80, 55, 35];
                    let how = Lettering { angle, colour, halo: true, ..Lettering::new(9.5, [0.5, 0.5]) };
                    canvas.text(&number(level, 0), place, how);
                    placed.push(place);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stand_at_their_levels_and_are_equally_wide_on_any_slope() {
        let contours = Contours::over(900.0).unwrap();
        assert_eq!(contours.interval, 50.0);
        let white = [255; 3];
        let over = |z: f64, slope: f64| Contours::over_colour(white, contours.ink(z, slope));
        for slope in [0.5, 2.0, 5.0] {
            let inked = (0..1000).map(|k| slope * f64::from(k)).filter(|&z| over(z, slope) != white);
            let share = inked.count() as f64 / 1000.0;
            // Four fine lines of at most 1.7 pixels and a strong one of 2.8 on every 250 / slope pixels.
            assert!(share > 0.0 && share < (4.0 * 2.0 + 3.0) * slope / 250.0 + 0.01, "{slope}: {share}");
        }
        assert_eq!(over(1025.0, 1.0), white);
        assert!(over(1000.0, 1.0)[0] < over(1050.0, 1.0)[0]);
        assert_eq!(over(1000.0, 0.0), white, "flat ground has no lines");
        assert!(Contours::over(0.0).is_none());
    }
}
