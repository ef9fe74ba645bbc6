//! Force and friction in a cell, and what it then offers to its faces.

use super::budget::Gives;
use super::ends::{EndsOf, EndsStorage, Slopes};
use super::faces::{FaceStates, FaceStatesOf};
use super::force::{Downstream, UNRESOLVED, centred, is_zero, pushed};
use super::forecast::{Forecast, Motion};
use super::sides::Sides;
use super::variant::EnergyStable;
use crate::real::{Real, per_axis, repeated};
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Order;
use crate::savage_hutter::friction::{LocalFriction, Resistance};
use crate::savage_hutter::ground::Bed;
use crate::scheme::{Cell, Forecasts, Spacing, Stencil};

/// What a cell that gives nothing offers.
#[inline(always)]
fn closed<const D: usize, R: Real, B: Bed<D, R>, P, T: EndsOf<D, R>>(
    Cell { state, ground, .. }: &Cell<Flow<D, R>, B, P>,
    forecast: &Forecast<D, R, B::Surface>,
) -> FaceStatesOf<D, R, B, T> {
    let (zero, one) = (R::zero(), R::splat(1.0));
    FaceStates {
        h: state.h,
        surface: forecast.surface,
        gain: forecast.gain,
        head: ground.head(),
        plane: ground.plane(),
        motion: forecast.motion,
        u: forecast.u,
        w: repeated(zero),
        free: repeated(zero),
        wave: zero,
        per_head: ground.per_head(),
        share: one,
        room: zero,
        budget: zero,
        inflow: zero,
        inflow_share: zero,
        holds: repeated(zero),
        ends: T::none(),
    }
}

impl<F: LocalFriction, B: Copy, const ORDER: u8> EnergyStable<F, B, ORDER>
where
    Order<ORDER>: EndsStorage,
{
    /// Is it of second order?
    #[inline(always)]
    pub(super) fn is_second(&self) -> bool {
        match Order::<ORDER>::LIMITED {
            Some(limited) => limited,
            None => self.second,
        }
    }

    /// [`crate::scheme::Scheme::reconstruct`].
    #[inline(always)]
    pub(super) fn offer<const D: usize, R: Real>(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B, F::Parameters<R>>,
        forecasts: &Forecasts<D, Forecast<D, R, B::Surface>>,
        dt: R,
    ) -> FaceStatesOf<D, R, B, EndsIn<D, R, ORDER>>
    where
        B: Bed<D, R>,
    {
        let near = stencil.star();
        let here = Cell { ground: near.here.ground.exact(), ..near.here };
        let mut offer: FaceStatesOf<D, R, B, EndsIn<D, R, ORDER>> = closed(&here, &forecasts.here);
        let shut = offer.motion.is_closed();
        if !R::any(!shut) {
            return offer;
        }
        let zero = R::zero();
        let per = near.spacing.inv;
        let lambda: [R; D] = per_axis!(k => dt * per[k]);
        let law = self.resistance(&here, offer.u, per);
        let sides: [Sides<R>; D] = per_axis!(axis => Sides::of::<D, B>(axis, forecasts));
        let mut slopes = None;
        if self.is_second() {
            let there = per_axis!(k => [forecasts.lo[k].u, forecasts.hi[k].u]);
            slopes = Some(Slopes::of::<B, _>(&near, &sides, (offer.u, there), lambda));
        }
        let w = self.accelerated(
            &here,
            (&offer.plane, offer.u, offer.motion),
            &law,
            (sides, slopes.as_ref()),
            &near.spacing,
            dt,
        );
        offer.w = per_axis!(k => R::select(shut, zero, w[k]));
        // What is shut offers the same as if all cells beside it were.
        offer.free = per_axis!(k => R::select(shut, zero, sides[k].freedom()));
        offer.holds = per_axis!(k => law.holding * near.spacing.size[k]);
        // What friction stops gives nothing; what nothing resists still gives its thermal part.
        let stops = is_zero(offer.w) & zero.lt(law.dry) & !shut;
        if let Some(slopes) = &slopes {
            offer.ends =
                EndsOf::of(slopes.with::<B, _>(&near, &offer.plane, [offer.u, offer.w], stops | shut, dt));
        }
        let code = offer.motion.code;
        let stopped = stops & !offer.motion.is_tower();
        offer.motion = Motion { code: R::select(stopped, R::splat(Motion::<R>::STOPS), code) };
        let gives = Gives { lambda, flows: !(stops | shut), shut };
        gives.offers::<B, _>(&sides, &mut offer);
        gives.budget::<B, _, _>(&near, &sides, &mut offer);
        offer
    }

    /// The velocity after force and friction.
    #[inline(always)]
    fn accelerated<const D: usize, R: Real>(
        &self,
        here: &Cell<Flow<D, R>, B, F::Parameters<R>>,
        (plane, u, motion): (&B::Plane, [R; D], Motion<R>),
        law: &Resistance<R>,
        (sides, slopes): ([Sides<R>; D], Option<&Slopes<D, R>>),
        spacing: &Spacing<D, R>,
        dt: R,
    ) -> [R; D]
    where
        B: Bed<D, R>,
    {
        let zero = R::zero();
        let forces: [Downstream<R>; D] = per_axis!(k => sides[k].force(spacing.inv[k]));
        let (forces, unresolved) = centred(forces, law.dry);
        let pushed = pushed::<D, R, B>(plane, u, forces, dt);
        let slow = here.ground.square(u).le(unresolved * R::splat(spacing.smallest));
        let idle = R::select(slow & !motion.is_tower(), unresolved * R::splat(UNRESOLVED), zero);
        let mut dry = R::select(here.state.is_still(), law.holding, law.dry);
        let mut ahead = None;
        if let Some(slopes) = slopes
            && R::any(slopes.any)
        {
            let at_mid_time = self.resistance_at_mid_time(here, [u, pushed], slopes, law, (spacing.inv, dt));
            dry = R::select(slopes.any, at_mid_time, dry);
            ahead = Some((slopes.any, per_axis!(k => u[k] + (slopes.advected[k] + slopes.advected[k]))));
        }
        self.slowed(here, plane, (Resistance { dry, ..*law }, idle), pushed, ahead, dt)
    }

    /// The dry resistance at mid time: of the mean of the velocity before and after the push, moved on and shortened by what friction
    /// takes in half a step.
    #[inline(always)]
    fn resistance_at_mid_time<const D: usize, R: Real>(
        &self,
        here: &Cell<Flow<D, R>, B, F::Parameters<R>>,
        [u, pushed]: [[R; D]; 2],
        slopes: &Slopes<D, R>,
        law: &Resistance<R>,
        (per, dt): ([R; D], R),
    ) -> R
    where
        B: Bed<D, R>,
    {
        let (one, half) = (R::splat(1.0), R::splat(0.5));
        let mean: [R; D] = per_axis!(k => half * (u[k] + pushed[k]) + slopes.advected[k]);
        let speed = here.ground.square(mean).sqrt();
        let none = speed.le(R::zero());
        let keep = (one - half * dt * law.dry / R::select(none, one, speed)).positive_part();
        self.resistance(here, per_axis!(k => mean[k] * keep), per).dry
    }
}

/// What a cell of this order keeps of its ends.
pub(super) type EndsIn<const D: usize, R, const ORDER: u8> = <Order<ORDER> as EndsStorage>::Ends<D, R>;
