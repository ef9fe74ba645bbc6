//! The mountain under a map: light and shadow, contour lines.

use rayon::prelude::*;

use super::colours::{Rgb, mix};
use super::ticks::round_length;

/// Light on each cell (0 to 1) from the north-west, 45 degrees high, by the normal of central differences; NaN where a
/// neighbour has no elevation. `bed` has `ny` rows of `nx` values from the south, cells of side `cell`.
pub(super) fn hillshade(bed: &[f64], nx: usize, ny: usize, cell: f64) -> Vec<f64> {
    let (south_east, up) = (-0.5, std::f64::consts::FRAC_1_SQRT_2);
    let mut light = vec![f64::NAN; nx * ny];
    light.par_chunks_mut(nx).enumerate().for_each(|(j, row)| {
        let (below, above) = (j.saturating_sub(1), (j + 1).min(ny - 1));
        for (i, light) in row.iter_mut().enumerate() {
            let (left, right) = (i.saturating_sub(1), (i + 1).min(nx - 1));
            let slope = |a: f64, b: f64, cells: usize| (b - a) / (cells.max(1) as f64 * cell);
            let dx = slope(bed[j * nx + left], bed[j * nx + right], right - left);
            let dy = slope(bed[below * nx + i], bed[above * nx + i], above - below);
            let along = -dx * south_east + dy * south_east + up;
            *light = if bed[j * nx + i].is_finite() {
                (along / (1.0 + dx * dx + dy * dy).sqrt()).max(0.0)
            } else {
                f64::NAN
            };
        }
    });
    light
}

/// The pale grey of ground in this light.
pub(super) fn ground(light: f64) -> Rgb {
    let level = 255.0 * (0.52 + 0.5 * light).min(1.0);
    [level.round() as u8; 3]
}

/// Contour lines every `interval`, each fifth one stronger.
#[derive(Debug, Clone, Copy)]
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

    /// `colour` with the contour line that passes here drawn over it: the distance to the line is |z - level| over the
    /// slope per pixel, so that lines are equally wide wherever they run.
    pub fn over_colour(&self, colour: Rgb, z: f64, slope: f64) -> Rgb {
        if slope <= 1e-12 * self.interval {
            return colour;
        }
        let strength = |interval: f64, half: f64, ink: f64| {
            let distance = (z - (z / interval).round() * interval).abs() / slope;
            let crowded = (interval / slope / 6.0).min(1.0); // lines closer than 6 pixels fade
            (half + 0.5 - distance).clamp(0.0, 1.0) * ink * crowded
        };
        let fine = strength(self.interval, 0.35, 0.42);
        let strong = strength(self.interval * Self::EACH, 0.9, 0.62);
        mix(colour, Self::COLOUR, fine.max(strong))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_towards_the_light_are_brighter() {
        let plane = |a: f64, b: f64| -> Vec<f64> {
            (0..25).map(|k| a * f64::from(k % 5) + b * f64::from(k / 5)).collect()
        };
        let light = |bed: &[f64]| hillshade(bed, 5, 5, 1.0)[12];
        let flat = light(&plane(0.0, 0.0));
        assert!((flat - 0.5f64.sqrt()).abs() < 1e-15);
        // A slope that falls to the north-west faces the light.
        assert!(light(&plane(0.5, -0.5)) > flat && light(&plane(-0.5, 0.5)) < flat);
        assert!((light(&plane(0.3, 0.3)) - flat / (1.0f64 + 0.18).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn holes_have_no_light() {
        let mut bed = vec![1.0; 9];
        bed[4] = f64::NAN;
        assert!(hillshade(&bed, 3, 3, 1.0)[4].is_nan());
    }
}
