//! A vector of cells: its new states, and what is watched of them.

use super::{Around, Strip};
use crate::lanes::SimdVector;
use crate::observe::Marks;
use crate::sweep::reducer::TileReducer;
use crate::sweep::scratch::Row;
use granflow_model::scheme::{Cell, Components, Diagnostics, Faces, Scheme, numbers};

/// The cells of a strip that are updated side by side.
pub(super) struct Vector<L: SimdVector> {
    /// The first one's column in the strip, and its place in the field.
    pub column: usize,
    pub place: usize,
    /// Which of them are in the strip and inside the data.
    pub mask: L::Mask,
}

impl<const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> Strip<'_, D, UNIFORM, L, T> {
    /// Update the cells of a vector.
    ///
    /// # Safety
    /// They belong to these tiles.
    #[inline(always)]
    pub(super) unsafe fn update(
        &self,
        reducer: &mut TileReducer,
        Vector { column, place, mask }: Vector<L>,
        states: &T::FaceStates,
        faces: &[Faces<T::Flux>; D],
        corners: &[[T::Corner; 2]; 2],
    ) -> T::State {
        let here = self.cell(place);
        let mut new = self.scheme.update(&Around { strip: self, place }, states, faces, corners, self.dt);
        let mut old = here.state;
        if self.rk_weight > 0.0 {
            old = T::State::load(
                #[inline(always)]
                |k| {
                    assert!(k < T::State::COUNT);
                    // SAFETY: as the caller promises.
                    unsafe { L::load_where(mask, self.to[k].add(place)) }
                },
            );
            new = self.scheme.rk_combine(L::splat(self.rk_weight), &old, &new);
        }
        let (before, input) = (numbers(old), numbers(here.state));
        // A zero keeps its sign where nothing changes, as in a tile that sleeps.
        let components = numbers(new);
        let new = T::State::load(
            #[inline(always)]
            |k| L::select(components[k].equals(input[k]), input[k], components[k]),
        );
        new.store(
            #[inline(always)]
            |k, value| {
                assert!(k < T::State::COUNT);
                // SAFETY: as the caller promises; there is such a component.
                unsafe {
                    value.store_where(mask, self.to[k].add(place));
                    if self.last && T::TRACKS_CHANGE {
                        reducer.change(k, column, mask, (value - before[k]).abs());
                    }
                }
            },
        );
        if !reducer.all_active::<L>(column) {
            let mut stays = self.scheme.is_static(&here);
            new.store(
                #[inline(always)]
                |k, value| stays = stays & value.equals(input[k]),
            );
            reducer.activate::<L>(column, mask & !stays);
        }
        new
    }

    /// Take the new states of a vector into account: one vector behind, while the next one's roots and divisions are under way.
    ///
    /// # Safety
    /// The cells of `mask` belong to these tiles, from column `m` of the strip on.
    #[inline(always)]
    pub(super) unsafe fn diagnostics(
        &self,
        m: usize,
        start: usize,
        updated: &Row<L, T::State, 1>,
        mask: L::Mask,
        reducer: &mut TileReducer,
    ) {
        if !self.last || !L::any(mask) {
            return;
        }
        let place = start + m;
        // SAFETY: a vector of the row.
        let state = unsafe { updated.get(m as isize) };
        let cell = Cell { state, ground: self.ground(place), forcing: self.forcing(place) };
        let watch = self.scheme.diagnostics(&cell);
        // Where a component of the state is no number the rate is infinite, as it is where one is.
        let mut rate = self.scheme.rate(&cell, &self.spacing);
        cell.state.store(
            #[inline(always)]
            |_, component| rate = component * L::zero() + rate,
        );
        let infinite = L::splat(f64::INFINITY);
        let rate = L::select(rate.lt(infinite), rate, infinite);
        // SAFETY: as the caller promises.
        unsafe { reducer.watch::<L>(m, mask, rate, watch.speed_squared) };
        if let Some(maps) = self.maps {
            // SAFETY: as the caller promises.
            unsafe { self.mark_maps(maps, place, mask, &watch) };
        }
    }

    /// Bring the maps of peaks and times up to date where the layer is thicker than the threshold.
    ///
    /// # Safety
    /// The places of `mask` belong to these tiles.
    #[inline(always)]
    unsafe fn mark_maps(&self, maps: &Marks, place: usize, mask: L::Mask, watch: &Diagnostics<L>) {
        let thick = mask & L::splat(maps.threshold).lt(watch.thickness);
        if !L::any(thick) {
            return;
        }
        let (zero, time) = (L::zero(), L::splat(self.time));
        let peaks = [(&maps.peak_thickness, watch.thickness), (&maps.peak_speed, watch.speed_squared.sqrt())];
        // SAFETY: as the caller promises.
        unsafe {
            for (map, value) in peaks {
                let seen: L = map.get(place, thick);
                let higher = thick & (seen.lt(value) | !seen.equals(seen));
                if L::any(higher) {
                    map.put(place, higher, value);
                }
            }
            let seen: L = maps.arrival_time.get(place, thick);
            let first = thick & !seen.equals(seen);
            if L::any(first) {
                maps.arrival_time.put(place, first, time);
            }
            let moves = thick & zero.lt(watch.speed_squared);
            if L::any(moves) {
                maps.stopping_time.put(place, moves, time);
            }
        }
    }
}
