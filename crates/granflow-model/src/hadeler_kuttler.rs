//! The Hadeler-Kuttler model of growing sandpiles: a standing layer u and a rolling layer v on a table.
//!
//! u_t = (1 - |grad u|) v, v_t = div(v grad u) - (1 - |grad u|) v + f (Aggarwal, Veerappa Gowda & Sudarshan Kumar 2023,
//! eqs. 1, 2), in the paper's scaling: slopes in units of the tangent of the angle of repose. Where the table itself is
//! not flat, grad u stands for the slope of the surface u + b, b the height of the table.
//!
//! [`scheme::HadelerKuttler`] computes it, [`table::Table`] says where sand lies, falls off and is held
//! back, [`direct`] gives the state it comes to rest in without time steps, [`exact`]
//! what it should come to rest in.

#[cfg(feature = "std")]
pub mod direct;
#[cfg(feature = "std")]
pub mod exact;
pub mod scheme;
pub mod table;

use crate::real::{Real, for_axis};
use crate::scheme::{Components, components};

/// The unknowns of a cell: u at its node with the smallest coordinates, v in the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pile<R> {
    /// Thickness u of the standing layer at the cell's lower left node.
    pub u: R,
    /// Mean thickness v of the rolling layer in the cell.
    pub v: R,
}

/// What is poured on a cell: the source f \[u per time\], split along the axes by the transport ray, f_1 = f cos^2(theta),
/// f_2 = f sin^2(theta) (eq. 47).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source<const D: usize, R> {
    /// Its part along each axis.
    pub split: [R; D],
}
components!([const D: usize, R: Real] Source<D, R> { split: [R; D] });

impl<const D: usize, R: Real> Source<D, R> {
    /// Nothing is poured.
    #[inline(always)]
    pub fn none() -> Self {
        Source { split: [R::zero(); D] }
    }
    /// f.
    #[inline(always)]
    pub fn rate(&self) -> R {
        let mut sum = R::zero();
        for_axis!(axis in D => {
            sum = sum + self.split[axis];
        });
        sum
    }
}

/// What is fixed in a cell and at its lower left node.
///
/// Nodes outnumber cells by one along each axis: the grid has one column and one row more than the table, which hold
/// nodes only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground<const D: usize, R> {
    /// Height b of the table at the node.
    pub bed: R,
    /// 1 where the cell belongs to the table, else 0.
    pub inside: R,
    /// Share of a cell's measure that the node stands for: (cells of the table around it)/2^D, and 0 where u = 0 is
    /// given or no cell of the table touches it.
    pub weight: R,
    /// 1 where the face at the cell's lower end of an axis is a wall, if it is an edge of the table.
    pub wall: [R; D],
    /// 1 where the cell lies in a hole of the table: outside, and enclosed.
    pub hole: R,
}

impl<const D: usize, R: Real> Ground<D, R> {
    /// Beside the table.
    #[inline(always)]
    pub fn outside() -> Self {
        Self::load(|_| R::zero())
    }
}

components!([R: Real] Pile<R> { u: R, v: R });

components!([const D: usize, R: Real] Ground<D, R> {
    bed: R, inside: R, weight: R, hole: R, wall: [R; D]
});
