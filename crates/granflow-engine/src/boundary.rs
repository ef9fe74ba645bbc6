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
    for axis in 0..D {
        let last = grid.cells[axis] as isize - 1;
        // The second axis takes the ghosts of the first along: a corner has neighbours too.
        let ghosts = GHOSTS as isize;
        let across =
            if axis == 0 { 0..layout.rows as isize } else { -ghosts..layout.columns as isize + ghosts };
        let place = |i: isize, j: isize| if axis == 0 { layout.place(i, j) } else { layout.place(j, i) };
        for ghost in 0..ghosts {
            for (side, target) in [(0, -1 - ghost), (1, last + 1 + ghost)] {
                if grid.boundary[axis][side] == Boundary::Absorbing {
                    continue; // 0, as the field was made
                }
                let edge = if side == 0 { 0 } else { last };
                let inward = if side == 0 { edge + ghost } else { edge - ghost };
                let source = match grid.boundary[axis][side] {
                    Boundary::Open | Boundary::Absorbing => edge,
                    Boundary::Wall => inward,
                    Boundary::Periodic => last - inward, // -1 - k is last - k, last + 1 + k is k
                };
                for j in across.clone() {
                    let value: P = field.get(place(source, j));
                    let value = match grid.boundary[axis][side] {
                        Boundary::Wall => mirror(axis, value),
                        Boundary::Open | Boundary::Periodic | Boundary::Absorbing => value,
                    };
                    field.set(place(target, j), value);
                }
            }
        }
    }
}
