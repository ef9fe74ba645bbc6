//! Two vectors as one: while one waits for a division or a root, the other goes on.

use super::vector::SimdVector;
use granflow_model::real::Real;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Two of the same, the second behind the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<T>(T, T);

macro_rules! operators {
    ($($trait:ident $name:ident,)*) => {
        $(impl<T: $trait<Output = T>> $trait for Pair<T> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Pair(self.0.$name(other.0), self.1.$name(other.1))
            }
        })*
    };
}
operators!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor,);

impl<T: Neg<Output = T>> Neg for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Pair(-self.0, -self.1)
    }
}
impl<T: Not<Output = T>> Not for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Pair(!self.0, !self.1)
    }
}

impl<L: Real> Real for Pair<L> {
    type Mask = Pair<L::Mask>;
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Pair(L::splat(value), L::splat(value))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        Pair(self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        Pair(self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn equals(self, other: Self) -> Self::Mask {
        Pair(self.0.equals(other.0), self.1.equals(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Pair(L::select(mask.0, yes.0, no.0), L::select(mask.1, yes.1, no.1))
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        L::any(mask.0 | mask.1)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Pair(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Pair(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Pair(self.0.ln(), self.1.ln())
    }
    #[inline(always)]
    fn each<const N: usize, const M: usize>(
        values: [Self; N],
        function: impl Fn([f64; N]) -> [f64; M],
    ) -> [Self; M] {
        let first = L::each(values.map(|pair| pair.0), &function);
        let second = L::each(values.map(|pair| pair.1), &function);
        std::array::from_fn(|m| Pair(first[m], second[m]))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Pair(self.0.mul_add(factor.0, term.0), self.1.mul_add(factor.1, term.1))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Pair(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Pair(self.0.max(other.0), self.1.max(other.1))
    }
}

impl<L: SimdVector> SimdVector for Pair<L> {
    const WIDTH: usize = 2 * L::WIDTH;
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: as the caller promises.
        unsafe { Pair(L::load(from), L::load(from.add(L::WIDTH))) }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: as the caller promises.
        unsafe {
            self.0.store(to);
            self.1.store(to.add(L::WIDTH));
        }
    }
    #[inline(always)]
    unsafe fn load_where(mask: Self::Mask, from: *const f64) -> Self {
        // SAFETY: as the caller promises.
        unsafe { Pair(L::load_where(mask.0, from), L::load_where(mask.1, from.wrapping_add(L::WIDTH))) }
    }
    #[inline(always)]
    unsafe fn store_where(self, mask: Self::Mask, to: *mut f64) {
        // SAFETY: as the caller promises.
        unsafe {
            self.0.store_where(mask.0, to);
            self.1.store_where(mask.1, to.wrapping_add(L::WIDTH));
        }
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self.0.first()
    }
    #[inline(always)]
    fn holds(mask: Self::Mask, k: usize) -> bool {
        if k < L::WIDTH { L::holds(mask.0, k) } else { L::holds(mask.1, k - L::WIDTH) }
    }
    #[inline(always)]
    fn from_bits(bits: u64) -> Self::Mask {
        Pair(L::from_bits(bits), L::from_bits(bits >> L::WIDTH))
    }
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        L::all(mask.0 & mask.1)
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u64 {
        L::bits(mask.0) | L::bits(mask.1) << L::WIDTH
    }
}
