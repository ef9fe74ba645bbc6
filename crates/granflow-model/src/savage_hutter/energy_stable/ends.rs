//! The two ends of a cell along an axis, in a smooth flow: second order in space and time.

use super::sides::Sides;
use crate::limiter;
use crate::real::{Real, for_axis, per_axis, repeated, total};
use crate::savage_hutter::Flow;
use crate::savage_hutter::balanced::Order;
use crate::savage_hutter::ground::Bed;
use crate::scheme::{Components, Neighbours, components};

/// How far a slope may exceed a one-sided difference: a steeper one makes shocks that the limiter of the energy cuts.
const STEEPEST: f64 = 1.1;

/// What a cell of second order offers beside its values, at mid time. Along an axis whose faces both flow freely it is smooth and has
/// slopes; along others it has none, and its faces there are of first order.
#[derive(Clone, Copy, Debug)]
pub struct Ends<const D: usize, R: Real> {
    /// 1 along a smooth axis, else 0.
    pub(super) smooth: [R; D],
    /// Depth and velocity in the middle.
    pub(super) h: R,
    pub(super) v: [R; D],
    /// What h, psi, and the velocity along the axis differ by from end to end.
    rise_h: [R; D],
    rise_psi: [R; D],
    rise_speed: [R; D],
    /// And the velocity, in the plane of the cell.
    rise_v: [[R; D]; D],
    /// The velocity that bed and friction gave in the step: what comes or leaves takes half of it.
    pub(super) given: [R; D],
}

components!([const D: usize, R: Real] Ends<D, R> {
    smooth: [R; D], h: R, v: [R; D], rise_h: [R; D], rise_psi: [R; D], rise_speed: [R; D], rise_v: [[R; D]; D], given: [R; D]
});

/// Half of `rise` towards the lower or the upper end.
#[inline(always)]
fn towards<R: Real>(side: usize, rise: R) -> R {
    rise * R::splat(if side == 0 { -0.5 } else { 0.5 })
}

impl<const D: usize, R: Real> Ends<D, R> {
    /// Depth at an end of a cell of depth `h`.
    #[inline(always)]
    pub(super) fn depth(&self, axis: usize, side: usize, h: R) -> R {
        (self.h + towards(side, self.rise_h[axis])).positive_part().min(h + h)
    }
    /// psi there less that of the cell before the step.
    #[inline(always)]
    pub(super) fn psi(&self, axis: usize, side: usize, gain: R) -> R {
        gain + towards(side, self.rise_psi[axis])
    }
    /// The velocity along the axis there, which moves the mass.
    #[inline(always)]
    pub(super) fn speed(&self, axis: usize, side: usize) -> R {
        self.v[axis] + towards(side, self.rise_speed[axis])
    }
    /// The velocity there, which is carried.
    #[inline(always)]
    pub(super) fn velocity(&self, axis: usize, side: usize) -> [R; D] {
        per_axis!(k => self.v[k] + towards(side, self.rise_v[axis][k]))
    }
}

/// The [`Ends`] of a scheme: none, if it is of first order.
pub trait EndsOf<const D: usize, R: Real>: Components<R> {
    /// Without slopes.
    fn none() -> Self;
    /// These.
    fn of(ends: Ends<D, R>) -> Self;
    /// They, if there are any.
    fn get(&self) -> Option<&Ends<D, R>>;
}

impl<const D: usize, R: Real> EndsOf<D, R> for () {
    #[inline(always)]
    fn none() {}
    #[inline(always)]
    fn of(_ends: Ends<D, R>) {}
    #[inline(always)]
    fn get(&self) -> Option<&Ends<D, R>> {
        None
    }
}

impl<const D: usize, R: Real> EndsOf<D, R> for Ends<D, R> {
    #[inline(always)]
    fn none() -> Self {
        let zero = R::zero();
        Ends {
            smooth: repeated(zero),
            h: zero,
            v: repeated(zero),
            rise_h: repeated(zero),
            rise_psi: repeated(zero),
            rise_speed: repeated(zero),
            rise_v: repeated(repeated(zero)),
            given: repeated(zero),
        }
    }
    #[inline(always)]
    fn of(ends: Ends<D, R>) -> Self {
        ends
    }
    #[inline(always)]
    fn get(&self) -> Option<&Ends<D, R>> {
        Some(self)
    }
}

/// What a cell of an [`Order`] keeps of its ends.
pub trait EndsStorage: Copy + Send + Sync + 'static {
    /// Is it of second order, if that is known?
    const LIMITED: Option<bool>;
    /// That.
    type Ends<const D: usize, R: Real>: EndsOf<D, R>;
}

