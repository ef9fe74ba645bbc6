//! What a cell offers to its faces and corners.

use crate::hadeler_kuttler::Ground;
use crate::limiter::Limited;
use crate::real::{Real, repeated};
use crate::scheme::{Components, components};

/// Cells along each axis at a corner.
pub(super) const TWO: usize = 2;

/// How the values of a cell vary across it.
pub trait CellSlopes<const D: usize, R: Real>: Components<R> {
    /// Not at all.
    fn none() -> Self;
    /// By limited differences, where it can.
    fn by(halves: Halves<D, R>) -> Self;
    /// By what, if it does.
    fn halves(&self) -> Option<&Halves<D, R>>;
}

impl<const D: usize, R: Real> CellSlopes<D, R> for () {
    #[inline(always)]
    fn none() {}
    #[inline(always)]
    fn by(_: Halves<D, R>) {}
    #[inline(always)]
    fn halves(&self) -> Option<&Halves<D, R>> {
        None
    }
}

/// Half the limited differences across a cell: what a value rises from its middle to its upper end, along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Halves<const D: usize, R> {
    pub(super) v: [R; D],
    pub(super) slope: [R; D],
    /// Not yet adapted.
    pub(super) edge: [R; D],
    /// Theta of the cell, 1 beside the table.
    pub(super) theta: R,
}

components!([const D: usize, R: Real] Halves<D, R> { v: [R; D], slope: [R; D], edge: [R; D], theta: R });

impl<const D: usize, R: Real> CellSlopes<D, R> for Halves<D, R> {
    #[inline(always)]
    fn none() -> Self {
        let none: [R; D] = repeated(R::zero());
        Halves { v: none, slope: none, edge: none, theta: R::splat(1.0) }
    }
    #[inline(always)]
    fn by(halves: Halves<D, R>) -> Self {
        halves
    }
    #[inline(always)]
    fn halves(&self) -> Option<&Halves<D, R>> {
        Some(self)
    }
}

/// How values vary across the cells of a scheme.
pub trait SlopeStorage: Copy + Send + Sync + 'static {
    /// In a cell.
    type CellSlopes<const D: usize, R: Real>: CellSlopes<D, R>;
}

impl SlopeStorage for Limited<false> {
    type CellSlopes<const D: usize, R: Real> = ();
}

impl SlopeStorage for Limited<true> {
    type CellSlopes<const D: usize, R: Real> = Halves<D, R>;
}

/// Where a cell and its lower left node are. A number, so that a few can be asked at once: 0 is on the table, the node free
/// to rise.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellClass<R> {
    pub(super) code: R,
}

components!([R: Real] CellClass<R> { code: R });

impl<R: Real> CellClass<R> {
    #[inline(always)]
    pub(super) fn new(code: R) -> Self {
        CellClass { code }
    }
    pub(super) const PINNED: f64 = 1.0;
    pub(super) const OUTSIDE: f64 = 2.0;

    #[inline(always)]
    pub(super) fn of<const D: usize>(ground: &Ground<D, R>) -> Self {
        let zero = R::zero();
        let outside = R::select(zero.lt(ground.inside), zero, R::splat(Self::OUTSIDE));
        CellClass::new(outside + R::select(zero.lt(ground.weight), zero, R::splat(Self::PINNED)))
    }
    #[inline(always)]
    pub(super) fn inside(self) -> R::Mask {
        self.code.lt(R::splat(Self::OUTSIDE))
    }
    /// The lower left node is free to rise.
    #[inline(always)]
    pub(super) fn free(self) -> R::Mask {
        self.code.equals(R::zero()) | self.code.equals(R::splat(Self::OUTSIDE))
    }
}

/// What a cell offers to its faces and corners.
#[derive(Clone, Copy, Debug)]
pub struct FaceStates<const D: usize, R: Real, S = Halves<D, R>> {
    /// Rolling layer.
    pub(super) v: R,
    /// Slope of the surface in the cell, along each axis.
    pub(super) slope: [R; D],
    /// Slope along the cell's lower edge of each axis.
    pub(super) edge: [R; D],
    /// B at the face less B at the cell's end, (h f - difference of B)/2: what is poured on the half cell.
    pub(super) poured: [R; D],
    /// 1 where the face at the lower end of an axis is a wall.
    pub(super) wall: [R; D],
    pub(super) place: CellClass<R>,
    pub(super) slopes: S,
}

components!([const D: usize, R: Real, S: CellSlopes<D, R>] FaceStates<D, R, S> {
    v: R, slope: [R; D], edge: [R; D], poured: [R; D], wall: [R; D], place: CellClass<R>, slopes: S
});

/// The two ends of a cell along an axis.
#[derive(Clone, Copy)]
pub(super) enum End {
    Lo,
    Hi,
}

/// A value at one end, which rises by `half` from the middle to the upper one.
#[inline(always)]
pub(super) fn at_end<R: Real>(end: End, mid: R, half: R) -> R {
    match end {
        End::Lo => mid - half,
        End::Hi => mid + half,
    }
}

impl<const D: usize, R: Real, S: CellSlopes<D, R>> FaceStates<D, R, S> {
    #[inline(always)]
    pub(super) fn v_at(&self, axis: usize, end: End) -> R {
        self.slopes.halves().map_or(self.v, |halves| at_end(end, self.v, halves.v[axis]))
    }
    #[inline(always)]
    pub(super) fn slope_at(&self, axis: usize, end: End) -> R {
        let mid = self.slope[axis];
        self.slopes.halves().map_or(mid, |halves| at_end(end, mid, halves.slope[axis]))
    }
    /// Along the lower edge, by the smaller Theta of the two cells along it.
    #[inline(always)]
    pub(super) fn edge_at(&self, axis: usize, end: End, beside: &Self) -> R {
        let mid = self.edge[axis];
        match (self.slopes.halves(), beside.slopes.halves()) {
            (Some(here), Some(there)) => at_end(end, mid, here.edge[axis] * here.theta.min(there.theta)),
            _ => mid,
        }
    }
    /// Rolling layer at a corner, by its end of each axis.
    #[inline(always)]
    pub(super) fn v_at_corner(&self, ends: [End; TWO]) -> R {
        let Some(Halves { v, .. }) = self.slopes.halves() else { return self.v };
        // The axes are added first: they may be swapped without changing a bit.
        let mut across = at_end(ends[0], R::zero(), v[0]);
        if D > 1 {
            across = across + at_end(ends[1], R::zero(), v[D - 1]);
        }
        self.v + across
    }
}
