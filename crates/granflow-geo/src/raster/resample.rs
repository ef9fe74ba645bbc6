//! Values between cell centres and on other grids.

use super::Raster;
use crate::cells::mapped;

/// From this ratio of new to old cell size on, a new cell takes the mean over its area.
const MEAN_FROM: f64 = 1.5;

impl Raster {
    /// The value at a point by bilinear interpolation between the four nearest cell centres.
    ///
    /// NaN outside the raster and where the cell that holds the point is nodata; nodata neighbours and those beyond
    /// the edge are left out and the remaining weights scaled to the sum 1, so that every result lies between values.
    pub fn sample(&self, x: f64, y: f64) -> f64 {
        let (u, v) = ((x - self.west) / self.cell, (y - self.south) / self.cell);
        let inside = u >= 0.0 && v >= 0.0 && u <= self.columns as f64 && v <= self.rows as f64;
        if !inside {
            return f64::NAN;
        }
        let holder = |u: f64, count: usize| (u as usize).min(count - 1);
        if self.at(holder(u, self.columns), holder(v, self.rows)).is_nan() {
            return f64::NAN;
        }
        let (left, below) = ((u - 0.5).floor(), (v - 0.5).floor());
        let (s, t) = (u - 0.5 - left, v - 0.5 - below);
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(i, j)| {
            let (column, row) = (left + i, below + j);
            let exists =
                column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
            let value = if exists { self.at(column as usize, row as usize) } else { f64::NAN };
            let weight = (1.0 - (s - i).abs()) * (1.0 - (t - j).abs());
            if value.is_nan() { (0.0, 0.0) } else { (weight, weight * value) }
        });
        let (weight, sum) = corners.into_iter().fold((0.0, 0.0), |(w, s), (dw, ds)| (w + dw, s + ds));
        if weight == 1.0 { sum } else { sum / weight }
    }

    /// The cells whose centres lie in a box \[x0, x1, y0, y1\]; `None` where none does.
    pub fn cropped(&self, [x0, x1, y0, y1]: [f64; 4]) -> Option<Raster> {
        let within = |centre: &dyn Fn(usize) -> f64, count: usize, low: f64, high: f64| {
            let mut inside = (0..count).filter(|&k| (low..=high).contains(&centre(k)));
            let first = inside.next()?;
            Some((first, inside.next_back().unwrap_or(first) + 1))
        };
        let (west, east) = within(&|k| self.x(k), self.columns, x0, x1)?;
        let (south, north) = within(&|k| self.y(k), self.rows, y0, y1)?;
        let row = |j: usize| &self.values[j * self.columns + west..j * self.columns + east];
        Some(Raster {
            columns: east - west,
            rows: north - south,
            west: self.west + west as f64 * self.cell,
            south: self.south + south as f64 * self.cell,
            cell: self.cell,
            values: (south..north).flat_map(row).copied().collect(),
            crs: self.crs.clone(),
        })
    }

    /// The raster with cells of another size, from the same south-western corner and as far as whole cells fit.
    ///
    /// Finer and similar cells take [`Raster::sample`] at their centre; cells at least 1.5 times as long take the
    /// mean over their area, and are nodata where less than half of that area has values.
    ///
    /// # Panics
    /// When `cell` is not a positive number.
    pub fn resample(&self, cell: f64) -> Raster {
        assert!(cell > 0.0 && cell.is_finite(), "cell size {cell}");
        let fit = |count: usize| ((count as f64 * self.cell / cell + 1e-6) as usize).max(1);
        let (columns, rows) = (fit(self.columns), fit(self.rows));
        self.on(Raster { columns, rows, cell, values: Vec::new(), crs: self.crs.clone(), ..*self })
    }

    /// The raster on the cells of `template`, by the rule of [`Raster::resample`]; nodata where it does not reach.
    pub fn resampled_to(&self, template: &Raster) -> Raster {
        self.on(Raster { values: Vec::new(), crs: self.crs.clone(), ..*template })
    }

    fn on(&self, mut target: Raster) -> Raster {
        let moved = (target.west - self.west).abs() + (target.south - self.south).abs();
        let same = target.columns == self.columns && target.rows == self.rows && target.cell == self.cell;
        target.values = if same && moved == 0.0 {
            self.values.clone()
        } else if target.cell >= MEAN_FROM * self.cell {
            let half = 0.5 * target.cell * target.cell;
            let mean =
                |(area, sum): (f64, f64)| if area < half * (1.0 - 1e-9) { f64::NAN } else { sum / area };
            self.overlap(&target).map(mean).collect()
        } else {
            let centre = |k: usize| (target.x(k % target.columns), target.y(k / target.columns));
            let value = |k: usize| {
                let (x, y) = centre(k);
                self.sample(x, y)
            };
            mapped(target.rows * target.columns, value)
        };
        target
    }

    /// For each cell of `target` the area that cells with values cover \[m^2\], and the integral of the values over it.
    pub(crate) fn overlap(&self, target: &Raster) -> impl Iterator<Item = (f64, f64)> {
        let across =
            intervals((self.west, self.cell, self.columns), (target.west, target.cell, target.columns));
        let along = intervals((self.south, self.cell, self.rows), (target.south, target.cell, target.rows));
        let (columns, rows) = (target.columns, target.rows);
        let cell = move |k: usize| {
            let (mut area, mut sum) = (0.0, 0.0);
            for &(row, height) in &along[k / columns] {
                for &(column, width) in &across[k % columns] {
                    let value = self.values[row * self.columns + column];
                    if !value.is_nan() {
                        area += width * height;
                        sum += width * height * value;
                    }
                }
            }
            (area, sum)
        };
        (0..rows * columns).map(cell)
    }
}

