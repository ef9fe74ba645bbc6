//! The scalar of every formula: one `f64`, or several side by side on SIMD lanes, with the same source and the same bits.
//!
//! Decisions on cell values are [`Real::select`], never `if`: a lane cannot branch.

#[cfg(any(test, not(feature = "std")))]
mod logarithm;
#[cfg(any(test, not(feature = "std")))]
mod rounded;

use core::fmt::Debug;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A real number, or several of them side by side.
///
/// `min`, `max` and `select` are defined by comparisons, so that a scalar and a lane agree bit for bit
/// (also on which zero they return). Only [`Real::mul_add`] fuses a product and a sum.
pub trait Real:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The answer of a comparison: `bool` for one number, a lane mask for several.
    type Mask: Copy
        + Debug
        + Send
        + Sync
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// The same constant in every place.
    fn splat(value: f64) -> Self;
    /// self < other.
    fn lt(self, other: Self) -> Self::Mask;
    /// self <= other.
    fn le(self, other: Self) -> Self::Mask;
    /// self == other, as numbers (so -0 is 0).
    fn equals(self, other: Self) -> Self::Mask;
    /// `yes` where the mask holds, `no` elsewhere; both are computed.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Does the mask hold anywhere? Only to leave out work whose result is not used.
    fn any(mask: Self::Mask) -> bool;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// A function of single numbers, one cell after the other: for what has no other form, or would crowd the loops.
    fn each<const N: usize, const M: usize>(
        values: [Self; N],
        function: impl Fn([f64; N]) -> [f64; M],
    ) -> [Self; M];
    /// self * factor + term, rounded once. Never in a sum over axes or over the two sides of a face: its terms are not
    /// treated alike, so that a mirror image would differ in the last place.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// The smaller one, `select(self < other)`.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// The larger one, `select(other < self)`.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    /// max(self, 0).
    #[inline(always)]
    fn positive_part(self) -> Self {
        self.max(Self::zero())
    }

    /// Arc sine x of a sine on \[-1, 1\], and the cosine r = sqrt(1 - s^2) of x, to one unit in the last place; x is odd and
    /// exactly +-pi/2 at the ends.
    ///
    /// For |s| <= 1/2, with z = s^2: x = s + s z p(z), r = 1 - z k(z) (Chebyshev fits of p and k on \[0, 1/4\], relative
    /// errors 6e-17): no root. Beyond, asin s = pi/2 - 2 asin(sqrt((1 - s)/2)) with the same polynomial.
    #[inline(always)]
    fn asin_and_cos(self) -> [Self; 2] {
        #[expect(clippy::excessive_precision, reason = "the fit as it came, rounded by the compiler")]
        const P: [f64; 12] = [
            0.028169218060881412899,
            -0.010749050339697807562,
            0.016035514349148823079,
            0.0078029494773533171436,
            0.0118754943826369232,
            0.013929652902326633248,
            0.017355259955786321748,
            0.022372047631744510379,
            0.030381947367098481126,
            0.044642857103423643363,
            0.075000000000207643609,
            0.16666666666666648628,
        ];
        #[expect(clippy::excessive_precision, reason = "the fit as it came, rounded by the compiler")]
        const K: [f64; 12] = [
            0.030336770093371595724,
            -0.011368622748428646582,
            0.017471657075426302105,
            0.0088103422539604778959,
            0.013438972337306030325,
            0.016075569365753806049,
            0.020510486539711933399,
            0.02734363057679603845,
            0.039062503131324703835,
            0.062499999957752455103,
            0.12500000000022245743,
            0.49999999999999980674,
        ];
        let one = Self::splat(1.0);
        let square = self * self;
        let steep = Self::splat(0.25).lt(square);
        if !Self::any(steep) {
            return [
                (self * square).mul_add(Self::polynomial(P, square), self),
                one - square * Self::polynomial(K, square),
            ];
        }
        let right = Self::splat(core::f64::consts::FRAC_PI_2);
        let negative = self.lt(Self::zero());
        if !Self::any(!square.equals(one)) {
            return [Self::select(negative, -right, right), Self::zero()];
        }
        let size = self.abs();
        let folded = (one - size) * Self::splat(0.5);
        let (z, s) = (Self::select(steep, folded, square), Self::select(steep, folded.sqrt(), self));
        let p = Self::polynomial(P, z);
        let rest = (s * z) * p;
        // pi/2 - 2 (s + rest), the large terms first; the last constant is what f64 cuts off from pi/2
        let far = (right - (s + s)) - ((rest + rest) - Self::splat(6.123_233_995_736_766e-17));
        let far = Self::select(negative, -far, far);
        let near = one - z * Self::polynomial(K, z);
        [Self::select(steep, far, (s * z).mul_add(p, s)), Self::select(steep, (one - square).sqrt(), near)]
    }

    /// p_0 z^11 + p_1 z^10 + ... + p_11: the odd and the even powers side by side, each by Horner's rule.
    #[inline(always)]
    fn polynomial(p: [f64; 12], z: Self) -> Self {
        let square = z * z;
        let (mut odd, mut even) = (Self::splat(p[0]), Self::splat(p[1]));
        for k in 1..6 {
            odd = odd.mul_add(square, Self::splat(p[2 * k]));
            even = even.mul_add(square, Self::splat(p[2 * k + 1]));
        }
        odd.mul_add(z, even)
    }
}

