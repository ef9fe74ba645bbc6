//! What the inner loops ask of a vector of numbers: to be read and written, all or where a mask holds.

use granflow_model::real::Real;

/// The most numbers side by side.
pub(crate) const MAX_LANES: usize = 8;

/// A number, or several that are side by side in memory.
pub trait SimdVector: Real {
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
