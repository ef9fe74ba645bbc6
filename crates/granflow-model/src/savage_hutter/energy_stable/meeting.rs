//! What two cells show each other at their face.

use super::ends::EndsOf;
use super::faces::FaceStatesOf;
use crate::real::{Real, per_axis};
use crate::savage_hutter::ground::Bed;

/// What two cells show each other at their face.
pub(super) struct Meeting<const D: usize, R: Real> {
    /// The axis is smooth on both sides: the values are those of the ends at mid time, else of the cells.
    pub second: R::Mask,
    /// Depth, velocity towards the face, and the share of the thermal part.
    pub h: [R; 2],
    pub v: [R; 2],
    pub thermal: [R; 2],
    /// The larger sqrt(psi' h).
    pub wave: R,
    /// psi of the right side less that of the left one.
    pub rise: R,
    /// How much psi of each cell changes until the mass passes.
    pub gain: [R; 2],
    /// The velocity that the mass carries.
    pub carried: [[R; D]; 2],
    /// What the pressure of a level surface changes until mid time, per metric and time.
    pub later: R,
}

impl<const D: usize, R: Real> Meeting<D, R> {
    /// Of two cells, psi of the right one being `rise` above that of the left.
    #[inline(always)]
    pub(super) fn of<B: Bed<D, R>, T: EndsOf<D, R>>(
        axis: usize,
        sides: [&FaceStatesOf<D, R, B, T>; 2],
        rise: R,
        lambda: R,
    ) -> Self {
        let (zero, one) = (R::zero(), R::splat(1.0));
        let mut meeting = Meeting {
            second: one.lt(zero),
            h: per_axis!(side => sides[side].h.positive_part()),
            v: [sides[0].mean_velocity(axis), -sides[1].mean_velocity(axis)],
            thermal: per_axis!(side => sides[side].thermal(lambda)),
            wave: sides[0].wave.max(sides[1].wave),
            rise,
            gain: per_axis!(side => sides[side].gain),
            carried: per_axis!(side => sides[side].w),
            later: zero,
        };
        let (Some(left), Some(right)) = (sides[0].ends.get(), sides[1].ends.get()) else { return meeting };
        let second = zero.lt(left.smooth[axis]) & zero.lt(right.smooth[axis]);
        if !R::any(second) {
            return meeting;
        }
        let ends = [left, right];
        meeting.second = second;
        let gain: [R; 2] = per_axis!(side => sides[side].head * (ends[side].h - sides[side].h));
        let psi: [R; 2] = per_axis!(side => ends[side].psi(axis, 1 - side, gain[side]));
        let v = [left.speed(axis, 1), -right.speed(axis, 0)];
        meeting.h = per_axis!(side => {
            R::select(second, ends[side].depth(axis, 1 - side, sides[side].h), meeting.h[side])
        });
        let wave = (sides[0].head * meeting.h[0]).max(sides[1].head * meeting.h[1]).sqrt();
        meeting.wave = R::select(second, wave, meeting.wave);
        meeting.v = per_axis!(side => R::select(second, v[side], meeting.v[side]));
        meeting.thermal = per_axis!(side => R::select(second, one, meeting.thermal[side]));
        meeting.rise = R::select(second, rise + (psi[1] - psi[0]), rise);
        meeting.gain = per_axis!(side => R::select(second, gain[side], meeting.gain[side]));
        let velocity: [[R; D]; 2] = per_axis!(side => ends[side].velocity(axis, 1 - side));
        meeting.carried = per_axis!(side => {
            per_axis!(k => R::select(second, velocity[side][k], meeting.carried[side][k]))
        });
        let head = (sides[0].head + sides[1].head) * R::splat(0.25);
        let later = head * (left.h * right.h - sides[0].h * sides[1].h);
        meeting.later = R::select(second, later, zero);
        meeting
    }
}
