//! What a sweep finds in a tile.

use super::{MAX_COMPONENTS, OUTLETS, STRIP};
use crate::lanes::SimdVector;
use std::ops::Range;

/// What a sweep found in one tile.
#[derive(Clone, Copy, Debug)]
pub struct TileStats {
    /// Largest sum of signal speeds over dx \[1/time\]; infinite where a state is no number.
    pub rate: f64,
    /// Largest speed along the bed.
    pub speed: f64,
    /// Volume per cell measure and time that left by each of [`OUTLETS`], times dt.
    pub out: [f64; OUTLETS.len()],
    /// Largest change of each part of the state in the step.
    pub change: [f64; MAX_COMPONENTS],
    /// Where a cell changed, or may yet.
    pub activity: Activity,
}

impl TileStats {
    /// Of no cell.
    pub const NONE: TileStats = TileStats {
        rate: 0.0,
        speed: 0.0,
        out: [0.0; OUTLETS.len()],
        change: [0.0; MAX_COMPONENTS],
        activity: Activity { anywhere: false, near: [[false; 2]; 2] },
    };
}

/// Where in a tile something activity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Activity {
    /// In any of its cells.
    pub anywhere: bool,
    /// In those from which a step reaches beyond its lower and its upper end along x, and along y.
    pub near: [[bool; 2]; 2],
}

impl Activity {
    /// Here or there.
    pub fn or(self, other: Activity) -> Activity {
        let near = |axis: usize, side: usize| self.near[axis][side] | other.near[axis][side];
        Activity {
            anywhere: self.anywhere | other.anywhere,
            near: [[near(0, 0), near(0, 1)], [near(1, 0), near(1, 1)]],
        }
    }
    /// Does a step reach the tile that lies `dx` and `dy` tiles away?
    pub fn reaches(&self, [dx, dy]: [isize; 2]) -> bool {
        let along = |axis: usize, d: isize| d == 0 || self.near[axis][usize::from(d > 0)];
        self.anywhere && along(0, dx) && along(1, dy)
    }
}

/// One quantity in each column of a strip.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Columns([f64; STRIP]);

impl Columns {
    const NONE: Columns = Columns([0.0; STRIP]);

    /// Keep the larger of what the columns from `column` on have and `value`.
    #[inline(always)]
    fn most<L: SimdVector>(&mut self, column: usize, value: L) {
        debug_assert!(column + L::WIDTH <= STRIP);
        // SAFETY: `column` is that of a vector inside the strip.
        unsafe {
            let place = self.0.as_mut_ptr().add(column);
            value.max(L::load(place)).store(place);
        }
    }
}

/// Tallies in the making. Everything is gathered down the columns of a strip and then, for each tile, across its columns:
/// how many lanes compute it, and with which tiles at its sides, makes no difference.
pub(super) struct TileReducer {
    rate: Columns,
    square: Columns,
    change: [Columns; MAX_COMPONENTS],
    /// Columns in which a cell changed or may yet, a bit each: in the rows that are under way, in those before, in the lowest.
    activity: u128,
    before: u128,
    low: u128,
}

impl TileReducer {
    pub(super) const fn new() -> Self {
        const { assert!(STRIP <= 128) };
        let none = Columns::NONE;
        TileReducer {
            rate: none,
            square: none,
            change: [none; MAX_COMPONENTS],
            activity: 0,
            before: 0,
            low: 0,
        }
    }

    /// Take the cells of `mask` into account, the first of which lies in `column`: their rates and squared speeds.
    #[inline(always)]
    pub(super) fn watch<L: SimdVector>(&mut self, column: usize, mask: L::Mask, rate: L, square: L) {
        self.rate.most(column, L::select(mask, rate, L::zero()));
        self.square.most(column, L::select(mask, square, L::zero()));
    }

    /// Keep the largest change of a part.
    #[inline(always)]
    pub(super) fn change<L: SimdVector>(&mut self, part: usize, column: usize, mask: L::Mask, change: L) {
        self.change[part].most(column, L::select(mask, change, L::zero()));
    }

    /// Does every column from `column` on that a vector has stir already?
    #[inline(always)]
    pub(super) fn all_stir<L: SimdVector>(&self, column: usize) -> bool {
        let all = (1 << L::WIDTH) - 1;
        (self.activity >> column) as u64 & all == all
    }
    /// Note the cells that changed or may yet.
    #[inline(always)]
    pub(super) fn stir<L: SimdVector>(&mut self, column: usize, mask: L::Mask) {
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

    /// The tally of the tile in some columns, of so many rows, without what left it; they are empty afterwards.
    pub(super) fn finish(&mut self, columns: Range<usize>, rows: usize, reach: usize) -> TileStats {
        // None is less than 0 or no number.
        let most = |quantity: &Columns| {
            quantity.0[columns.clone()]
                .iter()
                .fold(0.0, |most, &value| if most < value { value } else { most })
        };
        let mut tally = TileStats {
            rate: most(&self.rate),
            speed: most(&self.square).sqrt(),
            change: self.change.each_ref().map(most),
            ..TileStats::NONE
        };
        let bits = ((1_u128 << columns.len()) - 1) << columns.start;
        let all = (self.before | self.activity) & bits;
        let high = if rows > reach { self.activity & bits } else { all };
        let some = |bits: u128| bits != 0;
        let end = (1_u128 << reach.min(columns.len())) - 1;
        let ends = [end << columns.start, end << (columns.end - reach.min(columns.len()))];
        tally.activity = Activity {
            anywhere: some(all),
            near: [ends.map(|end| some(all & end)), [some(self.low & bits), some(high)]],
        };
        let TileReducer { rate, square, change: [a, b, c], .. } = self;
        for quantity in [rate, square, a, b, c] {
            quantity.0[columns.clone()].fill(0.0);
        }
        for kept in [&mut self.activity, &mut self.before, &mut self.low] {
            *kept &= !bits;
        }
        tally
    }
}
