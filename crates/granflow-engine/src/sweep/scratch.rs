//! The rows that a strip is computed from, small enough for the second-level cache.

use super::reducer::TileReducer;
use crate::lanes::{MAX_LANES, SimdVector};
use crate::tiles::STRIP;
use granflow_model::scheme::{Components, Scheme};
use std::cell::RefCell;
use std::marker::PhantomData;

/// Room for a vector before the rows, and behind each.
const PADDING: usize = MAX_LANES;
/// Rows of full length that are computed at a time; of shorter ones as many as fit into their place, a power of two.
const ROWS: usize = 4;
const _: () = assert!(ROWS >= 3, "of forecasts, which are found row by row, three rows are needed");

/// Numbers in a line of the cache.
const LINE: usize = 8;

/// A line of the cache.
#[derive(Clone, Copy)]
#[repr(align(64))]
#[expect(dead_code, reason = "it is read through pointers")]
struct Line([f64; LINE]);

/// The memory that a thread computes strips in: made when it computes its first one, as large as the largest scheme asks for. It
/// begins as zeros; later strips find the numbers of earlier ones, and use none of them.
pub(super) struct Workspace {
    lines: Vec<Line>,
    in_strip: [u16; STRIP],
}

thread_local! {
    static WORKSPACE: RefCell<Workspace> = const { RefCell::new(Workspace { lines: Vec::new(), in_strip: [0; STRIP] }) };
}

impl Workspace {
    /// Let `work` use this thread's memory, for strips of a scheme.
    pub(super) fn with<const D: usize, L: SimdVector, T: Scheme<D, L>>(work: impl FnOnce(Memory)) {
        const { assert!(STRIP.is_multiple_of(LINE) && PADDING.is_multiple_of(LINE)) };
        let numbers = Scratch::<D, L, T>::NUMBERS + TileReducer::numbers(T::State::COUNT);
        WORKSPACE.with_borrow_mut(|Workspace { lines, in_strip }| {
            let count = numbers.div_ceil(LINE);
            if lines.len() < count {
                *lines = vec![Line([0.0; LINE]); count];
            }
            let start = lines.as_mut_ptr().cast();
            work(Memory { start, len: lines.len() * LINE, in_strip, owner: PhantomData });
        });
    }
}

/// The numbers of a workspace.
pub(super) struct Memory<'a> {
    start: *mut f64,
    len: usize,
    in_strip: &'a mut [u16; STRIP],
    owner: PhantomData<&'a mut [f64]>,
}

impl<'a> Memory<'a> {
    /// Cut it into the rows that a scheme needs.
    #[inline(always)]
    pub(super) fn cut<const D: usize, L: SimdVector, T: Scheme<D, L>>(
        self,
    ) -> (Scratch<'a, D, L, T>, TileReducer<'a>) {
        let Memory { start, len, in_strip, .. } = self;
        let rows = Scratch::<D, L, T>::NUMBERS;
        assert!(rows + TileReducer::numbers(T::State::COUNT) <= len);
        // SAFETY: there are as many numbers, borrowed for 'a, and the rows do not overlap.
        unsafe { (Scratch::at(start, in_strip), TileReducer::at(start.add(rows), T::State::COUNT)) }
    }
}

/// Rows of values, struct of arrays: `KEPT` times as many as are computed at a time, each in the place of one that is no longer
/// needed.
pub(super) struct Rows<'a, L, P, const KEPT: usize> {
    start: *mut f64,
    /// Numbers from one row to the next.
    pitch: usize,
    /// One less than there are rows, a power of two.
    mask: usize,
    owner: PhantomData<&'a mut [f64]>,
    values: PhantomData<fn() -> (L, P)>,
}

/// Numbers of a component in all rows.
const fn room(kept: usize) -> usize {
    PADDING + kept * ROWS * (STRIP + PADDING)
}

impl<L: SimdVector, P: Components<L>, const KEPT: usize> Rows<'_, L, P, KEPT> {
    /// How many numbers they have.
    const NUMBERS: usize = P::COUNT * room(KEPT);

    /// The rows that begin at `place`, which moves behind them.
    ///
    /// # Safety
    /// Their numbers belong to the rows alone as long as they are used.
    unsafe fn cut(place: &mut *mut f64) -> Self {
        let start = *place;
        // SAFETY: as the caller promises.
        *place = unsafe { start.add(Self::NUMBERS) };
        Rows { start, pitch: 0, mask: 0, owner: PhantomData, values: PhantomData }
    }
    /// The same rows, by value.
    #[inline(always)]
    fn reborrow(&mut self) -> Rows<'_, L, P, KEPT> {
        Rows { owner: PhantomData, ..*self }
    }
    /// Let them have `end` cells, and `at_once` of them be computed at a time.
    fn keep(&mut self, at_once: usize, end: usize) {
        let kept = KEPT * at_once;
        assert!(kept.is_power_of_two() && PADDING + kept * (end + PADDING) <= room(KEPT));
        (self.mask, self.pitch) = (kept - 1, end + PADDING);
    }
    /// Row `number`, two below the grid at least.
    #[inline(always)]
    pub(super) fn row(&self, number: isize) -> Row<'_, L, P, KEPT> {
        // SAFETY: there are so many rows.
        let start = unsafe { self.start.add(((number + 2) as usize & self.mask) * self.pitch) };
        Row { start, owner: PhantomData, values: PhantomData }
    }
    /// Row `number`, to be written.
    #[inline(always)]
    pub(super) fn row_mut(&mut self, number: isize) -> RowMut<'_, L, P, KEPT> {
        RowMut(self.row(number))
    }
    /// Row `number`, and the one above to be written.
    #[inline(always)]
    pub(super) fn with_next(&mut self, number: isize) -> (Row<'_, L, P, KEPT>, RowMut<'_, L, P, KEPT>) {
        const { assert!(KEPT > 1, "there is no row above") };
        (self.row(number), RowMut(self.row(number + 1)))
    }
}

