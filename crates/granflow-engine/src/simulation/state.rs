//! A run in memory: fields, clock, tiles and ledger.

use super::error::{BuildError, check};
use super::last_step::LastStep;
use super::step_size::StepSize;
use super::totals::Totals;
use crate::boundary;
use crate::field::Field;
use crate::grid::{Grid, Layout};
use crate::kernel::{Kernel, Loops};
use crate::lanes::SimdLevel;
use crate::observe::Maps;
use crate::sweep::tracked;
use crate::tiles::{OUTLETS, OutletFace, Tile, TileBlock, TileStats, cut};
use granflow_model::real::{CompensatedSum, per_axis};
use granflow_model::scheme::{Components, Scheme, Spacing};
use granflow_model::time::Stages;

/// The fields of a run, its clock and its ledger.
pub struct Simulation<const D: usize, S: Scheme<D, f64>> {
    pub(super) scheme: S,
    pub(super) loops: Loops<D, S>,
    pub(super) grid: Grid<D>,
    pub(super) layout: Layout,
    pub(super) spacing: Spacing<D, f64>,
    pub(super) grounds: Field,
    pub(super) forcings: Field,
    pub(super) stages: Stages,
    pub(super) step_size: StepSize,
    pub(super) now: Field,
    /// Written by the next stage; the state two stages before until then.
    pub(super) next: Field,
    pub(super) simd: SimdLevel,
    pub(super) tiles: Vec<Tile>,
    /// How many tiles are side by side.
    pub(super) across: usize,
    pub(super) outlets: Vec<OutletFace>,
    /// Tiles with outlets.
    pub(super) with_outlets: Vec<u32>,
    /// What the last sweep over each tile found, and the largest changes there: as many as components are watched.
    pub(super) stats: Vec<TileStats>,
    pub(super) changes: Vec<f64>,
    /// The same of the tiles that are awake, as a sweep leaves it.
    pub(super) found: Vec<TileStats>,
    pub(super) found_changes: Vec<f64>,
    /// Sums over the cells of each tile, per cell measure, and which of them are out of date.
    pub(super) sums: Vec<Totals>,
    pub(super) outdated: Vec<bool>,
    /// The tiles with a source, and those whose forcing has just been changed.
    pub(super) poured_on: Vec<bool>,
    pub(super) forced: Vec<bool>,
    /// The largest rates and speeds by rows of tiles, and the largest changes.
    pub(super) row_max: Vec<TileRowMax>,
    pub(super) row_changes: Vec<f64>,
    /// The largest rate of all.
    pub(super) rate: f64,
    /// The largest change of each component per time.
    pub(super) drift: Vec<f64>,
    /// Tiles that changed in the last step, or may yet.
    pub(super) active: Vec<u32>,
    /// Tiles that something can happen in: the active ones and those that a step reaches from them.
    pub(super) frontier: Vec<u32>,
    /// Which tiles of the frontier belong to no block yet.
    pub(super) queued: Vec<bool>,
    /// The frontier by blocks.
    pub(super) awake: Vec<u32>,
    pub(super) blocks: Vec<TileBlock>,
    /// Summary maps, where they are kept.
    pub(super) maps: Option<Maps>,
    pub(super) time: f64,
    pub(super) step: u64,
    pub(super) updates: u64,
    /// Volume per cell measure that has left by each outlet.
    pub(super) out: [CompensatedSum; OUTLETS.len()],
    /// Volume per time that is poured in now, and the volume that has been poured in.
    pub(super) supply: f64,
    pub(super) poured: CompensatedSum,
    pub(super) last: LastStep,
}

/// A value of every cell, given by index per axis.
type OfCell<'a, const D: usize, P> = &'a (dyn Fn([usize; D]) -> P + Sync);

/// The field whose cells have these values.
fn laid_out<const D: usize, P: Components<f64>>(layout: &Layout, value: OfCell<D, P>) -> Field {
    const { assert!(D == 1 || D == 2, "a grid has one dimension or two") };
    let mut field = Field::zeros::<P>(layout);
    field.fill(layout, |column, row| value(per_axis!(k => if k == 0 { column } else { row })));
    field
}

/// What is largest in a row of tiles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TileRowMax {
    pub rate: f64,
    pub speed: f64,
    /// Not yet known.
    pub stale: bool,
}

