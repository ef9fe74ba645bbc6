//! The rows that a strip is computed from, small enough for the first-level cache.

use super::{MOST_PARTS, STRIP};
use crate::lanes::{MOST_LANES, Wide};
use granflow_model::scheme::Parts;
use std::mem::MaybeUninit;

/// Room for a vector before and behind the strip.
const ROOM: usize = MOST_LANES;
/// Numbers in a row.
const ROW: usize = ROOM + STRIP + ROOM;

/// A row of values, struct of arrays, of at most `MOST` parts.
#[repr(align(64))]
pub(super) struct Row<const MOST: usize>([[MaybeUninit<f64>; ROW]; MOST]);

impl<const MOST: usize> Row<MOST> {
    /// The values of the cells from `at` on.
    ///
    /// # Safety
    /// They have been put; or `at` is -1, or one vector reaches behind the end, and [`Row::mend`] has been called.
    #[inline(always)]
    pub(super) unsafe fn get<L: Wide, P: Parts<L>>(&self, at: isize) -> P {
        const { assert!(P::COUNT <= MOST && L::WIDTH <= MOST_LANES) };
        debug_assert!(at >= -1 && at + L::WIDTH as isize <= (STRIP + ROOM) as isize);
        let place = (ROOM as isize + at) as usize;
        // SAFETY: inside the row, and as the caller promises.
        P::gather(
            #[inline(always)]
            |k| unsafe { L::load(self.0.get_unchecked(k).as_ptr().cast::<f64>().add(place)) },
        )
    }
    /// Put values, at most one vector behind the end.
    #[inline(always)]
    pub(super) fn put<L: Wide, P: Parts<L>>(&mut self, at: usize, value: P) {
        const { assert!(P::COUNT <= MOST) };
        debug_assert!(at + L::WIDTH <= STRIP + ROOM);
        // SAFETY: inside the row.
        value.scatter(
            #[inline(always)]
            |k, part| unsafe {
                part.store(self.0.get_unchecked_mut(k).as_mut_ptr().cast::<f64>().add(ROOM + at));
            },
        );
    }
    /// Let the place before the first be as the first, and those behind `end` be 0.
    #[inline(always)]
    pub(super) fn mend(&mut self, parts: usize, end: usize) {
        for part in &mut self.0[..parts] {
            part[ROOM - 1] = part[ROOM];
            part[ROOM + end..ROOM + end + ROOM].fill(MaybeUninit::new(0.0));
        }
    }
}

/// Most numbers of the edges, of the flux, of the corner of a scheme.
pub(super) const MOST_EDGES: usize = 40;
pub(super) const MOST_FLUX: usize = 8;
pub(super) const MOST_CORNER: usize = 1;

/// The rows of a strip.
pub(super) struct Scratch {
    /// Two rows of edges: of the row that is updated and the one above.
    pub edges: [Row<MOST_EDGES>; 2],
    /// Through the lower faces along x of a row.
    pub across: Row<MOST_FLUX>,
    /// Through the faces along y below a row.
    pub below: Row<MOST_FLUX>,
    /// At the lower left corners of a row, and of the row above.
    pub corners: [Row<MOST_CORNER>; 2],
    /// The new states of a row.
    pub fresh: Row<MOST_PARTS>,
    /// Which cells of each vector are those of the strip, a bit each.
    pub ours: [u16; STRIP],
}

impl Scratch {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let mut scratch = MaybeUninit::<Scratch>::uninit();
        let start = scratch.as_mut_ptr();
        // SAFETY: the rows are numbers that need not be initialized, the rest is. (A constant would be copied here.)
        unsafe {
            (&raw mut (*start).ours).write([0; STRIP]);
            scratch.assume_init()
        }
    }
}
