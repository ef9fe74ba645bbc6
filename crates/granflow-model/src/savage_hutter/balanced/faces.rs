//! What a cell offers to its faces, and what passes one.

use super::slopes::CellSlopes;
use crate::real::{Real, for_axis, per_axis, total};
use crate::savage_hutter::flux::Half;
use crate::savage_hutter::ground::Towards;
use crate::scheme::{Components, components};

/// What a cell offers to its faces.
#[derive(Clone, Copy, Debug)]
pub struct FaceStates<const D: usize, R: Real, P, T> {
    pub(super) h: R,
    pub(super) u: [R; D],
    /// How they vary, per axis.
    pub(super) slopes: [P; D],
    /// What the kinetic density sends through the lower and the upper face of each axis.
    pub(super) half: [[Half<R>; 2]; D],
    /// The tangent plane of the bed.
    pub(super) plane: T,
    /// What the cell lets out.
    pub(super) class: CellClass<R>,
}

components!([const D: usize, R: Real, P: Components<R>, T: Components<R>] FaceStates<D, R, P, T> {
    h: R, u: [R; D], slopes: [P; D], half: [[Half<R>; 2]; D], plane: T, class: CellClass<R>
});

/// Is a cell, or one of the two cells of a face, bare or held? A number, so that a few can be asked at once: 0 is open.
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

    /// Dry, or a film, or outside: takes what comes, gives nothing.
    pub(super) const DRY: f64 = 1.0;
    /// Holds itself: thick, q = 0, and the pull is within the static bound.
    pub(super) const HELD: f64 = 3.0;

    #[inline(always)]
    pub(super) fn dry(dry: R::Mask) -> Self {
        CellClass::new(R::select(dry, R::splat(Self::DRY), R::zero()))
    }
    #[inline(always)]
    pub(super) fn held(self, held: R::Mask) -> Self {
        CellClass::new(R::select(held, R::splat(Self::HELD), self.code))
    }
    #[inline(always)]
    pub(super) fn and(self, other: Self) -> Self {
        CellClass::new(self.code + other.code)
    }
    /// Both cells of the face, or this one, are open.
    #[inline(always)]
    pub(super) fn is_open(self) -> R::Mask {
        self.code.equals(R::zero())
    }
    /// This cell, or one of the two, is held.
    #[inline(always)]
    pub(super) fn is_held(self) -> R::Mask {
        R::splat(Self::HELD).le(self.code)
    }
}

impl<const D: usize, R: Real, P: CellSlopes<D, R>, T> FaceStates<D, R, P, T> {
    /// The share of the density going out through a face that the mean flow carries.
    #[inline(always)]
    pub(super) fn advected_share(&self, axis: usize, towards: Towards) -> R {
        let flow =
            self.slopes[axis].depth(towards, self.h) * self.slopes[axis].velocity(towards, self.u)[axis];
        let outward = if towards == Towards::Lo { -flow } else { flow };
        let mass = self.half[axis][towards as usize].mass;
        let none = mass.equals(R::zero());
        let share = outward.positive_part() / R::select(none, R::splat(1.0), mass.abs());
        R::select(none, R::zero(), share.min(R::splat(1.0)))
    }
}

impl<const D: usize, R: Real, P, T> FaceStates<D, R, P, T> {
    /// Give no more in a stage than there is. The bound on the slopes promises that at the speeds the step was chosen by; a later
    /// stage has other ones, and far larger ones below a cliff. `lambda` is dt/dx.
    #[inline(always)]
    pub(super) fn keep_positive(&mut self, lambda: [R; D]) {
        let out: [R; D] =
            per_axis!(axis => lambda[axis] * (self.half[axis][1].mass - self.half[axis][0].mass));
        let (out, most) = (total(out), R::splat(1.0 - 1e-12) * self.h.positive_part());
        let over = most.lt(out);
        if R::any(over) {
            let share = R::select(over, most / R::select(over, out, R::splat(1.0)), R::splat(1.0));
            for_axis!(axis in D => {
                self.half[axis] = per_axis!(side => self.half[axis][side].share(share));
            });
        }
    }
}

/// What passes a face.
#[derive(Clone, Copy, Debug)]
pub struct Flux<const D: usize, R: Real> {
    pub(super) mass: R,
    /// Momentum along the axis of the face, as its left and its right cell see it.
    pub(super) left: [R; D],
    pub(super) right: [R; D],
    /// What its two cells let out.
    pub(super) class: CellClass<R>,
}

components!([const D: usize, R: Real] Flux<D, R> {
    mass: R, left: [R; D], right: [R; D], class: CellClass<R>
});
