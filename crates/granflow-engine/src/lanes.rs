//! Several cells side by side: the same formulas on SIMD lanes, with the same bits.

mod pair;
#[cfg(test)]
mod tests;

#[cfg(target_arch = "aarch64")]
use fearless_simd::aarch64::Neon;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use fearless_simd::x86::{Avx2, Avx512};
use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, SimdMask};
use granflow_model::real::Real;
use pair::Pair;
use std::fmt::{Debug, Formatter, Result};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Most numbers side by side.
pub(crate) const MAX_LANES: usize = 16;

/// A number, or several, that lie side by side in memory.
pub(crate) trait SimdVector: Real {
    /// How many.
    const WIDTH: usize;
    /// Read them.
    ///
    /// # Safety
    /// `from` and the `WIDTH - 1` numbers behind it can be read.
    unsafe fn load(from: *const f64) -> Self;
    /// Write them.
    ///
    /// # Safety
    /// `to` and the `WIDTH - 1` places behind it can be written, and nobody else uses them.
    unsafe fn store(self, to: *mut f64);
    /// Read those of `mask`, 0 elsewhere.
    ///
    /// # Safety
    /// The places of `mask` from `from` on can be read.
    #[inline(always)]
    unsafe fn load_where(mask: Self::Mask, from: *const f64) -> Self {
        if Self::all(mask) {
            // SAFETY: as the caller promises.
            return unsafe { Self::load(from) };
        }
        let mut numbers = [0.0; MAX_LANES];
        for k in 0..Self::WIDTH {
            if Self::holds(mask, k) {
                // SAFETY: as the caller promises.
                numbers[k] = unsafe { *from.add(k) };
            }
        }
        // SAFETY: there are no more lanes.
        unsafe { Self::load(numbers.as_ptr()) }
    }
    /// Write those of `mask`.
    ///
    /// # Safety
    /// The places of `mask` from `to` on can be written, and nobody else uses them.
    #[inline(always)]
    unsafe fn store_where(self, mask: Self::Mask, to: *mut f64) {
        if Self::all(mask) {
            // SAFETY: as the caller promises.
            return unsafe { self.store(to) };
        }
        let mut numbers = [0.0; MAX_LANES];
        // SAFETY: there are no more lanes.
        unsafe { self.store(numbers.as_mut_ptr()) };
        for k in 0..Self::WIDTH {
            if Self::holds(mask, k) {
                // SAFETY: as the caller promises.
                unsafe { *to.add(k) = numbers[k] };
            }
        }
    }
    /// Read numbers of single precision.
    ///
    /// # Safety
    /// As [`SimdVector::load`].
    #[inline(always)]
    unsafe fn load_single(from: *const f32) -> Self {
        let mut numbers = [0.0; MAX_LANES];
        for k in 0..Self::WIDTH {
            // SAFETY: as the caller promises.
            numbers[k] = f64::from(unsafe { *from.add(k) });
        }
        // SAFETY: there are no more lanes.
        unsafe { Self::load(numbers.as_ptr()) }
    }
    /// Read those of `mask`, 0 elsewhere.
    ///
    /// # Safety
    /// As [`SimdVector::load_where`].
    #[inline(always)]
    unsafe fn load_single_where(mask: Self::Mask, from: *const f32) -> Self {
        if Self::all(mask) {
            // SAFETY: as the caller promises.
            return unsafe { Self::load_single(from) };
        }
        let mut numbers = [0.0; MAX_LANES];
        for k in 0..Self::WIDTH {
            if Self::holds(mask, k) {
                // SAFETY: as the caller promises.
                numbers[k] = f64::from(unsafe { *from.add(k) });
            }
        }
        // SAFETY: there are no more lanes.
        unsafe { Self::load(numbers.as_ptr()) }
    }
    /// Write those of `mask`, rounded to single precision.
    ///
    /// # Safety
    /// As [`SimdVector::store_where`].
    #[inline(always)]
    unsafe fn store_single_where(self, mask: Self::Mask, to: *mut f32) {
        let mut numbers = [0.0; MAX_LANES];
        // SAFETY: there are no more lanes.
        unsafe { self.store(numbers.as_mut_ptr()) };
        if Self::all(mask) {
            for k in 0..Self::WIDTH {
                // SAFETY: as the caller promises.
                unsafe { *to.add(k) = numbers[k] as f32 };
            }
            return;
        }
        for k in 0..Self::WIDTH {
            if Self::holds(mask, k) {
                // SAFETY: as the caller promises.
                unsafe { *to.add(k) = numbers[k] as f32 };
            }
        }
    }
    /// The first of them.
    fn first(self) -> f64;
    /// Holds in place `k`?
    fn holds(mask: Self::Mask, k: usize) -> bool;
    /// Holds in the places of the bits that are set, the first the lowest.
    fn from_bits(bits: u64) -> Self::Mask;
    /// Holds in every place?
    fn all(mask: Self::Mask) -> bool;
    /// The places that hold, a bit each, the first the lowest.
    fn bits(mask: Self::Mask) -> u64;
}

