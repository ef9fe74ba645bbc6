//! Terrain: the bed z = b(x, y) of a raster, and its gradient and Hessian by local least squares.

mod fit;
mod survey;
mod wide;

pub use fit::Fit;
pub use survey::{Pits, Survey};

use crate::cells::reduced;
use crate::raster::Raster;
use fit::Windows;
use std::sync::Arc;

/// The length over which the bed's gradient and curvature are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curvature {
    /// Span of the window of the least-squares fit \[m\]; see [`Curvature::half_width`].
    Length(f64),
    /// No curvature: the Hessian is zero, the gradient is that of the 3 x 3 window.
    Off,
}

impl Curvature {
    /// Half-width m of the window in cells: m = max(1, round(length / (2 cell))).
    ///
    /// The window has (2 m + 1)^2 cells; between the centres of its outermost cells lie 2 m cells.
    pub fn half_width(self, cell: f64) -> usize {
        match self {
            Curvature::Length(length) => ((0.5 * length / cell).round() as usize).max(1),
            Curvature::Off => 1,
        }
    }
}

/// A bed whose derivatives are fitted where they are asked for: they take more memory than the bed, and a run asks once. Only
/// where windows are more than 17 cells wide they are fitted together and kept, 40 bytes a cell.
#[derive(Debug, Clone)]
pub struct Terrain {
    /// Elevation b of the bed \[m\], NaN outside.
    pub bed: Arc<Raster>,
    windows: Windows,
    /// The fits of all cells, where windows are so wide that one by one they take too long, or several runs ask for them.
    wide: Option<Arc<[Fit]>>,
    curvature: Curvature,
}

/// How steep a terrain is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steepness {
    /// Number of cells with values.
    pub cells: usize,
    /// How many of them are steeper than the limit asked for.
    pub steeper: usize,
    /// `steeper / cells`.
    pub share: f64,
    /// The largest slope \[radians\].
    pub max_slope: f64,
}

impl Terrain {
    /// The bed with windows of this length around its cells.
    pub fn new(bed: impl Into<Arc<Raster>>, curvature: Curvature) -> Terrain {
        let bed = bed.into();
        let m = curvature.half_width(bed.cell);
        let windows = Windows::new(m, bed.cell);
        let wide = (m > wide::NARROW).then(|| wide::fits(&bed, m).into());
        Terrain { bed, windows, wide, curvature }
    }

    /// The same with the fits of all cells kept, 40 bytes each: for several runs on one bed.
    pub fn with_fits(mut self) -> Terrain {
        let columns = self.bed.columns;
        let fits =
            || (0..self.bed.values.len()).map(|k| self.windows.fit(&self.bed, [k % columns, k / columns]));
        if self.wide.is_none() {
            self.wide = Some(fits().collect());
        }
        self
    }

    /// The length over which its derivatives are taken.
    pub fn curvature(&self) -> Curvature {
        self.curvature
    }

    /// Fits b + b_x x + b_y y + b_xx x^2/2 + b_xy x y + b_yy y^2/2 around the cell (column, row) by least squares, all
    /// cells of its window weighing the same; zero at nodata, the Hessian zero with [`Curvature::Off`].
    ///
    /// Nodata cells and cells beyond the edge are left out. Where the rest does not determine the six coefficients
    /// (ragged 3 x 3 windows at an edge), the window widens by one cell on each side; where that fails too, a plane
    /// is fitted, then differences towards the neighbours there are, and a lone cell is level. Every quadratic bed
    /// is reproduced exactly but for rounding, and beds mirrored in an axis give mirrored derivatives bit for bit.
    pub fn fit(&self, cell: [usize; 2]) -> Fit {
        let fit = match &self.wide {
            Some(fits) => fits[cell[1] * self.bed.columns + cell[0]],
            None => self.windows.fit(&self.bed, cell),
        };
        match self.curvature {
            Curvature::Length(_) => fit,
            Curvature::Off => Fit { hessian: [0.0; 3], ..fit },
        }
    }

    /// What `both` makes of the values of the fits of all cells with values.
    fn reduced<T: Copy + Send + Sync>(
        &self,
        value: impl Fn(Fit) -> T + Send + Sync,
        none: T,
        both: impl Fn(T, T) -> T + Send + Sync,
    ) -> T {
        let Raster { columns, values, .. } = &*self.bed;
        let of = |k: usize| (!values[k].is_nan()).then(|| value(self.fit([k % columns, k / columns])));
        reduced(values.len(), of, none, both)
    }

