//! The rows of a block, from the lowest to the highest.

use super::update::Vector;
use super::{Around, Strip};
use crate::lanes::{SimdContext, SimdVector};
use crate::sweep::reducer::TileReducer;
use crate::sweep::scratch::{Row as ScratchRow, Scratch};
use crate::tiles::{Tile, TileStats};
use granflow_model::real::repeated;
use granflow_model::scheme::{Components, Faces, Forecasts, Scheme};

/// A row under way: the columns of the block, the row whose face states are found, the first row of the block.
#[derive(Clone, Copy)]
struct Row {
    columns: [usize; 2],
    number: isize,
    first: isize,
}

impl Row {
    /// Which of two scratch rows holds this row; the other one holds the row below.
    #[inline(always)]
    fn parity(self) -> usize {
        (self.number - self.first + 2) as usize % 2
    }
    /// Which of three scratch rows holds row `number`, at most one away.
    #[inline(always)]
    fn third(self, number: isize) -> usize {
        (number - self.first + 3) as usize % 3
    }
}

impl<const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> Strip<'_, D, UNIFORM, L, T> {
    /// Compute the tiles from the lowest row to the highest.
    ///
    /// What runs on lanes is called in pieces of a row, each a function of its own: one for all rows would take the compiler twice as
    /// long.
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
        let (first, end) = (lowest.rows[0] as isize, highest.rows[1] as isize);
        self.mark_strip(columns, scratch);
        for stats in &mut *found {
            stats.outflow = TileStats::NONE.outflow;
        }
        let tracked = changes.len() / found.len();
        // The row of tiles that is under way, and where in `found` it begins.
        let (mut tile_row, mut from) = (tiles.clone(), 0);
        // In one dimension a row has all it needs; in two the one above comes first.
        let ahead = if D > 1 { 1 } else { 0 };
        for number in first - ahead..end + ahead {
            let (row, j) = (Row { columns, number, first }, number - ahead);
            context.call(
                #[inline(always)]
                || self.find_face_states(row, scratch.reborrow()),
            );
            if number < first {
                continue;
            }
            context.call(
                #[inline(always)]
                || self.find_fluxes_along_x(row, scratch.reborrow()),
            );
            let leave = tile_row.clone().take(across).zip(&mut found[from..]);
            for (tile, found) in leave.filter(|(tile, _)| !tile.outlets.is_empty()) {
                context.call(
                    #[inline(always)]
                    || self.add_outflow(&mut found.outflow, tile, columns, j, scratch, false),
                );
            }
            context.call(
                #[inline(always)]
                || self.update_row(row, scratch.reborrow(), reducer),
            );
            let leave = tile_row.clone().take(across).zip(&mut found[from..]);
            for (tile, found) in leave.filter(|(tile, _)| !tile.outlets.is_empty()) {
                context.call(
                    #[inline(always)]
                    || self.add_outflow(&mut found.outflow, tile, columns, j, scratch, true),
                );
            }
            let Some(&Tile { rows: [bottom, top], .. }) = tile_row.clone().next() else { continue };
            reducer.pass((j + 1 - bottom as isize).max(0) as usize, top - bottom, self.reach);
            if j + 1 == top as isize {
                for (tile, k) in tile_row.clone().take(across).zip(from..) {
                    let [start, end] = tile.columns.map(|i| i - columns[0] + 1);
                    let changes = &mut changes[k * tracked..(k + 1) * tracked];
                    let stats = reducer.finish(start..end, top - bottom, self.reach, changes);
                    found[k] = TileStats { outflow: found[k].outflow, ..stats };
                }
                tile_row.by_ref().take(across).for_each(drop);
                from += across;
            }
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

    /// Find the face states of row `number`.
    #[inline(always)]
    fn find_face_states(self, row: Row, mut scratch: Scratch<D, L, T>) {
        if T::Forecast::COUNT > 0 {
            self.find_forecasts(row, &mut scratch.forecasts);
        }
        let Scratch { forecasts, face_states, .. } = &mut scratch;
        let above = &mut face_states[row.parity()];
        let place = self.start(row.columns, row.number);
        // One vector ahead: its roots and divisions are under way while this one's sums are formed.
        let mut primitives = self.scheme.primitives(&self.cell(place));
        for m in Self::vectors(row.columns) {
            self.prefetch_rows(place + m);
            let next = self.scheme.primitives(&self.cell(place + m + L::WIDTH));
            let stencil = Around { strip: &self, place: place + m };
            // SAFETY: a vector of the row.
            unsafe {
                let forecasts = Self::forecasts(forecasts, row, m as isize);
                above.put(m as isize, self.scheme.reconstruct(&stencil, &primitives, &forecasts, self.dt));
            }
            primitives = next;
        }
        if row.number <= row.first {
            above.fill_halo(Self::end(row.columns));
        }
    }

    /// Forecast the row above `number` (in one dimension the row itself), before the first row also that and the one below.
    #[inline(always)]
    fn find_forecasts(&self, row: Row, rows: &mut [ScratchRow<L, T::Forecast>; 3]) {
        let [from, to] = match D {
            1 => [row.number; 2],
            _ if row.number < row.first => [row.number - 1, row.number + 1],
            _ => [row.number + 1; 2],
        };
        for number in from..=to {
            let place = self.start(row.columns, number);
            let here = &mut rows[row.third(number)];
            // From the cell before the first to the one behind the last.
            for m in (0..Self::end(row.columns) + 2).step_by(L::WIDTH) {
                let stencil = Around { strip: self, place: place + m - 1 };
                // SAFETY: it begins before the first cell or at one of the row.
                unsafe { here.put(m as isize - 1, self.scheme.forecast(&stencil, self.dt)) };
            }
        }
    }

    /// The forecasts around the cells from `at` on.
    ///
    /// # Safety
    /// A vector of the row.
    #[inline(always)]
    unsafe fn forecasts(
        rows: &[ScratchRow<L, T::Forecast>; 3],
        row: Row,
        at: isize,
    ) -> Forecasts<D, T::Forecast> {
        let here = &rows[row.third(row.number)];
        // SAFETY: as the caller promises.
        unsafe {
            let (mut lo, mut hi) = (repeated(here.get(at - 1)), repeated(here.get(at + 1)));
            if D > 1 {
                lo[D - 1] = rows[row.third(row.number - 1)].get(at);
                hi[D - 1] = rows[row.third(row.number + 1)].get(at);
            }
            Forecasts { here: here.get(at), lo, hi }
        }
    }

    /// Find the fluxes along x of the row below `number` (in one dimension of the row itself), and the values at its upper
    /// corners.
    #[inline(always)]
    fn find_fluxes_along_x(self, row: Row, mut scratch: Scratch<D, L, T>) {
        let Scratch { face_states, across, corners, .. } = &mut scratch;
        let end = Self::end(row.columns);
        if row.number <= row.first {
            across.fill_halo(end);
        }
        let above = &face_states[row.parity()];
        let here = if D > 1 { &face_states[1 - row.parity()] } else { above };
        let updates = D == 1 || row.number > row.first;
        let high = &mut corners[row.parity()];
        for m in Self::vectors(row.columns) {
            let at = m as isize;
            // SAFETY: a vector of the row.
            unsafe {
                let (left, right) = (here.get(at - 1), here.get(at));
                if updates {
                    across.put(at, self.scheme.flux(0, &left, &right, self.lambda(0)));
                }
                if T::Corner::COUNT > 0 {
                    let (below, above) = (above.get(at - 1), above.get(at));
                    high.put(at, self.scheme.corner([[&left, &right], [&below, &above]]));
                }
            }
        }
        high.fill_halo(end);
    }

    /// Find the fluxes along y between row `number` and the one below, and update that (in one dimension the row itself).
    #[inline(always)]
    fn update_row(self, row: Row, mut scratch: Scratch<D, L, T>, reducer: &mut TileReducer) {
        let Scratch { face_states, across, below, corners, updated, in_strip, .. } = &mut scratch;
        let (Row { columns, number, first }, parity) = (row, row.parity());
        let above = &face_states[parity];
        let here = if D > 1 { &face_states[1 - parity] } else { above };
        let high = &corners[parity];
        let low = if D > 1 { &corners[1 - parity] } else { high };
        let updates = D == 1 || number > first;
        let place = self.start(columns, if D > 1 { number - 1 } else { number });
        // The cells of the vector before that have a new state.
        let mut before = L::from_bits(0);
        for m in Self::vectors(columns) {
            let at = m as isize;
            // SAFETY: a vector of the row; a strip has at most STRIP cells. (In the first row of a block `below` and `across` hold
            // numbers of other strips, and what is made of them is not used.)
            unsafe {
                let states = here.get(at);
                let mut faces: [_; D] = repeated(Faces { lo: across.get(at), hi: across.get(at + 1) });
                if D > 1 {
                    let up = self.scheme.flux(D - 1, &states, &above.get(at), self.lambda(D - 1));
                    faces[D - 1] = Faces { lo: below.get(at), hi: up };
                    below.put(at, up);
                }
                if updates {
                    if m > 0 {
                        self.diagnostics(m - L::WIDTH, place, updated, before, reducer);
                    }
                    let mut mask = L::from_bits(u64::from(*in_strip.get_unchecked(m / L::WIDTH)));
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
            unsafe { self.diagnostics(Self::end(columns) - L::WIDTH, place, updated, before, reducer) };
        }
    }
}
