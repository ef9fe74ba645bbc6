//! Friction on the velocity that the surface gave: it stops and never reverses.

use super::variant::EnergyStable;
use crate::real::{Real, largest, per_axis};
use crate::savage_hutter::friction::{Friction, Resistance};
use crate::savage_hutter::ground::Bed;

impl<F: Friction, B> EnergyStable<F, B> {
    /// A pull this much above the static bound still counts as held.
    const SLACK: f64 = 1.0 + 1e-10;

    /// The resistance of a cell of depth `h` and velocity `u`, the static bound with slack and rounding; `per` is 1/dx.
    #[inline(always)]
    pub(super) fn resistance<const D: usize, R: Real>(
        &self,
        bed: &B,
        h: R,
        u: [R; D],
        per: [R; D],
    ) -> Resistance<R>
    where
        B: Bed<D, R>,
    {
        let thickness = bed.thickness(h).max(R::splat(f64::MIN_POSITIVE));
        let law =
            self.friction.resistance(thickness, bed.square(u), bed.normal_load(u), bed.weight_at_rest());
        Resistance { holding: law.holding * R::splat(Self::SLACK) + bed.rounding(h, largest(per)), ..law }
    }

    /// What friction leaves of `pushed`; exactly 0 where it stops the cell, where it leaves no more than an acceleration `idle`, and
    /// where the rest would not move it by the last place of a cell's size in this step.
    #[inline(always)]
    pub(super) fn slowed<const D: usize, R: Real>(
        plane: &B::Plane,
        [dry, drag, idle]: [R; 3],
        pushed: [R; D],
        lambda: [R; D],
        dt: R,
    ) -> [R; D]
    where
        B: Bed<D, R>,
    {
        let (zero, one) = (R::zero(), R::splat(1.0));
        let size = B::square_in(plane, pushed).sqrt();
        let left = size - dt * dry;
        let stops = left.le(dt * idle) | (left * largest(lambda)).lt(R::splat(1e-15));
        let mut keep = left / R::select(stops, one, size);
        if R::any(!drag.equals(zero)) {
            // v + dt drag v^2 = left, solved for v: the part that grows with the square, implicitly.
            let z = R::select(stops, zero, dt * drag * left);
            keep = keep * (R::splat(2.0) / (one + (one + R::splat(4.0) * z).sqrt()));
        }
        per_axis!(k => R::select(stops, zero, pushed[k] * keep))
    }
}
