//! What leaves the domain through the faces of rows.

use super::Strip;
use crate::lanes::SimdVector;
use crate::sweep::scratch::Scratch;
use crate::tiles::{OUTLETS, OutletFace, Tile};
use granflow_model::scheme::{Scheme, Side};

impl<const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> Strip<'_, D, UNIFORM, L, T> {
    /// Add what passed the outlets of a tile in some rows: in each first what left along x and through the lower faces along y, then
    /// what left through the upper ones.
    #[inline(always)]
    pub(super) fn add_outflow(
        &self,
        outflow: &mut [f64; OUTLETS.len()],
        tile: &Tile,
        columns: [usize; 2],
        rows: [isize; 2],
        scratch: &Scratch<D, L, T>,
    ) {
        // They are sorted by rows.
        let outlets = &self.outlets[tile.outlets.clone()];
        let below = |up_to: isize| outlets.partition_point(|outlet| (outlet.cell[1] as isize) < up_to);
        for j in rows[0]..rows[1] {
            let row = &outlets[below(j)..below(j + 1)];
            let upper = |outlet: &&OutletFace| (outlet.axis, outlet.side) == (1, 1);
            for outlet in row.iter().filter(|outlet| !upper(outlet)).chain(row.iter().filter(upper)) {
                outflow[outlet.outlet as usize] += self.outflow(outlet, columns, j, scratch);
            }
        }
    }

    /// What passed an outlet of row `j`.
    #[inline(always)]
    fn outflow(&self, outlet: &OutletFace, columns: [usize; 2], j: isize, scratch: &Scratch<D, L, T>) -> f64 {
        let (axis, up) = (outlet.axis as usize, usize::from(outlet.side));
        let at = (outlet.cell[0] as usize - columns[0] + 1) as isize;
        // SAFETY: a face of a cell of the strip; the row ends with room for a vector.
        let flux: T::Flux = unsafe {
            if axis == 0 {
                scratch.along_x.row(j).get(at + up as isize)
            } else {
                scratch.along_y.row(j + up as isize).get(at)
            }
        };
        let lambda = self.lambda(axis);
        let leaves = if up == 0 {
            -self.scheme.outflow(&flux, Side::Right, lambda)
        } else {
            self.scheme.outflow(&flux, Side::Left, lambda)
        };
        leaves.first()
    }
}
