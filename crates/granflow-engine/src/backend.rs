//! One fused sweep over the tiles that are awake, on any number of threads and lanes with the same result bit for bit.
//!
//! A tile sleeps while all cells that a step reaches it from, its own and those of its neighbours that are near it, rested
//! and did not change in the last step: what it would compute is then what it already holds. Each tile is computed by one thread, reads only the old field and
//! writes only its own cells; sums are taken per tile and added in the order of the tiles.

mod scratch;
mod strip;
mod tally;

use crate::field::Field;
use crate::grid::Layout;
use crate::lanes::{SimdContext, SimdKernel, SimdLevel, SimdVector};
use crate::observe::Maps;
use granflow_model::scheme::{Scheme, SchemeVisitor};
use rayon::prelude::*;
use std::marker::PhantomData;
use std::ops::Range;
use strip::Workspace;
pub use tally::TileStats;

/// Most cells side by side that are computed in one go, with the neighbour at each end.
pub(crate) const STRIP: usize = 128;

/// Largest extent of a tile along x and y. Half of it is at least 6, the reach of a two-stage step: so small may tiles be that
/// a grid is cut into.
pub const fn tile_size(dimensions: usize) -> [usize; 2] {
    if dimensions == 1 { [STRIP - 2, 1] } else { [(STRIP - 2) / 6, 12] }
}

/// Most rows of tiles that one thread computes in one go: the rows between them are then read once.
pub const MAX_TILES: usize = 6;

/// A rectangle of tiles that are awake, row by row in the list of them.
#[derive(Clone, Debug)]
pub struct TileBlock {
    /// Places in the list.
    pub awake: Range<usize>,
    /// How many lie side by side.
    pub across: usize,
}

/// The five ways out of the domain, as the ledger books them.
pub const OUTLETS: [&str; 5] = ["left", "right", "bottom", "top", "nodata"];

/// A rectangle of cells, half open.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Columns from, to.
    pub columns: [usize; 2],
    /// Rows from, to.
    pub rows: [usize; 2],
    /// The faces that lead out of the domain, by number.
    pub outlets: Range<usize>,
    /// The ground is the same in all cells that the tile sees.
    pub uniform: bool,
}

/// A face that leads out of the domain.
#[derive(Clone, Copy, Debug)]
pub struct OutletFace {
    /// The cell's column and row.
    pub cell: [u32; 2],
    /// The axis of the face.
    pub axis: u8,
    /// 0 at the lower end of the cell, 1 at the upper.
    pub side: u8,
    /// By which of [`OUTLETS`].
    pub exit: u8,
}

/// Arrays that several threads write in disjoint places.
pub(crate) struct DisjointSlice<'a, T = f64> {
    start: *mut T,
    len: usize,
    owner: PhantomData<&'a mut [T]>,
}
// SAFETY: a sheet is only read and written through its unsafe functions, whose callers own disjoint places.
unsafe impl<T: Send> Sync for DisjointSlice<'_, T> {}
unsafe impl<T: Send> Send for DisjointSlice<'_, T> {}

impl<'a, T> DisjointSlice<'a, T> {
    pub(crate) fn new(values: &'a mut [T]) -> Self {
        DisjointSlice { start: values.as_mut_ptr(), len: values.len(), owner: PhantomData }
    }
    /// Some of the places.
    ///
    /// # Safety
    /// Nobody else uses them during the life of the sheet.
    pub(crate) unsafe fn slice(&self, places: Range<usize>) -> &'a mut [T] {
        assert!(places.start <= places.end && places.end <= self.len);
        // SAFETY: in bounds, and nobody else uses these places.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(places.start), places.len()) }
    }
}

impl DisjointSlice<'_, f32> {
    /// What stands from `place` on where `mask` holds, `else` 0.
    ///
    /// # Safety
    /// No other thread may write the places of `mask` during the life of the sheet.
    #[inline(always)]
    pub(crate) unsafe fn get<L: SimdVector>(&self, place: usize, mask: L::Mask) -> L {
        debug_assert!(place + L::WIDTH <= self.len);
        // SAFETY: in bounds, and nobody else writes here.
        unsafe { L::load_single_where(mask, self.start.add(place)) }
    }
    /// # Safety
    /// Only one thread may use the places of `mask` during the life of the sheet.
    #[inline(always)]
    pub(crate) unsafe fn put<L: SimdVector>(&self, place: usize, mask: L::Mask, value: L) {
        debug_assert!(place + L::WIDTH <= self.len);
        // SAFETY: in bounds, and nobody else uses these places.
        unsafe { value.store_single_where(mask, self.start.add(place)) }
    }
}

