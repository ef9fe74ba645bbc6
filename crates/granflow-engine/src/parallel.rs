//! Work on several threads, by rayon; without the feature `threads` the same work on one. No result depends on it.

#[cfg(feature = "threads")]
mod pool {
    use rayon::prelude::*;

    /// How many threads work.
    pub(crate) fn threads() -> usize {
        rayon::current_num_threads()
    }
    /// Each number below `count`.
    pub(crate) fn for_each(count: usize, work: impl Fn(usize) + Send + Sync) {
        (0..count).into_par_iter().for_each(work);
    }
    /// The items in chunks of `size`, each of which one thread takes when it is free.
    pub(crate) fn for_each_chunk<T: Sync>(items: &[T], size: usize, work: impl Fn(&[T]) + Send + Sync) {
        items.par_chunks(size).with_max_len(1).for_each(work);
    }
    /// The items in chunks of `size`, each with the number of its first one.
    pub(crate) fn for_each_chunk_mut<T: Send>(
        items: &mut [T],
        size: usize,
        work: impl Fn(usize, &mut [T]) + Send + Sync,
    ) {
        items.par_chunks_mut(size).enumerate().for_each(|(k, chunk)| work(k * size, chunk));
    }
    /// The values of the numbers below `count`, in their order.
    pub(crate) fn map<T: Send>(count: usize, value: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
        (0..count).into_par_iter().map(value).collect()
    }
    /// Is there such a number below `count`?
    pub(crate) fn any(count: usize, is: impl Fn(usize) -> bool + Send + Sync) -> bool {
        (0..count).into_par_iter().any(is)
    }
}

#[cfg(not(feature = "threads"))]
mod pool {
    /// How many threads work.
    pub(crate) fn threads() -> usize {
        1
    }
    /// Each number below `count`.
    pub(crate) fn for_each(count: usize, work: impl Fn(usize) + Send + Sync) {
        (0..count).for_each(work);
    }
    /// The items in chunks of `size`.
    pub(crate) fn for_each_chunk<T: Sync>(items: &[T], size: usize, work: impl Fn(&[T]) + Send + Sync) {
        items.chunks(size).for_each(work);
    }
    /// The items in chunks of `size`, each with the number of its first one.
    pub(crate) fn for_each_chunk_mut<T: Send>(
        items: &mut [T],
        size: usize,
        work: impl Fn(usize, &mut [T]) + Send + Sync,
    ) {
        items.chunks_mut(size).enumerate().for_each(|(k, chunk)| work(k * size, chunk));
    }
    /// The values of the numbers below `count`, in their order.
    pub(crate) fn map<T: Send>(count: usize, value: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
        (0..count).map(value).collect()
    }
    /// Is there such a number below `count`?
    pub(crate) fn any(count: usize, is: impl Fn(usize) -> bool + Send + Sync) -> bool {
        (0..count).any(is)
    }
}

pub(crate) use pool::{any, for_each, for_each_chunk, for_each_chunk_mut, map, threads};