/// For each new interval the old ones that it overlaps, each with the common length; both are equal intervals along an axis,
/// given as begin, length and count.
pub fn intervals(
    (from, step, count): (f64, f64, usize),
    (to, new, cells): (f64, f64, usize),
) -> Vec<Vec<(usize, f64)>> {
    let interval = |k: usize| {
        let low = (to + k as f64 * new - from) / step;
        let high = (to + (k + 1) as f64 * new - from) / step;
        let first = low.floor().clamp(0.0, count as f64) as usize;
        let end = high.ceil().clamp(0.0, count as f64) as usize;
        let common = |i: usize| step * (high.min(i as f64 + 1.0) - low.max(i as f64));
        (first..end).map(|i| (i, common(i))).filter(|(_, length)| *length > 1e-12 * new).collect()
    };
    (0..cells).map(interval).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::sampled;

    #[test]
    fn sampling_is_exact_on_planes_and_stays_between_values() {
        let plane = sampled(6, 4, |x, y| 2.0 * x - 3.0 * y + 7.0);
        for (x, y) in [(0.5, 0.5), (1.25, 2.75), (5.5, 3.5), (3.0, 1.0)] {
            assert!((plane.sample(x, y) - (2.0 * x - 3.0 * y + 7.0)).abs() < 1e-14);
        }
        assert_eq!(plane.sample(0.0, 0.0), plane.sample(0.5, 0.5));
        assert!(plane.sample(-0.1, 1.0).is_nan() && plane.sample(1.0, 4.1).is_nan());
        let holed = sampled(3, 3, |x, y| if x == 1.5 && y == 1.5 { f64::NAN } else { x });
        assert!(holed.sample(1.2, 1.2).is_nan());
        assert!((0.5..=2.5).contains(&holed.sample(0.9, 0.9)));
    }

    #[test]
    fn a_part_has_the_cells_whose_centres_lie_in_it() {
        let plane = sampled(8, 6, |x, y| x + 10.0 * y);
        let part = plane.cropped([1.5, 4.4, 2.6, 100.0]).unwrap();
        assert_eq!((part.columns, part.rows, part.west, part.south), (3, 3, 1.0, 3.0));
        let exact = |k: usize| part.x(k % 3) + 10.0 * part.y(k / 3);
        assert!((0..9).all(|k| part.values[k] == exact(k)));
        assert_eq!(plane.cropped([f64::NEG_INFINITY, 1e9, -1e9, 1e9]).unwrap(), plane);
        assert_eq!(plane.cropped([1.6, 1.7, 0.0, 9.0]), None);
        assert_eq!(plane.cropped([9.0, 12.0, 0.0, 9.0]), None);
    }

    #[test]
    fn finer_cells_interpolate_and_coarser_cells_average() {
        let plane = sampled(8, 6, |x, y| x + 10.0 * y);
        let fine = plane.resample(0.5);
        assert_eq!((fine.columns, fine.rows), (16, 12));
        assert!((fine.at(5, 7) - (2.75 + 37.5)).abs() < 1e-13);
        let coarse = plane.resample(2.0);
        assert_eq!((coarse.columns, coarse.rows), (4, 3));
        assert!((0..12).all(|k| (coarse.at(k % 4, k / 4) - (coarse.x(k % 4) + 10.0 * coarse.y(k / 4))).abs() < 1e-13));
        let odd = plane.resample(2.5);
        assert_eq!((odd.columns, odd.rows), (3, 2));
        let mean = (0.5 + 1.5 + 0.5 * 2.5) / 2.5 + 10.0 * (0.5 + 1.5 + 0.5 * 2.5) / 2.5;
        assert!((odd.at(0, 0) - mean).abs() < 1e-13, "{}", odd.at(0, 0));
        assert_eq!(plane.resample(1.0), plane);
    }

    /// A part of an elevation model on coarser cells: exact for a plane, and of rough ground the mean over the area of each cell.
    #[test]
    fn a_part_on_coarser_cells_is_exact_on_planes_and_keeps_the_mean() {
        let region = [2.9, 21.1, 3.9, 18.2];
        let plane = sampled(24, 20, |x, y| 2.0 * x - 3.0 * y + 700.0);
        // Neighbours like dice: a value of each cell of its own.
        let rough = sampled(24, 20, |x, y| ((12.9898 * x + 78.233 * y).sin() * 43_758.545).fract());
        for cell in [1.5, 2.0, 2.5, 3.0] {
            let part = plane.cropped(region).unwrap();
            let coarse = part.resample(cell);
            assert_eq!((coarse.west, coarse.south, coarse.cell), (part.west, part.south, cell));
            for k in 0..coarse.values.len() {
                let (x, y) = (coarse.x(k % coarse.columns), coarse.y(k / coarse.columns));
                // Where cells are cut, the mean of steps is that of the plane up to the steps' own asymmetry.
                let exact = 2.0 * x - 3.0 * y + 700.0;
                let bound = if cell.fract() == 0.0 { 1e-11 } else { 0.5 * (2.0 + 3.0) / cell };
                assert!((coarse.values[k] - exact).abs() < bound, "{cell}: {} {exact}", coarse.values[k]);
            }
            let part = rough.cropped(region).unwrap();
            let coarse = part.resample(cell);
            for k in 0..coarse.values.len() {
                let (low, left) = (k / coarse.columns, k % coarse.columns);
                let mut sum = 0.0;
                // By quadrature on sixteen points a length, each in one cell of the file.
                let points = (16.0 * cell) as usize;
                for (i, j) in (0..points * points).map(|n| (n % points, n / points)) {
                    let at = |first: usize, n: usize| (first as f64) * cell + (n as f64 + 0.5) / 16.0;
                    sum += part.at(at(left, i) as usize, at(low, j) as usize);
                }
                let mean = sum / (points * points) as f64;
                assert!((coarse.values[k] - mean).abs() < 1e-11, "{cell}: {} {mean}", coarse.values[k]);
            }
        }
    }

    #[test]
    fn a_coarse_cell_needs_values_over_half_its_area() {
        let ragged = sampled(4, 2, |x, y| if x < 2.0 && (x < 1.0 || y < 1.0) { f64::NAN } else { 5.0 });
        let coarse = ragged.resample(2.0);
        assert!(coarse.at(0, 0).is_nan());
        assert_eq!(coarse.at(1, 0), 5.0);
    }

    #[test]
    fn another_grid_takes_what_reaches_it_and_overlap_keeps_the_integral() {
        let heap = sampled(10, 10, |x, y| x * y);
        let template = Raster { west: 2.3, south: -1.0, cell: 0.7, ..sampled(20, 20, |_, _| 0.0) };
        let moved = heap.resampled_to(&template);
        assert!(moved.at(0, 0).is_nan());
        let (x, y) = (moved.x(3), moved.y(4));
        assert!((moved.at(3, 4) - heap.sample(x, y)).abs() == 0.0);
        let wide = Raster { west: -3.0, south: -3.0, cell: 0.7, ..sampled(30, 30, |_, _| 0.0) };
        let (areas, sums): (Vec<f64>, Vec<f64>) = heap.overlap(&wide).unzip();
        assert!((areas.iter().sum::<f64>() - 100.0).abs() < 1e-10);
        assert!((sums.iter().sum::<f64>() - heap.values.iter().sum::<f64>()).abs() < 1e-10);
    }
}
