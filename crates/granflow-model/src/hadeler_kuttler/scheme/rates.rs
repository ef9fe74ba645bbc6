//! What passes a face, what a node loses, and how the rolling layer of a cell changes.

use super::cell::{CellSlopes, End, FaceStates, TWO};
use crate::hadeler_kuttler::{Ground, Source};
use crate::real::{Real, for_axis};
use crate::scheme::{Faces, Spacing};

/// Two slopes that sum to less are level: their sign is rounding.
pub(super) const LEVEL: f64 = 1e-12;

/// H of a face less the value of B there (eqs. 10, 45): what flows towards smaller coordinates.
#[inline(always)]
pub(super) fn flux<const D: usize, R: Real, S: CellSlopes<D, R>>(
    axis: usize,
    left: &FaceStates<D, R, S>,
    right: &FaceStates<D, R, S>,
) -> R {
    let (zero, one) = (R::zero(), R::splat(1.0));
    let (a, b) = (left.slope_at(axis, End::Hi), right.slope_at(axis, End::Lo));
    let (v_a, v_b) = (left.v_at(axis, End::Hi), right.v_at(axis, End::Lo));
    let (poured_a, poured_b) = (left.poured[axis], right.poured[axis]);
    // (a + b)/(|a| + |b|): a sign, where the two slopes do not point against each other.
    let (sum, size) = (a + b, a.abs() + b.abs());
    let mut lean = R::select(sum.lt(zero), -one, one);
    let against = (a * b).lt(zero);
    if R::any(against) {
        lean = R::select(against, sum / R::select(against, size, one), lean);
    }
    lean = R::select(size.lt(R::splat(LEVEL)), zero, lean);
    let poured = ((poured_b - poured_a) + lean * (poured_b + poured_a)) * R::splat(0.5);
    let within = (b.positive_part() * v_b + a.min(zero) * v_a) + poured;
    let rim = (left.place.code + right.place.code) + right.wall[axis];
    if !R::any(!rim.equals(zero)) {
        return within;
    }
    // An open edge takes what comes and gives nothing; level ground leads over it.
    let over_left = b.positive_part() * v_b + R::select(b.lt(zero), zero, poured_b);
    let over_right = a.min(zero) * v_a - R::select(zero.lt(a), zero, poured_a);
    let (in_left, in_right) = (left.place.inside(), right.place.inside());
    let over = R::select(in_left, over_right, over_left);
    let passes = (in_left | in_right) & !zero.lt(right.wall[axis]);
    R::select(in_left & in_right, within, R::select(passes, over, zero))
}

/// sqrt(x^2 + y^2) of two numbers >= 0; where one of them is 0 it is the other, without a root.
#[inline(always)]
pub(super) fn length<R: Real>(x: R, y: R) -> R {
    let both = R::zero().lt(x) & R::zero().lt(y);
    let sum = x + y;
    if R::any(both) { R::select(both, (x * x + y * y).sqrt(), sum) } else { sum }
}

/// G at a node (eq. 9; in two dimensions the largest over the cells around it, which keeps v >= 0 and is eq. 9 where
/// nothing varies along one axis): what the standing layer loses, v (|grad u| - 1).
#[inline(always)]
pub(super) fn corner<const D: usize, R: Real, S: CellSlopes<D, R>>(
    around: [[&FaceStates<D, R, S>; 2]; 2],
) -> R {
    let (zero, one) = (R::zero(), R::splat(1.0));
    let [[_, below_right], [above_left, above_right]] = around;
    let mut steep = [[zero, zero], [zero, zero]];
    for_axis!(axis in D => {
        // The edges that end and that begin at the node, each with the cells along it.
        let (ends, begins) = (if axis == 0 { above_left } else { below_right }, above_right);
        let [ends_beside, begins_beside] =
            if axis == 0 { [around[0][0], around[0][1]] } else { [around[0][0], around[1][0]] };
        let over = ends.edge_at(axis, End::Hi, ends_beside);
        let under = begins.edge_at(axis, End::Lo, begins_beside);
        steep[axis] = [over.positive_part(), (-under).positive_part()];
    });
    let mut rim = above_right.place.code;
    for_axis!(x in TWO => {
        rim = rim + (around[0][x].place.code + around[1][x].place.code);
    });
    let plain = !R::any(!rim.equals(zero));
    let mut largest = R::splat(f64::NEG_INFINITY);
    for_axis!(y in TWO => {
        for_axis!(x in TWO => {
            let cell = around[y][x];
            let slope = if D > 1 { length(steep[0][x], steep[1][y]) } else { steep[0][x] };
            let end = |place: usize| if place == 0 { End::Hi } else { End::Lo };
            let loss = cell.v_at_corner([end(x), end(y)]) * (slope - one);
            let larger = largest.max(loss);
            largest = if plain { larger } else { R::select(cell.place.inside(), larger, largest) };
        });
    });
    if plain { largest } else { R::select(above_right.place.free(), largest, zero) }
}

/// v_t of a cell: sum over axes of (H_hi - H_lo)/h + f + S, S the mean of G at the cell's nodes (eqs. 8, 44).
#[inline(always)]
pub(super) fn rate_of_v<const D: usize, R: Real>(
    ground: &Ground<D, R>,
    source: &Source<D, R>,
    faces: &[Faces<R>; D],
    corners: &[[R; 2]; 2],
    spacing: &Spacing<D, R>,
) -> R {
    let (mut flow, poured) = (R::zero(), source.rate());
    for_axis!(axis in D => {
        flow = flow + (faces[axis].hi - faces[axis].lo) * spacing.inv[axis];
    });
    let [[a, b], [c, d]] = *corners;
    let mean = if D > 1 { ((a + d) + (b + c)) * R::splat(0.25) } else { (a + b) * R::splat(0.5) };
    R::select(R::zero().lt(ground.inside), flow + (poured + mean), R::zero())
}
