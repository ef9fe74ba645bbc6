//! Friction on the velocity that the surface gave: it stops and never reverses.

use super::variant::EnergyStable;
use crate::real::{Real, largest, per_axis};
use crate::savage_hutter::Flow;
use crate::savage_hutter::friction::{LocalFriction, Resistance};
use crate::savage_hutter::ground::Bed;
use crate::scheme::Cell;

/// What friction leaves of a velocity is rounding below this share of what it takes.
const ROUNDING: f64 = 1e-12;

impl<F: LocalFriction, B, const ORDER: u8> EnergyStable<F, B, ORDER> {
    /// A pull this much above the static bound still counts as held.
    const SLACK: f64 = 1.0 + 1e-10;

    /// The resistance of a cell at velocity `u`, the static bound with slack and rounding; `per` is 1/dx. Its ground is [`Bed::exact`].
    #[inline(always)]
    pub(super) fn resistance<const D: usize, R: Real>(
        &self,
        Cell { state: Flow { h, .. }, ground: bed, forcing }: &Cell<Flow<D, R>, B, F::Parameters<R>>,
        u: [R; D],
        per: [R; D],
    ) -> Resistance<R>
    where
        B: Bed<D, R>,
    {
        let (square, load) = (bed.square(u), bed.normal_load(u));
        let law = self.friction.resistance_with(
            forcing,
            Self::thickness(bed, *h),
            square,
            load,
            bed.weight_at_rest(),
        );
        Resistance { holding: law.holding * R::splat(Self::SLACK) + bed.rounding(*h, largest(per)), ..law }
    }

    /// The thickness that the law is asked about.
    #[inline(always)]
    fn thickness<const D: usize, R: Real>(bed: &B, h: R) -> R
    where
        B: Bed<D, R>,
    {
        bed.thickness(h).max(R::splat(f64::MIN_POSITIVE))
    }

    /// What friction leaves of `pushed`; exactly 0 where it stops the cell, or leaves no more than an acceleration `idle` or than its
    /// own rounding. Where the flow is smooth it acts along the velocity at mid time, `pushed` + x `ahead`, x falling to 0 where it
    /// takes half of the speed.
    #[inline(always)]
    pub(super) fn slowed<const D: usize, R: Real>(
        &self,
        Cell { state, ground, forcing }: &Cell<Flow<D, R>, B, F::Parameters<R>>,
        plane: &B::Plane,
        (law, idle): (Resistance<R>, R),
        pushed: [R; D],
        ahead: Option<(R::Mask, [R; D])>,
        dt: R,
    ) -> [R; D]
    where
        B: Bed<D, R>,
    {
        let (zero, one) = (R::zero(), R::splat(1.0));
        let size = B::square_in(plane, pushed).sqrt();
        let dry = law.dry;
        let loss = dt * dry;
        let left = size - loss;
        let stops = left.le(dt * idle.max(dry * R::splat(ROUNDING)));
        let per = one / R::select(stops, one, size);
        let mut slowed: [R; D] = per_axis!(k => pushed[k] * (left * per));
        if let Some((smooth, ahead)) = ahead
            && R::any(smooth)
        {
            let x = (one - (loss + loss) * per).positive_part();
            let along: [R; D] = per_axis!(k => pushed[k] + x * ahead[k]);
            let length = B::square_in(plane, along).sqrt();
            let none = length.le(zero);
            let share = loss / R::select(none, one, length);
            let turns = smooth & !none;
            slowed = per_axis!(k => R::select(turns, pushed[k] - share * along[k], slowed[k]));
        }
        let thickness = Self::thickness(ground, state.h);
        let keep = self.friction.kept(forcing, &law, thickness, R::select(stops, zero, left), dt);
        per_axis!(k => R::select(stops, zero, slowed[k] * keep))
    }
}
