//! Work on several threads, by rayon; without the feature `threads` the same work on one. No result depends on it.
//!
//! All work goes through one function that is generic in nothing ([`pool::each`]): else every loop of every scheme would have rayon's
//! splitting and stealing compiled for itself, in each crate that steps it.

use crate::disjoint::DisjointSlice;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

#[cfg(feature = "threads")]
mod pool {
    use rayon::prelude::*;

    /// How many threads work.
    pub(crate) fn threads() -> usize {
        rayon::current_num_threads()
    }
    /// Each number below `count`, once; a thread that is free takes at most `together` of them.
    pub(super) fn each(count: usize, together: usize, work: &(dyn Fn(usize) + Sync)) {
        (0..count).into_par_iter().with_max_len(together).for_each(work);
    }
}

#[cfg(not(feature = "threads"))]
mod pool {
    /// How many threads work.
    pub(crate) fn threads() -> usize {
        1
    }
    /// Each number below `count`, once.
    pub(super) fn each(count: usize, _together: usize, work: &(dyn Fn(usize) + Sync)) {
        (0..count).for_each(work);
    }
}

pub(crate) use pool::threads;

/// Each number below `count`.
pub(crate) fn for_each(count: usize, work: impl Fn(usize) + Sync) {
    pool::each(count, usize::MAX, &work);
}

/// The items in chunks of `size`, each of which one thread takes when it is free.
pub(crate) fn for_each_chunk<T: Sync>(items: &[T], size: usize, work: impl Fn(&[T]) + Sync) {
    let start = |chunk: usize| (chunk * size).min(items.len());
    pool::each(items.len().div_ceil(size), 1, &|chunk| work(&items[start(chunk)..start(chunk + 1)]));
}

/// The items in chunks of `size`, each with the number of its first one.
pub(crate) fn for_each_chunk_mut<T: Send>(
    items: &mut [T],
    size: usize,
    work: impl Fn(usize, &mut [T]) + Sync,
) {
    let len = items.len();
    let start = |chunk: usize| (chunk * size).min(len);
    let items = DisjointSlice::new(items);
    pool::each(len.div_ceil(size), usize::MAX, &|chunk| {
        // SAFETY: a chunk belongs to one thread.
        work(start(chunk), unsafe { items.slice(start(chunk)..start(chunk + 1)) });
    });
}

/// The values of the numbers below `count`, in their order.
pub(crate) fn map<T: Default + Send>(count: usize, value: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut values: Vec<T> = (0..count).map(|_| T::default()).collect();
    for_each_chunk_mut(&mut values, 1, |number, place| place[0] = value(number));
    values
}

/// Is there such a number below `count`?
pub(crate) fn any(count: usize, is: impl Fn(usize) -> bool + Sync) -> bool {
    let found = AtomicBool::new(false);
    for_each(count, |number| {
        if !found.load(Relaxed) && is(number) {
            found.store(true, Relaxed);
        }
    });
    found.into_inner()
}
