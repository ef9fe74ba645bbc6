//! The pointwise functions of the scheme.

use super::ends::EndsStorage;
use super::faces::{FaceStatesOf, Flux};
use super::flux::flux;
use super::forecast::Forecast;
use super::reconstruct::EndsIn;
use super::variant::EnergyStable;
use crate::real::{Real, largest, per_axis, total};
use crate::savage_hutter::balanced::Order;
use crate::savage_hutter::friction::LocalFriction;
use crate::savage_hutter::ground::Bed;
use crate::savage_hutter::{Flow, normal};
use crate::scheme::{Cell, Diagnostics, Faces, Forecasts, Scheme, SchemeVisitor, Side, Spacing, Stencil};
use crate::time::{EULER, Stages};

/// A cell keeps less than the books allow by this share, so that the energy falls in every step in which anything moves.
const LOST: f64 = 1e-6;

impl<F: LocalFriction, const D: usize, R: Real, B: Bed<D, R>, const ORDER: u8> Scheme<D, R>
    for EnergyStable<F, B, ORDER>
where
    Order<ORDER>: EndsStorage,
{
    type State = Flow<D, R>;
    type Ground = B;
    type Forcing = F::Parameters<R>;
    type Primitives = ();
    type Forecast = Forecast<D, R, B::Surface>;
    type FaceStates = FaceStatesOf<D, R, B, EndsIn<D, R, ORDER>>;
    type Flux = Flux<D, R>;
    type Corner = ();

    const REFUSES_LONG_STEPS: bool = true;

    fn usual_forcing(&self) -> F::Parameters<R> {
        self.friction.parameters()
    }
    fn stages(&self) -> Stages {
        EULER
    }
    /// 1: beyond, cells would give more than they hold, and what keeps them from it brakes the flow.
    fn max_courant(&self) -> f64 {
        1.0
    }
    /// 0.9, and 0.7 at second order: beyond, the limiter cuts strong shocks.
    fn suggested_courant(&self) -> f64 {
        if self.second { 0.7 } else { 0.9 }
    }

    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output {
        if self.second {
            visitor.visit(&self.of_order::<B::On<L>, 2>())
        } else {
            visitor.visit(&self.of_order::<B::On<L>, 1>())
        }
    }

    #[inline(always)]
    fn primitives(&self, _here: &Cell<Flow<D, R>, B, F::Parameters<R>>) {}
    #[inline(always)]
    fn forecast(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B, F::Parameters<R>>,
        dt: R,
    ) -> Self::Forecast {
        self.foresee(stencil, dt)
    }
    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B, F::Parameters<R>>,
        _: &(),
        forecasts: &Forecasts<D, Self::Forecast>,
        dt: R,
    ) -> Self::FaceStates {
        self.offer(stencil, forecasts, dt)
    }
    #[inline(always)]
    fn flux(&self, axis: usize, left: &Self::FaceStates, right: &Self::FaceStates, lambda: R) -> Flux<D, R> {
        flux::<D, R, B, _>(axis, [left, right], lambda)
    }
    #[inline(always)]
    fn corner(&self, _around: [[&Self::FaceStates; 2]; 2]) {}

    #[inline(always)]
    fn update(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B, F::Parameters<R>>,
        face_states: &Self::FaceStates,
        faces: &[Faces<Flux<D, R>>; D],
        _corners: &[[(); 2]; 2],
        _dt: R,
    ) -> Flow<D, R> {
        let (zero, half, h) = (R::zero(), R::splat(0.5), stencil.at([0; D]).state.h);
        let gone = total::<D, R>(per_axis!(axis => faces[axis].hi.mass - faces[axis].lo.mass));
        let energy = total::<D, R>(per_axis!(axis => faces[axis].hi.energy[0] - faces[axis].lo.energy[1]));
        let q: [R; D] = per_axis!(k => {
            let lost: [R; D] = per_axis!(axis => faces[axis].hi.left[k] - faces[axis].lo.right[k]);
            h * face_states.w[k] - total(lost)
        });
        let left = normal(h - gone);
        let film = left.lt(R::splat(self.film));
        let kinetic = h * (half * B::square_in(&face_states.plane, face_states.u));
        let allowed = ((kinetic - half * face_states.head * (gone * gone)) - energy) * R::splat(1.0 - LOST);
        // No more than the head that there is.
        let psi = B::potential(&face_states.surface) - face_states.head * gone;
        let allowed = allowed.min(left * (R::splat(self.ceiling) - psi).positive_part());
        // |q|^2/(2 h) <= allowed
        let (square, most) = (B::square_in(&face_states.plane, q), (left + left) * allowed.positive_part());
        let over = most.lt(square);
        let mut keep = R::splat(1.0);
        if R::any(over) {
            keep = R::select(over, (most / R::select(over, square, R::splat(1.0))).sqrt(), keep);
        }
        Flow { h: left, q: per_axis!(k => R::select(film, zero, q[k] * keep)) }
    }

    fn mirror(&self, axis: usize, state: &Flow<D, R>) -> Flow<D, R> {
        state.mirror(axis)
    }
    fn mirror_ground(&self, axis: usize, ground: &B) -> B {
        ground.mirror(axis)
    }
    /// sum over axes of (|u| + sqrt(2 beta h))/dx, and at least sqrt(5 g/dx): no fall from rest takes a tenth of a cell in a step. A
    /// film never sets the step.
    #[inline(always)]
    fn rate(&self, here: &Cell<Flow<D, R>, B, F::Parameters<R>>, spacing: &Spacing<D, R>) -> R {
        let fall = (R::splat(5.0) * here.ground.gravity() * largest(spacing.inv)).sqrt();
        let rate = here.state.rate(&here.ground, spacing.inv).max(fall);
        R::select(here.state.h.lt(R::splat(self.film)), R::zero(), rate)
    }
    /// q = 0: a cell that a step leaves at rest and unchanged, every later step leaves so.
    #[inline(always)]
    fn is_static(&self, here: &Cell<Flow<D, R>, B, F::Parameters<R>>) -> R::Mask {
        here.state.is_still() | self.is_dry(here)
    }
    #[inline(always)]
    fn is_nodata(&self, ground: &B) -> R::Mask {
        ground.is_nodata()
    }
    #[inline(always)]
    fn outflow(&self, flux: &Flux<D, R>, _side: Side, _lambda: R) -> R {
        flux.mass
    }
    fn yield_ratio(&self, stencil: &impl Stencil<D, R, Flow<D, R>, B, F::Parameters<R>>) -> R {
        self.pull_at_rest(stencil)
    }
    #[inline(always)]
    fn diagnostics(&self, here: &Cell<Flow<D, R>, B, F::Parameters<R>>) -> Diagnostics<R> {
        here.state.diagnostics(&here.ground, R::splat(self.film))
    }
}
