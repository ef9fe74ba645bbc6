//! The rows that a strip is computed from, small enough for the first-level cache.

use super::{MAX_COMPONENTS, STRIP};
use crate::lanes::{MAX_LANES, SimdVector};
use granflow_model::scheme::Components;
use std::mem::MaybeUninit;

/// Room for a vector before and behind the strip.
const PADDING: usize = MAX_LANES;
/// Numbers in a row.
const ROW: usize = PADDING + STRIP + PADDING;

/// A row of values, struct of arrays, of at most `MAX` parts.
#[repr(align(64))]
pub(super) struct Row<const MAX: usize>([[MaybeUninit<f64>; ROW]; MAX]);

impl<const MAX: usize> Row<MAX> {
    /// The values of the cells from `at` on.
    ///
    /// # Safety
    /// They have been put; or `at` is -1, or one vector reaches behind the end, and [`Row::fill_halo`] has been called.
    #[inline(always)]
    pub(super) unsafe fn get<L: SimdVector, P: Components<L>>(&self, at: isize) -> P {
        const { assert!(P::COUNT <= MAX && L::WIDTH <= MAX_LANES) };
        debug_assert!(at >= -1 && at + L::WIDTH as isize <= (STRIP + PADDING) as isize);
        let place = (PADDING as isize + at) as usize;
        // SAFETY: inside the row, and as the caller promises.
        P::load(
            #[inline(always)]
            |k| unsafe { L::load(self.0.get_unchecked(k).as_ptr().cast::<f64>().add(place)) },
        )
    }
    /// Put values, at most one vector behind the end.
    #[inline(always)]
    pub(super) fn put<L: SimdVector, P: Components<L>>(&mut self, at: usize, value: P) {
        const { assert!(P::COUNT <= MAX) };
        debug_assert!(at + L::WIDTH <= STRIP + PADDING);
        // SAFETY: inside the row.
        value.store(
            #[inline(always)]
            |k, part| unsafe {
                part.store(self.0.get_unchecked_mut(k).as_mut_ptr().cast::<f64>().add(PADDING + at));
            },
        );
    }
    /// Let the place before the first be as the first, and those behind `end` be 0.
    #[inline(always)]
    pub(super) fn fill_halo(&mut self, parts: usize, end: usize) {
        for part in &mut self.0[..parts] {
            part[PADDING - 1] = part[PADDING];
            part[PADDING + end..PADDING + end + PADDING].fill(MaybeUninit::new(0.0));
        }
    }
}

/// Most numbers of the edges, of the flux, of the corner of a scheme.
pub(super) const MAX_EDGES: usize = 40;
pub(super) const MAX_FLUX: usize = 8;
pub(super) const MAX_CORNER: usize = 1;

/// The rows of a strip.
pub(super) struct Scratch {
    /// Two rows of edges: of the row that is updated and the one above.
    pub edges: [Row<MAX_EDGES>; 2],
    /// Through the lower faces along x of a row.
    pub across: Row<MAX_FLUX>,
    /// Through the faces along y below a row.
    pub below: Row<MAX_FLUX>,
    /// At the lower left corners of a row, and of the row above.
    pub corners: [Row<MAX_CORNER>; 2],
    /// The new states of a row.
    pub updated: Row<MAX_COMPONENTS>,
    /// Which cells of each vector are those of the strip, a bit each.
    pub in_strip: [u16; STRIP],
}

impl Scratch {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let mut scratch = MaybeUninit::<Scratch>::uninit();
        let start = scratch.as_mut_ptr();
        // SAFETY: the rows are numbers that need not be initialized, the rest is. (A constant would be copied here.)
        unsafe {
            (&raw mut (*start).in_strip).write([0; STRIP]);
            scratch.assume_init()
        }
    }
}
