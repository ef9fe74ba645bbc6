//! Cell values as struct of arrays.

use crate::grid::Layout;
use crate::scheme::Parts;

/// One padded array per number of a cell value.
#[derive(Clone, Debug)]
pub struct Field {
    /// The arrays, each [`Layout::len`] long.
    pub parts: Vec<Vec<f64>>,
}

impl Field {
    /// Zeros for values of type `P`.
    pub fn zeros<P: Parts<f64>>(layout: &Layout) -> Field {
        Field { parts: vec![vec![0.0; layout.len()]; P::COUNT] }
    }
    /// The value at `place`.
    #[inline(always)]
    pub fn get<P: Parts<f64>>(&self, place: usize) -> P {
        P::gather(|k| self.parts[k][place])
    }
    /// Set the value at `place`.
    #[inline(always)]
    pub fn set<P: Parts<f64>>(&mut self, place: usize, value: P) {
        value.scatter(|k, part| self.parts[k][place] = part);
    }
}

/// Most numbers that a cell value has.
const MOST: usize = 16;

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
    /// The value at `place`.
    ///
    /// # Safety
    /// `place` is below [`Layout::len`] of the field's layout, and the field holds values of type `P`.
    #[inline(always)]
    pub unsafe fn get<P: Parts<f64>>(&self, place: usize) -> P {
        const { assert!(P::COUNT <= MOST) };
        P::gather(|k| {
            debug_assert!(place < self.parts[k].len());
            // SAFETY: as the caller promises; k < P::COUNT <= MOST.
            unsafe { *self.parts.get_unchecked(k).get_unchecked(place) }
        })
    }
}
