//! Cell values as struct of arrays.

use crate::disjoint::DisjointSlice;
use crate::grid::Layout;
use crate::parallel;
use granflow_model::scheme::{Components, MAX_COMPONENTS};
use std::marker::PhantomData;

/// One padded array for each component of a value of a cell.
#[derive(Debug, Default)]
pub struct Field {
    /// The components in double precision, each [`Layout::len`] numbers long, or 1 where a component is the same in all cells;
    /// empty where one is kept in single precision.
    doubles: Vec<Vec<f64>>,
    /// Those in single precision; empty where a component is kept in double precision.
    singles: Vec<Vec<f32>>,
}

/// Is a component one of those whose bits are set?
#[inline(always)]
pub(crate) const fn has(mask: u32, k: usize) -> bool {
    mask >> k & 1 == 1
}

/// Bytes that a grid keeps of a value in each cell.
pub(crate) const fn bytes_per_cell<P: Components<f64>>() -> usize {
    let (singles, shared) = (P::F32_MASK.count_ones() as usize, P::UNIFORM_MASK.count_ones() as usize);
    (P::COUNT - shared - singles) * size_of::<f64>() + singles * size_of::<f32>()
}

impl Field {
    /// Zeros for values of type `P`.
    pub fn zeros<P: Components<f64>>(layout: &Layout) -> Field {
        const {
            assert!(
                P::COUNT <= MAX_COMPONENTS,
                "too many components: raise MAX_COMPONENTS in granflow-model/src/scheme.rs"
            );
            assert!(P::F32_MASK & P::UNIFORM_MASK == 0, "a uniform component is kept in double precision");
            assert!((P::F32_MASK | P::UNIFORM_MASK) >> P::COUNT == 0, "a mask has bits of no component");
        };
        let double = |k: usize| zeros(Self::lengths::<P>(layout, k)[0]);
        let single = |k: usize| zeros(Self::lengths::<P>(layout, k)[1]);
        Field { doubles: (0..P::COUNT).map(double).collect(), singles: (0..P::COUNT).map(single).collect() }
    }
    /// How many numbers component `k` has in double and in single precision.
    fn lengths<P: Components<f64>>(layout: &Layout, k: usize) -> [usize; 2] {
        let length = if has(P::UNIFORM_MASK, k) { 1 } else { layout.len() };
        if has(P::F32_MASK, k) { [0, length] } else { [length, 0] }
    }
    /// A field of components in double precision that were taken from another.
    pub fn of(components: Vec<Vec<f64>>) -> Field {
        Field { singles: vec![Vec::new(); components.len()], doubles: components }
    }
    /// The components in double precision, padded; empty where one is kept in single precision.
    pub fn components(&self) -> &[Vec<f64>] {
        &self.doubles
    }
    /// The arrays of the components in double precision.
    pub(crate) fn arrays_mut(&mut self) -> impl Iterator<Item = &mut [f64]> {
        self.doubles.iter_mut().map(Vec::as_mut_slice)
    }
    /// The value of every cell, without the ghosts, by its column and row; components that are the same in all cells are
    /// taken from the first.
    pub(crate) fn fill<P: Components<f64>>(
        &mut self,
        layout: &Layout,
        value: impl Fn(usize, usize) -> P + Sync,
    ) {
        if P::UNIFORM_MASK != 0 {
            value(0, 0).store(|k, part| {
                if has(P::UNIFORM_MASK, k) {
                    self.doubles[k][0] = part;
                }
            });
        }
        let writer = self.writer::<P>();
        parallel::for_each(layout.rows, |row| {
            for column in 0..layout.columns {
                let place = layout.place(column as isize, row as isize);
                // SAFETY: a row belongs to one thread.
                unsafe { writer.replace(place, value(column, row)) };
            }
        });
    }
    /// Become those of `other`.
    pub(crate) fn copy_from(&mut self, other: &Field) {
        if self.doubles.len() != other.doubles.len() {
            *self = other.clone();
            return;
        }
        for (own, other) in self.doubles.iter_mut().zip(&other.doubles) {
            own.copy_from_slice(other);
        }
    }
    /// Go this share of the way to `end`, in double precision; what is the same stays so bit for bit.
    pub(crate) fn approach(&mut self, end: &Field, share: f64) {
        const AT_ONCE: usize = 1 << 14;
        for (own, end) in self.doubles.iter_mut().zip(&end.doubles) {
            parallel::for_each_chunk_mut(own, AT_ONCE, |from, own| {
                for (own, end) in own.iter_mut().zip(&end[from..]) {
                    if own != end {
                        *own += share * (end - *own);
                    }
                }
            });
        }
    }
    /// Does it hold values of type `P` in every place of the layout?
    pub(crate) fn holds<P: Components<f64>>(&self, layout: &Layout) -> bool {
        let fits = |k: usize| [self.doubles[k].len(), self.singles[k].len()] == Self::lengths::<P>(layout, k);
        [self.doubles.len(), self.singles.len()] == [P::COUNT; 2] && (0..P::COUNT).all(fits)
    }
    /// The value at `place`.
    #[inline(always)]
    pub fn get<P: Components<f64>>(&self, place: usize) -> P {
        P::load(|k| {
            if has(P::F32_MASK, k) {
                f64::from(self.singles[k][place])
            } else {
                self.doubles[k][if has(P::UNIFORM_MASK, k) { 0 } else { place }]
            }
        })
    }
    /// The values at `start` and the next places, opened for reading: one check for all numbers of a cell.
    ///
    /// # Panics
    /// If they reach beyond the arrays.
    pub fn row<P: Components<f64>>(&self, start: usize, len: usize) -> Row<'_, P> {
        for k in 0..P::COUNT {
            let there = if has(P::F32_MASK, k) { self.singles[k].len() } else { self.doubles[k].len() };
            let end = if has(P::UNIFORM_MASK, k) { Some(1) } else { start.checked_add(len) };
            assert!(end.is_some_and(|end| end <= there), "cells beyond their field");
        }
        Row { starts: self.starts::<P>(), start, len, owner: PhantomData }
    }
    /// Set the value at `place`, but for the parts that are the same in all cells.
    #[inline(always)]
    pub fn set<P: Components<f64>>(&mut self, place: usize, value: P) {
        value.store(|k, part| {
            if has(P::F32_MASK, k) {
                self.singles[k][place] = part as f32;
            } else if !has(P::UNIFORM_MASK, k) {
                self.doubles[k][place] = part;
            }
        });
    }
    /// The values, for several threads that read and replace those of disjoint places.
    pub(crate) fn writer<P: Components<f64>>(&mut self) -> Writer<'_, P> {
        Writer {
            doubles: self.doubles.iter_mut().map(|array| DisjointSlice::new(array)).collect(),
            singles: self.singles.iter_mut().map(|array| DisjointSlice::new(array)).collect(),
            values: PhantomData,
        }
    }
    /// Are the values at some places the same bit for bit? Places come as the first ones of rows of `width`.
    pub(crate) fn is_uniform(&self, starts: impl Iterator<Item = usize> + Clone, width: usize) -> bool {
        fn uniform<T: Copy, B: PartialEq>(
            part: &[T],
            bits: impl Fn(T) -> B,
            mut starts: impl Iterator<Item = usize> + Clone,
            width: usize,
        ) -> bool {
            let Some(first) = starts.clone().next().filter(|_| part.len() > 1) else { return true };
            let first = bits(part[first]);
            starts.all(|start| part[start..start + width].iter().all(|value| bits(*value) == first))
        }
        self.doubles.iter().all(|part| uniform(part, f64::to_bits, starts.clone(), width))
            && self.singles.iter().all(|part| uniform(part, f32::to_bits, starts.clone(), width))
    }
    /// Where the arrays begin, to be read with the precision of `P`.
    pub(crate) fn starts<P: Components<f64>>(&self) -> [*const u8; MAX_COMPONENTS] {
        let mut starts = [std::ptr::null(); MAX_COMPONENTS];
        for (k, start) in starts.iter_mut().enumerate().take(P::COUNT) {
            let single = has(P::F32_MASK, k);
            *start = if single { self.singles[k].as_ptr().cast() } else { self.doubles[k].as_ptr().cast() };
        }
        starts
    }
}

