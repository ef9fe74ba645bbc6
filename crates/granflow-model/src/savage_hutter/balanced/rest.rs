//! The forces on a cell that is at rest, or has a neighbour that is: when it holds itself.

use super::faces::Flux;
use super::variant::Balanced;
use crate::real::{Real, for_axis, per_axis, repeated};
use crate::savage_hutter::Flow;
use crate::savage_hutter::friction::Friction;
use crate::savage_hutter::ground::{Bed, Towards};
use crate::scheme::{Cell, Faces, Neighbours, Stencil};

/// PotentialJump of the free surface's potential towards both neighbours of an axis.
pub(super) struct PotentialJump<R> {
    pub(super) whole: [R; 2],
    /// Its part by thickness, which the flux between open cells carries as pressure.
    pub(super) weight: [R; 2],
    /// The rest.
    pub(super) bed_jump: [R; 2],
}

impl<F: Friction, B: Copy, const ORDER: u8> Balanced<F, B, ORDER> {
    /// A pull this much above the static bound still counts as held.
    pub(super) const SLACK: f64 = 1.0 + 1e-10;

    #[inline(always)]
    pub(super) fn is_dry<const D: usize, R: Real>(&self, h: R, bed: &B) -> R::Mask
    where
        B: Bed<D, R>,
    {
        h.lt(R::splat(self.film)) | bed.is_nodata()
    }

    /// Largest difference du of the velocity u + du, u - du at a cell's two faces, depths h - dh and h + dh there,
    /// with which at most twice h (|u| + c) leaves, c = sqrt(2 beta h): then dt (|u| + c)/dx <= 1/2 per sum over
    /// the axes keeps h >= 0.
    ///
    /// A half sends at most u+ + 0.21 c per depth. With du <= c + |u| (h - dh)/(h + dh) one face sends
    /// (h + dh)(|u| + du) <= 2 h (|u| + c), and two receding ones 2 h du + 2 dh |u| <= 2 h (|u| + c); 0.9 c leaves
    /// room for the thermal part. Without the bound four thin fast neighbours drain a cell twice over.
    #[inline(always)]
    pub(super) fn max_slope<R: Real>(h: R, dh: R, u: R, beta: R) -> R {
        let c = ((beta + beta) * h.positive_part()).sqrt();
        let sum = h + dh;
        let dry = sum.le(R::zero());
        let share = R::select(dry, R::zero(), (h - dh) / R::select(dry, R::splat(1.0), sum)).positive_part();
        R::splat(0.9) * c + u * share
    }

    /// At rest or bare.
    #[inline(always)]
    pub(super) fn is_at_rest_or_dry<const D: usize, R: Real>(&self, cell: &Cell<Flow<D, R>, B>) -> R::Mask
    where
        B: Bed<D, R>,
    {
        cell.state.is_still() | self.is_dry(cell.state.h, &cell.ground)
    }

    /// The rise towards a neighbour. A bare bed above the surface leans on nothing: it counts at most as the surface
    /// continued.
    #[inline(always)]
    pub(super) fn dry_neighbour<const D: usize, R: Real>(
        &self,
        there: &Cell<Flow<D, R>, B>,
        rise: R,
        opposite: R,
    ) -> R
    where
        B: Bed<D, R>,
    {
        let above = self.is_dry(there.state.h, &there.ground) & R::zero().lt(rise);
        R::select(above, rise.min((-opposite).positive_part()), rise)
    }

    /// Rises towards both neighbours of one axis where neither is bare.
    #[inline(always)]
    pub(super) fn wet_jump<const D: usize, R: Real>(
        near: &Neighbours<D, R, Flow<D, R>, B>,
        axis: usize,
    ) -> PotentialJump<R>
    where
        B: Bed<D, R>,
    {
        let Cell { state, ground, .. } = &near.here;
        let dx = near.spacing.size[axis];
        let (a, b) = (&near.lo[axis], &near.hi[axis]);
        let bed_jump = [
            ground.bed_jump(axis, Towards::Lo, &a.ground, dx),
            ground.bed_jump(axis, Towards::Hi, &b.ground, dx),
        ];
        let weight = [
            ground.pressure_jump(&a.ground, state.h, a.state.h),
            ground.pressure_jump(&b.ground, state.h, b.state.h),
        ];
        PotentialJump { whole: [bed_jump[0] + weight[0], bed_jump[1] + weight[1]], weight, bed_jump }
    }