impl Real for f64 {
    type Mask = bool;
    #[inline(always)]
    fn splat(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn lt(self, other: f64) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: f64) -> bool {
        self <= other
    }
    #[inline(always)]
    fn equals(self, other: f64) -> bool {
        self == other
    }
    #[inline(always)]
    fn select(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        cfg_select! {
            feature = "std" => { f64::sqrt(self) }
            _ => { rounded::sqrt(self) }
        }
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn ln(self) -> f64 {
        cfg_select! {
            feature = "std" => { f64::ln(self) }
            _ => { logarithm::ln(self) }
        }
    }
    #[inline(always)]
    fn each<const N: usize, const M: usize>(
        values: [f64; N],
        function: impl Fn([f64; N]) -> [f64; M],
    ) -> [f64; M] {
        function(values)
    }
    #[inline(always)]
    fn mul_add(self, factor: f64, term: f64) -> f64 {
        cfg_select! {
            feature = "std" => { f64::mul_add(self, factor, term) }
            _ => { rounded::mul_add(self, factor, term) }
        }
    }
}

/// base^exponent, for base >= 0. With the feature `std` it is the standard library's.
#[inline]
pub(crate) fn power(base: f64, exponent: f64) -> f64 {
    cfg_select! {
        feature = "std" => { base.powf(exponent) }
        _ => { logarithm::power(base, exponent) }
    }
}

/// `k` itself. (The compiler would warn of an index in a branch that is never taken.)
#[inline(always)]
#[doc(hidden)]
pub const fn nth(k: usize) -> usize {
    k
}

/// How many items an array has that is made of three.
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct Count<const N: usize>;

impl<const N: usize> Count<N> {
    /// How many.
    #[inline(always)]
    pub const fn get(self) -> usize {
        N
    }
    /// So many of three, from the first on.
    #[inline(always)]
    pub const fn of<T: Copy>(self, three: [T; 3]) -> [T; N] {
        *three.first_chunk().expect("an array of at most three items")
    }
}

/// An array of at most three items that are the same. (`[value; N]` is a loop for the compiler, to be unrolled in each place where
/// it is inlined: a third of the time that the loops of a sweep take to compile.)
#[inline(always)]
pub const fn repeated<T: Copy, const N: usize>(value: T) -> [T; N] {
    Count.of([value, value, value])
}

/// An array of at most three items, made one by one: `per_axis!(k => a[k] + b[k])`.
///
/// As `core::array::from_fn`, but without a function in between: what is computed on lanes is inlined whole or not on lanes.
#[macro_export]
macro_rules! per_axis {
    ($k:ident => $value:expr) => {{
        let first = {
            let $k = $crate::real::nth(0);
            $value
        };
        let count = $crate::real::Count::<_>;
        let mut items = [first, first, first];
        if count.get() > 1 {
            let $k = $crate::real::nth(1);
            items[1] = $value;
        }
        if count.get() > 2 {
            let $k = $crate::real::nth(2);
            items[2] = $value;
        }
        count.of(items)
    }};
}
pub use per_axis;

/// `for_axis!(k in N => { .. })`: the block for k = 0 .. N, N at most 3, one after the other.
///
/// A loop over the axes that is left to the compiler may stay one, and then keeps its arrays in memory.
#[macro_export]
macro_rules! for_axis {
    ($k:ident in $n:ident => $body:block) => {{
        assert!($n <= 3);
        $crate::real::for_axis!(@one $k, 0, $n, $body);
        $crate::real::for_axis!(@one $k, 1, $n, $body);
        $crate::real::for_axis!(@one $k, 2, $n, $body);
    }};
    (@one $k:ident, $value:literal, $n:ident, $body:block) => {
        if $value < $n {
            let $k = $crate::real::nth($value);
            $body
        }
    };
}
pub use for_axis;

/// Inner product of two short vectors, summed in pairs from the first axis on.
#[inline(always)]
pub fn dot<const D: usize, R: Real>(a: [R; D], b: [R; D]) -> R {
    let mut sum = a[0] * b[0];
    for_axis!(axis in D => {
        if axis > 0 {
            sum = sum + a[axis] * b[axis];
        }
    });
    sum
}

/// The sum of a few numbers, from the first on.
#[inline(always)]
pub fn total<const D: usize, R: Real>(values: [R; D]) -> R {
    let mut sum = values[0];
    for_axis!(axis in D => {
        if axis > 0 {
            sum = sum + values[axis];
        }
    });
    sum
}

/// The largest of a few numbers.
#[inline(always)]
pub fn largest<const D: usize, R: Real>(values: [R; D]) -> R {
    let mut largest = values[0];
    for_axis!(axis in D => {
        if axis > 0 {
            largest = largest.max(values[axis]);
        }
    });
    largest
}

/// A sum that keeps what rounding drops (Neumaier 1974).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompensatedSum {
    high: f64,
    low: f64,
}

