//! The Savage-Hutter equations: depth-averaged granular flow with friction that starts, flows, stops and stays.
//!
//! h_t + div(h u) = 0, (h u)_t + div(h u u) + grad(beta h^2/2) = g(u) h (report eq. 1; on terrain
//! [`ground::Terrain`]). The unknowns are [`Flow`]; what is fixed in a cell is a [`ground::Bed`].

pub mod balanced;
pub mod earth_pressure;
pub mod energy_stable;
pub mod erosion;
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

    /// A trickle: a layer no thicker than `thickness` (normal to the bed), or one that carries no more than a layer of that thickness
    /// at the speed of its waves, h |V| <= sqrt(psi' d^3) with d its depth and psi' d the square of that speed. So slow is what
    /// seeps through a hollow that a trickle has filled.
    #[inline(always)]
    pub fn is_trickle<B: Bed<D, R>>(&self, bed: &B, thickness: R) -> R::Mask {
        let d = thickness / bed.thickness(R::splat(1.0));
        let square = self.h * self.h * bed.square(self.velocity());
        self.h.le(d) | square.le(bed.head() * (d * d * d))
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

#[cfg(test)]
mod tests {
    use super::ground::{Chute, Terrain};
    use super::*;

    #[test]
    fn a_trickle_is_thin_or_carries_no_more_than_a_thin_layer_at_the_speed_of_its_waves() {
        let flat = Chute { tilt: [0.0], beta: 9.81, cos: 9.81, curvature: 0.0 };
        let flow = |h: f64, u: f64| Flow { h, q: [h * u] };
        let most = (9.81 * 0.01_f64.powi(3)).sqrt();
        assert!(flow(0.0099, 30.0).is_trickle(&flat, 0.01));
        assert!(flow(2.0, 0.99 * most / 2.0).is_trickle(&flat, 0.01));
        assert!(!flow(2.0, 1.01 * most / 2.0).is_trickle(&flat, 0.01));
        assert!(!flow(0.0101, 1.0).is_trickle(&flat, 0.01));
        // On a slope of 60 degrees the layer 1 cm thick has a depth of 2 cm, and its waves the speed sqrt(g c^2 H) along the plan.
        let steep = Terrain::of(0.0, [3_f64.sqrt(), 0.0], 0.5, [0.0; 3], 9.81);
        let carried = |h: f64, along: f64| Flow { h, q: [along * 0.5, 0.0] };
        let most = (9.81 * 0.25 * 0.02_f64.powi(3)).sqrt();
        assert!(Flow { h: 0.0199, q: [1.0, 0.0] }.is_trickle(&steep, 0.01));
        assert!(carried(1.0, 0.99 * most).is_trickle(&steep, 0.01));
        assert!(!carried(1.0, 1.01 * most).is_trickle(&steep, 0.01));
    }
}
