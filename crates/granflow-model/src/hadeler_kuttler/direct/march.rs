//! The eikonal equation on a table by fast marching, in the discrete form that the scheme comes to rest in.
//!
//! At a node the scheme's loss vanishes where the steepest of the cells around it has slope one:
//! max over cells c of p_c^2 + q_c^2 = 1, p_c = (s - s_x)+/dx, q_c = (s - s_y)+/dy with the cell's own neighbours of the
//! node (eq. 9 in two dimensions). So s is the smallest of the cells' own solutions, each depends on lower values only,
//! and the nodes can be found in the order of their values (Tsitsiklis, IEEE Trans. Autom. Control 40, 1995; Sethian, PNAS 93, 1996).

use super::super::table::Table;
use alloc::vec;
use alloc::vec::Vec;
use core::cmp::Ordering;
use std::collections::BinaryHeap;

/// A node on the front, the lowest first, equal ones by number.
#[derive(PartialEq)]
struct Front {
    value: f64,
    node: usize,
}

impl Eq for Front {}
impl Ord for Front {
    fn cmp(&self, other: &Self) -> Ordering {
        other.value.total_cmp(&self.value).then(other.node.cmp(&self.node))
    }
}
impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The surface of slope one that rises from the nodes where it is known; infinite where no way leads.
///
/// Every value follows from lower ones by formulas that are symmetric in the axes and in the cells, so that symmetric
/// tables give symmetric surfaces bit for bit.
pub(super) fn march<const D: usize>(
    table: &Table<D>,
    size: [f64; D],
    known: impl Fn(usize) -> Option<f64>,
) -> Vec<f64> {
    let mut surface = vec![f64::INFINITY; table.size()];
    let mut final_ = vec![false; table.size()];
    let mut fixed = vec![false; table.size()];
    let mut front = BinaryHeap::new();
    for node in 0..table.size() {
        if let Some(value) = known(node) {
            surface[node] = value;
            fixed[node] = true;
            front.push(Front { value, node });
        }
    }
    while let Some(Front { node, .. }) = front.pop() {
        if core::mem::replace(&mut final_[node], true) {
            continue;
        }
        for (cell, corner) in table.around(node) {
            for axis in 0..D {
                let corner = corner ^ (1 << axis);
                let to = cell + table.span(corner);
                if final_[to] || fixed[to] {
                    continue;
                }
                let lower: [f64; D] = core::array::from_fn(|k| {
                    let from = cell + table.span(corner ^ (1 << k));
                    if final_[from] { surface[from] } else { f64::INFINITY }
                });
                let value = rise(lower, size);
                if value < surface[to] {
                    surface[to] = value;
                    front.push(Front { value, node: to });
                }
            }
        }
    }
    surface
}

/// The value s with sum over axes of ((s - lower)+/size)^2 = 1.
fn rise<const D: usize>(lower: [f64; D], size: [f64; D]) -> f64 {
    let (a, dx) = (lower[0], size[0]);
    if D == 1 {
        return a + dx;
    }
    let (b, dy) = (lower[D - 1], size[D - 1]);
    if a + dx <= b {
        return a + dx;
    }
    if b + dy <= a {
        return b + dy;
    }
    let (xx, yy) = (dx * dx, dy * dy);
    let step = a - b;
    let root = ((xx + yy) - step * step).sqrt();
    let value = ((a * yy + b * xx) + (dx * dy) * root) / (xx + yy);
    // Rounding must not put it below what it rests on.
    value.max(a.max(b))
}

#[cfg(test)]
mod tests {
    use super::rise;
    use std::prelude::v1::*;

    #[test]
    fn the_rise_has_slope_one_and_knows_no_order_of_the_axes() {
        for (a, b) in [(0.0, 0.0), (0.3, 0.35), (0.3, 0.31), (0.35, 0.3), (0.1, 5.0), (7.0, f64::INFINITY)] {
            let (dx, dy) = (0.1, 0.25);
            let s = rise([a, b], [dx, dy]);
            let slope = ((s - a).max(0.0) / dx).hypot((s - b).max(0.0) / dy);
            assert!((slope - 1.0).abs() < 1e-13, "{a} {b}: {slope}");
            assert_eq!(s, rise([b, a], [dy, dx]));
        }
        assert_eq!(rise([0.5], [0.25]), 0.75);
    }
}
