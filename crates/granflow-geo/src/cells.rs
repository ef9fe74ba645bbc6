//! Work on all cells: side by side on all cores with the feature `threads`, one after the other without.

#[cfg(feature = "threads")]
use rayon::prelude::*;

/// The value of each of so many cells.
pub(crate) fn mapped<T: Send>(cells: usize, value: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    #[cfg(feature = "threads")]
    return (0..cells).into_par_iter().map(value).collect();
    #[cfg(not(feature = "threads"))]
    return (0..cells).map(value).collect();
}

/// What `both` makes of the values of the cells that have one, in any order; `none` where no cell has.
pub(crate) fn reduced<T: Copy + Send + Sync>(
    cells: usize,
    value: impl Fn(usize) -> Option<T> + Send + Sync,
    none: T,
    both: impl Fn(T, T) -> T + Send + Sync,
) -> T {
    #[cfg(feature = "threads")]
    return (0..cells).into_par_iter().filter_map(value).reduce(|| none, both);
    #[cfg(not(feature = "threads"))]
    return (0..cells).filter_map(value).fold(none, both);
}
