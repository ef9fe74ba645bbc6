//! The pointwise functions of the scheme.

use super::faces::{CellClass, FaceStates, Flux};
use super::friction::Moved;
use super::reconstruct::{FaceStatesOf, SlopesOf};
use super::rest::StaticBalance;
use super::slopes::{CellSlopes, Order, SlopeStorage};
use super::variant::Balanced;
use crate::real::{Real, for_axis, largest, per_axis, repeated, total};
use crate::savage_hutter::flux::{Density, Half};
use crate::savage_hutter::friction::Friction;
use crate::savage_hutter::ground::{Bed, Towards};
use crate::savage_hutter::{Flow, normal};
use crate::scheme::{Cell, Diagnostics, Faces, Forecasts, Scheme, SchemeVisitor, Side, Spacing, Stencil};
use crate::time::{EULER, SSP_RK2, Stages};
use core::marker::PhantomData;

impl<F: Friction, const D: usize, R: Real, B: Bed<D, R>, const ORDER: u8> Scheme<D, R>
    for Balanced<F, B, ORDER>
where
    Order<ORDER>: SlopeStorage,
{
    type State = Flow<D, R>;
    type Ground = B;
    type Forcing = ();
    type Primitives = [Density<R>; D];
    type Forecast = ();
    type FaceStates = FaceStatesOf<D, R, B, ORDER>;
    type Flux = Flux<D, R>;
    type Corner = ();

    /// Euler's method at first order, else [`SSP_RK2`].
    fn stages(&self) -> Stages {
        if self.slopes { SSP_RK2 } else { EULER }
    }
    /// 1 at first order, else 1/2: the depth stays positive.
    fn max_courant(&self) -> f64 {
        if self.slopes { 0.5 } else { 1.0 }
    }

    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output {
        let Balanced { friction, film, slopes, .. } = *self;
        if slopes {
            visitor.visit(&Balanced::<F, B::On<L>, 2> { friction, film, slopes, bed: PhantomData })
        } else {
            visitor.visit(&Balanced::<F, B::On<L>, 1> { friction, film, slopes, bed: PhantomData })
        }
    }

    #[inline(always)]
    fn primitives(&self, Cell { state, ground, .. }: &Cell<Flow<D, R>, B>) -> [Density<R>; D] {
        if self.limited() {
            // The halves are those of the cell's ends; here only the velocity is needed.
            let u = state.velocity();
            return per_axis!(axis => Density::mean(u[axis]));
        }
        per_axis!(axis => Density::new(state.h.positive_part(), state.q[axis], ground.beta(axis)))
    }

    #[inline(always)]
    fn forecast(&self, _stencil: &impl Stencil<D, R, Flow<D, R>, B>, _dt: R) {}
    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B>,
        primitives: &[Density<R>; D],
        _forecasts: &Forecasts<D, ()>,
        dt: R,
    ) -> Self::FaceStates {
        let near = stencil.star();
        let Cell { state, ground, .. } = near.here;
        let per = near.spacing.inv;
        let u: [R; D] = per_axis!(axis => primitives[axis].u);
        let dry = self.is_dry(state.h, &ground);
        let mut face_states = FaceStates {
            h: state.h,
            u,
            slopes: repeated(SlopesOf::<D, R, ORDER>::none()),
            half: repeated([Half::none(), Half::none()]),
            plane: ground.plane(),
            class: CellClass::dry(dry),
        };
        let at_rest_or_dry = dry | state.is_still();
        let mut closed = dry;
        if R::any(at_rest_or_dry) {
            let still = at_rest_or_dry & !dry;
            if R::any(still) {
                let static_balance = self.static_balance(&near);
                let bound =
                    static_balance.holding * R::splat(Self::SLACK) + ground.rounding(state.h, largest(per));
                let mut held = ground.square(static_balance.pull).le(bound * bound) & still;
                // A symmetric tower pulls nowhere, yet falls: bound the drop towards each neighbour too.
                for_axis!(axis in D => {
                    let limit = bound * near.spacing.size[axis] * ground.stretch(axis);
                    held = held & static_balance.drop[axis].le(limit);
                });
                face_states.class = face_states.class.held(held);
                closed = closed | held;
            }
            // A held cell and a dry one give nothing.
            if !R::any(!closed) {
                return face_states;
            }
        }
        for_axis!(axis in D => {
            if self.limited() {
                self.limited_slopes(&near, u, axis, &mut face_states);
            } else {
                face_states.half[axis] = primitives[axis].halves(state.h.positive_part());
            }
        });
        if self.limited() {
            face_states.keep_positive(per_axis!(axis => dt * per[axis]));
        }
        if R::any(closed) {
            for_axis!(axis in D => {
                face_states.slopes[axis] = face_states.slopes[axis].only(!closed);
                face_states.half[axis] = per_axis!(side => face_states.half[axis][side].only(!closed));
            });
        }
        face_states
    }

    #[inline(always)]
    fn flux(&self, axis: usize, left: &Self::FaceStates, right: &Self::FaceStates, _lambda: R) -> Flux<D, R> {
        let (zero, one) = (R::zero(), R::splat(1.0));
        let (half_a, half_b) = (left.half[axis][1], right.half[axis][0]);
        let class = left.class.and(right.class);
        let mut flux = Flux { mass: zero, left: repeated(zero), right: repeated(zero), class };
        let all_open = !R::any(!class.is_open());
        if all_open || R::any(left.class.is_open() | right.class.is_open()) {
            let u_a = left.slopes[axis].velocity(Towards::Hi, left.u);
            let u_b = right.slopes[axis].velocity(Towards::Lo, right.u);
            let both = half_a.push + half_b.push;
            let (mut share_a, mut share_b, mut push_a, mut push_b) = (one, one, both, both);
            if !all_open {
                let (left_held, right_held) = (left.class.is_held(), right.class.is_held());
                // Into a held cell goes only what is carried there, the rest of the density is reflected. It feels its
                // neighbours' thickness through its pull; of the flux it takes the impact.
                share_a = R::select(right_held, left.advected_share(axis, Towards::Hi), one);
                share_b = R::select(left_held, right.advected_share(axis, Towards::Lo), one);
                let reflected_a = R::select(right_held, half_a.reflected(u_a[axis], share_a), both);
                let reflected_b = R::select(left_held, half_b.reflected(u_b[axis], share_b), both);
                push_a = R::select(left_held, zero, reflected_a);
                push_b = R::select(right_held, zero, reflected_b);
            }
            let (mass_a, mass_b) = (half_a.mass * share_a, half_b.mass * share_b);
            let [turned_a, turned_b] = B::parallel_transport([u_a, u_b], [&left.plane, &right.plane]);
            flux.mass = mass_a + mass_b;
            for_axis!(k in D => {
                flux.left[k] = mass_a * u_a[k] + mass_b * turned_b[k];
                flux.right[k] = mass_a * turned_a[k] + mass_b * u_b[k];
            });
            flux.left[axis] = flux.left[axis] + push_a;
            flux.right[axis] = flux.right[axis] + push_b;
        }
        flux
    }

    #[inline(always)]
    fn corner(&self, _around: [[&Self::FaceStates; 2]; 2]) {}
    #[inline(always)]
    fn update(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B>,
        face_states: &Self::FaceStates,
        faces: &[Faces<Flux<D, R>>; D],
        _corners: &[[(); 2]; 2],
        dt: R,
    ) -> Flow<D, R> {
        let Cell { state, ground, .. } = stencil.at([0; D]);
        let (bed, spacing) = (ground.exact(), stencil.spacing());
        let (zero, per) = (R::zero(), spacing.inv);
        let Flow { h, q } = state;
        let lambda: [R; D] = per_axis!(axis => dt * per[axis]);
        let gone =
            total::<D, R>(per_axis!(axis => lambda[axis] * (faces[axis].hi.mass - faces[axis].lo.mass)));
        let lost: [R; D] = per_axis!(k => {
            let lost: [R; D] = per_axis!(axis => lambda[axis] * (faces[axis].hi.left[k] - faces[axis].lo.right[k]));
            total(lost)
        });
        let classes = total::<D, R>(per_axis!(axis => faces[axis].lo.class.code + faces[axis].hi.class.code));
        let open = classes.equals(zero);
        let all_open = !R::any(!open);
        let mut at_rest_or_dry = None;
        if !all_open {
            // What holds itself or is bare, and is not touched, stays: leave out the work.
            let mut stays = !face_states.class.is_open() & gone.equals(zero);
            for_axis!(k in D => {
                stays = stays & lost[k].equals(zero) & q[k].equals(zero);
            });
            if !R::any(!stays) {
                return state;
            }
            at_rest_or_dry = Some(stays);
        }
        // One difference of symmetric sums: the axes can be exchanged to the last bit.
        let new = normal(h - gone);
        let mut moved: [R; D] = per_axis!(k => q[k] - lost[k]);
        // The depth under the source: the new one keeps draining cells bounded; at second order the old one
        // keeps the map a forward-Euler step wherever the depth does not halve.
        let depth = if self.limited() { h.min(new + new) } else { new }.positive_part();
        let pull = match bed.uniform_driving_force() {
            Some(slide) if all_open => slide,
            slide => {
                let pull = self.pull(stencil, &bed, faces, all_open);
                slide.map_or(pull, |slide| per_axis!(k => R::select(open, slide[k], pull[k])))
            }
        };
        for_axis!(k in D => {
            moved[k] = moved[k] + dt * depth * pull[k];
        });

        let slowed = self.slow(&bed, &state, Moved { h: new, depth, q: moved }, face_states.u, per, dt);
        match at_rest_or_dry {
            None => Flow { h: new, q: slowed },
            Some(at_rest_or_dry) => Flow {
                h: R::select(at_rest_or_dry, h, new),
                q: per_axis!(k => R::select(at_rest_or_dry, q[k], slowed[k])),
            },
        }
    }

    fn mirror(&self, axis: usize, state: &Flow<D, R>) -> Flow<D, R> {
        state.mirror(axis)
    }
    fn mirror_ground(&self, axis: usize, ground: &B) -> B {
        ground.mirror(axis)
    }
    /// A film never sets the step.
    #[inline(always)]
    fn rate(&self, here: &Cell<Flow<D, R>, B>, spacing: &Spacing<D, R>) -> R {
        let rate = here.state.rate(&here.ground, spacing.inv);
        R::select(here.state.h.lt(R::splat(self.film)), R::zero(), rate)
    }
    /// A cell whose last stage ended at rest is at rest; its depth is the average.
    #[inline(always)]
    fn rk_combine(&self, keep: R, old: &Flow<D, R>, new: &Flow<D, R>) -> Flow<D, R> {
        let give = R::splat(1.0) - keep;
        let stopped = new.is_still();
        Flow {
            h: keep * old.h + give * new.h,
            q: per_axis!(k => R::select(stopped, R::zero(), keep * old.q[k] + give * new.q[k])),
        }
    }
    /// q = 0: a cell that a step leaves at rest and unchanged, every later step leaves so. Not only held cells: where the
    /// surface or the bed bends, the pull by central differences may exceed the bound, or the drop to one neighbour,
    /// while the forces through the faces do not, and held neighbours take nothing from it.
    #[inline(always)]
    fn is_static(&self, here: &Cell<Flow<D, R>, B>) -> R::Mask {
        self.is_at_rest_or_dry(here)
    }
    #[inline(always)]
    fn is_nodata(&self, ground: &B) -> R::Mask {
        ground.is_nodata()
    }
    #[inline(always)]
    fn outflow(&self, flux: &Flux<D, R>, _side: Side, lambda: R) -> R {
        lambda * flux.mass
    }
    fn yield_ratio(&self, stencil: &impl Stencil<D, R, Flow<D, R>, B>) -> R {
        let near = stencil.star();
        let StaticBalance { pull, holding, .. } = self.static_balance(&near);
        let dry = self.is_dry(near.here.state.h, &near.here.ground);
        let none = dry | holding.le(R::zero());
        let share = near.here.ground.square(pull).sqrt() / R::select(none, R::splat(1.0), holding);
        R::select(none, R::zero(), share)
    }
    #[inline(always)]
    fn diagnostics(&self, here: &Cell<Flow<D, R>, B>) -> Diagnostics<R> {
        here.state.diagnostics(&here.ground, R::splat(self.film))
    }
}
