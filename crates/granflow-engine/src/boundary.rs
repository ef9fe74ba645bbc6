//! Ghost cells: the ends of the grid as copies, mirror images or the other end.

use crate::field::Field;
use crate::grid::{GHOSTS, Grid, Layout};
use granflow_model::scheme::{Boundary, Components};

/// Fill the ghost cells of `field`, which was made of zeros; `mirror(axis, value)` is the image across a wall.
pub fn fill<const D: usize, P: Components<f64>>(
    field: &mut Field,
    grid: &Grid<D>,
    layout: &Layout,
    mirror: impl Fn(usize, P) -> P,
) {
    if P::COUNT > 0 {
        each_line(&grid.cells, &grid.boundary, layout, &mut |line| {
            for k in 0..line.count {
                let value: P = field.get(line.source + k * line.step);
                let value = line.wall.map_or(value, |axis| mirror(axis, value));
                field.set(line.target + k * line.step, value);
            }
        });
    }
}

/// Ghost cells side by side along an end of the grid, and the cells whose values they take.
struct Line {
    source: usize,
    target: usize,
    /// Distance in memory from one to the next.
    step: usize,
    count: usize,
    /// The axis along which they are mirror images.
    wall: Option<usize>,
}

/// Every line of ghosts that is filled.
fn each_line(cells: &[usize], boundary: &[[Boundary; 2]], layout: &Layout, see: &mut dyn FnMut(Line)) {
    for (axis, (&count, ends)) in cells.iter().zip(boundary).enumerate() {
        let last = count as isize - 1;
        // The second axis takes the ghosts of the first along: a corner has neighbours too.
        let ghosts = GHOSTS as isize;
        let (first, count) = if axis == 0 { (0, layout.rows) } else { (-ghosts, layout.stride) };
        let place = |k: isize| if axis == 0 { layout.place(k, first) } else { layout.place(first, k) };
        for ghost in 0..ghosts {
            for (side, target) in [(0, -1 - ghost), (1, last + 1 + ghost)] {
                let edge = if side == 0 { 0 } else { last };
                let inward = if side == 0 { edge + ghost } else { edge - ghost };
                let source = match ends[side] {
                    Boundary::Absorbing => continue, // 0, as the field was made
                    Boundary::Open => edge,
                    Boundary::Wall => inward,
                    Boundary::Periodic => last - inward, // -1 - k is last - k, last + 1 + k is k
                };
                see(Line {
                    source: place(source),
                    target: place(target),
                    step: layout.step(1 - axis),
                    count,
                    wall: (ends[side] == Boundary::Wall).then_some(axis),
                });
            }
        }
    }
}
