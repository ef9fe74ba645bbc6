//! Limited slopes, and the halves of the kinetic density at the ends of a cell.

use super::faces::FaceStates;
use super::slopes::{CellSlopes, Order, SlopeStorage};
use super::variant::Balanced;
use crate::limiter;
use crate::real::{Real, per_axis};
use crate::savage_hutter::Flow;
use crate::savage_hutter::flux::Density;
use crate::savage_hutter::friction::Friction;
use crate::savage_hutter::ground::{Bed, Towards};
use crate::scheme::Neighbours;

pub(super) type SlopesOf<const D: usize, R, const ORDER: u8> =
    <Order<ORDER> as SlopeStorage>::CellSlopes<D, R>;

pub(super) type FaceStatesOf<const D: usize, R, B, const ORDER: u8> =
    FaceStates<D, R, SlopesOf<D, R, ORDER>, <B as Bed<D, R>>::Plane>;

impl<F: Friction, B: Copy, const ORDER: u8> Balanced<F, B, ORDER>
where
    Order<ORDER>: SlopeStorage,
{
    /// Do depth and velocity vary across a cell?
    #[inline(always)]
    pub(super) fn limited(&self) -> bool {
        match Order::<ORDER>::LIMITED {
            Some(limited) => limited,
            None => self.slopes,
        }
    }

    /// Limited slopes along one axis, and the halves at the cell's two ends.
    #[inline(always)]
    pub(super) fn limited_slopes<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B>,
        u: [R; D],
        axis: usize,
        face_states: &mut FaceStatesOf<D, R, B, ORDER>,
    ) where
        B: Bed<D, R>,
    {
        let Flow { h, .. } = near.here.state;
        let (a, b) = (&near.lo[axis].state, &near.hi[axis].state);
        let (ua, ub) = (a.velocity(), b.velocity());
        // Beside a cell at rest or bare there is no smooth flow to be second order in. A velocity reconstructed
        // down to 0 at a held cell's face carries nothing there, and two cells push each other for ever (silo);
        // thin cells beside bare ones trickle for ever (mountains).
        let smooth = !(self.is_at_rest_or_dry(&near.lo[axis]) | self.is_at_rest_or_dry(&near.hi[axis]));
        let half = R::select(smooth, R::splat(0.5), R::zero());
        let dh = half * limiter::central(h - a.h, b.h - h);
        let mut du: [R; D] = per_axis!(k => half * limiter::central(u[k] - ua[k], ub[k] - u[k]));
        let beta = near.here.ground.beta(axis);
        // Most differences are below 0.9 c, without any root.
        let wide = (R::splat(0.81) * (beta + beta) * h.positive_part()).lt(du[axis] * du[axis]);
        if R::any(wide) {
            let limit = Self::max_slope(h, dh.abs(), u[axis].abs(), beta);
            du[axis] = R::select(wide, du[axis].min(limit).max(-limit), du[axis]);
        }
        let slopes = SlopesOf::<D, R, ORDER>::by(dh, du);
        face_states.slopes[axis] = slopes;
        let depth = [slopes.depth(Towards::Lo, h), slopes.depth(Towards::Hi, h)];
        let velocity = [slopes.velocity(Towards::Lo, u)[axis], slopes.velocity(Towards::Hi, u)[axis]];
        let [lo, hi] = Density::ends(depth, velocity, beta);
        let (lo, hi) = (lo.halves(depth[0])[0], hi.halves(depth[1])[1]);
        face_states.half[axis] = [lo, hi];
    }
}
