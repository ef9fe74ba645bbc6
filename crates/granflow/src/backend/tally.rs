//! What a sweep finds in a tile.

use super::{EXITS, MOST_PARTS, STRIP};
use crate::lanes::Wide;
use crate::scheme::Watch;
use std::ops::Range;

/// What a sweep found in one tile.
#[derive(Clone, Copy, Debug)]
pub struct Tally {
    /// Largest sum of signal speeds over dx \[1/time\].
    pub rate: f64,
    /// Largest speed along the bed.
    pub speed: f64,
    /// Kinetic energy per density and cell measure.
    pub energy: f64,
    /// Volume per cell measure.
    pub volume: f64,
    /// Part of it in films.
    pub film: f64,
    /// Cells with a depth.
    pub wet: usize,
    /// Cells with a momentum.
    pub moving: usize,
    /// Volume per cell measure and time that left by each of [`EXITS`], times dt.
    pub out: [f64; EXITS.len()],
    /// Largest change of each part of the state in the step.
    pub change: [f64; MOST_PARTS],
    /// Every cell rested and none changed.
    pub quiet: bool,
    /// Every number is finite.
    pub finite: bool,
}

impl Tally {
    /// Of no cell.
    pub const NONE: Tally = Tally {
        rate: 0.0,
        speed: 0.0,
        energy: 0.0,
        volume: 0.0,
        film: 0.0,
        wet: 0,
        moving: 0,
        out: [0.0; EXITS.len()],
        change: [0.0; MOST_PARTS],
        quiet: true,
        finite: true,
    };
}

/// One quantity in each column of a strip.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Columns([f64; STRIP]);

impl Columns {
    const NONE: Columns = Columns([0.0; STRIP]);

    /// Combine the columns from `column` on with a value each.
    #[inline(always)]
    fn change<L: Wide>(&mut self, column: usize, change: impl FnOnce(L) -> L) {
        debug_assert!(column + L::WIDTH <= STRIP);
        // SAFETY: `column` is that of a vector inside the strip.
        unsafe {
            let place = self.0.as_mut_ptr().add(column);
            change(L::load(place)).store(place);
        }
    }
    #[inline(always)]
    fn add<L: Wide>(&mut self, column: usize, value: L) {
        self.change(
            column,
            #[inline(always)]
            |sum: L| sum + value,
        );
    }
    #[inline(always)]
    fn most<L: Wide>(&mut self, column: usize, value: L) {
        self.change(
            column,
            #[inline(always)]
            |most: L| value.max(most),
        );
    }
}

/// Tallies in the making. Everything is gathered down the columns of a strip and then, for each tile, across its columns:
/// how many lanes compute it, and with which tiles at its sides, makes no difference.
pub(crate) struct Count {
    rate: Columns,
    square: Columns,
    change: [Columns; MOST_PARTS],
    energy: Columns,
    volume: Columns,
    film: Columns,
    wet: Columns,
    moving: Columns,
    /// Columns in which a cell changed or may yet, a bit each.
    stirs: u128,
    infinite: u128,
}

impl Count {
    pub(crate) const fn new() -> Self {
        const { assert!(STRIP <= 128) };
        let none = Columns::NONE;
        Count {
            rate: none,
            square: none,
            change: [none; MOST_PARTS],
            energy: none,
            volume: none,
            film: none,
            wet: none,
            moving: none,
            stirs: 0,
            infinite: 0,
        }
    }

    /// Take the cells of `live` into account, the first of which lies in `column`.
    #[inline(always)]
    pub(crate) fn watch<L: Wide>(&mut self, column: usize, live: L::Mask, rate: L, watch: &Watch<L>) {
        let (zero, one) = (L::zero(), L::of(1.0));
        let square = L::select(live, watch.square, zero);
        let volume = L::select(live, watch.volume, zero);
        self.rate.most(column, L::select(live, rate, zero));
        self.square.most(column, square);
        self.volume.add(column, volume);
        self.energy.add(column, L::select(live, watch.energy, zero));
        let films = live & zero.lt(watch.film);
        if L::any(films) {
            self.film.add(column, L::select(films, watch.volume * watch.film, zero));
        }
        self.wet.add(column, L::select(zero.lt(volume), one, zero));
        self.moving.add(column, L::select(zero.lt(square), one, zero));
    }

    /// Keep the largest change of a part.
    #[inline(always)]
    pub(super) fn change<L: Wide>(&mut self, part: usize, column: usize, live: L::Mask, change: L) {
        self.change[part].most(column, L::select(live, change, L::zero()));
    }

    /// Does every column from `column` on that a vector has stir already?
    #[inline(always)]
    pub(super) fn all_stir<L: Wide>(&self, column: usize) -> bool {
        let all = (1 << L::WIDTH) - 1;
        (self.stirs >> column) as u64 & all == all
    }
    /// Note the cells that changed or may yet.
    #[inline(always)]
    pub(super) fn stir<L: Wide>(&mut self, column: usize, mask: L::Mask) {
        self.stirs |= u128::from(L::bits(mask)) << column;
    }
    /// Note the cells that are no number.
    #[inline(always)]
    pub(super) fn lose<L: Wide>(&mut self, column: usize, mask: L::Mask) {
        self.infinite |= u128::from(L::bits(mask)) << column;
    }

    /// The tally of the tile in some columns, without what left it; they are empty afterwards.
    pub(crate) fn finish(&mut self, columns: Range<usize>) -> Tally {
        let sum = |quantity: &Columns| quantity.0[columns.clone()].iter().sum::<f64>();
        // None is less than 0 or no number.
        let most = |quantity: &Columns| {
            quantity.0[columns.clone()]
                .iter()
                .fold(0.0, |most, &value| if most < value { value } else { most })
        };
        let mut tally = Tally {
            rate: most(&self.rate),
            speed: most(&self.square).sqrt(),
            energy: sum(&self.energy),
            volume: sum(&self.volume),
            film: sum(&self.film),
            wet: sum(&self.wet) as usize,
            moving: sum(&self.moving) as usize,
            change: self.change.each_ref().map(most),
            ..Tally::NONE
        };
        let bits = ((1_u128 << columns.len()) - 1) << columns.start;
        (tally.quiet, tally.finite) = (self.stirs & bits == 0, self.infinite & bits == 0);
        let Count { rate, square, change: [a, b, c], energy, volume, film, wet, moving, .. } = self;
        for quantity in [rate, square, a, b, c, energy, volume, film, wet, moving] {
            quantity.0[columns.clone()].fill(0.0);
        }
        (self.stirs, self.infinite) = (self.stirs & !bits, self.infinite & !bits);
        tally
    }
}