/// Most numbers a state has (h and two momenta).
pub const MAX_COMPONENTS: usize = 3;

/// Everything it takes to compute one stage.
#[derive(Clone, Copy)]
pub struct Sweep<'a> {
    /// What it is computed with.
    pub simd: SimdLevel,
    /// All tiles of the grid.
    pub tiles: &'a [Tile],
    /// The numbers of those that are awake.
    pub awake: &'a [u32],
    /// Those in runs.
    pub runs: &'a [TileBlock],
    /// Memory layout.
    pub layout: Layout,
    /// Cell sizes along the first axis and the last.
    pub size: [f64; 2],
    /// Static data.
    pub grounds: &'a Field,
    /// The state that the forward-Euler map is applied to.
    pub from: &'a Field,
    /// The ways out.
    pub outlets: &'a [OutletFace],
    /// Over how many cells a step reaches.
    pub reach: usize,
    /// Step.
    pub dt: f64,
    /// Weight of what `to` holds before (Shu-Osher).
    pub rk_weight: f64,
    /// The last stage of its step.
    pub last: bool,
    /// Time at the end of the step.
    pub time: f64,
}

impl Sweep<'_> {
    /// Compute the tiles that are awake, write `to` (and `maps` in the last stage), leave a tally each.
    pub fn run<const D: usize, S: Scheme<D, f64>>(
        &self,
        scheme: &S,
        to: &mut Field,
        maps: Option<&mut Maps>,
        tallies: &mut [TileStats],
    ) {
        assert!(to.holds::<S::State>(&self.layout) && self.from.holds::<S::State>(&self.layout));
        let mut parts = to.parts.iter_mut();
        let to = std::array::from_fn(|_| parts.next().map(|values| DisjointSlice::new(values)));
        let maps = maps.map(|maps| maps.slices());
        let tallies = DisjointSlice::new(&mut tallies[..self.awake.len()]);
        self.simd.run(Tiles::<D, S> { sweep: self, scheme, to, maps, tallies });
    }
}

/// The tiles of a sweep, with the scheme for one cell at a time.
struct Tiles<'a, const D: usize, S> {
    sweep: &'a Sweep<'a>,
    scheme: &'a S,
    to: [Option<DisjointSlice<'a>>; MAX_COMPONENTS],
    maps: Option<[DisjointSlice<'a, f32>; 4]>,
    tallies: DisjointSlice<'a, TileStats>,
}

impl<const D: usize, S: Scheme<D, f64>> SimdKernel for Tiles<'_, D, S> {
    type Output = ();
    fn run<L: SimdVector>(self, inside: impl SimdContext) {
        self.scheme.with_scalar::<L, _>(OnLanes { tiles: self, inside });
    }
}

/// The same, to be computed on lanes.
struct OnLanes<T, I> {
    tiles: T,
    inside: I,
}

impl<const D: usize, L: SimdVector, S: Scheme<D, f64>, I: SimdContext> SchemeVisitor<D, L>
    for OnLanes<Tiles<'_, D, S>, I>
{
    type Output = ();
    fn visit<T: Scheme<D, L>>(self, scheme: &T) {
        let OnLanes { tiles: Tiles { sweep, to, maps, tallies, .. }, inside } = self;
        let Sweep { tiles, awake, runs, .. } = *sweep;
        let chunk = runs.len().div_ceil(32 * rayon::current_num_threads()).max(1);
        runs.par_chunks(chunk).with_max_len(1).for_each(|runs| {
            inside.call(
                #[inline(always)]
                || {
                    let mut desk = Workspace::new();
                    for TileBlock { awake: range, across } in runs {
                        let tiles = awake[range.clone()].iter().map(|number| &tiles[*number as usize]);
                        // SAFETY: every tile belongs to one run.
                        let tallies = unsafe { tallies.slice(range.clone()) };
                        let to = (&to, maps.as_ref());
                        strip::run::<D, L, T, S>(sweep, scheme, tiles, *across, to, tallies, &mut desk);
                    }
                },
            );
        });
    }
}
