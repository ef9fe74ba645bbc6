//! How depth and velocity vary across a cell: not at all, or by limited differences.

use crate::real::{Real, per_axis, repeated};
use crate::savage_hutter::ground::Towards;
use crate::scheme::{Components, components};

/// How depth and velocity vary across a cell.
pub trait CellSlopes<const D: usize, R: Real>: Components<R> {
    /// Not at all.
    fn none() -> Self;
    /// By dh and du from the middle to the upper end, where they can.
    fn by(dh: R, du: [R; D]) -> Self;
    /// Depth at one end.
    fn depth(&self, towards: Towards, h: R) -> R;
    /// Velocity at one end.
    fn velocity(&self, towards: Towards, u: [R; D]) -> [R; D];
    /// Not at all but in the cells of a mask.
    #[must_use]
    fn only(self, mask: R::Mask) -> Self;
}

impl<const D: usize, R: Real> CellSlopes<D, R> for () {
    #[inline(always)]
    fn none() {}
    #[inline(always)]
    fn by(_dh: R, _du: [R; D]) {}
    #[inline(always)]
    fn depth(&self, _towards: Towards, h: R) -> R {
        h
    }
    #[inline(always)]
    fn velocity(&self, _towards: Towards, u: [R; D]) -> [R; D] {
        u
    }
    #[inline(always)]
    fn only(self, _mask: R::Mask) {}
}

/// Half of the limited differences across a cell, along one axis.
#[derive(Clone, Copy, Debug)]
pub struct Slope<const D: usize, R> {
    h: R,
    u: [R; D],
}

components!([const D: usize, R: Real] Slope<D, R> { h: R, u: [R; D] });

impl<const D: usize, R: Real> CellSlopes<D, R> for Slope<D, R> {
    #[inline(always)]
    fn none() -> Self {
        Slope { h: R::zero(), u: repeated(R::zero()) }
    }
    #[inline(always)]
    fn by(h: R, u: [R; D]) -> Self {
        Slope { h, u }
    }
    #[inline(always)]
    fn depth(&self, towards: Towards, h: R) -> R {
        match towards {
            Towards::Lo => h - self.h,
            Towards::Hi => h + self.h,
        }
        .positive_part()
    }
    #[inline(always)]
    fn velocity(&self, towards: Towards, u: [R; D]) -> [R; D] {
        per_axis!(k => match towards {
            Towards::Lo => u[k] - self.u[k],
            Towards::Hi => u[k] + self.u[k],
        })
    }
    #[inline(always)]
    fn only(self, mask: R::Mask) -> Self {
        let only = |value| R::select(mask, value, R::zero());
        Slope { h: only(self.h), u: per_axis!(k => only(self.u[k])) }
    }
}

/// The order of a scheme: 1, 2, or 0 where it is not known when the inner loops are compiled.
#[derive(Clone, Copy, Debug)]
pub struct Order<const ORDER: u8>;

/// How values vary across the cells of a scheme.
pub trait SlopeStorage: Copy + Send + Sync + 'static {
    /// Do they vary, if that is known?
    const LIMITED: Option<bool>;
    /// Along one axis.
    type CellSlopes<const D: usize, R: Real>: CellSlopes<D, R>;
}

impl SlopeStorage for Order<1> {
    const LIMITED: Option<bool> = Some(false);
    type CellSlopes<const D: usize, R: Real> = ();
}

impl SlopeStorage for Order<2> {
    const LIMITED: Option<bool> = Some(true);
    type CellSlopes<const D: usize, R: Real> = Slope<D, R>;
}

impl SlopeStorage for Order<0> {
    const LIMITED: Option<bool> = None;
    type CellSlopes<const D: usize, R: Real> = Slope<D, R>;
}
