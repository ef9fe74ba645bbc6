//! The share of the slopes that the adaptive scheme takes.

use super::cell::FaceStates;
use super::rates::{corner, flux, rate_of_v};
use super::reconstruct::constant;
use super::variant::HadelerKuttler;
use crate::hadeler_kuttler::{Ground, Pile, Source};
use crate::real::{Real, per_axis, power};
use crate::scheme::{Cell, Faces, Stencil};

impl<const LIMITED: bool> HadelerKuttler<LIMITED> {
    /// E of a cell (eq. 37): what the first-order scheme would change in it and at its corners,
    /// sum of |G| + h |v_t|, h the smallest cell size; in two dimensions half the sum, which is the line's where nothing
    /// varies across.
    #[inline(always)]
    pub(super) fn residual<const D: usize, R: Real>(
        &self,
        stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
        smallest: R,
    ) -> R {
        // around[y][x], from the neighbour with smaller coordinates; in one dimension the rows are the same.
        let around: [[FaceStates<D, R, ()>; 3]; 3] = per_axis!(y => {
            per_axis!(x => {
                let at = [x as isize - 1, y as isize - 1];
                constant(stencil, per_axis!(k => at[k]))
            })
        });
        let corners: [[R; 2]; 2] = per_axis!(y => per_axis!(x => {
            corner([[&around[y][x], &around[y][x + 1]], [&around[y + 1][x], &around[y + 1][x + 1]]])
        }));
        let faces: [Faces<R>; D] = per_axis!(axis => {
            let (lo, hi) =
                if axis == 0 { (&around[1][0], &around[1][2]) } else { (&around[0][1], &around[2][1]) };
            Faces { lo: flux(axis, lo, &around[1][1]), hi: flux(axis, &around[1][1], hi) }
        });
        let Cell { ground, forcing, .. } = stencil.at([0; D]);
        let rate = rate_of_v(&ground, &forcing, &faces, &corners, stencil.spacing());
        let [[a, b], [c, d]]: [[R; 2]; 2] = per_axis!(y => per_axis!(x => corners[y][x].abs()));
        let corners = if D > 1 { ((a + d) + (b + c)) * R::splat(0.5) } else { a + b };
        corners + rate.abs() * smallest
    }

    /// Theta(E) = E^2/(E^2 + h^m) (eq. 36).
    #[inline(always)]
    pub(super) fn theta<const D: usize, R: Real>(
        &self,
        exponent: f64,
        stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    ) -> R {
        let smallest = stencil.spacing().smallest;
        let residual = self.residual(stencil, R::splat(smallest));
        let square = residual * residual;
        square / (square + R::splat(power(smallest, exponent)))
    }
}
