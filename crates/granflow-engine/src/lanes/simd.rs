//! One vector of the processor's as a [`Real`].

use super::vector::{MAX_LANES, SimdVector};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};
use granflow_model::real::Real;
use std::fmt::{Debug, Formatter, Result};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// As many numbers as a vector of `S` holds.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd>(S::f64s);

impl<S: Simd> Lanes<S> {
    /// The proof that the processor has these simd; lanes are made only where [`super::level::SimdLevel::run`] found one.
    #[inline(always)]
    fn proof() -> S {
        const { assert!(size_of::<S>() == 0) };
        // SAFETY: a proof holds nothing, and [`super::level::SimdLevel::run`] had one.
        unsafe { std::mem::zeroed() }
    }
}

impl<S: Simd> Debug for Lanes<S> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        self.0.as_slice().fmt(f)
    }
}

/// Lanes in which something holds.
#[derive(Clone, Copy)]
pub(crate) struct LaneMask<S: Simd>(S::mask64s);

impl<S: Simd> Debug for LaneMask<S> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{:b}", self.0.to_bitmask())
    }
}
impl<S: Simd> BitAnd for LaneMask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        LaneMask(self.0 & other.0)
    }
}
impl<S: Simd> BitOr for LaneMask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        LaneMask(self.0 | other.0)
    }
}
impl<S: Simd> Not for LaneMask<S> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        LaneMask(!self.0)
    }
}
impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Lanes(self.0 + other.0)
    }
}
impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Lanes(self.0 - other.0)
    }
}
impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Lanes(self.0 * other.0)
    }
}
impl<S: Simd> Div for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Lanes(self.0 / other.0)
    }
}
impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(-self.0)
    }
}

impl<S: Simd> Real for Lanes<S> {
    type Mask = LaneMask<S>;
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Lanes(S::f64s::splat(Self::proof(), value))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<S> {
        LaneMask(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> LaneMask<S> {
        LaneMask(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn equals(self, other: Self) -> LaneMask<S> {
        LaneMask(self.0.simd_eq(other.0))
    }
    #[inline(always)]
    fn select(mask: LaneMask<S>, yes: Self, no: Self) -> Self {
        Lanes(mask.0.select(yes.0, no.0))
    }
    #[inline(always)]
    fn any(mask: LaneMask<S>) -> bool {
        mask.0.any_true()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Lanes(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Lanes(self.0.abs())
    }
    #[inline(always)]
    fn ln(self) -> Self {
        let numbers = self.0;
        Lanes(S::f64s::from_fn(Self::proof(), |k| numbers.as_slice()[k].ln()))
    }
    #[inline(always)]
    fn each<const N: usize, const M: usize>(
        values: [Self; N],
        function: impl Fn([f64; N]) -> [f64; M],
    ) -> [Self; M] {
        let mut found = [[0.0; MAX_LANES]; M];
        for k in 0..Self::WIDTH {
            let one = function(std::array::from_fn(|n| values[n].0.as_slice()[k]));
            for m in 0..M {
                found[m][k] = one[m];
            }
        }
        found.map(|numbers| Lanes(S::f64s::from_fn(Self::proof(), |k| numbers[k])))
    }
    /// WebAssembly's vectors round twice: there each number is taken by itself.
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        if cfg!(target_arch = "wasm32") {
            return Self::each([self, factor, term], |[a, b, c]| [a.mul_add(b, c)])[0];
        }
        Lanes(self.0.mul_add(factor.0, term.0))
    }
    /// On x86 the instruction is select(self < other) to the bit, zeros and what is not a number included.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Lanes(self.0.min(other.0))
    }
    /// As `min`.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Lanes(self.0.max(other.0))
    }
}

impl<S: Simd> SimdVector for Lanes<S> {
    const WIDTH: usize = <S::f64s as SimdBase<S>>::LEN;
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: as the caller promises.
        let numbers = unsafe { std::slice::from_raw_parts(from, Self::WIDTH) };
        Lanes(S::f64s::from_slice(Self::proof(), numbers))
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: as the caller promises.
        self.0.store_slice(unsafe { std::slice::from_raw_parts_mut(to, Self::WIDTH) });
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self.0.as_slice()[0]
    }
    #[inline(always)]
    fn holds(mask: LaneMask<S>, k: usize) -> bool {
        mask.0.test(k)
    }
    #[inline(always)]
    fn from_bits(bits: u64) -> LaneMask<S> {
        LaneMask(S::mask64s::from_bitmask(Self::proof(), bits & ((1 << Self::WIDTH) - 1)))
    }
    #[inline(always)]
    fn all(mask: LaneMask<S>) -> bool {
        mask.0.all_true()
    }
    #[inline(always)]
    fn bits(mask: LaneMask<S>) -> u64 {
        mask.0.to_bitmask()
    }
}
