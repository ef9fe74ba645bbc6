//! The inner loop: a strip of a tile, row by row, vector by vector.

use super::scratch::{MOST_FLUX, Row, Scratch};
use super::tally::{Count, Tally};
use super::{Leak, MOST_PARTS, STRIP, Sheet, Sweep, Tile};
use crate::field::MOST;
use crate::lanes::{MOST_LANES, Wide, expect};
use crate::scheme::{Cell, Faces, Parts, Scheme, Side, Spacing, Watch, Window};

/// A tile under way.
pub(super) struct Strip<'a, const D: usize, L: Wide, T: Scheme<D, L>> {
    sweep: &'a Sweep<'a, D>,
    scheme: &'a T,
    to: &'a [Option<Sheet<'a>>; MOST_PARTS],
    maps: Option<&'a [Sheet<'a>; 4]>,
    spacing: Spacing<D, L>,
    dt: L,
    /// Where the ground is the same everywhere it is read from here.
    even: Option<&'a Even>,
}

/// Put a tally where the next one belongs.
#[inline(always)]
fn finish<'t, L: Wide>(tallies: &mut impl Iterator<Item = &'t mut Tally>, count: Count<L>) {
    *tallies.next().expect("a tally for every tile") = count.finish();
}

/// The cells of a strip that are updated side by side.
struct Vector<L: Wide> {
    /// The first one's column in the strip, and its place in the field.
    column: usize,
    place: usize,
    /// Which of them are ours.
    live: L::Mask,
}

/// One ground, once for each lane.
#[repr(align(64))]
struct Even([[f64; MOST_LANES]; MOST]);

/// The cells around one and around those that share its vector.
struct Around<'a, const D: usize, L: Wide, T: Scheme<D, L>> {
    strip: &'a Strip<'a, D, L, T>,
    place: usize,
}

impl<const D: usize, L: Wide, T: Scheme<D, L>> Window<D, L, T::State, T::Ground> for Around<'_, D, L, T> {
    #[inline(always)]
    fn at(&self, offset: [isize; D]) -> Cell<T::State, T::Ground> {
        self.strip.cell(self.strip.sweep.layout.moved(self.place, offset))
    }
    #[inline(always)]
    fn spacing(&self) -> &Spacing<D, L> {
        &self.strip.spacing
    }
}

