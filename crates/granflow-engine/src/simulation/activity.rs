//! Which tiles are computed and which sleep.

use super::state::Simulation;
use crate::parallel;
use crate::tiles::{MAX_TILES, STRIP, TileBlock, tile_size};
use granflow_model::scheme::{Boundary, Scheme};

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Let every tile be computed in the next step; changes no result, only what it costs.
    pub fn wake_all(&mut self) {
        self.active.clear();
        self.active.extend(0..self.tiles.len() as u32);
    }

    /// Let no tile be computed any more: the state was found to be at rest before it was saved.
    pub fn sleep_all(&mut self) {
        self.active.clear();
    }

    /// Number the tiles that something can happen in, in rectangles: what is next to each other in memory is computed by one
    /// thread, as long as there is enough for all of them. Costs nothing for tiles that sleep.
    pub(super) fn wake(&mut self) {
        for &number in &self.awake {
            self.stats[number as usize].outflow = Default::default();
        }
        self.find_frontier();
        let across = self.across;
        let wide = across.min((STRIP - 2) / tile_size(D)[0]);
        let high = (self.frontier.len() / (wide * 4 * parallel::threads())).clamp(1, MAX_TILES);
        self.awake.clear();
        self.blocks.clear();
        for &number in &self.frontier {
            let number = number as usize;
            if !self.queued[number] {
                continue;
            }
            let columns = wide.min(across - number % across);
            // Where the ground is the same everywhere the loops are others.
            let uniform = self.tiles[number].uniform;
            let alike = |queued: &[bool], tile: usize| queued[tile] && self.tiles[tile].uniform == uniform;
            let width = (0..columns).take_while(|k| alike(&self.queued, number + k)).count();
            let from = self.awake.len();
            let mut row = number;
            for _ in 0..high {
                let tiles = row..row + width;
                if tiles.end > self.queued.len() || !tiles.clone().all(|tile| alike(&self.queued, tile)) {
                    break;
                }
                self.queued[tiles.clone()].fill(false);
                self.awake.extend(tiles.map(|tile| tile as u32));
                row += across;
            }
            self.blocks.push(TileBlock { awake: from..self.awake.len(), across: width });
        }
    }

    /// Find the tiles that something can happen in, in order: the active ones and those that a step reaches from them. They are marked in
    /// `queued`.
    fn find_frontier(&mut self) {
        let (across, up) = (self.across, self.tiles.len() / self.across);
        self.frontier.clear();
        let mut mark = |tile: usize| {
            if !std::mem::replace(&mut self.queued[tile], true) {
                self.frontier.push(tile as u32);
            }
        };
        for &number in &self.active {
            let (x, y) = (number as usize % across, number as usize / across);
            mark(number as usize);
            for v in y.saturating_sub(1)..(y + 2).min(up) {
                for u in x.saturating_sub(1)..(x + 2).min(across) {
                    let away = [u as isize - x as isize, v as isize - y as isize];
                    if self.stats[number as usize].activity.reaches(away) {
                        mark(v * across + u);
                    }
                }
            }
        }
        if !self.active.is_empty() {
            // Tiles at a periodic end never sleep: their neighbours are at the other end.
            let periodic = |axis: usize| self.grid.boundary[axis][0] == Boundary::Periodic;
            if periodic(0) {
                (0..up).for_each(|y| [0, across - 1].into_iter().for_each(|x| mark(y * across + x)));
            }
            if D > 1 && periodic(D - 1) {
                (0..across).for_each(|x| [0, up - 1].into_iter().for_each(|y| mark(y * across + x)));
            }
        }
        self.frontier.sort_unstable();
    }
}
