//! Limited slopes for second order in space.

use crate::real::Real;

/// The smallest of two differences of one sign, else 0: minmod(a, b).
#[inline(always)]
pub fn minmod<R: Real>(a: R, b: R) -> R {
    let size = a.abs().min(b.abs());
    let same_sign = R::zero().lt(a * b);
    R::select(same_sign, R::select(a.lt(R::zero()), -size, size), R::zero())
}

/// Monotonised central slope: minmod(2 lo, (lo + hi)/2, 2 hi) of the one-sided differences lo, hi.
///
/// van Leer, J. Comput. Phys. 23 (1977) 263; total variation diminishing, second order at smooth monotone data.
#[inline(always)]
pub fn central<R: Real>(lo: R, hi: R) -> R {
    let twice = minmod(lo, hi);
    minmod(twice + twice, (lo + hi) * R::of(0.5))
}
