//! The inner loop: a strip of a tile, row by row, vector by vector.

use super::scratch::{Row, Scratch};
use super::tally::{TileReducer, TileStats};
use super::{DisjointSlice, MAX_COMPONENTS, OUTLETS, OutletFace, Sweep, Tile};
use crate::field::{MAX, has};
use crate::grid::Layout;
use crate::lanes::{SimdVector, prefetch};
use granflow_model::real::per_axis;
use granflow_model::scheme::{Cell, Components, Diagnostics, Faces, Scheme, Side, Spacing, Stencil};

/// Tiles under way, on ground that is everywhere the same (`UNIFORM`) or not. All by value: what the inner loop reads through a
/// reference it would have to read anew after every number that it writes.
struct Strip<'a, const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> {
    layout: Layout,
    scheme: T,
    /// Where the numbers of the states and of the grounds begin.
    from: [*const u8; MAX],
    grounds: [*const u8; MAX],
    /// The ground where it is uniform, else of one of the cells.
    uniform: T::Ground,
    to: [*mut f64; MAX_COMPONENTS],
    maps: Option<&'a [DisjointSlice<'a, f32>; 4]>,
    outlets: &'a [OutletFace],
    spacing: Spacing<D, L>,
    reach: usize,
    dt: L,
    rk_weight: f64,
    last: bool,
    time: f64,
}

/// What the tiles of one thread are computed with.
pub(super) struct Workspace {
    scratch: Scratch,
    count: TileReducer,
}

impl Workspace {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Workspace { scratch: Scratch::new(), count: TileReducer::new() }
    }
}

/// The cells of a strip that are updated side by side.
struct Vector<L: SimdVector> {
    /// The first one's column in the strip, and its place in the field.
    column: usize,
    place: usize,
    /// Which of them are in_strip.
    mask: L::Mask,
}

/// The cells around one and around those that share its vector.
struct Around<'a, const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> {
    strip: &'a Strip<'a, D, UNIFORM, L, T>,
    place: usize,
}

impl<const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> Stencil<D, L, T::State, T::Ground>
    for Around<'_, D, UNIFORM, L, T>
{
    #[inline(always)]
    fn at(&self, offset: [isize; D]) -> Cell<T::State, T::Ground> {
        self.strip.cell(self.strip.layout.moved(self.place, offset))
    }
    #[inline(always)]
    fn spacing(&self) -> &Spacing<D, L> {
        &self.strip.spacing
    }
}

/// Compute a rectangle of tiles, `across` side by side, row by row; leave a tally each.
#[inline(always)]
pub(super) fn run<'a, 't, const D: usize, L: SimdVector, T: Scheme<D, L>, S: Scheme<D, f64>>(
    sweep: &Sweep<'a>,
    scheme: &T,
    tiles: impl Iterator<Item = &'t Tile> + Clone,
    across: usize,
    to: (&[Option<DisjointSlice>; MAX_COMPONENTS], Option<&'a [DisjointSlice<'a, f32>; 4]>),
    tallies: &mut [TileStats],
    Workspace { scratch, count }: &mut Workspace,
) {
    const { assert!(T::State::COUNT <= MAX_COMPONENTS && T::Ground::COUNT <= MAX) };
    // Mountains, which are kept in single precision, are seldom uniform, and one cell at a time is slow anyway: no loops are
    // compiled for them.
    if const { S::Ground::F32_MASK == 0 && L::WIDTH > 1 } && tiles.clone().all(|tile| tile.uniform) {
        let strip = Strip::<D, true, L, T>::new::<S>(sweep, scheme, tiles.clone(), to);
        strip.sweep(tiles, across, tallies, scratch, count);
    } else {
        let strip = Strip::<D, false, L, T>::new::<S>(sweep, scheme, tiles.clone(), to);
        strip.sweep(tiles, across, tallies, scratch, count);
    }
}

