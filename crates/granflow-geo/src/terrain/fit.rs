//! Least-squares quadratics through square windows of cells.
//!
//! Sums take mirrored cells in pairs, so that a mirrored bed gives the mirrored result bit for bit.

use crate::raster::Raster;

/// A pivot below this share of its diagonal entry means that the cells do not determine the coefficient.
const DEGENERATE: f64 = 1e-3;

/// First and second derivatives of the bed at a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Fit {
    /// Gradient (b_x, b_y).
    pub gradient: [f64; 2],
    /// Hessian (b_xx, b_xy, b_yy) \[1/m\].
    pub hessian: [f64; 3],
}

impl Fit {
    /// Cosine of the slope, c = 1 / sqrt(1 + |grad b|^2).
    pub fn cosine(&self) -> f64 {
        let [x, y] = self.gradient;
        1.0 / (1.0 + (x * x + y * y)).sqrt()
    }

    fn is_number(&self) -> bool {
        (self.gradient.iter().sum::<f64>() + self.hessian.iter().sum::<f64>()).is_finite()
    }
}

/// Windows without a gap: 1, u, v, u v and the centred squares p(u) = u^2 - m (m + 1)/3, p(v) are orthogonal on them,
/// hence each coefficient is one weighted sum.
#[derive(Debug, Clone)]
pub(super) struct Windows {
    m: usize,
    /// 1 / (sum of u^2 over the window * cell)
    first: f64,
    /// 2 / (sum of p(u)^2 over the window * cell^2)
    second: f64,
    /// 1 / (sum of u^2 v^2 over the window * cell^2)
    mixed: f64,
    /// p(0), p(1), ..., p(m)
    squares: Vec<f64>,
}

impl Windows {
    /// Windows of half-width `m`, of cells of this length.
    pub fn new(m: usize, cell: f64) -> Windows {
        let (count, mean) = ((2 * m + 1) as f64, (m * (m + 1)) as f64 / 3.0);
        let squares: Vec<f64> = (0..=m).map(|u| (u * u) as f64 - mean).collect();
        let line: f64 = (1..=m).map(|u| (2 * u * u) as f64).sum();
        let square = squares[0] * squares[0] + 2.0 * squares[1..].iter().map(|p| p * p).sum::<f64>();
        let area = cell * cell;
        let (first, mixed) = (1.0 / (count * line * cell), 1.0 / (line * line * area));
        Windows { m, first, second: 2.0 / (count * square * area), mixed, squares }
    }

    /// The fit at a cell, zero at nodata.
    pub fn fit(&self, bed: &Raster, [column, row]: [usize; 2]) -> Fit {
        if bed.at(column, row).is_nan() {
            return Fit::default();
        }
        let whole = |k: usize, count: usize| k >= self.m && k + self.m < count;
        let regular =
            (whole(column, bed.columns) && whole(row, bed.rows)).then(|| self.full(bed, column, row));
        match regular {
            Some(fit) if fit.is_number() => fit,
            _ => ragged(bed, column, row, self.m),
        }
    }

    /// The fit of a whole window, not a number where it holds nodata.
    fn full(&self, bed: &Raster, column: usize, row: usize) -> Fit {
        let m = self.m as isize;
        let at = |u: isize, v: isize| {
            bed.values[row.wrapping_add_signed(v) * bed.columns + column.wrapping_add_signed(u)]
        };
        let across = |u: isize| (1..=m).fold(at(u, 0), |sum, v| sum + (at(u, v) + at(u, -v)));
        let along = |v: isize| (1..=m).fold(at(0, v), |sum, u| sum + (at(u, v) + at(-u, v)));
        let (mut x, mut y) = (0.0, 0.0);
        let (mut xx, mut yy) = (self.squares[0] * across(0), self.squares[0] * along(0));
        let mut xy = 0.0;
        for u in 1..=m {
            let ((east, west), (north, south)) = ((across(u), across(-u)), (along(u), along(-u)));
            x += u as f64 * (east - west);
            y += u as f64 * (north - south);
            xx += self.squares[u as usize] * (east + west);
            yy += self.squares[u as usize] * (north + south);
            let twist = |u: isize, v: isize| (at(u, v) + at(-u, -v)) - (at(u, -v) + at(-u, v));
            for v in 1..u {
                xy += (u * v) as f64 * (twist(u, v) + twist(v, u));
            }
            xy += (u * u) as f64 * twist(u, u);
        }
        let hessian = [self.second * xx, self.mixed * xy, self.second * yy];
        Fit { gradient: [self.first * x, self.first * y], hessian }
    }
}

