//! Arrays that several threads write in disjoint places.

use crate::lanes::SimdVector;
use std::marker::PhantomData;
use std::ops::Range;

/// An array of which several threads write disjoint places.
pub(crate) struct DisjointSlice<'a, T = f64> {
    start: *mut T,
    len: usize,
    owner: PhantomData<&'a mut [T]>,
}
// SAFETY: it is only read and written through its unsafe functions, whose callers own disjoint places.
unsafe impl<T: Send> Sync for DisjointSlice<'_, T> {}
// SAFETY: as above.
unsafe impl<T: Send> Send for DisjointSlice<'_, T> {}

impl<'a, T> DisjointSlice<'a, T> {
    pub(crate) fn new(values: &'a mut [T]) -> Self {
        DisjointSlice { start: values.as_mut_ptr(), len: values.len(), owner: PhantomData }
    }
    /// Where the array begins.
    pub(crate) fn start(&self) -> *mut T {
        self.start
    }
    /// Some of the places.
    ///
    /// # Safety
    /// Nobody else uses them while the slice lives.
    pub(crate) unsafe fn slice(&self, places: Range<usize>) -> &'a mut [T] {
        assert!(places.start <= places.end && places.end <= self.len);
        // SAFETY: in bounds, and nobody else uses these places.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(places.start), places.len()) }
    }
}

impl DisjointSlice<'_, f32> {
    /// The numbers from `place` on where `mask` holds, else 0.
    ///
    /// # Safety
    /// The places of `mask` belong to the array, and no other thread writes them while the slice lives.
    #[inline(always)]
    pub(crate) unsafe fn get<L: SimdVector>(&self, place: usize, mask: L::Mask) -> L {
        debug_assert!(place + L::WIDTH <= self.len);
        // SAFETY: as the caller promises.
        unsafe { L::load_single_where(mask, self.start.add(place)) }
    }
    /// Set the numbers from `place` on where `mask` holds.
    ///
    /// # Safety
    /// The places of `mask` belong to the array, and no other thread uses them while the slice lives.
    #[inline(always)]
    pub(crate) unsafe fn put<L: SimdVector>(&self, place: usize, mask: L::Mask, value: L) {
        debug_assert!(place + L::WIDTH <= self.len);
        // SAFETY: as the caller promises.
        unsafe { value.store_single_where(mask, self.start.add(place)) }
    }
}
