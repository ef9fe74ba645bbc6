//! States and grounds that are given from outside between two steps: what enters, starts late, or is picked up.

use super::state::Simulation;
use crate::boundary;
use crate::tiles::{Activity, TileStats};
use granflow_model::real::CompensatedSum;
use granflow_model::scheme::{Components, MAX_COMPONENTS, Scheme, numbers};

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Give cells other states between two steps; what that adds of volume is booked as poured in. Only tiles in which a bit of a
    /// state changes wake.
    ///
    /// # Panics
    /// If a cell is outside the grid or the data.
    pub fn change(&mut self, cells: impl IntoIterator<Item = ([usize; D], S::State)>) {
        self.show_end();
        let (mut added, mut changed) = (CompensatedSum::default(), Vec::new());
        for (index, state) in cells {
            assert!((0..D).all(|axis| index[axis] < self.grid.cells[axis]), "a cell beyond the grid");
            assert!(!self.scheme.is_nodata(&self.ground(index)), "a cell outside the data");
            let before = self.diagnostics(index).volume;
            let place = self.place(index);
            if bits(self.now.get::<S::State>(place)) != bits(state) {
                self.now.set(place, state);
                added.add(self.diagnostics(index).volume);
                added.add(-before);
                changed.push(self.tile_of(index));
            }
        }
        changed.sort_unstable();
        changed.dedup();
        let volume = added.value() * self.grid.measure();
        self.poured.add(volume);
        self.last.poured += volume;
        for number in changed {
            let found = self.scanned_tile(number);
            self.stats[number] = TileStats { activity: Activity::EVERYWHERE, ..found };
            self.outdated[number] = true;
            self.row_max[number / self.across].stale = true;
            self.active.push(number as u32);
        }
        self.find_rate();
    }

    /// Give cells other grounds between two steps, data as they were; their tiles wake where a bit of them changes.
    ///
    /// # Panics
    /// If a cell is outside the grid or the data.
    pub fn replace_grounds(&mut self, cells: impl IntoIterator<Item = ([usize; D], S::Ground)>) {
        self.show_end();
        let mut changed = vec![false; self.tiles.len()];
        for (index, ground) in cells {
            assert!((0..D).all(|axis| index[axis] < self.grid.cells[axis]), "a cell beyond the grid");
            let data = [self.ground(index), ground].map(|ground| !self.scheme.is_nodata(&ground));
            assert_eq!(data, [true; 2], "a cell outside the data");
            let place = self.place(index);
            if bits(self.grounds.get::<S::Ground>(place)) != bits(ground) {
                self.grounds.set(place, ground);
                changed[self.tile_of(index)] = true;
            }
        }
        if !changed.contains(&true) {
            return;
        }
        let (grid, layout, scheme) = (&self.grid, &self.layout, &self.scheme);
        boundary::fill(&mut self.grounds, grid, layout, |axis, ground| scheme.mirror_ground(axis, &ground));
        self.find_uniform(&changed);
        for number in (0..changed.len()).filter(|number| changed[*number]) {
            self.stats[number].activity = Activity::EVERYWHERE;
            self.outdated[number] = true;
            self.active.push(number as u32);
        }
    }

    /// The number of the tile that holds a cell.
    pub(super) fn tile_of(&self, index: [usize; D]) -> usize {
        let row = if D > 1 { index[D - 1] } else { 0 };
        let x = self.tiles[..self.across].partition_point(|tile| tile.columns[1] <= index[0]);
        let up = self.tiles.len() / self.across;
        let (mut low, mut high) = (0, up);
        while low < high {
            let middle = (low + high) / 2;
            if self.tiles[middle * self.across].rows[1] <= row { low = middle + 1 } else { high = middle }
        }
        low * self.across + x
    }
}

/// The bits of a value.
pub(super) fn bits<P: Components<f64>>(value: P) -> [u64; MAX_COMPONENTS] {
    numbers(value).map(f64::to_bits)
}
