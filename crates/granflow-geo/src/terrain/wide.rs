//! The fits of windows that are many cells wide, all at once: sums down the columns, then along the rows, so that a cell costs
//! as much as its window is wide and not as many as cells lie in it.
//!
//! The normal equations are those of [`super::fit`]; the sums that make them come in another order. Sums take mirrored cells
//! in pairs, so that a mirrored bed gives the mirrored result bit for bit.

use super::fit::{Fit, eliminate, from_differences};
use crate::cells::mapped;
use crate::raster::Raster;

/// Windows of more than this half-width are fitted here; below it a window's own sum is as fast.
pub(super) const NARROW: usize = 8;

/// Sums over a column of a window, v from -m to m: of v^b over the cells with values for b = 0 to 4, and of v^b times the height
/// above a level for b = 0 to 2.
#[derive(Debug, Clone, Copy, Default)]
struct Column {
    cells: [f64; 5],
    heights: [f64; 3],
}

/// The fits of all cells, zero at nodata.
pub(super) fn fits(bed: &Raster, m: usize) -> Vec<Fit> {
    let level = bed.range().map_or(0.0, |(low, high)| 0.5 * (low + high));
    let row = |row: usize| {
        let columns: Vec<Column> =
            (0..bed.columns).map(|column| down(bed, m, level, [column, row])).collect();
        let fit = |column: usize| fit(bed, m, level, &columns, [column, row]);
        (0..bed.columns).map(fit).collect::<Vec<Fit>>()
    };
    mapped(bed.rows, row).concat()
}

/// The sums down the column of a window around a cell.
fn down(bed: &Raster, m: usize, level: f64, [column, row]: [usize; 2]) -> Column {
    let height = |row: Option<usize>| {
        let value =
            row.filter(|row| *row < bed.rows).map(|row| bed.values[row * bed.columns + column] - level);
        value.filter(|value| !value.is_nan()).map_or((0.0, 0.0), |value| (1.0, value))
    };
    let (count, own) = height(Some(row));
    let mut sums = Column { cells: [count, 0.0, 0.0, 0.0, 0.0], heights: [own, 0.0, 0.0] };
    for v in 1..=m {
        let ((above, top), (below, bottom)) = (height(row.checked_add(v)), height(row.checked_sub(v)));
        let (even, odd, v) = (above + below, above - below, v as f64);
        let powers = [1.0, v, v * v, v * v * v, v * v * v * v];
        for (b, power) in powers.into_iter().enumerate() {
            sums.cells[b] += power * if b % 2 == 0 { even } else { odd };
        }
        sums.heights[0] += top + bottom;
        sums.heights[1] += v * (top - bottom);
        sums.heights[2] += v * v * (top + bottom);
    }
    sums
}

/// The fit of the cell in the middle of a row of such sums.
fn fit(bed: &Raster, m: usize, level: f64, row_sums: &[Column], [column, row]: [usize; 2]) -> Fit {
    let own = bed.at(column, row) - level;
    if own.is_nan() {
        return Fit::default();
    }
    // cells[a][b] and heights[a][b]: sums of u^a v^b, and of that times the height.
    let mut cells = [[0.0; 5]; 5];
    let mut heights = [[0.0; 3]; 3];
    cells[0] = row_sums[column].cells;
    heights[0] = row_sums[column].heights;
    let nothing = Column::default();
    for u in 1..=m {
        let east = row_sums.get(column + u).unwrap_or(&nothing);
        let west = column.checked_sub(u).map_or(&nothing, |west| &row_sums[west]);
        let mut power = 1.0;
        for a in 0..5 {
            let sign = if a % 2 == 0 { 1.0 } else { -1.0 };
            for b in 0..5 - a {
                cells[a][b] += power * (east.cells[b] + sign * west.cells[b]);
            }
            for b in 0..3_usize.saturating_sub(a) {
                heights[a][b] += power * (east.heights[b] + sign * west.heights[b]);
            }
            power *= u as f64;
        }
    }
    // The basis 1, u, v, u^2/2, u v, v^2/2.
    const BASIS: [(usize, usize, f64); 6] =
        [(0, 0, 1.0), (1, 0, 1.0), (0, 1, 1.0), (2, 0, 0.5), (1, 1, 1.0), (0, 2, 0.5)];
    let matrix = BASIS.map(|(a, b, f)| BASIS.map(|(c, d, g)| f * g * cells[a + c][b + d]));
    let right = BASIS.map(|(a, b, f)| f * (heights[a][b] - own * cells[a][b]));
    let (cell, area) = (bed.cell, bed.cell * bed.cell);
    if let Some(a) = eliminate::<6>(matrix, right) {
        return Fit {
            gradient: [a[1] / cell, a[2] / cell],
            hessian: [a[3] / area, a[4] / area, a[5] / area],
        };
    }
    let plane = std::array::from_fn(|k| std::array::from_fn(|l| matrix[k][l]));
    match eliminate::<3>(plane, [right[0], right[1], right[2]]) {
        Some(a) => Fit { gradient: [a[1] / cell, a[2] / cell], hessian: [0.0; 3] },
        None => from_differences(bed, column, row),
    }
}

#[cfg(test)]
mod tests {
    use super::super::fit::Windows;
    use super::*;
    use crate::raster::tests::sampled;

    fn rough(x: f64, y: f64) -> f64 {
        1900.0 + 40.0 * (0.13 * x).sin() * (0.11 * y + 0.02 * x).cos() + 0.4 * y - 0.2 * x
    }

    fn ragged(f: impl Fn(f64, f64) -> f64) -> Raster {
        sampled(
            47,
            39,
            |x, y| if (x - 20.0).hypot(y - 18.0) < 5.6 || x + y < 9.0 { f64::NAN } else { f(x, y) },
        )
    }

    fn apart(a: &Fit, b: &Fit) -> f64 {
        let numbers = |fit: &Fit| fit.gradient.into_iter().chain(fit.hessian).collect::<Vec<_>>();
        numbers(a).iter().zip(numbers(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn it_is_the_fit_of_each_window_on_its_own() {
        let bed = ragged(rough);
        for m in [2, NARROW + 1, 30] {
            let windows = Windows::new(m, bed.cell);
            for (k, fit) in fits(&bed, m).into_iter().enumerate() {
                let one = windows.fit(&bed, bed.place(k));
                assert!(apart(&one, &fit) < 1e-9, "{m} {:?}: {one:?} {fit:?}", bed.place(k));
            }
        }
    }

    #[test]
    fn mirrored_beds_give_mirrored_derivatives_bit_for_bit() {
        let bed = ragged(rough);
        let (columns, rows) = (bed.columns, bed.rows);
        let at = |k: usize| bed.at(columns - 1 - k % columns, k / columns);
        let east = fits(&bed.with_values((0..rows * columns).map(at).collect()), 12);
        let at = |k: usize| bed.at(k % columns, rows - 1 - k / columns);
        let north = fits(&bed.with_values((0..rows * columns).map(at).collect()), 12);
        for (k, Fit { gradient: [x, y], hessian: [xx, xy, yy] }) in fits(&bed, 12).into_iter().enumerate() {
            let [i, j] = bed.place(k);
            let mirrored = Fit { gradient: [-x, y], hessian: [xx, -xy, yy] };
            assert_eq!(east[j * columns + columns - 1 - i], mirrored, "{i} {j}");
            let mirrored = Fit { gradient: [x, -y], hessian: [xx, -xy, yy] };
            assert_eq!(north[(rows - 1 - j) * columns + i], mirrored, "{i} {j}");
        }
    }
}
