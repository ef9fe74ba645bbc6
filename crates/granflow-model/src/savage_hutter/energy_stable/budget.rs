//! What a cell can give in a step, and what it can pay for.

use super::ends::EndsOf;
use super::faces::FaceStatesOf;
use super::sides::Sides;
use crate::real::{Real, for_axis, per_axis, total};
use crate::savage_hutter::Flow;
use crate::savage_hutter::ground::Bed;
use crate::scheme::Neighbours;

/// A cell gives at most this share of what it holds in a step, and what spreads at most this share of the rest through a face.
const GIVES: f64 = 0.98;
const SPREADS_OF_REST: f64 = 0.24;

/// What a cell gives.
pub(super) struct Gives<const D: usize, R: Real> {
    /// dt/dx
    pub lambda: [R; D],
    /// It moves.
    pub flows: R::Mask,
    /// It gives nothing, whatever happens.
    pub shut: R::Mask,
}

impl<const D: usize, R: Real> Gives<D, R> {
    /// All offers scaled to what the cell has.
    #[inline(always)]
    pub(super) fn offers<B: Bed<D, R>, T: EndsOf<D, R>>(
        &self,
        sides: &[Sides<R>; D],
        offer: &mut FaceStatesOf<D, R, B, T>,
    ) {
        let (zero, one, h) = (R::zero(), R::splat(1.0), offer.h.positive_part());
        offer.wave = R::select(self.shut, zero, (offer.head * h).sqrt());
        let all: [R; D] = per_axis!(axis => {
            let faces: [R; 2] = per_axis!(side => {
                let (donor, kinetic) = (offer.donor(axis, side), offer.bound(axis, side, self.lambda[axis]));
                donor + sides[axis].free[side] * (kinetic - donor).positive_part()
            });
            self.lambda[axis] * (faces[0] + faces[1])
        });
        let all = R::select(self.flows, total(all), zero);
        let most = h * R::splat(GIVES);
        let more = most.lt(all);
        if R::any(more) {
            offer.share = R::select(more, most / R::select(more, all, one), one);
        }
        offer.room = R::select(self.shut, zero, (h - all.min(most)) * R::splat(SPREADS_OF_REST));
    }

    /// What it can pay for: the kinetic energy of what stays, on which the predicted inflow draws.
    #[inline(always)]
    pub(super) fn budget<B: Bed<D, R>, P: Copy, T: EndsOf<D, R>>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B, P>,
        sides: &[Sides<R>; D],
        offer: &mut FaceStatesOf<D, R, B, T>,
    ) {
        let (zero, one, half) = (R::zero(), R::splat(1.0), R::splat(0.5));
        let stays = offer.room * R::splat(1.0 / SPREADS_OF_REST);
        offer.budget = stays * (half * B::square_in(&offer.plane, offer.u));
        let mut pays = zero.lt(offer.motion.freedom()) & zero.lt(offer.budget);
        for_axis!(axis in D => {
            pays = pays & !sides[axis].ends;
        });
        if !R::any(pays) {
            return;
        }
        let inflow: [[R; 2]; D] = per_axis!(axis => {
            let (own, lambda) = (near.here.state.q[axis], half * self.lambda[axis]);
            [lambda * (near.lo[axis].state.q[axis] + own), -(lambda * (own + near.hi[axis].state.q[axis]))]
        });
        let all = total::<D, R>(per_axis!(axis => inflow[axis][0] + inflow[axis][1]));
        let faces = R::splat(2.0 * D as f64);
        let mut dearest = zero;
        for_axis!(axis in D => {
            let costs: [R; 2] = per_axis!(side => inflow[axis][side] * (faces * inflow[axis][side] - all));
            dearest = dearest.max(costs[0]).max(costs[1]);
        });
        let costs = half * offer.head * dearest * faces;
        let over = pays & offer.budget.lt(costs);
        let mut share = one;
        if R::any(over) {
            share = R::select(over, (offer.budget / R::select(over, costs, one)).sqrt(), one);
        }
        offer.inflow_share = R::select(pays, share, zero);
        offer.inflow = offer.inflow_share * all;
    }
}