impl Clone for Field {
    fn clone(&self) -> Self {
        Field {
            doubles: self.doubles.iter().map(|part| copy(part)).collect(),
            singles: self.singles.iter().map(|part| copy(part)).collect(),
        }
    }
}

fn copy<T: Copy + Default>(part: &[T]) -> Vec<T> {
    let mut numbers = zeros(part.len());
    numbers.copy_from_slice(part);
    numbers
}

/// An array of zeros, on large pages where the system has them: a strip goes from row to row, and rows far from each other
/// are on as many small pages as there are rows and arrays.
pub(crate) fn zeros<T: Copy + Default>(len: usize) -> Vec<T> {
    let numbers = vec![T::default(); len];
    #[cfg(all(target_os = "linux", not(miri)))]
    {
        const PAGE: usize = 4096;
        let (start, bytes) = (numbers.as_ptr() as usize, size_of_val(numbers.as_slice()));
        let first = start.next_multiple_of(PAGE);
        // SAFETY: an advice on pages that belong wholly to the array; refused, it changes nothing.
        unsafe {
            libc::madvise(first as *mut _, (start + bytes).saturating_sub(first), libc::MADV_HUGEPAGE);
        }
    }
    numbers
}

/// Neighbouring places of a field, opened for reading.
#[derive(Clone, Copy)]
pub struct Row<'a, P> {
    starts: [*const u8; MAX_COMPONENTS],
    start: usize,
    len: usize,
    owner: PhantomData<(&'a Field, P)>,
}