impl CompensatedSum {
    /// Add a number.
    pub fn add(&mut self, value: f64) {
        let sum = self.high + value;
        self.low += if self.high.abs() >= value.abs() {
            (self.high - sum) + value
        } else {
            (value - sum) + self.high
        };
        self.high = sum;
    }
    /// The sum.
    pub fn value(&self) -> f64 {
        if self.high.is_finite() { self.high + self.low } else { self.high }
    }
    /// The two numbers that make it, for a checkpoint.
    pub fn parts(&self) -> [f64; 2] {
        [self.high, self.low]
    }
    /// From [`CompensatedSum::parts`].
    pub fn from_parts([high, low]: [f64; 2]) -> CompensatedSum {
        CompensatedSum { high, low }
    }
}

#[cfg(test)]
mod tests {
    use super::Real;
    use std::prelude::v1::*;

    #[test]
    fn arcs_are_right_to_the_last_place_and_exact_at_the_ends() {
        let (mut worst, mut worst_root): (f64, f64) = (0.0, 0.0);
        for k in -200_000..=200_000 {
            let s = f64::from(k) / 200_000.0;
            let [ours, root] = Real::asin_and_cos(s);
            let (exact, exact_root) = (f64::asin(s), ((1.0 - s) * (1.0 + s)).sqrt());
            worst = worst.max((ours - exact).abs() / exact.abs().max(f64::MIN_POSITIVE));
            // 1 - s^2 as the schemes form it loses what lies below 1e-16 of 1.
            worst_root = worst_root.max((root - exact_root).abs() * exact_root);
            assert_eq!(Real::asin_and_cos(-s), [-ours, root]);
        }
        assert!(worst < 4.5e-16, "relative error {worst:e}");
        assert!(worst_root < 2.5e-16, "error of the root {worst_root:e}");
        assert_eq!(Real::asin_and_cos(1.0_f64), [core::f64::consts::FRAC_PI_2, 0.0]);
        assert_eq!(Real::asin_and_cos(-1.0_f64), [-core::f64::consts::FRAC_PI_2, 0.0]);
        assert_eq!(Real::asin_and_cos(0.0_f64), [0.0, 1.0]);
    }
}
