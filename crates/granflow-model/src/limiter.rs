//! Limited slopes for second order in space.

use crate::real::Real;

/// May values have limited slopes across a cell, or are they known to be constant there?
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limited<const LIMITED: bool>;

/// The smaller of two differences where both rise, and where both fall; 0 else. One of the two is 0.
#[inline(always)]
fn smaller<R: Real>(a: R, b: R) -> [R; 2] {
    [a.min(b).positive_part(), a.max(b).min(R::zero())]
}

/// The smallest of two differences of one sign, else 0: minmod(a, b).
#[inline(always)]
pub fn minmod<R: Real>(a: R, b: R) -> R {
    let [rise, fall] = smaller(a, b);
    rise + fall
}

/// Central slope within 1.5 times each one-sided difference: minmod(1.5 lo, (lo + hi)/2, 1.5 hi).
///
/// van Leer, J. Comput. Phys. 23 (1977) 263, with the factor theta = 1.5 of Kurganov & Tadmor, J. Comput. Phys. 160
/// (2000) 241. With theta = 2 the published Riemann problem ends with a total variation of 0.5040 (exact 0.5), with 1.5
/// 0.5007, with 1 0.5006.
#[inline(always)]
pub fn central<R: Real>(lo: R, hi: R) -> R {
    central_within(1.5, lo, hi)
}

/// Central slope within `theta` times each one-sided difference: minmod(theta lo, (lo + hi)/2, theta hi), theta from 1 to 2.
#[inline(always)]
pub fn central_within<R: Real>(theta: f64, lo: R, hi: R) -> R {
    // Not by `map`: a function in between may stay one, and is then not computed on lanes.
    let ([rise, fall], factor) = (smaller(lo, hi), R::splat(theta));
    let (rise, fall) = (rise * factor, fall * factor);
    ((lo + hi) * R::splat(0.5)).min(rise).max(fall)
}