/// The fit of a window with gaps: quadratic, quadratic in the next wider window, plane, differences.
fn ragged(bed: &Raster, column: usize, row: usize, m: usize) -> Fit {
    let window = Window { bed, column, row };
    let cell = bed.cell;
    if let Some(a) = window.solve::<6>(m).or_else(|| window.solve::<6>(m + 1)) {
        let area = cell * cell;
        return Fit {
            gradient: [a[1] / cell, a[2] / cell],
            hessian: [a[3] / area, a[4] / area, a[5] / area],
        };
    }
    if let Some(a) = window.solve::<3>(m) {
        return Fit { gradient: [a[1] / cell, a[2] / cell], hessian: [0.0; 3] };
    }
    from_differences(bed, column, row)
}

/// The gradient by differences towards the neighbours there are, level without any.
pub(super) fn from_differences(bed: &Raster, column: usize, row: usize) -> Fit {
    let window = Window { bed, column, row };
    let cell = bed.cell;
    let difference = |forward: Option<f64>, backward: Option<f64>| match (forward, backward) {
        (Some(forward), Some(backward)) => (forward - backward) / (2.0 * cell),
        (Some(rise), None) => rise / cell,
        (None, Some(rise)) => -rise / cell,
        (None, None) => 0.0,
    };
    let x = difference(window.rise(1, 0), window.rise(-1, 0));
    let y = difference(window.rise(0, 1), window.rise(0, -1));
    Fit { gradient: [x, y], hessian: [0.0; 3] }
}

/// The neighbourhood of a cell.
struct Window<'a> {
    bed: &'a Raster,
    column: usize,
    row: usize,
}

impl Window<'_> {
    /// Elevation of the neighbour at (u, v) above the cell itself, `None` outside and at nodata.
    fn rise(&self, u: isize, v: isize) -> Option<f64> {
        let column = self.column.checked_add_signed(u).filter(|&c| c < self.bed.columns)?;
        let row = self.row.checked_add_signed(v).filter(|&r| r < self.bed.rows)?;
        let rise = self.bed.at(column, row) - self.bed.at(self.column, self.row);
        (!rise.is_nan()).then_some(rise)
    }

    /// The first `N` coefficients of 1, u, v, u^2/2, u v, v^2/2 by the normal equations, `None` where the cells do
    /// not determine them. The matrix holds whole and half numbers, hence no rounding; elimination without pivoting
    /// commutes with a change of sign of u or v.
    fn solve<const N: usize>(&self, m: usize) -> Option<[f64; N]> {
        let m = m as isize;
        let (mut matrix, mut right) = ([[0.0; N]; N], [0.0; N]);
        for (u, v) in (0..=m).flat_map(|v| (0..=m).map(move |u| (u, v))) {
            let mut parts = [[0.0; N]; 4];
            for (part, cell) in parts.iter_mut().zip(mirrored(u, v)) {
                let Some((i, j)) = cell else { continue };
                let Some(rise) = self.rise(i, j) else { continue };
                let (x, y) = (i as f64, j as f64);
                let basis = [1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y];
                for k in 0..N {
                    part[k] = rise * basis[k];
                    for l in k..N {
                        matrix[k][l] += basis[k] * basis[l];
                    }
                }
            }
            for k in 0..N {
                right[k] += (parts[0][k] + parts[1][k]) + (parts[2][k] + parts[3][k]);
            }
        }
        eliminate(matrix, right)
    }
}

/// The cells (+-u, +-v), each once: where u or v is 0 its mirror image is left out.
fn mirrored(u: isize, v: isize) -> [Option<(isize, isize)>; 4] {
    let (west, south) = (u != 0, v != 0);
    let cells = [(true, (u, v)), (west, (-u, v)), (south, (u, -v)), (west && south, (-u, -v))];
    cells.map(|(exists, cell)| exists.then_some(cell))
}

/// Solves a symmetric positive definite system given by its upper triangle, `None` where a pivot is below [`DEGENERATE`].
pub(super) fn eliminate<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> Option<[f64; N]> {
    let diagonal: [f64; N] = std::array::from_fn(|k| matrix[k][k]);
    for k in 0..N {
        if diagonal[k] == 0.0 || matrix[k][k] <= DEGENERATE * diagonal[k] {
            return None;
        }
        let pivot = matrix[k];
        for row in k + 1..N {
            let factor = pivot[row] / pivot[k];
            for (entry, above) in matrix[row].iter_mut().zip(pivot).skip(row) {
                *entry -= factor * above;
            }
            right[row] -= factor * right[k];
        }
    }
    for k in (0..N).rev() {
        let known = (k + 1..N).fold(right[k], |rest, l| rest - matrix[k][l] * right[l]);
        right[k] = known / matrix[k][k];
    }
    Some(right)
}
