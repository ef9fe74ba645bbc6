//! The mountain under a map: light and shadow, and contour lines.

use super::axes::extent;
use super::colours::{Rgb, whole};
use super::contours::{Contours, Elevations};
use super::lattice::{Between, Lattice};
use super::rows;
use super::view::{Extent, View};

/// The mountain at every pixel of a map, without what happened on it: maps that show the same box have it in common.
#[derive(Debug, Clone, PartialEq)]
pub struct Relief {
    view: View,
    columns: usize,
    rows: usize,
    /// Where the pixels of a row, and of a column, lie among the cells.
    pub(super) across: Vec<Between>,
    pub(super) up: Vec<Between>,
    pub(super) elevation: Vec<f64>,
    pub(super) light: Vec<f64>,
    pub(super) contours: Option<Contours>,
    /// How much of a contour line passes.
    pub(super) ink: Vec<f64>,
}

impl Relief {
    /// The relief of the elevations `bed` of a raster in the box `view` on so many pixels, with contour lines or without.
    pub(super) fn of(
        bed: &[f64],
        e: Extent,
        lines: bool,
        view: View,
        (columns, rows): (usize, usize),
    ) -> Relief {
        let at = |k: usize, n: usize, [low, high]: [f64; 2]| low + (high - low) * (k as f64 + 0.5) / n as f64;
        let across: Vec<_> = (0..columns)
            .map(|k| Between::new((at(k, columns, view.x) - e.west) / e.cell - 0.5, e.nx))
            .collect();
        let up: Vec<_> = (0..rows)
            .map(|k| Between::new((at(rows - 1 - k, rows, view.y) - e.south) / e.cell - 0.5, e.ny))
            .collect();
        let at_pixels = |values: &[f64]| {
            let lattice = Lattice { values, nx: e.nx };
            let mut pixels = vec![f64::NAN; columns * rows];
            rows::each(&mut pixels, columns, |row, line| {
                let along = line.iter_mut().zip(&across);
                along.for_each(|(pixel, &across)| *pixel = lattice.at(across, up[row]));
            });
            pixels
        };
        let elevation = at_pixels(bed);
        let light = at_pixels(&hillshade(bed, e.nx, e.ny, e.cell));
        let shown = extent(elevation.iter().copied());
        let contours = shown.filter(|_| lines).and_then(|[low, high]| Contours::over(high - low));
        let mut ink = Vec::new();
        if let Some(contours) = contours {
            let elevations = Elevations { elevation: &elevation, columns, rows };
            ink.resize(columns * rows, 0.0);
            rows::each(&mut ink, columns, |row, line| {
                for (column, ink) in line.iter_mut().enumerate() {
                    *ink = contours.ink(elevation[row * columns + column], elevations.slope(column, row));
                }
            });
        }
        Relief { view, columns, rows, across, up, elevation, light, contours, ink }
    }

    /// Is it of this box, but for a rounding, and size?
    pub(super) fn shows(&self, view: View, size: (usize, usize)) -> bool {
        let same = |own: [f64; 2], other: [f64; 2]| {
            let least = ROUNDING * (own[1] - own[0]);
            own.iter().zip(other).all(|(own, other)| (own - other).abs() <= least)
        };
        same(self.view.x, view.x) && same(self.view.y, view.y) && self.size() == size
    }

    pub(super) fn size(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }
}

/// The box around the same outlines differs by its last bits where a field within them is looked at too; a pixel is 1e-3 of it.
const ROUNDING: f64 = 1e-9;

/// Height of the sun over the horizon: 35 degrees, low enough that steep slopes towards it are not all alike.
const SUN: f64 = 35.0;

/// Light on each cell (0 to 1) from the north-west, by the normal of the differences to its neighbours; NaN without
/// elevation. `bed` has `ny` rows of `nx` values from the south, cells of side `cell`.
pub(super) fn hillshade(bed: &[f64], nx: usize, ny: usize, cell: f64) -> Vec<f64> {
    let (up, level) = SUN.to_radians().sin_cos();
    let north_west = level * std::f64::consts::FRAC_1_SQRT_2;
    let mut light = vec![f64::NAN; nx * ny];
    rows::each(&mut light, nx, |j, row| {
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
    [whole(255.0 * (0.55 + 0.40 * light)); 3]
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
