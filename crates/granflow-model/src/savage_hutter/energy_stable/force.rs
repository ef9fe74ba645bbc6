//! The velocity that the surface gives a cell.

use crate::real::{Real, dot, for_axis, per_axis};
use crate::savage_hutter::ground::Bed;

/// The share of the bound of friction by which a force may differ from the downstream one, towards the mean: friction pays for it,
/// and the flow does not feel every pit of the size of a cell.
const CENTRED: f64 = 0.25;

/// Where the forces of the two directions differ by more than what friction leaves, what a slow cell does is a matter of the grid
/// and not of the mountain: it stops at a share of that difference.
pub(super) const UNRESOLVED: f64 = 0.2;

/// The force per mass along one axis: `mean` + `apart` if the cell moves to smaller coordinates, `mean` - `apart` if to larger ones.
/// Where `apart` < 0 the surface is a crest, where it is > 0 a pit, out of which both ways lead up.
#[derive(Clone, Copy)]
pub(super) struct Downstream<R> {
    pub mean: R,
    pub apart: R,
}

impl<R: Real> Downstream<R> {
    /// Of the rises of psi to both neighbours; 1/dx is `per`.
    #[inline(always)]
    pub(super) fn of([to_lo, to_hi]: [R; 2], per: R) -> Self {
        let half = per * R::splat(0.5);
        Downstream { mean: (to_lo - to_hi) * half, apart: (to_lo + to_hi) * half }
    }
    /// Each moved towards the mean by at most `share`: what the mean takes from the surface in excess, friction pays.
    #[inline(always)]
    pub(super) fn centred(self, share: R) -> Self {
        Downstream { apart: self.apart - self.apart.max(-share).min(share), ..self }
    }
    #[inline(always)]
    fn is_pit(self) -> R::Mask {
        R::zero().lt(self.apart)
    }
    /// In a pit, the force turns the velocity `guess` by which it was chosen to `w`.
    #[inline(always)]
    fn stops(self, w: R, guess: R) -> R::Mask {
        self.is_pit() & !R::zero().lt(w * guess)
    }
}

/// The forces moved towards their means by what friction `dry` pays for; and half of what those of the two directions differed by
/// before, at most `dry`: what the grid does not resolve.
#[inline(always)]
pub(super) fn centred<const D: usize, R: Real>(
    forces: [Downstream<R>; D],
    dry: R,
) -> ([Downstream<R>; D], R) {
    let share = dry * R::splat(CENTRED * core::f64::consts::FRAC_1_SQRT_2);
    let apart: [R; D] = per_axis!(k => forces[k].apart);
    (per_axis!(k => forces[k].centred(share)), dot(apart, apart).sqrt().min(dry))
}

/// The rises of psi to both neighbours where the data end at one: the surface goes on as it comes, level if from a bare bed (`dry`)
/// above.
#[inline(always)]
pub(super) fn continued<R: Real>(rise: [R; 2], outside: [R::Mask; 2], dry: [R::Mask; 2]) -> [R; 2] {
    let zero = R::zero();
    per_axis!(side => {
        let leans = dry[1 - side] & zero.lt(rise[1 - side]);
        R::select(outside[side], R::select(leans, zero, -rise[1 - side]), rise[side])
    })
}

/// Is it 0 along every axis?
#[inline(always)]
pub(super) fn is_zero<const D: usize, R: Real>(w: [R; D]) -> R::Mask {
    let mut zero = w[0].equals(R::zero());
    for_axis!(k in D => {
        zero = zero & w[k].equals(R::zero());
    });
    zero
}

/// u + dt M phi
#[inline(always)]
fn accelerated<const D: usize, R: Real, B: Bed<D, R>>(
    plane: &B::Plane,
    u: [R; D],
    phi: [R; D],
    dt: R,
) -> [R; D] {
    let push = B::metric(plane, phi);
    per_axis!(k => u[k] + dt * push[k])
}

/// w = u + dt M phi with phi of every axis the downstream force for the sign of w, or, in a pit, where neither sign is that of the
/// force it leaves, the one that stops the cell along the axis.
///
/// The signs are those under the mean forces. On a crest any force between the two keeps the law, whatever the sign of w. An axis
/// in a pit whose w has the other sign is stopped, by the projection along M that takes the most energy; where this turns the other
/// axis in a pit, that is stopped too.
#[inline(always)]
pub(super) fn pushed<const D: usize, R: Real, B: Bed<D, R>>(
    plane: &B::Plane,
    u: [R; D],
    forces: [Downstream<R>; D],
    dt: R,
) -> [R; D] {
    let zero = R::zero();
    let guess = accelerated::<D, R, B>(plane, u, per_axis!(k => forces[k].mean), dt);
    let mut even = forces[0].apart.equals(zero);
    for_axis!(k in D => {
        even = even & forces[k].apart.equals(zero);
    });
    if !R::any(!even) {
        return guess;
    }
    let phi: [R; D] = per_axis!(k => {
        let Downstream { mean, apart } = forces[k];
        R::select(zero.lt(guess[k]), mean - apart, R::select(guess[k].lt(zero), mean + apart, mean))
    });
    let free = accelerated::<D, R, B>(plane, u, phi, dt);
    let mut any = forces[0].stops(free[0], guess[0]);
    for_axis!(k in D => {
        any = any | forces[k].stops(free[k], guess[k]);
    });
    if !R::any(any) {
        return free;
    }
    let columns: [[R; D]; D] = per_axis!(axis => {
        let unit: [R; D] = per_axis!(k => R::splat(if k == axis { 1.0 } else { 0.0 }));
        B::metric(plane, unit)
    });
    // Nowhere in the data is M singular; beside them the quotient is not used.
    let along: [R; D] = per_axis!(k => {
        let own = columns[k][k];
        let none = own.le(zero);
        R::select(forces[k].stops(free[k], guess[k]), free[k], zero) / R::select(none, R::splat(1.0), own)
    });
    per_axis!(k => {
        let mut left = R::select(forces[k].stops(free[k], guess[k]), zero, free[k]);
        for_axis!(other in D => {
            if other != k {
                left = left - columns[other][k] * along[other];
            }
        });
        R::select(forces[k].stops(free[k], guess[k]) | forces[k].stops(left, guess[k]), zero, left)
    })
}
