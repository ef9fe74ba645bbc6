//! Work on the rows of an image: side by side on all cores with the feature `threads`, one after the other without.

#[cfg(feature = "threads")]
use rayon::prelude::*;

/// Calls `work` with the number and the pixels of every row of `columns` pixels.
pub(super) fn each<T: Send>(pixels: &mut [T], columns: usize, work: impl Fn(usize, &mut [T]) + Send + Sync) {
    #[cfg(feature = "threads")]
    pixels.par_chunks_mut(columns).enumerate().for_each(|(row, line)| work(row, line));
    #[cfg(not(feature = "threads"))]
    pixels.chunks_mut(columns).enumerate().for_each(|(row, line)| work(row, line));
}