impl<const D: usize, S: Kernel<D>> Simulation<D, S> {
    /// A run from the ground and the initial state of every cell, given by index per axis; nothing is poured.
    ///
    /// # Errors
    /// [`BuildError`] for a grid without cells or whose cells have no size, and for a step that the scheme does not take.
    pub fn new(
        scheme: S,
        grid: Grid<D>,
        step_size: StepSize,
        ground: impl Fn([usize; D]) -> S::Ground + Sync,
        initial: impl Fn([usize; D]) -> S::State + Sync,
    ) -> Result<Self, BuildError> {
        Self::with_loops(Loops::of(), scheme, grid, step_size, ground, initial)
    }
}

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// [`Simulation::new`] with inner loops that [`crate::kernel!`] made a constant of.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn with_loops(
        loops: Loops<D, S>,
        scheme: S,
        grid: Grid<D>,
        step_size: StepSize,
        ground: impl Fn([usize; D]) -> S::Ground + Sync,
        initial: impl Fn([usize; D]) -> S::State + Sync,
    ) -> Result<Self, BuildError> {
        Self::built(loops, scheme, grid, step_size, &ground, &initial)
    }

    /// Once for a scheme, whatever gives the ground and the state.
    fn built(
        loops: Loops<D, S>,
        scheme: S,
        grid: Grid<D>,
        step_size: StepSize,
        ground: OfCell<D, S::Ground>,
        initial: OfCell<D, S::State>,
    ) -> Result<Self, BuildError> {
        check(&grid, step_size, scheme.max_courant(), scheme.stages().len())?;
        let layout = Layout::of(&grid);
        let mut grounds = laid_out::<D, S::Ground>(&layout, ground);
        boundary::fill(&mut grounds, &grid, &layout, |axis, g| scheme.mirror_ground(axis, &g));
        let now = laid_out::<D, S::State>(&layout, initial);
        let mut forcings = laid_out::<D, S::Forcing>(&layout, &|_| scheme.usual_forcing());
        boundary::fill(&mut forcings, &grid, &layout, |axis, f| scheme.mirror_forcing(axis, &f));
        let (tiles, across) = cut(&layout);
        let tracked = tracked::<D, S>();
        Ok(Simulation {
            spacing: Spacing::new(grid.size),
            next: now.clone(),
            stats: vec![TileStats::default(); tiles.len()],
            changes: vec![f64::INFINITY; tiles.len() * tracked],
            found_changes: vec![0.0; tiles.len() * tracked],
            row_changes: vec![f64::INFINITY; tiles.len() / across * tracked],
            drift: vec![f64::INFINITY; <S::State as Components<f64>>::COUNT],
            sums: vec![Totals::default(); tiles.len()],
            outdated: vec![true; tiles.len()],
            poured_on: vec![false; tiles.len()],
            forced: vec![false; tiles.len()],
            row_max: vec![TileRowMax::default(); tiles.len() / across],
            rate: 0.0,
            with_outlets: Vec::new(),
            active: (0..tiles.len() as u32).collect(),
            awake: Vec::with_capacity(tiles.len()),
            blocks: Vec::with_capacity(tiles.len()),
            frontier: Vec::with_capacity(tiles.len()),
            queued: vec![false; tiles.len()],
            found: vec![TileStats::default(); tiles.len()],
            grounds,
            forcings,
            maps: None,
            time: 0.0,
            step: 0,
            updates: 0,
            out: [CompensatedSum::default(); OUTLETS.len()],
            supply: 0.0,
            poured: CompensatedSum::default(),
            last: LastStep::none(0.0),
            stages: scheme.stages(),
            loops,
            scheme,
            grid,
            layout,
            step_size,
            now,
            tiles,
            across,
            outlets: Vec::new(),
            simd: SimdLevel::Best,
        }
        .scanned())
    }

    /// With everything that follows from the grounds and the state.
    fn scanned(mut self) -> Self {
        self.rebuild_ground_cache();
        self.rescan();
        self
    }

    /// Compute with these instructions; changes no result, only what it costs.
    pub fn use_simd(&mut self, simd: SimdLevel) {
        self.simd = simd;
    }

    pub(super) fn place_in(layout: &Layout, index: [usize; D]) -> usize {
        layout.place(index[0] as isize, if D > 1 { index[D - 1] as isize } else { 0 })
    }
    /// Place of a cell in the padded arrays.
    pub fn place(&self, index: [usize; D]) -> usize {
        Self::place_in(&self.layout, index)
    }
    /// The grid.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }
    /// The memory layout.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }
    /// The scheme.
    pub fn scheme(&self) -> &S {
        &self.scheme
    }
    /// Time reached, or shown ([`Simulation::show`]).
    pub fn time(&self) -> f64 {
        if self.is_shown() { self.last.at } else { self.time }
    }
    /// Steps done.
    pub fn step(&self) -> u64 {
        self.step
    }
    /// Forward-Euler maps of one cell computed so far, sleeping tiles left out.
    pub fn updates(&self) -> u64 {
        self.updates
    }
}
