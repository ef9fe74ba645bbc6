//! The surroundings of a cell along one axis, as forecast.

use super::force::{Downstream, continued};
use super::forecast::Forecast;
use crate::real::{Real, per_axis};
use crate::savage_hutter::ground::Bed;
use crate::scheme::Forecasts;

/// The surroundings of a cell, as forecast, along one axis.
#[derive(Clone, Copy)]
pub(super) struct Sides<R: Real> {
    /// The rises of psi to both neighbours, as they are.
    pub(super) level: [R; 2],
    /// The same after the gain of either, [`continued`] beyond the data.
    rises: [R; 2],
    /// How freely mass passes both faces.
    pub(super) free: [R; 2],
    /// A neighbour is outside the data.
    pub(super) ends: R::Mask,
    /// Both neighbours may give mass.
    pub(super) open: R::Mask,
}

impl<R: Real> Sides<R> {
    #[inline(always)]
    pub(super) fn of<const D: usize, B: Bed<D, R>>(
        axis: usize,
        forecasts: &Forecasts<D, Forecast<D, R, B::Surface>>,
    ) -> Self {
        let (zero, here) = (R::zero(), &forecasts.here);
        let there = [&forecasts.lo[axis], &forecasts.hi[axis]];
        let level = [
            -B::rise(axis, [&there[0].surface, &here.surface]),
            B::rise(axis, [&here.surface, &there[1].surface]),
        ];
        let outside = [there[0].motion.is_outside(), there[1].motion.is_outside()];
        let rise: [R; 2] = per_axis!(side => {
            R::select(outside[side], zero, level[side] + (there[side].gain - here.gain))
        });
        Sides {
            level,
            rises: continued(rise, outside, [there[0].motion.is_dry(), there[1].motion.is_dry()]),
            free: per_axis!(side => here.motion.between(there[side].motion, level[side])),
            ends: outside[0] | outside[1],
            open: !(there[0].motion.is_closed() | there[1].motion.is_closed()),
        }
    }
    /// As through the less free of both faces.
    #[inline(always)]
    pub(super) fn freedom(&self) -> R {
        self.free[0].min(self.free[1])
    }
    /// The forces for both directions, moved to their mean as far as the cell flows freely.
    #[inline(always)]
    pub(super) fn force(&self, per: R) -> Downstream<R> {
        let Downstream { mean, apart } = Downstream::of(self.rises, per);
        Downstream { mean, apart: apart * (R::splat(1.0) - self.freedom()) }
    }
}
