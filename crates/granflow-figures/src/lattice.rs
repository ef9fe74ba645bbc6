//! Values on a rectangular lattice, read between its points.

use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::colours::Rgb;
use super::rows;

/// Rows of `nx` values, row 0 first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice<'a> {
    pub values: &'a [f64],
    pub nx: usize,
}

/// A place between lattice points: the point before, the share of the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    index: usize,
    next: usize,
    share: f64,
}

impl Between {
    /// The place `at`, counted in points from the first of `n`; beyond the ends the end itself.
    pub fn new(at: f64, n: usize) -> Self {
        let at = at.clamp(0.0, (n - 1) as f64);
        let index = at as usize;
        Self { index, next: (index + 1).min(n - 1), share: at - index as f64 }
    }

    /// The place of `value` among increasing coordinates.
    pub fn among(value: f64, coordinates: &[f64]) -> Self {
        let next = coordinates.partition_point(|&c| c <= value).clamp(1, (coordinates.len() - 1).max(1));
        let (a, b) = (coordinates[next - 1], coordinates[next.min(coordinates.len() - 1)]);
        let share = if b > a { (value - a) / (b - a) } else { 0.0 };
        Self::new((next - 1) as f64 + share, coordinates.len())
    }
}

impl Lattice<'_> {
    /// The value between four points, bilinear; where one of them is not finite, that of the nearest point.
    pub fn at(&self, x: Between, y: Between) -> f64 {
        let [low, high] = [y.index, y.next].map(|row| row * self.nx);
        let (a, b) = (self.values[low + x.index], self.values[low + x.next]);
        let (c, d) = (self.values[high + x.index], self.values[high + x.next]);
        let value = (a + x.share * (b - a)) * (1.0 - y.share) + (c + x.share * (d - c)) * y.share;
        if value.is_finite() {
            return value;
        }
        match (x.share < 0.5, y.share < 0.5) {
            (true, true) => a,
            (false, true) => b,
            (true, false) => c,
            (false, false) => d,
        }
    }
}

/// An opaque image painted pixel by pixel, rows side by side on all cores; `None` leaves a pixel clear.
pub(super) fn paint(
    (width, height): (usize, usize),
    colour: impl Fn(usize, usize) -> Option<Rgb> + Sync,
) -> Option<Pixmap> {
    let mut image = Pixmap::new(u32::try_from(width).ok()?, u32::try_from(height).ok()?)?;
    rows::each(image.pixels_mut(), width, |row, pixels| {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            if let Some([r, g, b]) = colour(column, row) {
                *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(*pixel);
            }
        }
    });
    Some(image)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bilinear_field_is_read_exactly_and_holes_stay_holes() {
        let f = |x: f64, y: f64| 1.0 + 2.0 * x - y + 0.5 * x * y;
        let mut values: Vec<f64> = (0..12).map(|k| f(f64::from(k % 4), f64::from(k / 4))).collect();
        let read = |values: &[f64], x: f64, y: f64| {
            Lattice { values, nx: 4 }.at(Between::new(x, 4), Between::new(y, 3))
        };
        assert!((read(&values, 1.3, 0.7) - f(1.3, 0.7)).abs() < 1e-14);
        assert_eq!(read(&values, 9.0, -1.0), f(3.0, 0.0));
        values[5] = f64::NAN;
        assert!(read(&values, 1.2, 0.9).is_nan());
        assert_eq!(read(&values, 1.7, 0.9), f(2.0, 1.0));
    }

    #[test]
    fn uneven_coordinates_are_searched() {
        let between = Between::among(3.0, &[0.0, 1.0, 5.0]);
        assert_eq!((between.index, between.share), (1, 0.5));
        assert_eq!(Between::among(-1.0, &[0.0, 1.0]).share, 0.0);
        assert_eq!(Between::among(2.0, &[0.0]).index, 0);
    }
}
