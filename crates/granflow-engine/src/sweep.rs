//! One fused sweep over the tiles that are awake, on any number of threads and lanes with the same result bit for bit.
//!
//! A tile sleeps while all cells that a step reaches it from, its own and those of its neighbours that are near it, rested and
//! did not change in the last step: computing it would give the numbers that it holds. Each tile is computed by one thread, reads
//! only the old field and writes only its own cells; sums are taken per tile and added in the order of the tiles.

mod plan;
mod reducer;
mod scratch;
mod strip;

use crate::disjoint::DisjointSlice;
use crate::lanes::{Contexts, SimdContext, SimdKernel, SimdVector};
use crate::observe::Maps;
use crate::parallel;
use crate::tiles::{TileBlock, TileStats};
use granflow_model::scheme::{Components, Scheme, SchemeVisitor};
pub use plan::{Output, Sweep};
use scratch::Workspace;
use strip::Targets;

impl Sweep<'_> {
    /// Compute the tiles that are awake, with the instructions that the functions of `C` allow.
    pub fn run<const D: usize, S: Scheme<D, f64>, C: Contexts>(&self, scheme: &S, output: Output) {
        const {
            let masks = <S::State as Components<f64>>::F32_MASK | <S::State as Components<f64>>::UNIFORM_MASK;
            assert!(masks == 0, "a state is kept in double precision in every cell");
            assert!(
                <S::Forcing as Components<f64>>::UNIFORM_MASK == 0,
                "a forcing is kept in every cell: UNIFORM_MASK is for grounds"
            );
        }
        let Output { to, maps, stats, changes } = output;
        let tracked = tracked::<D, S>();
        // The inner loops trust the shape and these lengths.
        assert!(self.layout.fits(D), "loops for {D} dimensions on a grid of another");
        assert!(to.holds::<S::State>(&self.layout) && self.from.holds::<S::State>(&self.layout));
        assert!(self.grounds.holds::<S::Ground>(&self.layout));
        assert!(self.forcings.holds::<S::Forcing>(&self.layout));
        assert!(maps.as_ref().is_none_or(|maps| maps.holds(&self.layout)));
        let mut arrays = to.arrays_mut();
        let targets = Targets {
            to: std::array::from_fn(|_| arrays.next().map(DisjointSlice::new)),
            maps: maps.map(Maps::marks),
        };
        let stats = DisjointSlice::new(&mut stats[..self.awake.len()]);
        let changes = DisjointSlice::new(&mut changes[..self.awake.len() * tracked]);
        self.simd.run::<C, _>(Tiles::<D, S> { sweep: self, scheme, targets, stats, changes });
    }
}

/// How many components of the state are watched for the largest change.
pub(crate) const fn tracked<const D: usize, S: Scheme<D, f64>>() -> usize {
    if S::TRACKS_CHANGE { <S::State as Components<f64>>::COUNT } else { 0 }
}

/// The tiles of a sweep, with the scheme for one cell at a time.
struct Tiles<'a, const D: usize, S> {
    sweep: &'a Sweep<'a>,
    scheme: &'a S,
    targets: Targets<'a>,
    stats: DisjointSlice<'a, TileStats>,
    changes: DisjointSlice<'a>,
}

impl<const D: usize, S: Scheme<D, f64>> SimdKernel for Tiles<'_, D, S> {
    type Output = ();
    fn run<L: SimdVector>(self, context: impl SimdContext) {
        self.scheme.with_scalar::<L, _>(OnLanes { tiles: self, context });
    }
}

/// The same, to be computed on lanes.
struct OnLanes<T, I> {
    tiles: T,
    context: I,
}

impl<const D: usize, L: SimdVector, S: Scheme<D, f64>, I: SimdContext> SchemeVisitor<D, L>
    for OnLanes<Tiles<'_, D, S>, I>
{
    type Output = ();
    fn visit<T: Scheme<D, L>>(self, scheme: &T) {
        const {
            strip::same::<L, S::State, T::State>();
            strip::same::<L, S::Ground, T::Ground>();
            strip::same::<L, S::Forcing, T::Forcing>();
            assert!(S::TRACKS_CHANGE == T::TRACKS_CHANGE, "`with_scalar` gives another scheme");
        };
        let OnLanes { tiles: Tiles { sweep, targets, stats, changes, .. }, context } = self;
        let Sweep { tiles, awake, blocks, .. } = *sweep;
        let tracked = tracked::<D, S>();
        let chunk = blocks.len().div_ceil(32 * parallel::threads()).max(1);
        parallel::for_each_chunk(blocks, chunk, |blocks| {
            Workspace::with::<D, L, T>(|memory| {
                let (mut scratch, mut reducer) = memory.cut::<D, L, T>();
                for TileBlock { awake: range, across } in blocks {
                    let tiles = awake[range.clone()].iter().map(|number| &tiles[*number as usize]);
                    // SAFETY: every tile belongs to one block.
                    let found = unsafe {
                        let changes = changes.slice(range.start * tracked..range.end * tracked);
                        (stats.slice(range.clone()), changes)
                    };
                    let how = (sweep, &targets, context);
                    let memory = (&mut scratch, &mut reducer);
                    strip::run::<D, L, T, S>(how, scheme, tiles, *across, found, memory);
                }
            });
        });
    }
}