impl<P: Components<f64>> Row<'_, P> {
    /// The value `i` places behind the first.
    #[inline(always)]
    pub fn get(&self, i: usize) -> P {
        assert!(i < self.len, "a cell beyond its row");
        let place = self.start + i;
        P::load(|k| {
            assert!(k < P::COUNT);
            // SAFETY: `Field::row` found the places in all arrays.
            unsafe { read::<P>(self.starts[k], k, place) }
        })
    }
}

/// Part `k` at `place` of an array that begins at `start`.
///
/// # Safety
/// The array holds the part of a `P`, and has the place.
#[inline(always)]
unsafe fn read<P: Components<f64>>(start: *const u8, k: usize, place: usize) -> f64 {
    // SAFETY: as the caller promises.
    unsafe {
        if has(P::F32_MASK, k) {
            f64::from(*start.cast::<f32>().add(place))
        } else {
            *start.cast::<f64>().add(if has(P::UNIFORM_MASK, k) { 0 } else { place })
        }
    }
}

/// The values of a field, written by several threads in disjoint places.
pub(crate) struct Writer<'a, P> {
    doubles: Vec<DisjointSlice<'a>>,
    singles: Vec<DisjointSlice<'a, f32>>,
    values: PhantomData<fn() -> P>,
}

impl<P: Components<f64>> Writer<'_, P> {
    /// The value at `place`.
    ///
    /// # Safety
    /// No other thread uses the place.
    pub(crate) unsafe fn get(&self, place: usize) -> P {
        // SAFETY: as the caller promises.
        P::load(|k| unsafe {
            if has(P::F32_MASK, k) {
                f64::from(self.singles[k].slice(place..place + 1)[0])
            } else {
                let place = if has(P::UNIFORM_MASK, k) { 0 } else { place };
                self.doubles[k].slice(place..place + 1)[0]
            }
        })
    }
    /// Set the value at `place`, but for the components that are the same in all cells; does a bit of it change?
    ///
    /// # Safety
    /// No other thread uses the place.
    pub(crate) unsafe fn replace(&self, place: usize, value: P) -> bool {
        let mut changes = false;
        // SAFETY: as the caller promises.
        value.store(|k, component| unsafe {
            if has(P::F32_MASK, k) {
                let kept = &mut self.singles[k].slice(place..place + 1)[0];
                changes |= kept.to_bits() != (component as f32).to_bits();
                *kept = component as f32;
            } else if !has(P::UNIFORM_MASK, k) {
                let kept = &mut self.doubles[k].slice(place..place + 1)[0];
                changes |= kept.to_bits() != component.to_bits();
                *kept = component;
            }
        });
        changes
    }
}