impl<'a, const D: usize, L: Wide, T: Scheme<D, L>> Strip<'a, D, L, T> {
    /// Compute tiles that lie above each other.
    #[inline(always)]
    pub(super) fn run<'t>(
        sweep: &Sweep<D>,
        scheme: &T,
        tiles: impl Iterator<Item = &'t Tile> + Clone,
        to: &[Option<Sheet>; MOST_PARTS],
        maps: Option<&[Sheet; 4]>,
        tallies: &mut [Tally],
    ) {
        const { assert!(T::State::COUNT <= MOST_PARTS && T::Ground::COUNT <= MOST) };
        let Some(Tile { columns, rows, .. }) = tiles.clone().next() else { return };
        let mut even = Even([[0.0; MOST_LANES]; MOST]);
        let is_even = tiles.clone().all(|tile| tile.even);
        if is_even {
            let place = sweep.layout.place(columns[0] as isize, rows[0] as isize);
            for (k, lanes) in even.0.iter_mut().take(T::Ground::COUNT).enumerate() {
                *lanes = [sweep.grounds.part(k)[place]; MOST_LANES];
            }
        }
        let strip = Strip {
            sweep,
            scheme,
            to,
            maps,
            spacing: Spacing::new(sweep.size),
            dt: L::of(sweep.dt),
            even: is_even.then_some(&even),
        };
        strip.sweep(tiles, tallies);
    }

    #[inline(always)]
    fn cell(&self, place: usize) -> Cell<T::State, T::Ground> {
        let Sweep { from, grounds, .. } = self.sweep;
        // SAFETY: the tiles and their ghosts lie inside the layout, which ends with room for a vector.
        unsafe {
            let ground = match self.even {
                Some(even) => T::Ground::gather(
                    #[inline(always)]
                    |k| L::load(even.0.get_unchecked(k).as_ptr()),
                ),
                None => grounds.get(place),
            };
            Cell { state: from.get(place), ground }
        }
    }

    /// Compute the tiles, from the lowest row to the highest; a tile of one dimension strip by strip.
    #[inline(always)]
    fn sweep<'t>(&self, mut tiles: impl Iterator<Item = &'t Tile> + Clone, tallies: &mut [Tally]) {
        let (Some(highest), Some(mut tile)) = (tiles.clone().last(), tiles.next()) else { return };
        let (columns, first, end) = (tile.columns, tile.rows[0] as isize, highest.rows[1] as isize);
        let mut tallies = tallies.iter_mut();
        let mut count = Count::new();
        let mut scratch = Scratch::new();
        for from in (columns[0]..columns[1]).step_by(STRIP - 2) {
            let strip = [from, columns[1].min(from + STRIP - 2)];
            // In one dimension a row has all it needs; in two the one above comes first.
            let ahead = if D > 1 { 1 } else { 0 };
            for number in first - ahead..end + ahead {
                let j = number - ahead;
                self.row(
                    strip,
                    number,
                    first,
                    &self.sweep.leaks[tile.leaks.clone()],
                    &mut scratch,
                    &mut count,
                );
                if D > 1 && j + 1 == tile.rows[1] as isize {
                    finish(&mut tallies, std::mem::replace(&mut count, Count::new()));
                    tile = tiles.next().unwrap_or(tile);
                }
            }
        }
        if D == 1 {
            finish(&mut tallies, count);
        }
    }

    /// Find the edges of row `number`, and update the row below (in one dimension the row itself), unless it lies below
    /// the `first`. Cell 0 of the scratch is the one left of the strip.
    #[inline(always)]
    fn row(
        &self,
        columns: [usize; 2],
        number: isize,
        first: isize,
        leaks: &[Leak],
        scratch: &mut Scratch,
        count: &mut Count<L>,
    ) {
        let width = columns[1] - columns[0];
        // Whole vectors, the last with cells that are not ours.
        let end = (width + 2).next_multiple_of(L::WIDTH);
        let vectors = || (0..end).step_by(L::WIDTH);
        let start = |j: isize| self.sweep.layout.place(columns[0] as isize - 1, j);
        let ahead = if D > 1 { 1 } else { 0 };
        let Scratch { edges, across, below, corners } = scratch;
        if number <= first {
            across.mend(T::Flux::COUNT, end);
        }
        let [even, odd] = edges;
        let (above, row) = if (number - first) % 2 == 0 { (even, odd) } else { (odd, even) };
        let place = start(number);
        for m in vectors() {
            self.expect(start(number + 2) + m, start(number) + m);
            above.put(m, self.scheme.reconstruct(&Around { strip: self, place: place + m }));
        }
        above.mend(if number <= first { T::Edges::COUNT } else { 0 }, end);
        if number < first {
            return;
        }
        // They are sorted by rows.
        let leaks = {
            let below = |up_to: isize| leaks.partition_point(|leak| (leak.cell[1] as isize) < up_to);
            &leaks[below(number - ahead)..below(number - ahead + 1)]
        };
        let row = if D > 1 { &*row } else { &*above };
        let (above, j) = (&*above, number - ahead);
        let [low, high] = corners;
        for m in vectors() {
            let at = m as isize;
            // SAFETY: both rows have been put and mended.
            unsafe {
                let (left, right): (T::Edges, T::Edges) = (row.get(at - 1), row.get(at));
                if j >= first {
                    across.put(m, self.scheme.flux(0, &left, &right));
                }
                if T::Corner::COUNT > 0 {
                    let (below, above): (T::Edges, T::Edges) = (above.get(at - 1), above.get(at));
                    high.put(m, self.scheme.corner([[&left, &right], [&below, &above]]));
                }
            }
        }
        high.mend(T::Corner::COUNT, end);
        if !leaks.is_empty() {
            self.book(count, leaks, columns, [(0, 0, across, 0), (0, 1, across, 1), (1, 0, below, 0)]);
        }
        let low = if D > 1 { &*low } else { &*high };
        for m in vectors() {
            let at = m as isize;
            // SAFETY: all rows have been put and mended; `below` in the row before.
            unsafe {
                let edges: T::Edges = row.get(at);
                let mut faces = [Faces { lo: across.get(at), hi: across.get(at + 1) }; D];
                if D > 1 {
                    let up = self.scheme.flux(D - 1, &edges, &above.get(at));
                    if j >= first {
                        faces[D - 1] = Faces { lo: below.get(at), hi: up };
                    }
                    below.put(m, up);
                }
                if j >= first {
                    let live = L::within(1_usize.saturating_sub(m)..(width + 1).saturating_sub(m));
                    let corners = [[low.get(at), low.get(at + 1)], [high.get(at), high.get(at + 1)]];
                    let vector = Vector { column: m, place: start(j) + m, live };
                    self.update(count, vector, &edges, &faces, &corners);
                }
            }
        }
        if !leaks.is_empty() {
            self.book(count, leaks, columns, [(1, 1, below, 0)]);
        }
        corners.swap(0, 1);
    }

    #[inline(always)]
    fn sheet(&self, k: usize) -> &Sheet<'a> {
        self.to[k].as_ref().expect("a state has as many sheets as parts")
    }

    /// Ask for the vector that will be read at `next` and the one that will be written at `place`: the rows of a tile are too short
    /// for the processor to notice by itself where the next one begins.
    #[inline(always)]
    fn expect(&self, next: usize, place: usize) {
        /// Numbers in a line of the cache.
        const LINE: usize = 8;
        let Sweep { from, grounds, .. } = self.sweep;
        for m in (0..L::WIDTH).step_by(LINE) {
            for k in 0..T::State::COUNT {
                expect(from.part(k).as_ptr().wrapping_add(next + m));
                expect(self.sheet(k).at(place + m));
            }
            if self.even.is_none() {
                for k in 0..T::Ground::COUNT {
                    expect(grounds.part(k).as_ptr().wrapping_add(next + m));
                }
            }
        }
    }

    /// Update the cells of a vector.
    ///
    /// # Safety
    /// They belong to these tiles.
    #[inline(always)]
    unsafe fn update(
        &self,
        count: &mut Count<L>,
        Vector { column, place, live }: Vector<L>,
        edges: &T::Edges,
        faces: &[Faces<T::Flux>; D],
        corners: &[[T::Corner; 2]; 2],
    ) {
        let zero = L::zero();
        let here = self.cell(place);
        let live = live & !self.scheme.outside(&here.ground);
        if !L::any(live) {
            return;
        }
        let mut new = self.scheme.update(&here, edges, faces, corners, &self.spacing, self.dt);
        let mut old = here.state;
        if self.sweep.keep > 0.0 {
            // SAFETY: as the caller promises.
            old = T::State::gather(
                #[inline(always)]
                |k| unsafe { self.sheet(k).get(place, live) },
            );
            new = self.scheme.average(L::of(self.sweep.keep), &old, &new);
        }
        let mut finite = zero;
        let mut differs = L::zero().lt(zero);
        let (mut before, mut input) = ([zero; MOST_PARTS], [zero; MOST_PARTS]);
        old.scatter(
            #[inline(always)]
            |k, value| before[k] = value,
        );
        here.state.scatter(
            #[inline(always)]
            |k, value| input[k] = value,
        );
        new.scatter(
            #[inline(always)]
            |k, value| {
                // SAFETY: as the caller promises.
                unsafe { self.sheet(k).put(place, live, value) };
                finite = finite + value * zero;
                differs = differs | !value.same(input[k]);
                if self.sweep.last {
                    count.change(k, live, (value - before[k]).abs());
                }
            },
        );
        if count.quiet {
            count.quiet = !L::any(live & (differs | !self.scheme.rests(edges)));
        }
        count.finite &= !L::any(live & !finite.same(zero));
        if self.sweep.last {
            let cell = Cell { state: new, ground: here.ground };
            let watch = self.scheme.watch(&cell);
            count.watch(column, live, self.scheme.rate(&cell, &self.spacing), &watch);
            if let Some(maps) = self.maps {
                // SAFETY: as the caller promises.
                unsafe { self.mark(maps, place, live, &watch) };
            }
        }
    }

    /// Bring the maps of peaks and times up to date.
    ///
    /// # Safety
    /// The places of `live` belong to this tile.
    #[inline(always)]
    unsafe fn mark(&self, maps: &[Sheet; 4], place: usize, live: L::Mask, watch: &Watch<L>) {
        let [thickness, speed, arrival, stop] = maps;
        let (zero, time) = (L::zero(), L::of(self.sweep.time));
        // SAFETY: as the caller promises.
        unsafe {
            for (map, value) in [(thickness, watch.thickness), (speed, watch.speed)] {
                let higher = live & map.get::<L>(place, live).lt(value);
                if L::any(higher) {
                    map.put(place, higher, value);
                }
            }
            let thick = live & zero.lt(watch.volume) & watch.film.same(zero);
            if L::any(thick) {
                let seen: L = arrival.get(place, live);
                let first = thick & !seen.same(seen);
                if L::any(first) {
                    arrival.put(place, first, time);
                }
            }
            let moves = live & zero.lt(watch.speed);
            if L::any(moves) {
                stop.put(place, moves, time);
            }
        }
    }

    /// Book what passes the ways out of a row: of each kind of face (axis, side) the flux stands in a row of the
    /// scratch, moved by so many cells.
    #[inline(always)]
    fn book<const N: usize>(
        &self,
        count: &mut Count<L>,
        leaks: &[Leak],
        columns: [usize; 2],
        kinds: [(usize, u8, &Row<MOST_FLUX>, isize); N],
    ) {
        for leak in leaks {
            let column = leak.cell[0] as usize;
            if !(columns[0]..columns[1]).contains(&column) {
                continue;
            }
            for (axis, side, row, moved) in &kinds {
                if (leak.axis as usize, leak.side) != (*axis, *side) {
                    continue;
                }
                let at = (column - columns[0]) as isize + 1 + moved;
                // SAFETY: the row has been put, and ends with room for a vector.
                let flux: T::Flux = unsafe { row.get(at) };
                let leaves = if *side == 0 {
                    -self.scheme.booked(&flux, Side::Right)
                } else {
                    self.scheme.booked(&flux, Side::Left)
                };
                let lambda = self.sweep.dt * (1.0 / self.sweep.size[*axis]);
                count.out[leak.exit as usize] += lambda * leaves.first();
            }
        }
    }
}
