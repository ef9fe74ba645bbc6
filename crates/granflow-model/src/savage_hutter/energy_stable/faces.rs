//! What a cell offers to its faces, and what passes one.

use super::forecast::Motion;
use crate::real::Real;
use crate::savage_hutter::ground::Bed;
use crate::scheme::{Components, components};

/// What a cell offers to its faces. Masses are per cell area and step, energies per density besides.
#[derive(Clone, Copy, Debug)]
pub struct FaceStates<const D: usize, R: Real, P, S> {
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
}

components!([const D: usize, R: Real, P: Components<R>, S: Components<R>] FaceStates<D, R, P, S> {
    h: R, surface: S, gain: R, head: R, plane: P, motion: Motion<R>, u: [R; D], w: [R; D], free: [R; D], wave: R, per_head: R,
    share: R, room: R, budget: R, inflow: R, inflow_share: R, holds: [R; D]
});

/// Those over a bed.
pub(super) type FaceStatesOf<const D: usize, R, B> =
    FaceStates<D, R, <B as Bed<D, R>>::Plane, <B as Bed<D, R>>::Surface>;

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
        Flux { mass: zero, left: [zero; D], right: [zero; D], energy: [zero; 2] }
    }
}
