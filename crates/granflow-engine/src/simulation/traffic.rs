//! What a run takes of the memory, and what a step asks of it at least.

use super::state::Simulation;
use crate::field::bytes_per_cell;
use crate::observe::Maps;
use granflow_model::scheme::Scheme;

/// Bytes a cell and step that pass between memory and caches if every number is fetched and brought back once a stage.
///
/// Neighbours are taken to be in the cache already; the ground of tiles that see only one is not read at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traffic {
    /// Of the state, the ground and the forcing that are read.
    pub read: f64,
    /// Of the state that is written.
    pub written: f64,
    /// Fetched only to be written over: a line of the cache is read before a part of it is written.
    pub allocated: f64,
}

impl Traffic {
    /// All of them.
    pub fn sum(&self) -> f64 {
        self.read + self.written + self.allocated
    }
}

/// Bytes of a cell that a step reads and does not write.
const fn given<const D: usize, S: Scheme<D, f64>>() -> usize {
    bytes_per_cell::<S::Ground>() + bytes_per_cell::<S::Forcing>()
}

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Bytes that a cell takes while a run computes: its state now and next, its ground and forcing, and the maps if they are kept.
    pub fn bytes_per_cell(maps: bool) -> usize {
        let fields = 2 * bytes_per_cell::<S::State>() + given::<D, S>();
        fields + if maps { Maps::BYTES_PER_CELL } else { 0 }
    }
    /// What a step asks of the memory where every tile is awake and no maps are kept.
    pub fn traffic(&self) -> Traffic {
        let state = bytes_per_cell::<S::State>() as f64;
        let cells = |uniform: bool| {
            let tiles = self.tiles.iter().filter(|tile| tile.uniform || !uniform);
            let count = |[from, to]: [usize; 2]| to - from;
            tiles.map(|tile| count(tile.columns) * count(tile.rows)).sum::<usize>() as f64
        };
        let ground = given::<D, S>() as f64 * (1.0 - cells(true) / cells(false));
        let mut traffic = Traffic { read: 0.0, written: 0.0, allocated: 0.0 };
        for rk_weight in self.stages {
            traffic.read += state + ground;
            traffic.written += state;
            // A later stage reads what it writes over, for the average.
            *(if *rk_weight > 0.0 { &mut traffic.read } else { &mut traffic.allocated }) += state;
        }
        traffic
    }
}
