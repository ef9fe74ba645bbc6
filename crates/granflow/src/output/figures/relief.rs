//! The mountain under a map: light and shadow.

use rayon::prelude::*;

use super::colours::Rgb;

/// Height of the sun over the horizon: 35 degrees, low enough that steep slopes towards it are not all alike.
const SUN: f64 = 35.0;

/// Light on each cell (0 to 1) from the north-west, by the normal of the differences to its neighbours; NaN without
/// elevation. `bed` has `ny` rows of `nx` values from the south, cells of side `cell`.
pub(super) fn hillshade(bed: &[f64], nx: usize, ny: usize, cell: f64) -> Vec<f64> {
    let (up, level) = SUN.to_radians().sin_cos();
    let north_west = level * std::f64::consts::FRAC_1_SQRT_2;
    let mut light = vec![f64::NAN; nx * ny];
    light.par_chunks_mut(nx).enumerate().for_each(|(j, row)| {
        for (i, light) in row.iter_mut().enumerate() {
            let here = j * nx + i;
            // The slope between two neighbours, or one neighbour and the cell itself at a rim.
            let slope = |before: Option<usize>, after: Option<usize>| {
                let [a, b] = [before, after].map(|k| k.filter(|&k| bed[k].is_finite()));
                let cells = f64::from(u8::from(a.is_some()) + u8::from(b.is_some()));
                (bed[b.unwrap_or(here)] - bed[a.unwrap_or(here)]) / (cells.max(1.0) * cell)
            };
            let dx = slope((i > 0).then(|| here - 1), (i + 1 < nx).then_some(here + 1));
            let dy = slope((j > 0).then(|| here - nx), (j + 1 < ny).then_some(here + nx));
            if bed[here].is_finite() {
                *light = ((north_west * (dx - dy) + up) / (1.0 + dx * dx + dy * dy).sqrt()).max(0.0);
            }
        }
    });
    light
}

/// The grey of ground in this light, never as bright as the white of missing ground.
pub(super) fn ground(light: f64) -> Rgb {
    [(255.0 * (0.55 + 0.40 * light)).round() as u8; 3]
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
        assert!((flat - SUN.to_radians().sin()).abs() < 1e-15);
        // A slope that falls to the north-west faces the light.
        assert!(light(&plane(0.5, -0.5)) > flat && light(&plane(-0.5, 0.5)) < flat);
        assert!((light(&plane(0.3, 0.3)) - flat / (1.0f64 + 0.18).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn holes_have_no_light() {
        let mut bed = vec![1.0; 9];
        bed[4] = f64::NAN;
        let light = hillshade(&bed, 3, 3, 1.0);
        assert!(light[4].is_nan());
        assert!(
            light[3] == light[0] && light[3] > 0.5,
            "the rim of a hole in a plane is as light as the plane"
        );
    }
}
