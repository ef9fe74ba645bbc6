//! Values that are constant in a cell, or vary by limited differences.

use super::cell::{CellClass, CellSlopes, FaceStates, Halves};
use crate::hadeler_kuttler::{Ground, Pile, Source};
use crate::limiter::minmod;
use crate::real::{Real, for_axis, per_axis, repeated};
use crate::scheme::{Cell, Spacing, Stencil};

/// Height of the surface at the lower left node of the cell at `offset`.
#[inline(always)]
pub(super) fn surface<const D: usize, R: Real>(
    stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    offset: [isize; D],
) -> R {
    let cell = stencil.at(offset);
    cell.state.u + cell.ground.bed
}

/// The cell at `offset` with constant values.
#[inline(always)]
pub(super) fn constant<const D: usize, R: Real, S: CellSlopes<D, R>>(
    stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    offset: [isize; D],
) -> FaceStates<D, R, S> {
    let Cell { state, ground, forcing } = stencil.at(offset);
    let Spacing { size, inv: per, .. } = stencil.spacing();
    let half = R::splat(0.5);
    let (mut edge, mut slope) = (repeated(R::zero()), repeated(R::zero()));
    let here = surface(stencil, offset);
    for_axis!(k in D => {
        edge[k] = (surface(stencil, sum(offset, unit(k))) - here) * per[k];
        slope[k] = edge[k];
        if D > 1 {
            let far = surface(stencil, sum(offset, [1; D])) - surface(stencil, sum(offset, unit(1 - k)));
            slope[k] = (edge[k] + far * per[k]) * half;
        }
    });
    FaceStates {
        v: state.v,
        slope,
        edge,
        poured: per_axis!(k => forcing.split[k] * size[k] * half),
        wall: ground.wall,
        place: CellClass::of(&ground),
        slopes: S::none(),
    }
}

/// The limited difference over three cells, of which all must be on the table.
#[inline(always)]
pub(super) fn limited<R: Real>(smooth: R::Mask, lo: R, mid: R, hi: R) -> R {
    R::select(smooth, minmod(mid - lo, hi - mid), R::zero())
}

/// Does one of the two cells along the lower edge of the cell at `along` the axis belong to the table?
#[inline(always)]
pub(super) fn has_edge<const D: usize, R: Real>(
    stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    axis: usize,
    along: isize,
) -> R::Mask {
    let mut offset = [0; D];
    offset[axis] = along;
    let cell = R::zero().lt(stencil.at(offset).ground.inside);
    offset[1 - axis] = -1;
    cell | R::zero().lt(stencil.at(offset).ground.inside)
}

/// Limited differences of everything that varies (eqs. 16-18, 43), 0 beside the edge of the table.
#[inline(always)]
pub(super) fn linear<const D: usize, R: Real, S: CellSlopes<D, R>>(
    stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    here: &FaceStates<D, R, S>,
    theta: R,
) -> FaceStates<D, R, S> {
    let half = R::splat(0.5);
    let mut edges = *here;
    let none = repeated(R::zero());
    let mut halves = Halves { v: none, slope: none, edge: none, theta };
    for_axis!(axis in D => {
        let step = unit::<D>(axis);
        let a: FaceStates<D, R, ()> = constant(stencil, per_axis!(k => -step[k]));
        let b: FaceStates<D, R, ()> = constant(stencil, step);
        let smooth = a.place.inside() & b.place.inside() & here.place.inside();
        halves.v[axis] = theta * limited(smooth, a.v, here.v, b.v) * half;
        halves.slope[axis] = theta * limited(smooth, a.slope[axis], here.slope[axis], b.slope[axis]) * half;
        // B rises by half of each cell's source between two centres.
        let (lo, mid, hi) = (a.poured[axis], here.poured[axis], b.poured[axis]);
        let rise = R::select(smooth, minmod(lo + mid, mid + hi), R::zero());
        edges.poured[axis] = mid - theta * (mid - (mid - rise * half));
        // An edge belongs to the table if one of the two cells along it does.
        let mut exist = smooth;
        if D > 1 {
            exist = has_edge(stencil, axis, -1) & has_edge(stencil, axis, 0) & has_edge(stencil, axis, 1);
        }
        halves.edge[axis] = limited(exist, a.edge[axis], here.edge[axis], b.edge[axis]) * half;
    });
    edges.slopes = S::by(halves);
    edges
}

/// The offset of the next cell along `axis`.
#[inline(always)]
pub(super) fn unit<const D: usize>(axis: usize) -> [isize; D] {
    per_axis!(k => isize::from(k == axis))
}

#[inline(always)]
pub(super) fn sum<const D: usize>(a: [isize; D], b: [isize; D]) -> [isize; D] {
    per_axis!(k => a[k] + b[k])
}
