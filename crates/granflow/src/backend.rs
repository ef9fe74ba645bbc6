//! One fused sweep over the tiles that are awake, on any number of threads with the same result bit for bit.
//!
//! A tile sleeps while it and its eight neighbours rested and did not change in the last step: what it would
//! compute is then what it already holds. Each tile is computed by one thread, reads only the old field and
//! writes only its own cells; sums are taken per tile and added in the order of the tiles.

use crate::field::{Field, View};
use crate::grid::Layout;
use crate::observe::Maps;
use crate::scheme::{Cell, Faces, Parts, Scheme, Side, Spacing, Watch, Window};
use rayon::prelude::*;
use std::marker::PhantomData;

/// Largest extent of a tile along x and y. At least 6, the reach of a two-stage step.
pub const TILE: [usize; 2] = [16, 8];

/// The five ways out of the domain, as the ledger books them.
pub const EXITS: [&str; 5] = ["left", "right", "bottom", "top", "nodata"];

/// A rectangle of cells, half open.
#[derive(Clone, Copy, Debug)]
pub struct Tile {
    /// Columns from, to.
    pub columns: [usize; 2],
    /// Rows from, to.
    pub rows: [usize; 2],
    /// Some face of it leads out of the grid or of the data.
    pub rim: bool,
}

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
    pub out: [f64; 5],
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
        out: [0.0; 5],
        change: [0.0; MOST_PARTS],
        quiet: true,
        finite: true,
    };

    /// Take a cell into account: its rate and what the scheme watches in it.
    #[inline(always)]
    pub(crate) fn count(&mut self, rate: f64, watch: &Watch<f64>) {
        self.rate = if self.rate < rate { rate } else { self.rate };
        self.speed = if self.speed < watch.speed { watch.speed } else { self.speed };
        self.energy += watch.energy;
        self.volume += watch.volume;
        self.film += watch.volume * watch.film;
        self.wet += usize::from(watch.volume > 0.0);
        self.moving += usize::from(watch.speed > 0.0);
    }
}

/// Arrays that several threads write in disjoint places.
pub(crate) struct Sheet<'a> {
    start: *mut f64,
    len: usize,
    owner: PhantomData<&'a mut [f64]>,
}
// SAFETY: a sheet is only read and written through `get` and `put`, whose callers own disjoint places.
unsafe impl Sync for Sheet<'_> {}
unsafe impl Send for Sheet<'_> {}

impl<'a> Sheet<'a> {
    pub(crate) fn new(values: &'a mut [f64]) -> Self {
        Sheet { start: values.as_mut_ptr(), len: values.len(), owner: PhantomData }
    }
    /// # Safety
    /// No other thread may write `place` during the life of the sheet.
    #[inline(always)]
    pub(crate) unsafe fn get(&self, place: usize) -> f64 {
        debug_assert!(place < self.len);
        // SAFETY: in bounds, and nobody else writes here.
        unsafe { *self.start.add(place) }
    }
    /// # Safety
    /// Only one thread may use `place` during the life of the sheet.
    #[inline(always)]
    pub(crate) unsafe fn put(&self, place: usize, value: f64) {
        debug_assert!(place < self.len);
        // SAFETY: in bounds, and nobody else uses this place.
        unsafe { *self.start.add(place) = value }
    }
}

/// Most numbers a state has (h and two momenta).
pub const MOST_PARTS: usize = 3;

/// Everything a tile needs to compute one stage.
pub struct Sweep<'a, const D: usize, S: Scheme<D, f64>> {
    /// The scheme.
    pub scheme: &'a S,
    /// Memory layout.
    pub layout: Layout,
    /// Cell sizes.
    pub spacing: Spacing<D, f64>,
    /// Static data.
    pub grounds: View<'a>,
    /// The state that the forward-Euler map is applied to.
    pub from: View<'a>,
    /// Step.
    pub dt: f64,
    /// Weight of what `to` holds before (Shu-Osher).
    pub keep: f64,
    /// The last stage of its step.
    pub last: bool,
    /// Time at the end of the step.
    pub time: f64,
    /// Is the lower, the upper end of each axis a way out? Not where the ends are joined.
    pub exits: [[bool; 2]; D],
}

/// The cells around one of the tile.
struct Around<'a, const D: usize, S: Scheme<D, f64>> {
    sweep: &'a Sweep<'a, D, S>,
    place: usize,
}

