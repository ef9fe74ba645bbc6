//! What a cell offers to its faces, and what passes one.

use super::ends::EndsOf;
use super::forecast::Motion;
use crate::real::{Real, repeated};
use crate::savage_hutter::ground::Bed;
use crate::scheme::{Components, components};

/// What a cell offers to its faces. Masses are per cell area and step, energies per density besides.
#[derive(Clone, Copy, Debug)]
pub struct FaceStates<const D: usize, R: Real, P, S, T> {
    pub(super) h: R,
    /// The surface as it is, how much psi will rise, and psi' = d psi/dh.
    pub(super) surface: S,
    pub(super) gain: R,
    pub(super) head: R,
    /// The tangent plane of the bed.
    pub(super) plane: P,
    pub(super) motion: Motion<R>,
    /// The velocity before the step, and after force and friction: 0 where the cell gives nothing.
    pub(super) u: [R; D],
    pub(super) w: [R; D],
    /// How freely the cell flows along each axis: as through the less free of its two faces.
    pub(super) free: [R; D],
    /// sqrt(psi' h) and 1/psi'.
    pub(super) wave: R,
    pub(super) per_head: R,
    /// The share of all offers that the cell can give, and the room that they leave in it.
    pub(super) share: R,
    pub(super) room: R,
    /// The kinetic energy of what stays, and the share of the inflow by the old momenta, in all and per face, that it can pay for.
    pub(super) budget: R,
    pub(super) inflow: R,
    pub(super) inflow_share: R,
    /// How much psi may fall to a neighbour along an axis without anything sliding, per sqrt(1 + slope^2) of the bed.
    pub(super) holds: [R; D],
    /// How it varies from end to end.
    pub(super) ends: T,
}

components!([const D: usize, R: Real, P: Components<R>, S: Components<R>, T: Components<R>] FaceStates<D, R, P, S, T> {
    h: R, surface: S, gain: R, head: R, plane: P, motion: Motion<R>, u: [R; D], w: [R; D], free: [R; D], wave: R, per_head: R,
    share: R, room: R, budget: R, inflow: R, inflow_share: R, holds: [R; D], ends: T
});

/// Those over a bed.
pub(super) type FaceStatesOf<const D: usize, R, B, T> =
    FaceStates<D, R, <B as Bed<D, R>>::Plane, <B as Bed<D, R>>::Surface, T>;

/// What passes a face in a step, per cell area.
#[derive(Clone, Copy, Debug)]
pub struct Flux<const D: usize, R: Real> {
    pub(super) mass: R,
    /// Momentum, as its left and its right cell see it.
    pub(super) left: [R; D],
    pub(super) right: [R; D],
    /// Energy beyond that of the mass at the psi of its left and of its right cell.
    pub(super) energy: [R; 2],
}

components!([const D: usize, R: Real] Flux<D, R> { mass: R, left: [R; D], right: [R; D], energy: [R; 2] });

impl<const D: usize, R: Real> Flux<D, R> {
    /// Nothing passes.
    #[inline(always)]
    pub(super) fn none() -> Self {
        let zero = R::zero();
        Flux { mass: zero, left: repeated(zero), right: repeated(zero), energy: [zero, zero] }
    }
}

/// The thermal part of the density sends out at most this share of h sqrt(psi' h): sqrt(3/2)/4, with room for what psi' differs by
/// between the two cells.
const LARGEST_HALF: f64 = 0.33;

/// The thermal part is weakened by this share of lambda sqrt(psi' h), for that much is in the time-centring of the velocity; never
/// below the other share.
const WEAKENED: f64 = 0.5;
const THERMAL: f64 = 0.25;

impl<const D: usize, R: Real, P: Copy, S: Copy, T: EndsOf<D, R>> FaceStates<D, R, P, S, T> {
    /// The velocity of transport, the mean of those before and after force and friction.
    #[inline(always)]
    pub(super) fn mean_velocity(&self, axis: usize) -> R {
        (self.u[axis] + self.w[axis]) * R::splat(0.5)
    }
    /// The share of the thermal part that time-centring leaves.
    #[inline(always)]
    pub(super) fn thermal(&self, lambda: R) -> R {
        (R::splat(1.0) - R::splat(WEAKENED) * lambda * self.wave).max(R::splat(THERMAL))
    }
    /// The mass per time that is carried through a face, if the velocity after force and friction leads out too.
    #[inline(always)]
    pub(super) fn donor(&self, axis: usize, side: usize) -> R {
        let (v, w) = (self.mean_velocity(axis), self.w[axis]);
        let v = R::select(R::zero().lt(v * w), v, R::zero());
        self.h * (if side == 0 { -v } else { v }).positive_part()
    }
    /// The largest mass per time that the density sends through a face, before all are scaled to what there is.
    #[inline(always)]
    pub(super) fn bound(&self, axis: usize, side: usize, lambda: R) -> R {
        let v = self.mean_velocity(axis);
        let out = (if side == 0 { -v } else { v }).positive_part();
        let spray = self.wave * R::splat(LARGEST_HALF);
        let bound = self.h * (out + self.thermal(lambda) * spray);
        let Some(ends) = self.ends.get() else { return bound };
        let v = ends.speed(axis, side);
        let out = (if side == 0 { -v } else { v }).positive_part();
        // sqrt(psi' h) at an end that is deeper, by at most twice.
        let depth = ends.depth(axis, side, self.h);
        let at_end = R::select(self.h.lt(depth), spray * R::splat(core::f64::consts::SQRT_2), spray);
        let at_end = depth * (out + at_end);
        R::select(R::zero().lt(ends.smooth[axis]), bound.max(at_end), bound)
    }
}
