//! Force and friction in a cell, and what it then offers to its faces.

use super::budget::Gives;
use super::faces::{FaceStates, FaceStatesOf};
use super::force::{Downstream, UNRESOLVED, centred, pushed};
use super::forecast::{Forecast, Motion};
use super::sides::Sides;
use super::variant::EnergyStable;
use crate::real::{Real, for_axis, per_axis};
use crate::savage_hutter::Flow;
use crate::savage_hutter::friction::{Friction, Resistance};
use crate::savage_hutter::ground::Bed;
use crate::scheme::{Cell, Forecasts, Spacing, Stencil};

/// Is it 0 along every axis?
#[inline(always)]
fn is_zero<const D: usize, R: Real>(w: [R; D]) -> R::Mask {
    let mut zero = w[0].equals(R::zero());
    for_axis!(k in D => {
        zero = zero & w[k].equals(R::zero());
    });
    zero
}

/// What a cell that gives nothing offers.
#[inline(always)]
pub(super) fn closed<const D: usize, R: Real, B: Bed<D, R>>(
    Cell { state, ground, .. }: &Cell<Flow<D, R>, B>,
    forecast: &Forecast<D, R, B::Surface>,
) -> FaceStatesOf<D, R, B> {
    let (zero, one) = (R::zero(), R::splat(1.0));
    FaceStates {
        h: state.h,
        surface: forecast.surface,
        gain: forecast.gain,
        head: ground.head(),
        plane: ground.plane(),
        motion: forecast.motion,
        u: forecast.u,
        w: [zero; D],
        free: [zero; D],
        wave: zero,
        per_head: ground.per_head(),
        share: one,
        room: zero,
        budget: zero,
        inflow: zero,
        inflow_share: zero,
        holds: [zero; D],
    }
}

impl<F: Friction, B: Copy> EnergyStable<F, B> {
    /// [`crate::scheme::Scheme::reconstruct`].
    #[inline(always)]
    pub(super) fn offer<const D: usize, R: Real>(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B>,
        forecasts: &Forecasts<D, Forecast<D, R, B::Surface>>,
        dt: R,
    ) -> FaceStatesOf<D, R, B>
    where
        B: Bed<D, R>,
    {
        let near = stencil.star();
        let here = Cell { ground: near.here.ground.exact(), ..near.here };
        let mut offer = closed(&here, &forecasts.here);
        let shut = offer.motion.is_closed();
        if !R::any(!shut) {
            return offer;
        }
        let zero = R::zero();
        let (bed, h, per) = (here.ground, here.state.h, near.spacing.inv);
        let law = self.resistance(&bed, h, offer.u, per);
        let sides: [Sides<R>; D] = per_axis!(axis => Sides::of::<D, B>(axis, forecasts));
        let w = self.accelerated(&here, &offer, &law, sides, &near.spacing, dt);
        offer.w = per_axis!(k => R::select(shut, zero, w[k]));
        offer.free = per_axis!(k => sides[k].freedom());
        offer.holds = per_axis!(k => law.holding * near.spacing.size[k]);
        // What friction stops gives nothing; what nothing resists still gives its thermal part.
        let stops = is_zero(offer.w) & zero.lt(law.dry) & !shut;
        let code = offer.motion.code;
        let lets_go = offer.motion.is_tower();
        offer.motion = Motion { code: R::select(stops & !lets_go, R::splat(Motion::<R>::STOPS), code) };
        let gives = Gives { lambda: per_axis!(k => dt * per[k]), flows: !(stops | shut) };
        gives.offers::<B>(&sides, &mut offer);
        gives.budget::<B>(&near, &sides, &mut offer);
        offer
    }

    /// The velocity after force and friction.
    #[inline(always)]
    fn accelerated<const D: usize, R: Real>(
        &self,
        Cell { state, ground: bed, .. }: &Cell<Flow<D, R>, B>,
        offer: &FaceStatesOf<D, R, B>,
        law: &Resistance<R>,
        sides: [Sides<R>; D],
        spacing: &Spacing<D, R>,
        dt: R,
    ) -> [R; D]
    where
        B: Bed<D, R>,
    {
        let zero = R::zero();
        let forces: [Downstream<R>; D] = per_axis!(k => sides[k].force(spacing.inv[k]));
        let (forces, unresolved) = centred(forces, law.dry);
        let pushed = pushed::<D, R, B>(&offer.plane, offer.u, forces, dt);
        let slow = bed.square(offer.u).le(unresolved * R::splat(spacing.smallest));
        let idle = R::select(slow & !offer.motion.is_tower(), unresolved * R::splat(UNRESOLVED), zero);
        let dry = R::select(state.is_still(), law.holding, law.dry);
        let lambda: [R; D] = per_axis!(k => dt * spacing.inv[k]);
        Self::slowed::<D, R>(&offer.plane, [dry, law.drag, idle], pushed, lambda, dt)
    }
}
