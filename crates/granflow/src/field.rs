//! Cell values as struct of arrays.

use crate::grid::Layout;
use crate::scheme::Parts;

/// One padded array per number of a cell value.
#[derive(Debug, Default)]
pub struct Field {
    /// The arrays, each [`Layout::len`] long.
    pub parts: Vec<Vec<f64>>,
}

impl Field {
    /// Zeros for values of type `P`.
    pub fn zeros<P: Parts<f64>>(layout: &Layout) -> Field {
        Field { parts: (0..P::COUNT).map(|_| zeros(layout.len())).collect() }
    }
    /// The value at `place`.
    #[inline(always)]
    pub fn get<P: Parts<f64>>(&self, place: usize) -> P {
        P::gather(|k| self.parts[k][place])
    }
    /// The values at `start` and the next places, opened for reading: one check for all numbers of a cell.
    ///
    /// # Panics
    /// If they reach beyond the arrays.
    pub fn row(&self, start: usize, len: usize) -> Row<'_> {
        let part = |k: usize| self.parts.get(k).map_or(&[][..], |part| &part[start..start + len]);
        Row { parts: std::array::from_fn(part), count: self.parts.len(), len }
    }
    /// Set the value at `place`.
    #[inline(always)]
    pub fn set<P: Parts<f64>>(&mut self, place: usize, value: P) {
        value.scatter(|k, part| self.parts[k][place] = part);
    }
}

impl Clone for Field {
    fn clone(&self) -> Self {
        let copy = |part: &Vec<f64>| {
            let mut numbers = zeros(part.len());
            numbers.copy_from_slice(part);
            numbers
        };
        Field { parts: self.parts.iter().map(copy).collect() }
    }
}

/// An array of zeros, on large pages where the system has them: a strip goes from row to row, and rows far from each other
/// lie on as many small pages as there are rows and arrays.
fn zeros(len: usize) -> Vec<f64> {
    let numbers = vec![0.0; len];
    #[cfg(target_os = "linux")]
    {
        const PAGE: usize = 4096;
        let (start, bytes) = (numbers.as_ptr() as usize, len * size_of::<f64>());
        let first = start.next_multiple_of(PAGE);
        // SAFETY: an advice on pages that are wholly ours; refused, it changes nothing.
        unsafe {
            libc::madvise(first as *mut _, (start + bytes).saturating_sub(first), libc::MADV_HUGEPAGE);
        }
    }
    numbers
}

/// Most numbers that a cell value has.
pub(crate) const MOST: usize = 16;

/// Neighbouring places of a field, opened for reading.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    parts: [&'a [f64]; MOST],
    count: usize,
    len: usize,
}

impl Row<'_> {
    /// The value `i` places behind the first.
    #[inline(always)]
    pub fn get<P: Parts<f64>>(&self, i: usize) -> P {
        assert!(i < self.len && P::COUNT <= self.count, "a cell beyond its row");
        // SAFETY: the parts below COUNT are `len` long, and `Parts` asks for no others.
        P::gather(|k| unsafe { *self.parts[k].get_unchecked(i) })
    }
}

/// A field opened for reading in the inner loop.
#[derive(Clone, Copy)]
pub struct View<'a> {
    parts: [&'a [f64]; MOST],
}

impl Field {
    /// Open for reading.
    pub fn view(&self) -> View<'_> {
        View { parts: std::array::from_fn(|k| self.parts.get(k).map_or(&[][..], Vec::as_slice)) }
    }
}

impl View<'_> {
    /// Array number `k`.
    pub fn part(&self, k: usize) -> &[f64] {
        self.parts[k]
    }
    /// Where the arrays begin.
    pub(crate) fn starts(&self) -> [*const f64; MOST] {
        self.parts.map(<[f64]>::as_ptr)
    }
}
