//! The rows that a strip is computed from, small enough for the first-level cache.

use super::reducer::TileReducer;
use crate::lanes::{MAX_LANES, SimdVector};
use crate::tiles::STRIP;
use granflow_model::scheme::{Components, Scheme};
use std::cell::RefCell;
use std::marker::PhantomData;

/// Room for a vector before and behind the strip.
const PADDING: usize = MAX_LANES;
/// Numbers in a row.
const ROW: usize = PADDING + STRIP + PADDING;

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
        const { assert!(ROW.is_multiple_of(LINE) && STRIP.is_multiple_of(LINE)) };
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

/// A row of values, struct of arrays.
pub(super) struct Row<'a, L, P> {
    start: *mut f64,
    owner: PhantomData<&'a mut [f64]>,
    values: PhantomData<fn() -> (L, P)>,
}

impl<L: SimdVector, P: Components<L>> Row<'_, L, P> {
    /// How many numbers it has.
    const NUMBERS: usize = P::COUNT * ROW;

    /// # Safety
    /// The numbers behind `start` belong to the row alone as long as it is used.
    #[inline(always)]
    unsafe fn at(start: *mut f64) -> Self {
        Row { start, owner: PhantomData, values: PhantomData }
    }
    /// The same row, by value.
    #[inline(always)]
    fn reborrow(&mut self) -> Row<'_, L, P> {
        Row { start: self.start, owner: PhantomData, values: PhantomData }
    }
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
                unsafe { L::load(self.start.add(k * ROW + place)) }
            },
        )
    }
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
                unsafe { part.store(self.start.add(k * ROW + (PADDING as isize + at) as usize)) };
            },
        );
    }
    /// Let the place before the first be as the first, and those behind `end` be 0.
    #[inline(always)]
    pub(super) fn fill_halo(&mut self, end: usize) {
        assert!(end <= STRIP);
        for k in 0..P::COUNT {
            // SAFETY: inside the row.
            unsafe {
                let start = self.start.add(k * ROW);
                *start.add(PADDING - 1) = *start.add(PADDING);
                for m in (0..PADDING).step_by(L::WIDTH) {
                    L::zero().store(start.add(PADDING + end + m));
                }
            }
        }
    }
}

/// The rows of a strip.
pub(super) struct Scratch<'a, const D: usize, L: SimdVector, T: Scheme<D, L>> {
    /// Three rows of forecasts: of the row whose face states are found, and of the ones below and above.
    pub forecasts: [Row<'a, L, T::Forecast>; 3],
    /// Two rows of face states: of the row that is updated and the one above.
    pub face_states: [Row<'a, L, T::FaceStates>; 2],
    /// Through the lower faces along x of a row.
    pub across: Row<'a, L, T::Flux>,
    /// Through the faces along y below a row.
    pub below: Row<'a, L, T::Flux>,
    /// At the lower left corners of a row, and of the row above.
    pub corners: [Row<'a, L, T::Corner>; 2],
    /// The new states of a row.
    pub updated: Row<'a, L, T::State>,
    /// Which cells of each vector are those of the strip, a bit each.
    pub in_strip: &'a mut [u16; STRIP],
}

impl<'a, const D: usize, L: SimdVector, T: Scheme<D, L>> Scratch<'a, D, L, T> {
    /// The same rows, by value: a place behind a reference would be read again after every number that is written.
    #[inline(always)]
    pub(super) fn reborrow(&mut self) -> Scratch<'_, D, L, T> {
        let Scratch { forecasts: [a, b, c], face_states: [d, e], corners: [f, g], .. } = self;
        Scratch {
            forecasts: [a.reborrow(), b.reborrow(), c.reborrow()],
            face_states: [d.reborrow(), e.reborrow()],
            across: self.across.reborrow(),
            below: self.below.reborrow(),
            corners: [f.reborrow(), g.reborrow()],
            updated: self.updated.reborrow(),
            in_strip: self.in_strip,
        }
    }

    /// How many numbers its rows have.
    const NUMBERS: usize = 3 * Row::<L, T::Forecast>::NUMBERS
        + 2 * Row::<L, T::FaceStates>::NUMBERS
        + 2 * Row::<L, T::Flux>::NUMBERS
        + 2 * Row::<L, T::Corner>::NUMBERS
        + Row::<L, T::State>::NUMBERS;

    /// # Safety
    /// The [`Scratch::NUMBERS`] numbers behind `start` are borrowed for 'a.
    #[inline(always)]
    unsafe fn at(start: *mut f64, in_strip: &'a mut [u16; STRIP]) -> Self {
        let forecasts = Row::<L, T::Forecast>::NUMBERS;
        let states = Row::<L, T::FaceStates>::NUMBERS;
        let fluxes = Row::<L, T::Flux>::NUMBERS;
        let corners = Row::<L, T::Corner>::NUMBERS;
        // SAFETY: one row begins where the one before ends.
        unsafe {
            let state = start.add(3 * forecasts);
            let across = state.add(2 * states);
            let corner = across.add(2 * fluxes);
            Scratch {
                forecasts: [Row::at(start), Row::at(start.add(forecasts)), Row::at(start.add(2 * forecasts))],
                face_states: [Row::at(state), Row::at(state.add(states))],
                across: Row::at(across),
                below: Row::at(across.add(fluxes)),
                corners: [Row::at(corner), Row::at(corner.add(corners))],
                updated: Row::at(corner.add(2 * corners)),
                in_strip,
            }
        }
    }
}
