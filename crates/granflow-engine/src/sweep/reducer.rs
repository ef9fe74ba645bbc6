//! What a sweep finds in a tile, gathered cell by cell.

use crate::lanes::SimdVector;
use crate::tiles::{Activity, STRIP, TileStats};
use std::marker::PhantomData;
use std::ops::Range;

/// Gathers the largest rate, speed and changes down the columns of a strip and then, for each tile, across its columns: how many
/// lanes compute it, and with which tiles at its sides, makes no difference.
pub(super) struct TileReducer<'a> {
    /// The rate, the squared speed and the change of each component in each column of the strip.
    start: *mut f64,
    components: usize,
    /// Columns in which a cell changed or may yet, a bit each: in the rows that are under way, in those before, in the lowest.
    activity: u128,
    before: u128,
    low: u128,
    owner: PhantomData<&'a mut [f64]>,
}

const RATE: usize = 0;
const SPEED_SQUARED: usize = 1;
/// Of the first component; those of the others follow.
const CHANGE: usize = 2;

impl TileReducer<'_> {
    /// How many numbers it needs for a state of so many components.
    pub(super) const fn numbers(components: usize) -> usize {
        (CHANGE + components) * STRIP
    }
    /// Nothing gathered yet.
    ///
    /// # Safety
    /// The [`TileReducer::numbers`] numbers behind `start` are borrowed for its life.
    #[inline(always)]
    pub(super) unsafe fn at(start: *mut f64, components: usize) -> Self {
        const { assert!(STRIP <= 128) };
        // SAFETY: as the caller promises.
        unsafe { std::slice::from_raw_parts_mut(start, Self::numbers(components)).fill(0.0) };
        TileReducer { start, components, activity: 0, before: 0, low: 0, owner: PhantomData }
    }

    /// Keep the larger of `value` and what the columns from `column` on have.
    ///
    /// # Safety
    /// There is such a quantity, and the vector is inside the strip.
    #[inline(always)]
    unsafe fn raise<L: SimdVector>(&mut self, quantity: usize, column: usize, value: L) {
        debug_assert!(column + L::WIDTH <= STRIP && quantity < CHANGE + self.components);
        // SAFETY: as the caller promises.
        unsafe {
            let place = self.start.add(quantity * STRIP + column);
            value.max(L::load(place)).store(place);
        }
    }

    /// Take the rates and squared speeds of the cells of `mask` into account, the first of which is in `column`.
    ///
    /// # Safety
    /// The vector is inside the strip.
    #[inline(always)]
    pub(super) unsafe fn watch<L: SimdVector>(
        &mut self,
        column: usize,
        mask: L::Mask,
        rate: L,
        speed_squared: L,
    ) {
        // SAFETY: as the caller promises.
        unsafe {
            self.raise(RATE, column, L::select(mask, rate, L::zero()));
            self.raise(SPEED_SQUARED, column, L::select(mask, speed_squared, L::zero()));
        }
    }

    /// Keep the largest change of a component.
    ///
    /// # Safety
    /// There is such a component, and the vector is inside the strip.
    #[inline(always)]
    pub(super) unsafe fn change<L: SimdVector>(
        &mut self,
        component: usize,
        column: usize,
        mask: L::Mask,
        change: L,
    ) {
        // SAFETY: as the caller promises.
        unsafe { self.raise(CHANGE + component, column, L::select(mask, change, L::zero())) };
    }

    /// Is every column of a vector active already, from `column` on?
    #[inline(always)]
    pub(super) fn all_active<L: SimdVector>(&self, column: usize) -> bool {
        let all = (1 << L::WIDTH) - 1;
        (self.activity >> column) as u64 & all == all
    }
    /// Note the cells that changed or may yet.
    #[inline(always)]
    pub(super) fn activate<L: SimdVector>(&mut self, column: usize, mask: L::Mask) {
        self.activity |= u128::from(L::bits(mask)) << column;
    }

    /// So many of `rows` rows of the tiles are done; a step reaches over `reach` cells.
    #[inline(always)]
    pub(super) fn pass(&mut self, done: usize, rows: usize, reach: usize) {
        if done == reach.min(rows) {
            self.low = self.before | self.activity;
        }
        if done + reach == rows {
            self.before |= self.activity;
            self.activity = 0;
        }
    }

    /// The largest of a quantity in some columns, which are empty afterwards.
    fn take(&mut self, quantity: usize, columns: Range<usize>) -> f64 {
        assert!(quantity < CHANGE + self.components && columns.start <= columns.end && columns.end <= STRIP);
        // SAFETY: inside the numbers that it has.
        let values = unsafe {
            let start = self.start.add(quantity * STRIP + columns.start);
            std::slice::from_raw_parts_mut(start, columns.len())
        };
        // None is less than 0 or no number.
        let largest =
            values.iter().fold(0.0, |largest, &value| if largest < value { value } else { largest });
        values.fill(0.0);
        largest
    }

    /// What was found in the tile in some columns, of so many rows, but for its outflow; `changes` are of the components that
    /// are watched. Nothing of the tile is left afterwards.
    pub(super) fn finish(
        &mut self,
        columns: Range<usize>,
        rows: usize,
        reach: usize,
        changes: &mut [f64],
    ) -> TileStats {
        for (k, change) in changes.iter_mut().enumerate() {
            *change = self.take(CHANGE + k, columns.clone());
        }
        let bits = ((1_u128 << columns.len()) - 1) << columns.start;
        let all = (self.before | self.activity) & bits;
        let high = if rows > reach { self.activity & bits } else { all };
        let some = |bits: u128| bits != 0;
        let end = (1_u128 << reach.min(columns.len())) - 1;
        let ends = [end << columns.start, end << (columns.end - reach.min(columns.len()))];
        let activity = Activity {
            anywhere: some(all),
            near: [ends.map(|end| some(all & end)), [some(self.low & bits), some(high)]],
        };
        for kept in [&mut self.activity, &mut self.before, &mut self.low] {
            *kept &= !bits;
        }
        let rate = self.take(RATE, columns.clone());
        TileStats { rate, speed: self.take(SPEED_SQUARED, columns).sqrt(), activity, ..TileStats::default() }
    }
}