/// One of several rows, to be read.
pub(super) struct Row<'a, L, P, const KEPT: usize> {
    start: *mut f64,
    owner: PhantomData<&'a [f64]>,
    values: PhantomData<fn() -> (L, P)>,
}

/// One of several rows, to be written.
pub(super) struct RowMut<'a, L, P, const KEPT: usize>(Row<'a, L, P, KEPT>);

impl<L: SimdVector, P: Components<L>, const KEPT: usize> Row<'_, L, P, KEPT> {
    /// The values of the cells from `at` on.
    ///
    /// # Safety
    /// `at` is -1 or a cell of the strip, or a vector reaches at most its width behind the end.
    #[inline(always)]
    pub(super) unsafe fn get(&self, at: isize) -> P {
        const { assert!(L::WIDTH <= MAX_LANES) };
        debug_assert!(at >= -1 && at + L::WIDTH as isize <= (STRIP + PADDING) as isize);
        let place = (PADDING as isize + at) as usize;
        P::load(
            #[inline(always)]
            |k| {
                assert!(k < P::COUNT);
                // SAFETY: inside the row.
                unsafe { L::load(self.start.add(k * room(KEPT) + place)) }
            },
        )
    }
}

impl<'a, L, P, const KEPT: usize> std::ops::Deref for RowMut<'a, L, P, KEPT> {
    type Target = Row<'a, L, P, KEPT>;
    #[inline(always)]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<L: SimdVector, P: Components<L>, const KEPT: usize> RowMut<'_, L, P, KEPT> {
    /// Put values.
    ///
    /// # Safety
    /// As for [`Row::get`].
    #[inline(always)]
    pub(super) unsafe fn put(&mut self, at: isize, value: P) {
        debug_assert!(at >= -1 && at + L::WIDTH as isize <= (STRIP + PADDING) as isize);
        value.store(
            #[inline(always)]
            |k, part| {
                assert!(k < P::COUNT);
                // SAFETY: inside the row.
                unsafe { part.store(self.0.start.add(k * room(KEPT) + (PADDING as isize + at) as usize)) };
            },
        );
    }
}

/// The rows of a strip.
pub(super) struct Scratch<'a, const D: usize, L: SimdVector, T: Scheme<D, L>> {
    /// Forecasts: of the rows whose face states are found, and of the ones below and above.
    pub forecasts: Rows<'a, L, T::Forecast, 1>,
    /// Face states: of the rows that are updated and the one above.
    pub face_states: Rows<'a, L, T::FaceStates, 2>,
    /// Through the lower faces along x of the rows that are updated.
    pub along_x: Rows<'a, L, T::Flux, 1>,
    /// Through the lower faces along y of the rows that are updated and the one above.
    pub along_y: Rows<'a, L, T::Flux, 2>,
    /// At the lower left corners of the rows that are updated and the one above.
    pub corners: Rows<'a, L, T::Corner, 2>,
    /// The new states of a row.
    pub updated: Rows<'a, L, T::State, 1>,
    /// Which cells of each vector are those of the strip, a bit each.
    pub in_strip: &'a mut [u16; STRIP],
}

impl<'a, const D: usize, L: SimdVector, T: Scheme<D, L>> Scratch<'a, D, L, T> {
    /// The same rows, by value: a place behind a reference would be read again after every number that is written.
    #[inline(always)]
    pub(super) fn reborrow(&mut self) -> Scratch<'_, D, L, T> {
        Scratch {
            forecasts: self.forecasts.reborrow(),
            face_states: self.face_states.reborrow(),
            along_x: self.along_x.reborrow(),
            along_y: self.along_y.reborrow(),
            corners: self.corners.reborrow(),
            updated: self.updated.reborrow(),
            in_strip: self.in_strip,
        }
    }

    /// Let the rows have `end` cells; says how many are computed at a time.
    pub(super) fn fit(&mut self, end: usize) -> usize {
        let at_once = 1 << (ROWS * (STRIP + PADDING) / (end + PADDING)).ilog2();
        self.forecasts.keep(at_once, end);
        self.face_states.keep(at_once, end);
        self.along_x.keep(at_once, end);
        self.along_y.keep(at_once, end);
        self.corners.keep(at_once, end);
        self.updated.keep(1, end);
        at_once
    }

    /// How many numbers its rows have.
    const NUMBERS: usize = Rows::<L, T::Forecast, 1>::NUMBERS
        + Rows::<L, T::FaceStates, 2>::NUMBERS
        + Rows::<L, T::Flux, 1>::NUMBERS
        + Rows::<L, T::Flux, 2>::NUMBERS
        + Rows::<L, T::Corner, 2>::NUMBERS
        + Rows::<L, T::State, 1>::NUMBERS;

    /// # Safety
    /// The [`Scratch::NUMBERS`] numbers behind `start` are borrowed for 'a.
    unsafe fn at(start: *mut f64, in_strip: &'a mut [u16; STRIP]) -> Self {
        let mut place = start;
        // SAFETY: those of one kind begin where those of the one before end.
        unsafe {
            Scratch {
                forecasts: Rows::cut(&mut place),
                face_states: Rows::cut(&mut place),
                along_x: Rows::cut(&mut place),
                along_y: Rows::cut(&mut place),
                corners: Rows::cut(&mut place),
                updated: Rows::cut(&mut place),
                in_strip,
            }
        }
    }
}