    /// Rises towards both neighbours of one axis, as a resting cell counts them.
    #[inline(always)]
    pub(super) fn potential_jump<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B>,
        axis: usize,
    ) -> PotentialJump<R>
    where
        B: Bed<D, R>,
    {
        let rise = Self::wet_jump(near, axis);
        let (a, b) = (&near.lo[axis], &near.hi[axis]);
        let dry = [self.is_dry(a.state.h, &a.ground), self.is_dry(b.state.h, &b.ground)];
        if !R::any(dry[0] | dry[1]) {
            return rise;
        }
        let (out_lo, out_hi) = (a.ground.is_nodata(), b.ground.is_nodata());
        let zero = R::zero();
        let (lo, hi) = (R::select(out_lo, zero, rise.whole[0]), R::select(out_hi, zero, rise.whole[1]));
        let (bare_lo, bare_hi) = (self.dry_neighbour(a, lo, hi), self.dry_neighbour(b, hi, lo));
        // Outside the data the surface goes on as it comes; from one side only, there is no difference.
        let bare_lo = R::select(out_lo, -bare_hi, bare_lo);
        let bare_hi = R::select(out_hi, -bare_lo, bare_hi);
        let whole = [bare_lo, bare_hi];
        let weight = [R::select(out_lo, zero, rise.weight[0]), R::select(out_hi, zero, rise.weight[1])];
        let bed_jump: [R; 2] =
            per_axis!(side => R::select(dry[side], whole[side] - weight[side], rise.bed_jump[side]));
        PotentialJump { whole, weight, bed_jump }
    }
}

/// How a mass would stand in its cell at rest.
pub(super) struct StaticBalance<const D: usize, R> {
    /// The largest drop towards a neighbour, by the whole rise or by thickness alone, per axis.
    pub(super) drop: [R; D],
    /// F = -M grad(psi).
    pub(super) pull: [R; D],
    /// The static bound of |F|.
    pub(super) holding: R,
}

impl<F: Friction, B: Copy, const ORDER: u8> Balanced<F, B, ORDER> {
    /// Acceleration of a cell by the bed, and by thickness where the flux does not carry it, beside what passes its faces.
    #[inline(always)]
    pub(super) fn pull<const D: usize, R: Real>(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B>,
        bed: &B,
        faces: &[Faces<Flux<D, R>>; D],
        all_open: bool,
    ) -> [R; D]
    where
        B: Bed<D, R>,
    {
        let near = stencil.star();
        let (zero, per) = (R::zero(), near.spacing.inv);
        let [mut lo, mut hi, mut weight_lo, mut weight_hi]: [[R; D]; 4] =
            [repeated(zero), repeated(zero), repeated(zero), repeated(zero)];
        let mut bend: [R; D] = repeated(R::splat(1.0));
        for_axis!(axis in D => {
            let rise = if all_open { Self::wet_jump(&near, axis) } else { self.potential_jump(&near, axis) };
            [lo[axis], hi[axis]] = rise.bed_jump;
            [weight_lo[axis], weight_hi[axis]] = rise.weight;
            if !all_open {
                // The flux carries no pressure where a cell of the face is held, and what mends it goes with it.
                let (at_lo, at_hi) = (faces[axis].lo.class.is_held(), faces[axis].hi.class.is_held());
                lo[axis] = R::select(at_lo, rise.whole[0], lo[axis]);
                hi[axis] = R::select(at_hi, rise.whole[1], hi[axis]);
                weight_lo[axis] = R::select(at_lo, zero, weight_lo[axis]);
                weight_hi[axis] = R::select(at_hi, zero, weight_hi[axis]);
                let half = R::splat(0.5);
                bend[axis] = R::select(at_lo, zero, half) + R::select(at_hi, zero, half);
            }
        });
        let mut pull = bed.driving_force(lo, hi, per);
        if bed.uniform_driving_force().is_none() {
            let cross = bed.cross_force(weight_lo, weight_hi, per);
            for_axis!(k in D => {
                let change = bed.curvature_force(k, &near.lo[k].ground, &near.hi[k].ground, per[k]);
                pull[k] = pull[k] + cross[k] + change * near.here.state.h * bend[k];
            });
        }
        pull
    }

    #[inline(always)]
    pub(super) fn static_balance<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B>,
    ) -> StaticBalance<D, R>
    where
        B: Bed<D, R>,
    {
        let mut near = *near;
        near.here.ground = near.here.ground.exact();
        for_axis!(axis in D => {
            near.lo[axis].ground = near.lo[axis].ground.exact();
            near.hi[axis].ground = near.hi[axis].ground.exact();
        });
        let Cell { state, ground, .. } = &near.here;
        let zero = R::zero();
        let [mut lo, mut hi, mut drop]: [[R; D]; 3] = [repeated(zero), repeated(zero), repeated(zero)];
        for_axis!(axis in D => {
            let PotentialJump { whole: [a, b], weight: [c, d], .. } = self.potential_jump(&near, axis);
            (lo[axis], hi[axis]) = (a, b);
            drop[axis] = (-a).min(-c).max((-b).min(-d));
        });
        let at_rest = ground.weight_at_rest();
        let thickness = ground.thickness(state.h).max(R::splat(f64::MIN_POSITIVE));
        let holding = self.friction.resistance(thickness, zero, at_rest, at_rest).holding;
        StaticBalance { drop, pull: ground.driving_force(lo, hi, near.spacing.inv), holding }
    }
}
