//! The Savage-Hutter equations: depth-averaged granular flow with friction that starts, flows, stops and stays.
//!
//! h_t + div(h u) = 0, (h u)_t + div(h u u) + grad(beta h^2/2) = g(u) h (report eq. 1; on terrain
//! [`ground::Terrain`]). The unknowns are [`Flow`]; what is fixed in a cell is a [`ground::Bed`].

pub mod balanced;
pub mod energy_stable;
#[cfg(feature = "std")]
pub mod exact;

pub mod flux;
pub mod friction;
pub mod ground;
pub mod kinetic;

use crate::real::{Real, for_axis, per_axis, total};
use crate::scheme::{Diagnostics, components};
use ground::Bed;

/// A depth below the smallest normal number is none: subnormal numbers round by as much as they hold.
#[inline(always)]
fn normal<R: Real>(h: R) -> R {
    R::select(h.abs().lt(R::splat(f64::MIN_POSITIVE)), R::zero(), h)
}

/// The unknowns of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow<const D: usize, R> {
    /// Depth (papers: scaled, normal to the chute) or, on terrain, volume per plan area H = h/c \[m\].
    pub h: R,
    /// Momentum h u (terrain: H w, w the horizontal velocity \[m/s\]).
    pub q: [R; D],
}

impl<const D: usize, R: Real> Flow<D, R> {
    /// At rest with depth `h`.
    #[inline(always)]
    pub fn still(h: R) -> Self {
        Flow { h, q: [R::zero(); D] }
    }

    /// u = q/h, and 0 where h is none.
    #[inline(always)]
    pub fn velocity(&self) -> [R; D] {
        let (zero, one) = (R::zero(), R::splat(1.0));
        let wet = R::splat(f64::MIN_POSITIVE).le(self.h);
        let per = R::select(wet, one / R::select(wet, self.h, one), zero);
        per_axis!(k => self.q[k] * per)
    }

    /// q = 0 in every component.
    #[inline(always)]
    pub fn is_still(&self) -> R::Mask {
        let mut still = self.q[0].equals(R::zero());
        for_axis!(axis in D => {
            still = still & self.q[axis].equals(R::zero());
        });
        still
    }

    /// The mirror image across a wall normal to `axis`.
    pub fn mirror(mut self, axis: usize) -> Self {
        self.q[axis] = -self.q[axis];
        self
    }

    /// sum over axes of (|u| + sqrt(2 beta h))/dx, the support of the kinetic density (report eq. 28).
    #[inline(always)]
    pub fn rate<B: Bed<D, R>>(&self, bed: &B, per: [R; D]) -> R {
        let u = self.velocity();
        let along: [R; D] = per_axis!(axis => {
            let beta = bed.beta(axis);
            (u[axis].abs() + ((beta + beta) * self.h.positive_part()).sqrt()) * per[axis]
        });
        total(along)
    }

    /// Volume, speed, energy of this state on `bed`; a film is thinner than `film`.
    #[inline(always)]
    pub fn diagnostics<B: Bed<D, R>>(&self, bed: &B, film: R) -> Diagnostics<R> {
        let speed_squared = bed.square(self.velocity());
        Diagnostics {
            volume: self.h,
            speed_squared,
            energy: self.h * speed_squared * R::splat(0.5),
            thickness: bed.thickness(self.h),
            film: R::select(self.h.lt(film), R::splat(1.0), R::zero()),
        }
    }
}

components!([const D: usize, R: Real] Flow<D, R> { h: R, q: [R; D] });
