//! The rows of a block, from the lowest to the highest.

use super::update::Vector;
use super::{Around, Strip};
use crate::lanes::{SimdContext, SimdVector};
use crate::sweep::reducer::TileReducer;
use crate::sweep::scratch::{Row, Scratch};
use crate::tiles::{Tile, TileStats};
use granflow_model::real::repeated;
use granflow_model::scheme::{Components, Faces, Forecasts, Scheme};

/// Rows that are computed at a time.
#[derive(Clone, Copy)]
struct Batch {
    /// The columns of the block, and its first row.
    columns: [usize; 2],
    first: isize,
    /// The rows of the tiles that are under way, half open.
    tiles: [usize; 2],
    /// The rows whose face states are found, half open.
    numbers: [isize; 2],
}

impl<const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> Strip<'_, D, UNIFORM, L, T> {
    /// In one dimension a row has all it needs; in two the face states of the one above are found before it is updated.
    const AHEAD: isize = if D > 1 { 1 } else { 0 };

    /// Compute the tiles from the lowest row to the highest.
    ///
    /// What runs on lanes is called in three passes, each a function of its own: one for all would take the compiler twice as long. A
    /// pass takes several rows, or fetching what they share would be felt where rows are short.
    pub(super) fn sweep<'t>(
        &self,
        context: impl SimdContext,
        tiles: impl Iterator<Item = &'t Tile> + Clone,
        across: usize,
        (found, changes): (&mut [TileStats], &mut [f64]),
        (scratch, reducer): (&mut Scratch<D, L, T>, &mut TileReducer),
    ) {
        let (Some(lowest), Some(highest)) = (tiles.clone().next(), tiles.clone().last()) else { return };
        let columns = [lowest.columns[0], highest.columns[1]];
        let first = lowest.rows[0] as isize;
        self.mark_strip(columns, scratch);
        for stats in &mut *found {
            stats.outflow = Default::default();
        }
        let tracked = changes.len() / found.len();
        let at_once = scratch.fit(Self::end(columns)) as isize;
        // The row of tiles that is under way, and where in `found` it begins.
        let (mut tile_row, mut from) = (tiles.clone(), 0);
        let mut next = first - Self::AHEAD;
        while let Some(&Tile { rows: [bottom, top], .. }) = tile_row.clone().next() {
            let end = (next + at_once).min(top as isize + Self::AHEAD);
            let batch = Batch { columns, first, tiles: [bottom, top], numbers: [next, end] };
            context.call(
                #[inline(always)]
                || self.find_face_states(batch, scratch.reborrow()),
            );
            context.call(
                #[inline(always)]
                || self.find_fluxes_along_x(batch, scratch.reborrow()),
            );
            context.call(
                #[inline(always)]
                || self.update_rows(batch, scratch.reborrow(), reducer),
            );
            let leave = tile_row.clone().take(across).zip(&mut found[from..]);
            let updated = [next, end].map(|number| number - Self::AHEAD);
            for (tile, found) in leave.filter(|(tile, _)| !tile.outlets.is_empty()) {
                context.call(
                    #[inline(always)]
                    || self.add_outflow(&mut found.outflow, tile, columns, updated, scratch),
                );
            }
            if end == top as isize + Self::AHEAD {
                for (tile, k) in tile_row.clone().take(across).zip(from..) {
                    let [start, end] = tile.columns.map(|i| i - columns[0] + 1);
                    let changes = &mut changes[k * tracked..(k + 1) * tracked];
                    let stats = reducer.finish(start..end, top - bottom, self.reach, changes);
                    found[k] = TileStats { outflow: found[k].outflow, ..stats };
                }
                tile_row.by_ref().take(across).for_each(drop);
                from += across;
            }
            next = end;
        }
    }

    /// Note which cells of each vector belong to the strip.
    fn mark_strip(&self, columns: [usize; 2], scratch: &mut Scratch<D, L, T>) {
        let none = UNIFORM && L::any(self.scheme.is_nodata(&self.ground(0)));
        for m in Self::vectors(columns) {
            let in_strip = if none { 0 } else { ((1_u128 << (columns[1] - columns[0])) - 1) << 1 };
            scratch.in_strip[m / L::WIDTH] = (in_strip >> m) as u16;
        }
    }

    /// Find the face states of some rows.
    #[inline(always)]
    fn find_face_states(self, batch: Batch, mut scratch: Scratch<D, L, T>) {
        for number in batch.numbers[0]..batch.numbers[1] {
            if T::Forecast::COUNT > 0 {
                self.find_forecasts(batch, number, &mut scratch);
            }
            let [below, here, above] =
                [-1, 0, 1].map(|up| scratch.forecasts.row(if D > 1 { number + up } else { number }));
            let mut face_states = scratch.face_states.row_mut(number);
            let place = self.start(batch.columns, number);
            // One vector ahead: its roots and divisions are under way while this one's sums are formed.
            let mut primitives = self.scheme.primitives(&self.cell(place));
            for m in Self::vectors(batch.columns) {
                self.prefetch_rows(place + m);
                let next = self.scheme.primitives(&self.cell(place + m + L::WIDTH));
                let stencil = Around { strip: &self, place: place + m };
                // SAFETY: a vector of the row.
                unsafe {
                    let forecasts = Self::forecasts([&below, &here, &above], m as isize);
                    face_states
                        .put(m as isize, self.scheme.reconstruct(&stencil, &primitives, &forecasts, self.dt));
                }
                primitives = next;
            }
        }
    }

    /// Forecast the row above `number` (in one dimension the row itself), before the first row also that and the one below.
    #[inline(always)]
    fn find_forecasts(&self, batch: Batch, number: isize, scratch: &mut Scratch<D, L, T>) {
        let [from, to] = match D {
            1 => [number; 2],
            _ if number < batch.first => [number - 1, number + 1],
            _ => [number + 1; 2],
        };
        for number in from..=to {
            let place = self.start(batch.columns, number);
            let mut here = scratch.forecasts.row_mut(number);
            // From the cell before the first to the one behind the last.
            for m in (0..Self::end(batch.columns) + 2).step_by(L::WIDTH) {
                let stencil = Around { strip: self, place: place + m - 1 };
                // SAFETY: it begins before the first cell or at one of the row.
                unsafe { here.put(m as isize - 1, self.scheme.forecast(&stencil, self.dt)) };
            }
        }
    }

    /// The forecasts around the cells from `at` on of the middle one of three rows.
    ///
    /// # Safety
    /// A vector of the row.
    #[inline(always)]
    unsafe fn forecasts(
        [below, here, above]: [&Row<L, T::Forecast, 1>; 3],
        at: isize,
    ) -> Forecasts<D, T::Forecast> {
        // SAFETY: as the caller promises.
        unsafe {
            let (mut lo, mut hi) = (repeated(here.get(at - 1)), repeated(here.get(at + 1)));
            if D > 1 {
                lo[D - 1] = below.get(at);
                hi[D - 1] = above.get(at);
            }
            Forecasts { here: here.get(at), lo, hi }
        }
    }

    /// Find the fluxes along x of the rows below (in one dimension of the rows themselves), and the values at their upper
    /// corners.
    #[inline(always)]
    fn find_fluxes_along_x(self, batch: Batch, mut scratch: Scratch<D, L, T>) {
        for number in batch.numbers[0].max(batch.first)..batch.numbers[1] {
            let above = scratch.face_states.row(number);
            let here = scratch.face_states.row(number - Self::AHEAD);
            let updates = D == 1 || number > batch.first;
            let mut along_x = scratch.along_x.row_mut(number - Self::AHEAD);
            let mut corners = scratch.corners.row_mut(number);
            for m in Self::vectors(batch.columns) {
                let at = m as isize;
                // SAFETY: a vector of the row.
                unsafe {
                    let (left, right) = (here.get(at - 1), here.get(at));
                    if updates {
                        along_x.put(at, self.scheme.flux(0, &left, &right, self.lambda(0)));
                    }
                    if T::Corner::COUNT > 0 {
                        let (below, above) = (above.get(at - 1), above.get(at));
                        corners.put(at, self.scheme.corner([[&left, &right], [&below, &above]]));
                    }
                }
            }
        }
    }

    /// Find the fluxes along y between some rows and the ones below, and update these (in one dimension the rows themselves).
    #[inline(always)]
    fn update_rows(self, batch: Batch, mut scratch: Scratch<D, L, T>, reducer: &mut TileReducer) {
        let [bottom, top] = batch.tiles;
        for number in batch.numbers[0].max(batch.first)..batch.numbers[1] {
            self.update_row(batch, number, &mut scratch, reducer);
            let done = number - Self::AHEAD + 1 - bottom as isize;
            reducer.pass(done.max(0) as usize, top - bottom, self.reach);
        }
    }

    /// Find the fluxes along y between row `number` and the one below, and update that (in one dimension the row itself).
    #[inline(always)]
    fn update_row(
        &self,
        batch: Batch,
        number: isize,
        scratch: &mut Scratch<D, L, T>,
        reducer: &mut TileReducer,
    ) {
        let columns = batch.columns;
        let above = scratch.face_states.row(number);
        let here = scratch.face_states.row(number - Self::AHEAD);
        let along_x = scratch.along_x.row(number - Self::AHEAD);
        let (lower, mut upper) = scratch.along_y.with_next(number - 1);
        let high = scratch.corners.row(number);
        let low = scratch.corners.row(number - Self::AHEAD);
        let mut updated = scratch.updated.row_mut(0);
        let updates = D == 1 || number > batch.first;
        let place = self.start(columns, number - Self::AHEAD);
        // The cells of the vector before that have a new state.
        let mut before = L::from_bits(0);
        for m in Self::vectors(columns) {
            let at = m as isize;
            // SAFETY: a vector of the row; a strip has at most STRIP cells. (Before the first row of a block `along_y` holds
            // numbers of other strips, as face states do before the first cell, and fluxes and corners behind the last vector; what is
            // made of them is not used.)
            unsafe {
                let states = here.get(at);
                let mut faces: [_; D] = repeated(Faces { lo: along_x.get(at), hi: along_x.get(at + 1) });
                if D > 1 {
                    let up = self.scheme.flux(D - 1, &states, &above.get(at), self.lambda(D - 1));
                    faces[D - 1] = Faces { lo: lower.get(at), hi: up };
                    upper.put(at, up);
                }
                if updates {
                    if m > 0 {
                        self.diagnostics(m - L::WIDTH, place, &updated, before, reducer);
                    }
                    let mut mask = L::from_bits(u64::from(*scratch.in_strip.get_unchecked(m / L::WIDTH)));
                    if !UNIFORM {
                        mask = mask & !self.scheme.is_nodata(&self.ground(place + m));
                    }
                    before = mask;
                    if L::any(mask) {
                        let corners = [[low.get(at), low.get(at + 1)], [high.get(at), high.get(at + 1)]];
                        let vector = Vector { column: m, place: place + m, mask };
                        updated.put(at, self.update(reducer, vector, &states, &faces, &corners));
                    }
                }
            }
        }
        if updates {
            // SAFETY: the last vector of the row.
            unsafe { self.diagnostics(Self::end(columns) - L::WIDTH, place, &updated, before, reducer) };
        }
    }
}
