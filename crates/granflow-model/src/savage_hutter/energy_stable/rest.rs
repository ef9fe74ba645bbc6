//! When a cell at rest holds itself.

use super::force::{Downstream, UNRESOLVED, centred, continued, pushed};
use super::variant::EnergyStable;
use crate::real::{Real, for_axis, per_axis, repeated};
use crate::savage_hutter::Flow;
use crate::savage_hutter::friction::LocalFriction;
use crate::savage_hutter::ground::Bed;
use crate::scheme::{Cell, Neighbours, Stencil};

/// A tower stands over a neighbour by this share of what friction holds: without it the last excess leaks in ever smaller parts.
pub(super) const TOWER: f64 = 1.01;

impl<F: LocalFriction, B: Copy, const ORDER: u8> EnergyStable<F, B, ORDER> {
    /// Does a cell at rest hold itself, and if not, is it a tower: pulled no more than the static bound `holding`, yet above a
    /// neighbour by more, by its surface and by its thickness?
    #[inline(always)]
    pub(super) fn balance<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B, F::Parameters<R>>,
        holding: R,
    ) -> (R::Mask, R::Mask)
    where
        B: Bed<D, R>,
    {
        let (size, zero) = (near.spacing.size, R::zero());
        let ground = near.here.ground.exact();
        let h = near.here.state.h;
        let (surface, mut tower) = (ground.surface(h, size), zero.lt(zero));
        let mut pull: [R; D] = repeated(zero);
        for_axis!(axis in D => {
            let bound = holding * size[axis] * B::stretch_in(&ground.plane(), axis) * R::splat(TOWER);
            let there = [&near.lo[axis], &near.hi[axis]];
            let beds: [B; 2] = per_axis!(side => there[side].ground.exact());
            let outside: [R::Mask; 2] = [beds[0].is_nodata(), beds[1].is_nodata()];
            let surfaces: [B::Surface; 2] = [
                beds[0].surface(there[0].state.h, size),
                beds[1].surface(there[1].state.h, size),
            ];
            let rise = [-B::rise(axis, [&surfaces[0], &surface]), B::rise(axis, [&surface, &surfaces[1]])];
            let rise: [R; 2] = per_axis!(side => R::select(outside[side], zero, rise[side]));
            let stands: [R::Mask; 2] = per_axis!(side => {
                let thicker = -ground.pressure_jump(&beds[side], h, there[side].state.h);
                bound.lt((-rise[side]).min(thicker)) & !outside[side]
            });
            tower = tower | stands[0] | stands[1];
            pull[axis] = Downstream::of(self.leaning(there, rise), near.spacing.inv[axis]).mean;
        });
        let square = ground.square(B::metric(&ground.plane(), pull));
        let within = square.le(holding * holding);
        (within & !tower, within & tower)
    }

    /// The rise to a neighbour; to a bare bed above the surface at most as the surface goes on, `opposite` being the rise to the other.
    #[inline(always)]
    fn counted<const D: usize, R: Real>(
        &self,
        there: &Cell<Flow<D, R>, B, F::Parameters<R>>,
        rise: R,
        opposite: R,
    ) -> R
    where
        B: Bed<D, R>,
    {
        let above = self.is_dry(there) & R::zero().lt(rise);
        R::select(above, rise.min((-opposite).positive_part()), rise)
    }

    /// The rises of psi as a cell at rest counts them: a bare bed above the surface leans on nothing, and counts at most as the surface
    /// continued; outside the data the surface goes on as it comes.
    #[inline(always)]
    fn leaning<const D: usize, R: Real>(
        &self,
        there: [&Cell<Flow<D, R>, B, F::Parameters<R>>; 2],
        [lo, hi]: [R; 2],
    ) -> [R; 2]
    where
        B: Bed<D, R>,
    {
        let (from_lo, from_hi) = (self.counted(there[0], lo, hi), self.counted(there[1], hi, lo));
        let lo = R::select(there[0].ground.is_nodata(), -from_hi, from_lo);
        let hi = R::select(there[1].ground.is_nodata(), -lo, from_hi);
        [lo, hi]
    }

    /// The pull on a cell at rest as a share of what holds it: friction, and what the grid does not resolve; a pit holds by itself.
    #[inline(always)]
    pub(super) fn pull_at_rest<const D: usize, R: Real>(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B, F::Parameters<R>>,
    ) -> R
    where
        B: Bed<D, R>,
    {
        let (near, zero, one) = (stencil.star(), R::zero(), R::splat(1.0));
        let here = Cell { ground: near.here.ground.exact(), ..near.here };
        let bed = here.ground;
        let (size, per) = (near.spacing.size, near.spacing.inv);
        let law = self.resistance(&here, repeated(zero), per);
        let surface = bed.surface(near.here.state.h, size);
        let forces: [[Downstream<R>; 2]; D] = per_axis!(axis => {
            let there = [&near.lo[axis], &near.hi[axis]];
            let surfaces: [B::Surface; 2] =
                per_axis!(side => there[side].ground.exact().surface(there[side].state.h, size));
            let rise = [-B::rise(axis, [&surfaces[0], &surface]), B::rise(axis, [&surface, &surfaces[1]])];
            let outside = [there[0].ground.is_nodata(), there[1].ground.is_nodata()];
            let rise: [R; 2] = per_axis!(side => R::select(outside[side], zero, rise[side]));
            let goes_on = continued(rise, outside, [self.is_dry(there[0]), self.is_dry(there[1])]);
            [Downstream::of(goes_on, per[axis]), Downstream::of(self.leaning(there, rise), per[axis])]
        });
        // As a step from rest would push it, per time; or it holds itself by the mean forces.
        let plane = bed.plane();
        let (centred, unresolved) = centred(per_axis!(k => forces[k][0]), law.dry);
        let pushed = pushed::<D, R, B>(&plane, repeated(zero), centred, one);
        let pulls = [pushed, B::metric(&plane, per_axis!(k => forces[k][1].mean))];
        let pulls: [R; 2] = per_axis!(of => B::square_in(&plane, pulls[of]).sqrt());
        let bounds = [law.holding + unresolved * R::splat(UNRESOLVED), law.holding];
        let none = self.is_dry(&near.here) | law.dry.le(zero);
        let shares: [R; 2] = per_axis!(of => pulls[of] / R::select(none, one, bounds[of]));
        R::select(none, zero, shares[0].min(shares[1]))
    }
}