impl<const D: usize, S: Scheme<D, f64>> Window<D, f64, S::State, S::Ground> for Around<'_, D, S> {
    #[inline(always)]
    fn at(&self, offset: [isize; D]) -> Cell<S::State, S::Ground> {
        self.sweep.cell(self.sweep.layout.moved(self.place, offset))
    }
    #[inline(always)]
    fn spacing(&self) -> &Spacing<D, f64> {
        &self.sweep.spacing
    }
}

impl<const D: usize, S: Scheme<D, f64>> Sweep<'_, D, S> {
    #[inline(always)]
    fn cell(&self, place: usize) -> Cell<S::State, S::Ground> {
        // SAFETY: the tiles and their ghosts lie inside the layout.
        unsafe { Cell { state: self.from.get(place), ground: self.grounds.get(place) } }
    }

    #[inline(always)]
    fn edges(&self, place: usize) -> S::Edges {
        self.scheme.reconstruct(&Around { sweep: self, place })
    }

    /// Compute the tiles numbered in `awake`, write `to` (and `maps` in the last stage), leave a tally each.
    pub fn run(
        &self,
        tiles: &[Tile],
        awake: &[u32],
        to: &mut Field,
        maps: Option<&mut Maps>,
        tallies: &mut [Tally],
    ) {
        const { assert!(<S::State as Parts<f64>>::COUNT <= MOST_PARTS) };
        let mut parts = to.parts.iter_mut();
        let sheets: [Option<Sheet>; MOST_PARTS] =
            std::array::from_fn(|_| parts.next().map(|values| Sheet::new(values)));
        let maps = maps.map(|maps| maps.sheets());
        let results = &mut tallies[..awake.len()];
        results.par_iter_mut().zip(awake.par_iter()).with_min_len(1).for_each(|(tally, &number)| {
            *tally = self.tile(&tiles[number as usize], &sheets, maps.as_ref());
        });
    }

    fn tile(&self, tile: &Tile, to: &[Option<Sheet>; MOST_PARTS], maps: Option<&[Sheet; 4]>) -> Tally {
        let [i0, i1] = tile.columns;
        let width = i1 - i0;
        let start = |j: isize| self.layout.place(i0 as isize - 1, j);
        let first = tile.rows[0] as isize;
        let seed = self.edges(start(first) + 1);
        let mut rows = [[seed; TILE[0] + 2]; 2];
        let fill = |row: &mut [S::Edges; TILE[0] + 2], j: isize| {
            let place = start(j);
            for (k, edges) in row[..width + 2].iter_mut().enumerate() {
                *edges = self.edges(place + k);
            }
        };
        let idle = self.scheme.flux(0, &seed, &seed);
        let mut below = [idle; TILE[0]];
        fill(&mut rows[0], first);
        if D > 1 {
            fill(&mut rows[1], first - 1);
            for k in 0..width {
                below[k] = self.scheme.flux(D - 1, &rows[1][k + 1], &rows[0][k + 1]);
            }
        }
        let corners = |low: &[S::Edges], high: &[S::Edges], found: &mut [S::Corner]| {
            for (k, corner) in found.iter_mut().enumerate() {
                *corner = self.scheme.corner([[&low[k], &low[k + 1]], [&high[k], &high[k + 1]]]);
            }
        };
        let void = self.scheme.corner([[&seed; 2]; 2]);
        let (mut low, mut high) = ([void; TILE[0] + 1], [void; TILE[0] + 1]);
        corners(&rows[if D > 1 { 1 } else { 0 }], &rows[0], &mut low[..=width]);
        let mut tally = Tally::NONE;
        for j in tile.rows[0]..tile.rows[1] {
            let (even, odd) = rows.split_at_mut(1);
            let (row, above) = match (j - tile.rows[0]) % 2 {
                0 => (&mut even[0], &mut odd[0]),
                _ => (&mut odd[0], &mut even[0]),
            };
            let j = j as isize;
            if D > 1 {
                fill(above, j + 1);
            }
            corners(row, if D > 1 { above } else { row }, &mut high[..=width]);
            let mut left = self.scheme.flux(0, &row[0], &row[1]);
            for k in 0..width {
                let right = self.scheme.flux(0, &row[k + 1], &row[k + 2]);
                let mut faces = [Faces { lo: left, hi: right }; D];
                if D > 1 {
                    let up = self.scheme.flux(D - 1, &row[k + 1], &above[k + 1]);
                    faces[D - 1] = Faces { lo: below[k], hi: up };
                    below[k] = up;
                }
                left = right;
                let place = start(j) + 1 + k;
                let here = self.cell(place);
                if self.scheme.outside(&here.ground) {
                    continue;
                }
                let corners = [[low[k], low[k + 1]], [high[k], high[k + 1]]];
                let new = self.scheme.update(&here, &row[k + 1], &faces, &corners, &self.spacing, self.dt);
                // SAFETY: every cell belongs to one tile and every tile to one thread.
                let (old, new) = unsafe { self.store(place, new, &here.state, to) };
                self.judge(&mut tally, &here, new, &row[k + 1]);
                if self.last {
                    Self::compare(&mut tally, old, new);
                    self.watch(&mut tally, Cell { state: new, ground: here.ground }, place, maps);
                }
                if tile.rim {
                    self.book(&mut tally, [i0 + k, j as usize], &faces, place);
                }
            }
            std::mem::swap(&mut low, &mut high);
        }
        tally
    }

    /// Average `new` with what the step began with, if the stage does, and write it; returns both.
    ///
    /// # Safety
    /// `place` belongs to this thread.
    #[inline(always)]
    unsafe fn store(
        &self,
        place: usize,
        new: S::State,
        from: &S::State,
        to: &[Option<Sheet>; MOST_PARTS],
    ) -> (S::State, S::State) {
        let sheet = |k: usize| to[k].as_ref().expect("a state has as many sheets as parts");
        let (old, new) = if self.keep > 0.0 {
            // SAFETY: as the caller promises.
            let old = S::State::gather(|k| unsafe { sheet(k).get(place) });
            (old, self.scheme.average(self.keep, &old, &new))
        } else {
            (*from, new)
        };
        // SAFETY: as the caller promises.
        new.scatter(|k, value| unsafe { sheet(k).put(place, value) });
        (old, new)
    }

    /// Keep the largest change of each part.
    #[inline(always)]
    fn compare(tally: &mut Tally, old: S::State, new: S::State) {
        let mut before = [0.0; MOST_PARTS];
        old.scatter(|k, value| before[k] = value);
        new.scatter(|k, value| {
            let change = (value - before[k]).abs();
            tally.change[k] = if tally.change[k] < change { change } else { tally.change[k] };
        });
    }

    /// Does the cell rest, unchanged and finite?
    #[inline(always)]
    fn judge(&self, tally: &mut Tally, here: &Cell<S::State, S::Ground>, new: S::State, edges: &S::Edges) {
        let mut old = [0.0; MOST_PARTS];
        here.state.scatter(|k, value| old[k] = value);
        let (mut same, mut finite) = (true, true);
        new.scatter(|k, value| {
            same &= value == old[k];
            finite &= value.is_finite();
        });
        tally.quiet &= same & self.scheme.rests(edges);
        tally.finite &= finite;
    }

    #[inline(always)]
    fn watch(
        &self,
        tally: &mut Tally,
        cell: Cell<S::State, S::Ground>,
        place: usize,
        maps: Option<&[Sheet; 4]>,
    ) {
        let rate = self.scheme.rate(&cell, &self.spacing);
        let watch = self.scheme.watch(&cell);
        tally.count(rate, &watch);
        if let Some([thickness, speed, arrival, stop]) = maps {
            // SAFETY: the cell belongs to this tile alone.
            unsafe {
                if thickness.get(place) < watch.thickness {
                    thickness.put(place, watch.thickness);
                }
                if speed.get(place) < watch.speed {
                    speed.put(place, watch.speed);
                }
                if watch.volume > 0.0 && watch.film == 0.0 && arrival.get(place).is_nan() {
                    arrival.put(place, self.time);
                }
                if watch.speed > 0.0 {
                    stop.put(place, self.time);
                }
            }
        }
    }

    /// Book what leaves a cell of the rim through its faces.
    fn book(&self, tally: &mut Tally, index: [usize; 2], faces: &[Faces<S::Flux>; D], place: usize) {
        let cells = [self.layout.columns, self.layout.rows];
        for axis in 0..D {
            let lambda = self.dt * self.spacing.per[axis];
            for (side, flux) in [(0, &faces[axis].lo), (1, &faces[axis].hi)] {
                let ends = index[axis] == if side == 0 { 0 } else { cells[axis] - 1 };
                if ends && !self.exits[axis][side] {
                    continue;
                }
                let step = self.layout.step(axis);
                let there = if side == 0 { place - step } else { place + step };
                let way = 2 * axis + side;
                let (here, there) = (self.cell(place).ground, self.cell(there).ground);
                let exit = if ends { Some(way) } else { self.scheme.exit(&here, &there, way) };
                let Some(exit) = exit else { continue };
                let leaves = if side == 0 {
                    -self.scheme.booked(flux, Side::Right)
                } else {
                    self.scheme.booked(flux, Side::Left)
                };
                tally.out[exit] += lambda * leaves;
            }
        }
    }
}