impl<'a, const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> Strip<'a, D, UNIFORM, L, T> {
    #[inline(always)]
    fn new<'t, S: Scheme<D, f64>>(
        sweep: &Sweep<'a>,
        scheme: &T,
        mut tiles: impl Iterator<Item = &'t Tile>,
        (to, maps): (&[Option<DisjointSlice>; MAX_COMPONENTS], Option<&'a [DisjointSlice<'a, f32>; 4]>),
    ) -> Self {
        let corner = tiles.next().map_or([0; 2], |tile| [tile.columns[0], tile.rows[0]]);
        let place = sweep.layout.place(corner[0] as isize, corner[1] as isize);
        let mut parts = [0.0; MAX];
        sweep.grounds.get::<S::Ground>(place).store(
            #[inline(always)]
            |k, part| parts[k] = part,
        );
        let uniform = T::Ground::load(
            #[inline(always)]
            |k| L::splat(parts[k]),
        );
        Strip {
            layout: sweep.layout,
            scheme: *scheme,
            from: sweep.from.starts::<S::State>(),
            grounds: sweep.grounds.starts::<S::Ground>(),
            uniform,
            to: to.each_ref().map(|sheet| sheet.as_ref().map_or(std::ptr::null_mut(), |sheet| sheet.start)),
            maps,
            outlets: sweep.outlets,
            spacing: Spacing::new(per_axis!(k => sweep.size[k])),
            reach: sweep.reach,
            dt: L::splat(sweep.dt),
            rk_weight: sweep.rk_weight,
            last: sweep.last,
            time: sweep.time,
        }
    }

    #[inline(always)]
    fn cell(&self, place: usize) -> Cell<T::State, T::Ground> {
        // SAFETY: the tiles and their ghosts lie inside the layout, which ends with room for a vector.
        let state = unsafe {
            T::State::load(
                #[inline(always)]
                |k| L::load(self.from.get_unchecked(k).cast::<f64>().add(place)),
            )
        };
        Cell { state, ground: self.ground(place) }
    }

    #[inline(always)]
    fn ground(&self, place: usize) -> T::Ground {
        if UNIFORM {
            return self.uniform;
        }
        // SAFETY: as in `cell`.
        unsafe {
            T::Ground::load(
                #[inline(always)]
                |k| {
                    let start = *self.grounds.get_unchecked(k);
                    if has(T::Ground::UNIFORM_MASK, k) {
                        L::splat(*start.cast())
                    } else if has(T::Ground::F32_MASK, k) {
                        L::load_single(start.cast::<f32>().add(place))
                    } else {
                        L::load(start.cast::<f64>().add(place))
                    }
                },
            )
        }
    }

    /// Compute the tiles from the lowest row to the highest.
    #[inline(always)]
    fn sweep<'t>(
        &self,
        tiles: impl Iterator<Item = &'t Tile> + Clone,
        across: usize,
        tallies: &mut [TileStats],
        scratch: &mut Scratch,
        count: &mut TileReducer,
    ) {
        let (Some(lowest), Some(highest)) = (tiles.clone().next(), tiles.clone().last()) else { return };
        let columns = [lowest.columns[0], highest.columns[1]];
        let (first, end) = (lowest.rows[0] as isize, highest.rows[1] as isize);
        let none = UNIFORM && L::any(self.scheme.is_nodata(&self.ground(0)));
        for m in Self::vectors(columns) {
            let in_strip = if none { 0 } else { ((1_u128 << (columns[1] - columns[0])) - 1) << 1 };
            scratch.in_strip[m / L::WIDTH] = (in_strip >> m) as u16;
        }
        let outlet = tiles.clone().any(|tile| !tile.outlets.is_empty());
        for tally in &mut *tallies {
            tally.out = TileStats::NONE.out;
        }
        // The row of tiles that is under way, and the place of its tallies.
        let (mut level, mut from) = (tiles.clone(), 0);
        // In one dimension a row has all it needs; in two the one above comes first.
        let ahead = if D > 1 { 1 } else { 0 };
        for number in first - ahead..end + ahead {
            let j = number - ahead;
            self.edges(columns, number, first, scratch);
            if number < first {
                continue;
            }
            self.across(columns, number, first, scratch);
            if outlet {
                for (tile, k) in level.clone().take(across).zip(from..) {
                    self.book(&mut tallies[k].out, tile, columns, j, scratch, false);
                }
            }
            self.update_row(columns, number, first, scratch, count);
            if outlet {
                for (tile, k) in level.clone().take(across).zip(from..) {
                    self.book(&mut tallies[k].out, tile, columns, j, scratch, true);
                }
            }
            let Some(&Tile { rows: [bottom, top], .. }) = level.clone().next() else { continue };
            count.pass((j + 1 - bottom as isize).max(0) as usize, top - bottom, self.reach);
            if j + 1 == top as isize {
                for (tile, k) in level.clone().take(across).zip(from..) {
                    let [start, end] = tile.columns.map(|i| i - columns[0] + 1);
                    let found = count.finish(start..end, top - bottom, self.reach);
                    tallies[k] = TileStats { out: tallies[k].out, ..found };
                }
                level.by_ref().take(across).for_each(drop);
                from += across;
            }
        }
    }

    /// Numbers of a row that are computed: the cells of the strip with a neighbour at both ends, filled up to whole vectors
    /// with cells that are not in_strip.
    #[inline(always)]
    fn end(columns: [usize; 2]) -> usize {
        (columns[1] - columns[0] + 2).next_multiple_of(L::WIDTH)
    }
    #[inline(always)]
    fn vectors(columns: [usize; 2]) -> impl Iterator<Item = usize> {
        let count = Self::end(columns) / L::WIDTH;
        (0..count).map(|k| k * L::WIDTH)
    }
    /// Place of cell 0 of the scratch, the one left of the strip.
    #[inline(always)]
    fn start(&self, columns: [usize; 2], j: isize) -> usize {
        self.layout.place(columns[0] as isize - 1, j)
    }

    /// Find the edges of row `number`.
    #[inline(always)]
    fn edges(&self, columns: [usize; 2], number: isize, first: isize, scratch: &mut Scratch) {
        let above = &mut scratch.edges[(number - first + 2) as usize % 2];
        let place = self.start(columns, number);
        // One vector ahead: its roots and divisions are under way while this one's sums are formed.
        let mut prime = self.scheme.primitives(&self.cell(place));
        for m in Self::vectors(columns) {
            self.prefetch_rows(place + m);
            let next = self.scheme.primitives(&self.cell(place + m + L::WIDTH));
            above.put(m, self.scheme.reconstruct(&Around { strip: self, place: place + m }, &prime));
            prime = next;
        }
        above.fill_halo(if number <= first { T::FaceStates::COUNT } else { 0 }, Self::end(columns));
    }

    /// Ask for what will be read a row above `place` and written at it: the rows of a strip are too short for the processor to
    /// notice by itself where the next one begins.
    #[inline(always)]
    fn prefetch_rows(&self, place: usize) {
        /// Numbers in a line of the cache.
        const LINE: usize = 8;
        let above = place + self.layout.stride;
        for m in (0..L::WIDTH).step_by(LINE) {
            for k in 0..T::State::COUNT {
                prefetch(self.from[k].cast::<f64>().wrapping_add(above + m).cast());
                prefetch(self.to[k].wrapping_add(place + m).cast());
            }
            if !UNIFORM {
                for k in 0..T::Ground::COUNT {
                    let start = self.grounds[k];
                    if has(T::Ground::F32_MASK, k) {
                        prefetch(start.cast::<f32>().wrapping_add(above + m).cast());
                    } else if !has(T::Ground::UNIFORM_MASK, k) {
                        prefetch(start.cast::<f64>().wrapping_add(above + m).cast());
                    }
                }
            }
        }
    }

    /// Find what passes the faces along x of the row below `number` (in one dimension the row itself) and what is found at
    /// its upper corners.
    #[inline(always)]
    fn across(&self, columns: [usize; 2], number: isize, first: isize, scratch: &mut Scratch) {
        let Scratch { edges, across, corners, .. } = scratch;
        let end = Self::end(columns);
        if number <= first {
            across.fill_halo(T::Flux::COUNT, end);
        }
        let above = &edges[(number - first) as usize % 2];
        let row = if D > 1 { &edges[(number - first + 1) as usize % 2] } else { above };
        let updates = D == 1 || number > first;
        let high = &mut corners[(number - first) as usize % 2];
        for m in Self::vectors(columns) {
            let at = m as isize;
            // SAFETY: both rows have been put and mended.
            unsafe {
                let (left, right): (T::FaceStates, T::FaceStates) = (row.get(at - 1), row.get(at));
                if updates {
                    across.put(m, self.scheme.flux(0, &left, &right));
                }
                if T::Corner::COUNT > 0 {
                    let (below, above): (T::FaceStates, T::FaceStates) = (above.get(at - 1), above.get(at));
                    high.put(m, self.scheme.corner([[&left, &right], [&below, &above]]));
                }
            }
        }
        high.fill_halo(T::Corner::COUNT, end);
    }

    /// Find what passes the faces along y between row `number` and the one below, and update that (in one dimension the
    /// row itself).
    #[inline(always)]
    fn update_row(
        &self,
        columns: [usize; 2],
        number: isize,
        first: isize,
        scratch: &mut Scratch,
        count: &mut TileReducer,
    ) {
        let Scratch { edges, across, below, corners, updated, in_strip, .. } = scratch;
        let above = &edges[(number - first) as usize % 2];
        let row = if D > 1 { &edges[(number - first + 1) as usize % 2] } else { above };
        let high = &corners[(number - first) as usize % 2];
        let low = if D > 1 { &corners[(number - first + 1) as usize % 2] } else { high };
        let updates = D == 1 || number > first;
        let place = self.start(columns, if D > 1 { number - 1 } else { number });
        // The cells of the vector before that have a new state.
        let mut before = L::from_bits(0);
        for m in Self::vectors(columns) {
            let at = m as isize;
            // SAFETY: all rows have been put and mended, `below` in the row before (in the first row of a rectangle it and `across`
            // hold anything, and what is made of that is not used); a strip has at most STRIP cells.
            unsafe {
                let edges: T::FaceStates = row.get(at);
                let mut faces = [Faces { lo: across.get(at), hi: across.get(at + 1) }; D];
                if D > 1 {
                    let up = self.scheme.flux(D - 1, &edges, &above.get(at));
                    faces[D - 1] = Faces { lo: below.get(at), hi: up };
                    below.put(m, up);
                }
                if updates {
                    if m > 0 {
                        self.diagnostics(m - L::WIDTH, place, updated, before, count);
                    }
                    let mut mask = L::from_bits(u64::from(*in_strip.get_unchecked(m / L::WIDTH)));
                    if !UNIFORM {
                        mask = mask & !self.scheme.is_nodata(&self.ground(place + m));
                    }
                    before = mask;
                    if L::any(mask) {
                        let corners = [[low.get(at), low.get(at + 1)], [high.get(at), high.get(at + 1)]];
                        let vector = Vector { column: m, place: place + m, mask };
                        updated.put(m, self.update(count, vector, &edges, &faces, &corners));
                    }
                }
            }
        }
        if updates {
            self.diagnostics(Self::end(columns) - L::WIDTH, place, updated, before, count);
        }
    }

    /// Update the cells of a vector.
    ///
    /// # Safety
    /// They belong to these tiles.
    #[inline(always)]
    unsafe fn update(
        &self,
        count: &mut TileReducer,
        Vector { column, place, mask }: Vector<L>,
        edges: &T::FaceStates,
        faces: &[Faces<T::Flux>; D],
        corners: &[[T::Corner; 2]; 2],
    ) -> T::State {
        let zero = L::zero();
        let here = self.cell(place);
        let mut new = self.scheme.update(&Around { strip: self, place }, edges, faces, corners, self.dt);
        let mut old = here.state;
        if self.rk_weight > 0.0 {
            // SAFETY: as the caller promises.
            old = T::State::load(
                #[inline(always)]
                |k| unsafe { L::load_where(mask, self.to[k].add(place)) },
            );
            new = self.scheme.rk_combine(L::splat(self.rk_weight), &old, &new);
        }
        let (mut before, mut input) = ([zero; MAX_COMPONENTS], [zero; MAX_COMPONENTS]);
        old.store(
            #[inline(always)]
            |k, value| before[k] = value,
        );
        here.state.store(
            #[inline(always)]
            |k, value| input[k] = value,
        );
        new.store(
            #[inline(always)]
            |k, value| {
                // SAFETY: as the caller promises.
                unsafe { value.store_where(mask, self.to[k].add(place)) };
                if self.last && T::TRACKS_CHANGE {
                    count.change(k, column, mask, (value - before[k]).abs());
                }
            },
        );
        if !count.all_stir::<L>(column) {
            let mut stays = self.scheme.is_static(&here);
            new.store(
                #[inline(always)]
                |k, value| stays = stays & value.equals(input[k]),
            );
            count.stir::<L>(column, mask & !stays);
        }
        new
    }

    /// Take the new states of a vector into account: one vector behind, while the next one's roots and divisions are under way.
    #[inline(always)]
    fn diagnostics(
        &self,
        m: usize,
        start: usize,
        updated: &Row<MAX_COMPONENTS>,
        mask: L::Mask,
        count: &mut TileReducer,
    ) {
        if !self.last || !L::any(mask) {
            return;
        }
        let place = start + m;
        // SAFETY: the vector has been put; the ground is that of the same cells.
        let cell = Cell { state: unsafe { updated.get(m as isize) }, ground: self.ground(place) };
        let watch = self.scheme.diagnostics(&cell);
        // Where a part of the state is no number the rate is infinite, as it is where one is.
        let mut rate = self.scheme.rate(&cell, &self.spacing);
        cell.state.store(
            #[inline(always)]
            |_, part| rate = part.mul_add(L::zero(), rate),
        );
        let most = L::splat(f64::INFINITY);
        count.watch::<L>(m, mask, L::select(rate.lt(most), rate, most), watch.speed_squared);
        if let Some(maps) = self.maps {
            // SAFETY: these are cells of in_strip.
            unsafe { self.mark(maps, place, mask, &watch) };
        }
    }

    /// Bring the maps of peaks and times up to date.
    ///
    /// # Safety
    /// The places of `mask` belong to this tile.
    #[inline(always)]
    unsafe fn mark(
        &self,
        maps: &[DisjointSlice<f32>; 4],
        place: usize,
        mask: L::Mask,
        watch: &Diagnostics<L>,
    ) {
        let [thickness, speed, arrival, stop] = maps;
        let (zero, time) = (L::zero(), L::splat(self.time));
        // SAFETY: as the caller promises.
        unsafe {
            for (map, value) in [(thickness, watch.thickness), (speed, watch.speed_squared.sqrt())] {
                let higher = mask & map.get::<L>(place, mask).lt(value);
                if L::any(higher) {
                    map.put(place, higher, value);
                }
            }
            let thick = mask & zero.lt(watch.volume) & watch.film.equals(zero);
            if L::any(thick) {
                let seen: L = arrival.get(place, mask);
                let first = thick & !seen.equals(seen);
                if L::any(first) {
                    arrival.put(place, first, time);
                }
            }
            let moves = mask & zero.lt(watch.speed_squared);
            if L::any(moves) {
                stop.put(place, moves, time);
            }
        }
    }

    /// Book what passes the ways out of row `j` of a tile: after the faces along x are known those and the lower ones along
    /// y, after the update (`up`) the upper ones.
    #[inline(always)]
    fn book(
        &self,
        out: &mut [f64; OUTLETS.len()],
        tile: &Tile,
        columns: [usize; 2],
        j: isize,
        scratch: &Scratch,
        up: bool,
    ) {
        // They are sorted by rows.
        let outlets = &self.outlets[tile.outlets.clone()];
        let below = |up_to: isize| outlets.partition_point(|outlet| (outlet.cell[1] as isize) < up_to);
        for outlet in &outlets[below(j)..below(j + 1)] {
            let (axis, side) = (outlet.axis as usize, outlet.side);
            if (axis == 1 && side == 1) != up {
                continue;
            }
            let row = if axis == 0 { &scratch.across } else { &scratch.below };
            let moved = usize::from(axis == 0 && side == 1);
            let at = outlet.cell[0] as usize - columns[0] + 1 + moved;
            // SAFETY: the row has been put, and ends with room for a vector.
            let flux: T::Flux = unsafe { row.get(at as isize) };
            let leaves = if side == 0 {
                -self.scheme.outflow(&flux, Side::Right)
            } else {
                self.scheme.outflow(&flux, Side::Left)
            };
            let lambda = self.dt.first() * self.spacing.inv[axis].first();
            out[outlet.exit as usize] += lambda * leaves.first();
        }
    }
}
