//! What leaves the domain through the faces of a row.

use super::Strip;
use crate::lanes::SimdVector;
use crate::sweep::scratch::Scratch;
use crate::tiles::{OUTLETS, Tile};
use granflow_model::scheme::{Scheme, Side};

impl<const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> Strip<'_, D, UNIFORM, L, T> {
    /// Add what passes the outlets of row `j` of a tile: after the fluxes along x are known that along x and at the lower faces
    /// along y, after the update (`up`) that at the upper ones.
    #[inline(always)]
    pub(super) fn add_outflow(
        &self,
        outflow: &mut [f64; OUTLETS.len()],
        tile: &Tile,
        columns: [usize; 2],
        j: isize,
        scratch: &Scratch<D, L, T>,
        up: bool,
    ) {
        // They are sorted by rows.
        let outlets = &self.outlets[tile.outlets.clone()];
        let below = |up_to: isize| outlets.partition_point(|outlet| (outlet.cell[1] as isize) < up_to);
        for outlet in &outlets[below(j)..below(j + 1)] {
            let (axis, side) = (outlet.axis as usize, outlet.side);
            if (axis == 1 && side == 1) != up {
                continue;
            }
            let row = if axis == 0 { &scratch.across } else { &scratch.below };
            let moved = usize::from(axis == 0 && side == 1);
            let at = outlet.cell[0] as usize - columns[0] + 1 + moved;
            // SAFETY: a face of a cell of the strip; the row ends with room for a vector.
            let flux: T::Flux = unsafe { row.get(at as isize) };
            let lambda = self.lambda(axis);
            let leaves = if side == 0 {
                -self.scheme.outflow(&flux, Side::Right, lambda)
            } else {
                self.scheme.outflow(&flux, Side::Left, lambda)
            };
            outflow[outlet.outlet as usize] += leaves.first();
        }
    }
}
