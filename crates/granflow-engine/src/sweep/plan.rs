//! What a sweep reads and what it writes.

use crate::field::Field;
use crate::grid::Layout;
use crate::lanes::SimdLevel;
use crate::observe::Maps;
use crate::tiles::{OutletFace, Tile, TileBlock, TileStats};

/// One stage of a step, to be computed in the tiles that are awake.
#[derive(Clone, Copy)]
pub struct Sweep<'a> {
    /// The instructions to use.
    pub(crate) simd: SimdLevel,
    /// All tiles of the grid.
    pub(crate) tiles: &'a [Tile],
    /// The numbers of those that are awake.
    pub(crate) awake: &'a [u32],
    /// These in rectangles; each belongs to one.
    pub(crate) blocks: &'a [TileBlock],
    /// Memory layout.
    pub(crate) layout: Layout,
    /// Cell sizes along the first axis and the last.
    pub(crate) size: [f64; 2],
    /// What does not change in time.
    pub(crate) grounds: &'a Field,
    /// What acts on the cells in this step.
    pub(crate) forcings: &'a Field,
    /// The state that the forward-Euler map is applied to.
    pub(crate) from: &'a Field,
    /// The faces that lead out of the domain.
    pub(crate) outlets: &'a [OutletFace],
    /// Over how many cells a step reaches.
    pub(crate) reach: usize,
    /// Step.
    pub(crate) dt: f64,
    /// Weight of the state that [`Output::to`] holds before (Shu-Osher).
    pub(crate) rk_weight: f64,
    /// The last stage of its step.
    pub(crate) last: bool,
    /// Time at the end of the step.
    pub(crate) time: f64,
}

/// Where a sweep writes.
pub struct Output<'a> {
    /// The new states.
    pub(crate) to: &'a mut Field,
    /// The summary maps, in the last stage of a step, where they are kept.
    pub(crate) maps: Option<&'a mut Maps>,
    /// What was found in each tile that is awake.
    pub(crate) stats: &'a mut [TileStats],
    /// The largest change of each component in each tile that is awake, where the scheme keeps watch of it.
    pub(crate) changes: &'a mut [f64],
}