impl EndsStorage for Order<1> {
    const LIMITED: Option<bool> = Some(false);
    type Ends<const D: usize, R: Real> = ();
}

impl EndsStorage for Order<2> {
    const LIMITED: Option<bool> = Some(true);
    type Ends<const D: usize, R: Real> = Ends<D, R>;
}

impl EndsStorage for Order<0> {
    const LIMITED: Option<bool> = None;
    type Ends<const D: usize, R: Real> = Ends<D, R>;
}

/// The limited slopes of a cell, and what the flow carries into its middle within half a step.
pub(super) struct Slopes<const D: usize, R: Real> {
    ends: Ends<D, R>,
    /// The axes that are smooth, and whether any is.
    axes: [R::Mask; D],
    pub any: R::Mask,
    /// How the velocity in the middle changes by advection.
    pub advected: [R; D],
}

impl<const D: usize, R: Real> Slopes<D, R> {
    /// Of the cell in the middle with velocity `u`; `there` are the velocities of its neighbours, lower first.
    #[inline(always)]
    pub(super) fn of<B: Bed<D, R>, P: Copy>(
        near: &Neighbours<D, R, Flow<D, R>, B, P>,
        sides: &[Sides<R>; D],
        (u, there): ([R; D], [[[R; D]; 2]; D]),
        lambda: [R; D],
    ) -> Self {
        let (one, half) = (R::splat(1.0), R::splat(0.5));
        let (h, plane) = (near.here.state.h, near.here.ground.plane());
        let axes: [R::Mask; D] = per_axis!(k => sides[k].open & one.le(sides[k].freedom()));
        let mut any = axes[0];
        let mut ends = <Ends<D, R> as EndsOf<D, R>>::none();
        for_axis!(axis in D => {
            let smooth = axes[axis];
            any = any | smooth;
            let (lo, hi) = (&near.lo[axis], &near.hi[axis]);
            let [below, above] = there[axis];
            let slope_h = steep(h - lo.state.h, hi.state.h - h);
            ends.smooth[axis] = R::select(smooth, one, R::zero());
            ends.rise_h[axis] = only(smooth, slope_h);
            ends.rise_psi[axis] = only(smooth, steep(-sides[axis].level[0], sides[axis].level[1]));
            ends.rise_speed[axis] = only(smooth, steep(u[axis] - below[axis], above[axis] - u[axis]));
            let below = B::parallel_transport([below, u], [&lo.ground.plane(), &plane])[0];
            let above = B::parallel_transport([above, u], [&hi.ground.plane(), &plane])[0];
            ends.rise_v[axis] = per_axis!(k => only(smooth, steep(u[k] - below[k], above[k] - u[k])));
        });
        let carried: [R; D] = per_axis!(k => {
            lambda[k] * (u[k] * ends.rise_h[k] + h * ends.rise_speed[k])
        });
        let comes = (-(half * total(carried))).max(-(half * h)).min(half * h);
        ends.h = h + comes;
        let advected = per_axis!(k => {
            let along: [R; D] = per_axis!(axis => lambda[axis] * (u[axis] * ends.rise_v[axis][k]));
            -(half * total(along))
        });
        Slopes { ends, axes, any, advected }
    }

    /// With the velocity `w` after force and friction; none where the cell stops.
    #[inline(always)]
    pub(super) fn with<B: Bed<D, R>, P: Copy>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B, P>,
        plane: &B::Plane,
        [u, w]: [[R; D]; 2],
        stops: R::Mask,
        dt: R,
    ) -> Ends<D, R> {
        let half = R::splat(0.5);
        // What the pressure did, which the faces do at mid time.
        let pressure: [R; D] = per_axis!(k => {
            let (lo, hi) = (&near.lo[k], &near.hi[k]);
            let rise = hi.ground.head() * hi.state.h - lo.ground.head() * lo.state.h;
            only(self.axes[k], rise * (near.spacing.inv[k] * half))
        });
        let pressure = B::metric(plane, pressure);
        Ends {
            smooth: per_axis!(k => R::select(stops, R::zero(), self.ends.smooth[k])),
            v: per_axis!(k => half * (u[k] + w[k]) + self.advected[k]),
            given: per_axis!(k => (w[k] - u[k]) + dt * pressure[k]),
            ..self.ends
        }
    }
}

#[inline(always)]
fn steep<R: Real>(lo: R, hi: R) -> R {
    limiter::central_within(STEEPEST, lo, hi)
}

#[inline(always)]
fn only<R: Real>(mask: R::Mask, value: R) -> R {
    R::select(mask, value, R::zero())
}