    /// How many cells have a fit of this kind.
    pub fn count(&self, kind: impl Fn(&Fit) -> bool + Sync + Send) -> usize {
        self.reduced(|fit| usize::from(kind(&fit)), 0, |a, b| a + b)
    }

    /// Largest slope, and the cells steeper than `limit` \[radians\].
    pub fn steepness(&self, limit: f64) -> Steepness {
        let one = |fit: Fit| {
            let tangent = fit.gradient[0].hypot(fit.gradient[1]);
            (1, usize::from(tangent > limit.tan()), tangent)
        };
        type Found = (usize, usize, f64);
        let both = |a: Found, b: Found| (a.0 + b.0, a.1 + b.1, a.2.max(b.2));
        let (cells, steeper, max) = self.reduced(one, (0, 0, 0.0), both);
        Steepness { cells, steeper, share: steeper as f64 / cells.max(1) as f64, max_slope: max.atan() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::sampled;

    fn quadratic(x: f64, y: f64) -> f64 {
        1500.0 + 0.3 * x - 0.7 * y + 0.011 * x * x - 0.023 * x * y + 0.017 * y * y
    }

    /// The fit of every cell, x fastest.
    fn fits(terrain: &Terrain) -> Vec<Fit> {
        let Raster { columns, rows, .. } = *terrain.bed;
        (0..rows * columns).map(|k| terrain.fit([k % columns, k / columns])).collect()
    }

    fn worst(terrain: &Terrain) -> f64 {
        let columns = terrain.bed.columns;
        let error = |k: usize| {
            let [column, row] = [k % columns, k / columns];
            let (x, y) = (terrain.bed.x(column), terrain.bed.y(row));
            let exact = [0.3 + 0.022 * x - 0.023 * y, -0.7 - 0.023 * x + 0.034 * y, 0.022, -0.023, 0.034];
            let fit = terrain.fit([column, row]);
            let found = fit.gradient.into_iter().chain(fit.hessian);
            found.zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let valid = (0..terrain.bed.values.len()).filter(|&k| !terrain.bed.values[k].is_nan());
        valid.map(error).fold(0.0, f64::max)
    }

    fn ragged(f: impl Fn(f64, f64) -> f64) -> Raster {
        sampled(23, 17, |x, y| if (x - 9.0).hypot(y - 8.0) < 2.6 || x + y < 4.0 { f64::NAN } else { f(x, y) })
    }

    #[test]
    fn quadratic_beds_are_exact_up_to_edges_and_nodata() {
        for length in [0.0, 2.0, 4.0, 6.0] {
            let terrain = Terrain::new(sampled(23, 17, quadratic), Curvature::Length(length));
            assert!(worst(&terrain) < 1e-9, "{length}: {}", worst(&terrain));
        }
        for length in [4.0, 6.0] {
            let terrain = Terrain::new(ragged(quadratic), Curvature::Length(length));
            assert!(worst(&terrain) < 1e-9, "{length}: {}", worst(&terrain));
        }
        let five = Raster { cell: 5.0, ..sampled(9, 9, |x, y| quadratic(5.0 * x, 5.0 * y)) };
        assert!(worst(&Terrain::new(five, Curvature::Length(20.0))) < 1e-9);
    }

    #[test]
    fn the_window_follows_the_length_and_off_has_no_curvature() {
        let half = |length: f64| Curvature::Length(length).half_width(5.0);
        assert_eq!([half(1.0), half(14.9), half(15.0), half(20.0), half(40.0)], [1, 1, 2, 2, 4]);
        let rough = |x: f64, y: f64| (3.0 * x).sin() + (2.0 * y).cos();
        let off = fits(&Terrain::new(sampled(9, 9, rough), Curvature::Off));
        let narrow = fits(&Terrain::new(sampled(9, 9, rough), Curvature::Length(2.0)));
        assert!(off.iter().zip(&narrow).all(|(off, narrow)| off.gradient == narrow.gradient));
        assert!(off.iter().all(|fit| fit.hessian == [0.0; 3]) && narrow[40].hessian[0] != 0.0);
    }

    #[test]
    fn mirrored_beds_give_mirrored_derivatives_bit_for_bit() {
        let rough = |x: f64, y: f64| 900.0 + 7.0 * (0.7 * x).sin() * (0.3 * y + 0.1 * x).cos() + 0.4 * y;
        for length in [2.0, 4.0, 6.0] {
            let bed = ragged(rough);
            let (columns, rows) = (bed.columns, bed.rows);
            let values =
                (0..rows * columns).map(|k| bed.at(columns - 1 - k % columns, k / columns)).collect();
            let flipped = (0..rows * columns).map(|k| bed.at(k % columns, rows - 1 - k / columns)).collect();
            let east = Terrain::new(bed.with_values(values), Curvature::Length(length));
            let north = Terrain::new(bed.with_values(flipped), Curvature::Length(length));
            let terrain = Terrain::new(bed, Curvature::Length(length));
            for [i, j] in (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j])) {
                let Fit { gradient: [x, y], hessian: [xx, xy, yy] } = terrain.fit([i, j]);
                let mirrored = Fit { gradient: [-x, y], hessian: [xx, -xy, yy] };
                assert_eq!(east.fit([columns - 1 - i, j]), mirrored, "{i} {j}");
                let mirrored = Fit { gradient: [x, -y], hessian: [xx, -xy, yy] };
                assert_eq!(north.fit([i, rows - 1 - j]), mirrored, "{i} {j}");
            }
        }
    }

    #[test]
    fn swapped_axes_give_swapped_derivatives_bit_for_bit_in_full_windows() {
        let rough = |x: f64, y: f64| 900.0 + 7.0 * (0.7 * x).sin() * (0.3 * y + 0.1 * x).cos() + 0.4 * y;
        let bed = sampled(12, 12, rough);
        let terrain = Terrain::new(bed.clone(), Curvature::Length(6.0));
        let swapped = Terrain::new(sampled(12, 12, |x, y| rough(y, x)), Curvature::Length(6.0));
        for [i, j] in (3..9).flat_map(|j| (3..9).map(move |i| [i, j])) {
            let Fit { gradient: [x, y], hessian: [xx, xy, yy] } = terrain.fit([i, j]);
            assert_eq!(swapped.fit([j, i]), Fit { gradient: [y, x], hessian: [yy, xy, xx] });
        }
    }

    #[test]
    fn poor_neighbourhoods_fall_back_to_planes_differences_and_level() {
        let strip = fits(&Terrain::new(sampled(9, 1, |x, _| 2.0 * x), Curvature::Length(4.0)));
        assert!(strip.iter().all(|f| (f.gradient[0] - 2.0).abs() < 1e-12 && f.gradient[1] == 0.0));
        let pair = fits(&Terrain::new(sampled(2, 2, |x, y| 2.0 * x - y), Curvature::Length(4.0)));
        let slope = |f: &Fit| (f.gradient[0] - 2.0).abs() < 1e-12 && (f.gradient[1] + 1.0).abs() < 1e-12;
        assert!(pair.iter().all(|f| slope(f) && f.hessian == [0.0; 3]));
        let lone = sampled(5, 5, |x, y| if x == 2.5 && y == 2.5 { 7.0 } else { f64::NAN });
        let lone = fits(&Terrain::new(lone, Curvature::Length(4.0)));
        assert!(lone.iter().all(|f| *f == Fit::default()));
    }

    #[test]
    fn kept_fits_are_those_that_are_found_one_by_one() {
        let rough = |x: f64, y: f64| 900.0 + 7.0 * (0.7 * x).sin() * (0.3 * y + 0.1 * x).cos() + 0.4 * y;
        for curvature in [Curvature::Length(4.0), Curvature::Off] {
            let terrain = Terrain::new(ragged(rough), curvature);
            let bits = |fits: Vec<Fit>| fits.iter().map(|fit| format!("{fit:?}")).collect::<Vec<_>>();
            assert_eq!(bits(fits(&terrain)), bits(fits(&terrain.with_fits())));
        }
    }

    #[test]
    fn steepness_counts_the_cells_above_a_limit() {
        let bed = sampled(20, 8, |x, y| {
            if y > 7.0 {
                f64::NAN
            } else if x < 10.0 {
                0.0
            } else {
                2.0 * (x - 10.0)
            }
        });
        let steep = Terrain::new(bed, Curvature::Off).steepness(60f64.to_radians());
        assert_eq!((steep.cells, steep.steeper), (140, 63));
        assert!((steep.max_slope.tan() - 2.0).abs() < 1e-9 && (steep.share - 0.45).abs() < 1e-15);
        let terrain = Terrain::new(sampled(5, 5, |x, _| x), Curvature::Off);
        assert!((terrain.fit([2, 2]).cosine() - 0.5f64.sqrt()).abs() < 1e-12);
    }
}
