//! What a sweep finds in a tile.

use super::{EXITS, MOST_PARTS, STRIP};
use crate::lanes::Wide;
use crate::real::each;
use crate::scheme::Watch;

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

/// Sums of one quantity down the columns of a strip.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Columns([f64; STRIP]);

impl Columns {
    #[inline(always)]
    fn add<L: Wide>(&mut self, column: usize, value: L) {
        debug_assert!(column + L::WIDTH <= STRIP);
        // SAFETY: `column` is that of a vector inside the strip.
        unsafe {
            let place = self.0.as_mut_ptr().add(column);
            (L::load(place) + value).store(place);
        }
    }
    fn sum(&self) -> f64 {
        self.0.iter().sum()
    }
}

/// A tally in the making. Sums run down the columns of the strips and then across them, largest values need no order:
/// how many lanes compute it makes no difference.
pub(crate) struct Count<L: Wide> {
    rate: L,
    speed: L,
    change: [L; MOST_PARTS],
    energy: Columns,
    volume: Columns,
    film: Columns,
    wet: usize,
    moving: usize,
    pub(super) out: [f64; EXITS.len()],
    pub(super) quiet: bool,
    pub(super) finite: bool,
}

#[inline(always)]
fn most<L: Wide>(most: &mut L, live: L::Mask, value: L) {
    *most = L::select(live & most.lt(value), value, *most);
}

#[inline(always)]
fn largest<L: Wide>(value: L) -> f64 {
    let mut lanes = [0.0_f64; STRIP];
    // SAFETY: a strip is wider than any vector.
    unsafe { value.store(lanes.as_mut_ptr()) };
    lanes.into_iter().fold(0.0, f64::max)
}

impl<L: Wide> Count<L> {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        let (zero, columns) = (L::zero(), Columns([0.0; STRIP]));
        Count {
            rate: zero,
            speed: zero,
            change: [zero; MOST_PARTS],
            energy: columns,
            volume: columns,
            film: columns,
            wet: 0,
            moving: 0,
            out: [0.0; EXITS.len()],
            quiet: true,
            finite: true,
        }
    }

    /// Take the cells of `live` into account, the first of which lies in `column`.
    #[inline(always)]
    pub(crate) fn watch(&mut self, column: usize, live: L::Mask, rate: L, watch: &Watch<L>) {
        let zero = L::zero();
        most(&mut self.rate, live, rate);
        most(&mut self.speed, live, watch.speed);
        let volume = L::select(live, watch.volume, zero);
        self.volume.add(column, volume);
        self.energy.add(column, L::select(live, watch.energy, zero));
        let films = live & zero.lt(watch.film);
        if L::any(films) {
            self.film.add(column, L::select(films, watch.volume * watch.film, zero));
        }
        self.wet += L::count(zero.lt(volume));
        self.moving += L::count(live & zero.lt(watch.speed));
    }

    /// Keep the largest change of a part.
    #[inline(always)]
    pub(super) fn change(&mut self, part: usize, live: L::Mask, change: L) {
        most(&mut self.change[part], live, change);
    }

    /// The tally.
    #[inline(always)]
    pub(crate) fn finish(self) -> Tally {
        Tally {
            rate: largest(self.rate),
            speed: largest(self.speed),
            change: each!(k => largest(self.change[k])),
            energy: self.energy.sum(),
            volume: self.volume.sum(),
            film: self.film.sum(),
            wet: self.wet,
            moving: self.moving,
            out: self.out,
            quiet: self.quiet,
            finite: self.finite,
        }
    }
}