impl SimdVector for f64 {
    const WIDTH: usize = 1;
    #[inline(always)]
    unsafe fn load(from: *const f64) -> f64 {
        // SAFETY: as the caller promises.
        unsafe { *from }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: as the caller promises.
        unsafe { *to = self }
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self
    }
    #[inline(always)]
    fn holds(mask: bool, _: usize) -> bool {
        mask
    }
    #[inline(always)]
    fn from_bits(bits: u64) -> bool {
        bits & 1 == 1
    }
    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn bits(mask: bool) -> u64 {
        u64::from(mask)
    }
}

/// Ask for a number that will be read or written soon.
#[inline(always)]
pub(crate) fn prefetch(place: *const u8) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch may be given any address.
    unsafe {
        std::arch::x86_64::_mm_prefetch(place.cast(), std::arch::x86_64::_MM_HINT_T0);
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

/// The simd that a step is computed with; the results are the same bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimdLevel {
    /// One cell at a time.
    Scalar,
    /// The widest vectors of this processor: AVX-512, AVX2 or NEON; one cell at a time where it has none of them.
    Best,
    /// As `Best`, but no wider than AVX2.
    Avx2,
}

/// Work that any kind of lanes can do.
pub(crate) trait SimdKernel {
    /// What it gives.
    type Output;
    /// Do it; `run` calls a function where the simd of `L` are allowed.
    fn run<L: SimdVector>(self, inside: impl SimdContext) -> Self::Output;
}

/// Where the simd of some lanes are allowed.
pub(crate) trait SimdContext: Copy + Send + Sync {
    /// Call `work` there.
    fn call<T>(self, work: impl FnOnce() -> T) -> T;
}

#[derive(Clone, Copy)]
struct ScalarContext;

impl SimdContext for ScalarContext {
    #[inline(always)]
    fn call<T>(self, work: impl FnOnce() -> T) -> T {
        work()
    }
}

#[derive(Clone, Copy)]
struct VectorContext<S>(S);

impl<S: Simd> SimdContext for VectorContext<S> {
    #[inline(always)]
    fn call<T>(self, work: impl FnOnce() -> T) -> T {
        self.0.vectorize(work)
    }
}

impl SimdLevel {
    /// Let `job` use them.
    pub(crate) fn run<J: SimdKernel>(self, job: J) -> J::Output {
        match (self, Level::new()) {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            (SimdLevel::Best, Level::Avx512(simd)) => job.run::<Lanes<Avx512>>(VectorContext(simd)),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            (SimdLevel::Best | SimdLevel::Avx2, level) if level.as_avx2().is_some() => {
                job.run::<Pair<Lanes<Avx2>>>(VectorContext(level.as_avx2().expect("just seen")))
            }
            #[cfg(target_arch = "aarch64")]
            (SimdLevel::Best | SimdLevel::Avx2, Level::Neon(simd)) => {
                job.run::<Pair<Lanes<Neon>>>(VectorContext(simd))
            }
            _ => job.run::<f64>(ScalarContext),
        }
    }

    /// What they are on this processor.
    pub fn found(self) -> &'static str {
        match (self, Level::new()) {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            (SimdLevel::Best, Level::Avx512(_)) => "AVX-512, vectors of 8 cells",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            (SimdLevel::Best | SimdLevel::Avx2, level) if level.as_avx2().is_some() => {
                "AVX2, two vectors of 4 cells"
            }
            #[cfg(target_arch = "aarch64")]
            (SimdLevel::Best | SimdLevel::Avx2, Level::Neon(_)) => "NEON, two vectors of 2 cells",
            _ => "scalar, one cell at a time",
        }
    }
}

/// As many numbers as a vector of `S` holds.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd>(S::f64s);

impl<S: Simd> Lanes<S> {
    /// The proof that the processor has these simd; lanes are made only where [`SimdLevel::run`] found one.
    #[inline(always)]
    fn proof() -> S {
        const { assert!(size_of::<S>() == 0) };
        // SAFETY: a proof holds nothing, and `SimdLevel::run` had one.
        unsafe { std::mem::zeroed() }
    }
    #[inline(always)]
    fn each(self, f: impl Fn(f64) -> f64) -> Self {
        let numbers = self.0;
        Lanes(S::f64s::from_fn(Self::proof(), |k| f(numbers.as_slice()[k])))
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
        self.each(f64::ln)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
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
