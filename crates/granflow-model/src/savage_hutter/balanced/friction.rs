//! Friction, clipped after the flux.

use super::slopes::{Order, SlopeStorage};
use super::variant::Balanced;
use crate::real::{Real, for_axis, largest, per_axis};
use crate::savage_hutter::Flow;
use crate::savage_hutter::friction::{Friction, kept};
use crate::savage_hutter::ground::Bed;

/// A cell after fluxes and pull, before friction.
#[derive(Clone, Copy)]
pub(super) struct Moved<const D: usize, R> {
    /// Its new depth.
    pub h: R,
    /// The depth under the source.
    pub depth: R,
    /// Its momentum.
    pub q: [R; D],
}

impl<F: Friction, B: Copy, const ORDER: u8> Balanced<F, B, ORDER>
where
    Order<ORDER>: SlopeStorage,
{
    /// The momentum that friction leaves: it stops and never reverses. `old` is the velocity before the step, `per` 1/dx.
    #[inline(always)]
    pub(super) fn slow<const D: usize, R: Real>(
        &self,
        bed: &B,
        state: &Flow<D, R>,
        Moved { h, depth, q: moved }: Moved<D, R>,
        old: [R; D],
        per: [R; D],
        dt: R,
    ) -> [R; D]
    where
        B: Bed<D, R>,
    {
        let zero = R::zero();
        let lambda: [R; D] = per_axis!(axis => dt * per[axis]);
        let thickness = bed.thickness(h).max(R::splat(f64::MIN_POSITIVE));
        let square = bed.square(old);
        let law = self.friction.resistance(thickness, square, bed.normal_load(old), bed.weight_at_rest());
        let still = state.is_still();
        let mut dry = law.dry;
        if R::any(still) {
            let resting = law.holding * R::splat(Self::SLACK) + bed.rounding(state.h, largest(per));
            dry = R::select(still, resting, dry);
        }
        let size = bed.square(moved).sqrt();
        let loss = dt * depth * dry;
        let left = size - loss;
        // Slower than before, and within a step not by the last place of its depth: it has stopped.
        let mut spent = (left * largest(lambda)).le(R::splat(1e-15) * h);
        if R::any(spent) {
            spent = spent & left.le(square.sqrt() * state.h);
        }
        let stops = left.le(zero) | spent | h.lt(R::splat(self.film));
        let mut keep = left / R::select(stops, R::splat(1.0), size);
        if R::any(!(law.drag + law.viscous).equals(zero)) {
            let speed = R::select(stops, zero, left / R::select(stops, R::splat(1.0), h));
            keep = keep * kept(law.viscous, law.drag, speed, dt);
        }
        let mut slowed: [R; D] = per_axis!(k => R::select(stops, zero, moved[k] * keep));
        if self.limited() {
            // Along the new velocity friction is first order in time where the flow turns. Where a step takes at most
            // a quarter of the momentum it acts along the old one, as in a forward-Euler step.
            let speed = square.sqrt();
            let taken = dt * depth * (law.dry + law.viscous * speed + law.drag * square);
            let far = (taken * R::splat(4.0)).lt(size) & !(still | stops | speed.le(zero));
            let share = taken / R::select(far, speed, R::splat(1.0));
            for_axis!(k in D => {
                slowed[k] = R::select(far, moved[k] - share * old[k], slowed[k]);
            });
        }
        slowed
    }
}
