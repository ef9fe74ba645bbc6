//! A run in memory: fields, clock, tiles and ledger.

mod error;
mod traffic;

pub use error::{BuildError, Failure};
pub use traffic::Traffic;

use crate::backend::{
    MAX_COMPONENTS, MAX_TILES, OUTLETS, OutletFace, STRIP, Sweep, Tile, TileBlock, TileStats, tile_size,
};
use crate::boundary;
use crate::field::Field;
use crate::grid::{GHOSTS, Grid, Layout};
use crate::kernels::Kernel;
pub use crate::lanes::SimdLevel;
use crate::observe::Maps;
use granflow_model::real::{CompensatedSum, per_axis};
use granflow_model::scheme::{Boundary, Cell, Components, Diagnostics, Scheme, Spacing, Stencil};
use granflow_model::time::Stages;
use rayon::prelude::*;

/// How long a step is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepSize {
    /// The same dt every step.
    Fixed(f64),
    /// dt = courant / max over cells of [`Scheme::rate`].
    Courant(f64),
}

/// Sums over the whole grid.
#[derive(Clone, Copy, Debug, Default)]
pub struct Totals {
    /// Volume (length x depth in one dimension): sum of h times the cell measure.
    pub volume: f64,
    /// Part of it in films.
    pub film: f64,
    /// Largest speed along the bed.
    pub speed: f64,
    /// Kinetic energy per density.
    pub energy: f64,
    /// Cells with a depth.
    pub wet: usize,
    /// Cells with a momentum.
    pub moving: usize,
}

/// The fields of a run, its clock and its books.
pub struct Simulation<const D: usize, S: Scheme<D, f64>> {
    scheme: S,
    grid: Grid<D>,
    layout: Layout,
    spacing: Spacing<D, f64>,
    grounds: Field,
    stages: Stages,
    step_size: StepSize,
    now: Field,
    next: Field,
    tiles: Vec<Tile>,
    across: usize,
    outlets: Vec<OutletFace>,
    simd: SimdLevel,
    tallies: Vec<TileStats>,
    /// Sums over the cells of each tile, per cell measure, and which of them are out of date.
    sums: Vec<Totals>,
    unsummed: Vec<bool>,
    /// Their largest rates and speeds, by rows of tiles.
    row_max: Vec<TileRowMax>,
    /// The largest rate of all.
    rate: f64,
    /// Tiles with ways out.
    with_outlets: Vec<u32>,
    /// Tiles that changed in the last step, or may yet.
    active: Vec<u32>,
    awake: Vec<u32>,
    runs: Vec<TileBlock>,
    /// Tiles that something can happen in, and which of them belong to no run yet.
    frontier: Vec<u32>,
    queued: Vec<bool>,
    found: Vec<TileStats>,
    /// Summary maps, kept while present.
    pub maps: Option<Maps>,
    time: f64,
    step: u64,
    updates: u64,
    out: [CompensatedSum; 5],
    /// Volume per time that is poured in now, and what has been poured in.
    supply: f64,
    poured: CompensatedSum,
    last_dt: f64,
}

/// What is largest in a row of tiles.
#[derive(Clone, Copy, Debug, Default)]
struct TileRowMax {
    rate: f64,
    speed: f64,
    /// Not yet known.
    stale: bool,
}

/// How many numbers [`Simulation::clock`] has.
pub const CLOCK: usize = 3 + 2 * OUTLETS.len() + 3;

/// The cells around one, outside a sweep.
struct Around<'a, const D: usize, S: Scheme<D, f64>> {
    simulation: &'a Simulation<D, S>,
    place: usize,
}

impl<const D: usize, S: Scheme<D, f64>> Stencil<D, f64, S::State, S::Ground> for Around<'_, D, S> {
    fn at(&self, offset: [isize; D]) -> Cell<S::State, S::Ground> {
        let place = self.simulation.layout.moved(self.place, offset);
        Cell { state: self.simulation.now.get(place), ground: self.simulation.grounds.get(place) }
    }
    fn spacing(&self) -> &Spacing<D, f64> {
        &self.simulation.spacing
    }
}

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// A run from the ground and the initial state of every cell, given by index per axis.
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
        const { assert!(D == 1 || D == 2, "a grid has one dimension or two") };
        error::check(&grid, step_size, scheme.max_courant())?;
        let layout = Layout::of(&grid);
        let mut bed = Field::zeros::<S::Ground>(&layout);
        let mut now = Field::zeros::<S::State>(&layout);
        let index = |column: usize, row: usize| per_axis!(k => if k == 0 { column } else { row });
        bed.fill(&layout, |column, row| ground(index(column, row)));
        now.fill(&layout, |column, row| initial(index(column, row)));
        boundary::fill(&mut bed, &grid, &layout, |axis, g| scheme.mirror_ground(axis, &g));
        let (tiles, across) = cut(&layout);
        let mut simulation = Simulation {
            spacing: Spacing::new(grid.size),
            next: now.clone(),
            tallies: vec![TileStats::NONE; tiles.len()],
            sums: vec![Totals::default(); tiles.len()],
            unsummed: vec![true; tiles.len()],
            row_max: vec![TileRowMax::default(); tiles.len() / across],
            rate: 0.0,
            with_outlets: Vec::new(),
            active: Vec::with_capacity(tiles.len()),
            awake: Vec::with_capacity(tiles.len()),
            runs: Vec::with_capacity(tiles.len()),
            frontier: Vec::with_capacity(tiles.len()),
            queued: vec![false; tiles.len()],
            found: vec![TileStats::NONE; tiles.len()],
            grounds: bed,
            maps: None,
            time: 0.0,
            step: 0,
            updates: 0,
            out: [CompensatedSum::default(); 5],
            supply: 0.0,
            poured: CompensatedSum::default(),
            last_dt: 0.0,
            stages: scheme.stages(),
            scheme,
            grid,
            layout,
            step_size,
            now,
            tiles,
            across,
            outlets: Vec::new(),
            simd: SimdLevel::Best,
        };
        simulation.wake_all();
        simulation.rebuild_ground_cache();
        simulation.rescan();
        Ok(simulation)
    }

    /// Volume per time that the grounds pour in.
    fn supplied(&self) -> f64 {
        let mut sum = CompensatedSum::default();
        for number in 0..self.grid.count() {
            sum.add(self.scheme.source_rate(&self.ground(self.grid.index(number))));
        }
        sum.value() * self.grid.measure()
    }

    /// Note what follows from the grounds: the supply, the ways out, and where the ground is everywhere the same.
    fn rebuild_ground_cache(&mut self) {
        self.supply = self.supplied();
        self.outlets.clear();
        self.with_outlets.clear();
        for number in 0..self.tiles.len() {
            let from = self.outlets.len();
            let Tile { columns, rows, .. } = self.tiles[number];
            for j in rows[0]..rows[1] {
                for i in columns[0]..columns[1] {
                    self.find_outlets([i, j]);
                }
            }
            // Of no use where a ground is kept in single precision: see `backend::strip`.
            let uniform = S::Ground::F32_MASK == 0 && self.is_uniform(columns, rows);
            let tile = &mut self.tiles[number];
            (tile.outlets, tile.uniform) = (from..self.outlets.len(), uniform);
            if !tile.outlets.is_empty() {
                self.with_outlets.push(number as u32);
            }
        }
    }

    /// Is the ground the same bit for bit in the cells of a tile and all that they see?
    fn is_uniform(&self, columns: [usize; 2], rows: [usize; 2]) -> bool {
        let margin = self.layout.margin as isize;
        let start = |j: isize| self.layout.place(columns[0] as isize - GHOSTS as isize, j);
        let width = columns[1] - columns[0] + 2 * GHOSTS;
        self.grounds.is_uniform((rows[0] as isize - margin..rows[1] as isize + margin).map(start), width)
    }

    /// Note the faces of a cell that lead out of the domain.
    fn find_outlets(&mut self, cell: [usize; 2]) {
        let place = self.layout.place(cell[0] as isize, cell[1] as isize);
        let here: S::Ground = self.grounds.get(place);
        if self.scheme.is_nodata(&here) {
            return;
        }
        for axis in 0..D {
            for side in 0..2 {
                let ends = cell[axis] == if side == 0 { 0 } else { self.grid.cells[axis] - 1 };
                if ends && self.grid.boundary[axis][side] == Boundary::Periodic {
                    continue;
                }
                let step = self.layout.step(axis);
                let there = self.grounds.get(if side == 0 { place - step } else { place + step });
                let way = 2 * axis + side;
                if let Some(exit) = if ends { Some(way) } else { self.scheme.outlet(&here, &there, way) } {
                    let cell = cell.map(|k| k as u32);
                    self.outlets.push(OutletFace {
                        cell,
                        axis: axis as u8,
                        side: side as u8,
                        exit: exit as u8,
                    });
                }
            }
        }
    }

    /// Compute with these simd; changes no result, only what it costs.
    pub fn use_simd(&mut self, simd: SimdLevel) {
        self.simd = simd;
    }

    /// Give every cell the ground that `change` makes of its index and its present one, and wake all.
    pub fn change_grounds(&mut self, change: impl Fn([usize; D], S::Ground) -> S::Ground) {
        for number in 0..self.grid.count() {
            let index = self.grid.index(number);
            let place = self.place(index);
            let ground = self.grounds.get(place);
            self.grounds.set(place, change(index, ground));
        }
        let (grid, layout, scheme) = (&self.grid, &self.layout, &self.scheme);
        boundary::fill(&mut self.grounds, grid, layout, |axis, g| scheme.mirror_ground(axis, &g));
        self.rebuild_ground_cache();
        self.wake_all();
        self.unsummed.fill(true);
    }

    fn place_in(layout: &Layout, index: [usize; D]) -> usize {
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
    /// Time reached.
    pub fn time(&self) -> f64 {
        self.time
    }
    /// Steps done.
    pub fn step(&self) -> u64 {
        self.step
    }
    /// Forward-Euler maps of one cell computed so far, sleeping tiles left out.
    pub fn updates(&self) -> u64 {
        self.updates
    }
    /// The state of a cell.
    pub fn state(&self, index: [usize; D]) -> S::State {
        self.now.get(self.place(index))
    }
    /// The ground of a cell.
    pub fn ground(&self, index: [usize; D]) -> S::Ground {
        self.grounds.get(self.place(index))
    }
    /// Ground and state of a cell.
    pub fn cell(&self, index: [usize; D]) -> Cell<S::State, S::Ground> {
        Cell { state: self.state(index), ground: self.ground(index) }
    }
    /// What the scheme watches in a cell.
    pub fn diagnostics(&self, index: [usize; D]) -> Diagnostics<f64> {
        self.scheme.diagnostics(&self.cell(index))
    }
    /// Pull as a share of the static bound, [`Scheme::yield_ratio`], in every cell, x fastest.
    pub fn yield_ratios(&mut self) -> Vec<f64> {
        boundary::fill(&mut self.now, &self.grid, &self.layout, |axis, s| self.scheme.mirror(axis, &s));
        let margin = |number: usize| {
            let index = self.grid.index(number);
            let outside = self.scheme.is_nodata(&self.ground(index));
            let around = Around { simulation: self, place: self.place(index) };
            if outside { 0.0 } else { self.scheme.yield_ratio(&around) }
        };
        (0..self.grid.count()).into_par_iter().map(margin).collect()
    }
    /// What is made of every cell, x fastest.
    pub fn collect<T>(&self, value: impl Fn(&Cell<S::State, S::Ground>) -> T) -> Vec<T> {
        (0..self.grid.count()).map(|number| value(&self.cell(self.grid.index(number)))).collect()
    }
    /// A value of as many cells as `values` holds, from number `from` on, x fastest, where every row is `columns` long: the
    /// grid's own, or one less in each where the last column is left out.
    pub fn fill(
        &self,
        columns: usize,
        from: usize,
        values: &mut [f64],
        value: impl Fn(&Cell<S::State, S::Ground>) -> f64,
    ) {
        let (mut number, mut rest) = (from, values);
        while !rest.is_empty() {
            let (i, j) = (number % columns, number / columns);
            let (row, after) = rest.split_at_mut((columns - i).min(rest.len()));
            let place = self.layout.place(i as isize, j as isize);
            let (states, grounds) = (self.now.row(place, row.len()), self.grounds.row(place, row.len()));
            number += row.len();
            for (i, here) in row.iter_mut().enumerate() {
                *here = value(&Cell { state: states.get(i), ground: grounds.get(i) });
            }
            rest = after;
        }
    }

    /// A value of every cell, x fastest.
    pub fn map(&self, value: impl Fn(&Cell<S::State, S::Ground>) -> f64 + Sync) -> Vec<f64> {
        const AT_ONCE: usize = 1 << 14;
        let mut values = vec![0.0; self.grid.count()];
        let parts = values.par_chunks_mut(AT_ONCE).enumerate();
        parts.for_each(|(k, part)| self.fill(self.layout.columns, k * AT_ONCE, part, &value));
        values
    }

    /// Volume that has left by the left, right, bottom and top end and into nodata since the start.
    pub fn out(&self) -> [f64; 5] {
        self.out.map(|sum| sum.value() * self.grid.measure())
    }

    /// Volume that has been poured in since the start.
    pub fn poured(&self) -> f64 {
        self.poured.value()
    }
    /// Volume per time that is poured in now.
    pub fn supply(&self) -> f64 {
        self.supply
    }
    /// max over cells of |change of each part of the state|/dt in the last step; infinite before the first, and after a
    /// step that was cut to less than half: a change divided by a sliver is rounding.
    pub fn drift(&self) -> [f64; MAX_COMPONENTS] {
        let whole = self.last_dt > 0.0 && self.last_dt > 0.5 * self.wanted_step();
        let mut most = [0.0_f64; MAX_COMPONENTS];
        for tally in &self.tallies {
            for (most, change) in most.iter_mut().zip(tally.change) {
                *most = most.max(change);
            }
        }
        most.map(|change| if whole { change / self.last_dt } else { f64::INFINITY })
    }

    /// Every cell rests by the scheme's own proof and the last step changed nothing: nothing ever will.
    pub fn at_rest(&self) -> bool {
        self.step > 0 && self.active.is_empty()
    }
    /// Largest speed along the bed.
    pub fn speed(&self) -> f64 {
        self.row_max.iter().fold(0.0, |most, level| level.speed.max(most))
    }
    /// Sums over all cells, compensated and in fixed order; cells that changed since [`Simulation::take_sums`] are looked at.
    pub fn totals(&self) -> Totals {
        let sum = |(number, sums): (usize, &Totals)| {
            if self.unsummed[number] { self.totals_of(&self.tiles[number]) } else { *sums }
        };
        let parts: Vec<Totals> = self.sums.par_iter().enumerate().map(sum).collect();
        let (mut volume, mut film) = (CompensatedSum::default(), CompensatedSum::default());
        let mut totals = Totals { speed: self.speed(), ..Totals::default() };
        for part in parts {
            volume.add(part.volume);
            film.add(part.film);
            totals.energy += part.energy;
            totals.wet += part.wet;
            totals.moving += part.moving;
        }
        let measure = self.grid.measure();
        totals.energy *= measure;
        Totals { volume: volume.value() * measure, film: film.value() * measure, ..totals }
    }

    /// Take the sums over the cells that have changed, so that [`Simulation::totals`] need not.
    pub fn take_sums(&mut self) {
        let mut sums = std::mem::take(&mut self.sums);
        sums.par_iter_mut().zip(&self.tiles).zip(&self.unsummed).for_each(|((sums, tile), &unsummed)| {
            if unsummed {
                *sums = self.totals_of(tile);
            }
        });
        self.sums = sums;
        self.unsummed.fill(false);
    }

    /// Sums over a tile, per cell measure.
    fn totals_of(&self, tile: &Tile) -> Totals {
        let mut totals = Totals::default();
        self.visit(tile, |cell| {
            let watch = self.scheme.diagnostics(cell);
            totals.volume += watch.volume;
            totals.film += watch.volume * watch.film;
            totals.energy += watch.energy;
            totals.wet += usize::from(watch.volume > 0.0);
            totals.moving += usize::from(watch.speed_squared > 0.0);
        });
        totals
    }

    /// See the cells of a tile that lie inside the data.
    fn visit(&self, tile: &Tile, mut see: impl FnMut(&Cell<S::State, S::Ground>)) {
        let Tile { columns, rows, .. } = *tile;
        let width = columns[1] - columns[0];
        for j in rows[0]..rows[1] {
            let start = self.layout.place(columns[0] as isize, j as isize);
            let (states, grounds) = (self.now.row(start, width), self.grounds.row(start, width));
            for i in 0..width {
                let cell = Cell { state: states.get(i), ground: grounds.get(i) };
                if !self.scheme.is_nodata(&cell.ground) {
                    see(&cell);
                }
            }
        }
    }

    /// Keep summary maps from now on, beginning with the state as it stands.
    pub fn keep_maps(&mut self) {
        let mut maps = Maps::new(&self.layout);
        for number in 0..self.grid.count() {
            let index = self.grid.index(number);
            let (place, watch) = (self.place(index), self.diagnostics(index));
            maps.peak_thickness[place] = watch.thickness as f32;
            maps.peak_speed[place] = watch.speed_squared.sqrt() as f32;
            if watch.volume > 0.0 && watch.film == 0.0 {
                maps.arrival_time[place] = self.time as f32;
            }
        }
        self.maps = Some(maps);
    }

    /// Rates and speeds of the state as it stands (needed once, before the first step or after a restart).
    fn rescan(&mut self) {
        let rescan = |tile: &Tile| {
            // Nothing is known of the change before the next step.
            let mut tally = TileStats { change: [f64::INFINITY; MAX_COMPONENTS], ..TileStats::NONE };
            let mut square = 0.0;
            self.visit(tile, |cell| {
                let rate = self.scheme.rate(cell, &self.spacing);
                tally.rate = if tally.rate < rate { rate } else { tally.rate };
                square = self.scheme.diagnostics(cell).speed_squared.max(square);
            });
            tally.speed = square.sqrt();
            tally
        };
        self.tallies = self.tiles.par_iter().map(rescan).collect();
        self.unsummed.fill(true);
        self.row_max.fill(TileRowMax { stale: true, ..TileRowMax::default() });
        self.find_rate();
    }

    /// max over cells of [`Scheme::rate`]: the Courant number of a step dt is dt times this.
    pub fn rate(&self) -> f64 {
        self.rate
    }
    /// The step that the Courant condition or the case asks for; infinite where nothing could move.
    pub fn wanted_step(&self) -> f64 {
        match self.step_size {
            StepSize::Fixed(dt) => dt,
            StepSize::Courant(courant) => {
                // At courant = 1 a fast thin cell empties to the last bit: rounding must not take more than it holds.
                const LESS: f64 = 1.0 - 1e-14;
                LESS * courant / self.rate
            }
        }
    }

    /// Does the step follow from the state?
    pub fn is_adaptive(&self) -> bool {
        matches!(self.step_size, StepSize::Courant(_))
    }

    /// Find the largest rate and speed; rows in which all slept are as they were.
    fn find_rate(&mut self) {
        for (level, tallies) in self.row_max.iter_mut().zip(self.tallies.chunks(self.across)) {
            if level.stale {
                *level = TileRowMax::default();
                for tally in tallies {
                    level.rate = if level.rate < tally.rate { tally.rate } else { level.rate };
                    level.speed = level.speed.max(tally.speed);
                }
            }
        }
        self.rate =
            self.row_max.iter().fold(0.0, |most, level| if most < level.rate { level.rate } else { most });
    }

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
    fn wake(&mut self) {
        for &number in &self.awake {
            self.tallies[number as usize].out = TileStats::NONE.out;
        }
        self.find_frontier();
        let across = self.across;
        let wide = across.min((STRIP - 2) / tile_size(D)[0]);
        let high = (self.frontier.len() / (wide * 4 * rayon::current_num_threads())).clamp(1, MAX_TILES);
        self.awake.clear();
        self.runs.clear();
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
            self.runs.push(TileBlock { awake: from..self.awake.len(), across: width });
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
                    if self.tallies[number as usize].activity.reaches(away) {
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

    /// The numbers that a restart needs: time, step, updates, and the books.
    pub fn clock(&self) -> Vec<f64> {
        let mut numbers = vec![self.time, self.step as f64, self.updates as f64];
        numbers.extend(self.out.iter().flat_map(|sum| sum.parts()));
        numbers.extend(self.poured.parts());
        numbers.push(self.last_dt);
        numbers
    }
    /// The state arrays, padded, for a checkpoint.
    pub fn arrays(&self) -> &Field {
        &self.now
    }
    /// Take up a run from [`Simulation::clock`] and [`Simulation::arrays`]; false where the sizes do not fit.
    pub fn restore(&mut self, clock: &[f64], arrays: Field) -> bool {
        let fits = clock.len() == CLOCK
            && arrays.parts.len() == self.now.parts.len()
            && arrays.parts.iter().all(|part| part.len() == self.layout.len());
        if fits {
            self.time = clock[0];
            self.step = clock[1] as u64;
            self.updates = clock[2] as u64;
            for (k, sum) in self.out.iter_mut().enumerate() {
                *sum = CompensatedSum::from_parts([clock[3 + 2 * k], clock[4 + 2 * k]]);
            }
            let end = 3 + 2 * OUTLETS.len();
            self.poured = CompensatedSum::from_parts([clock[end], clock[end + 1]]);
            self.last_dt = clock[end + 2];
            self.now = arrays;
            self.next = self.now.clone();
            self.wake_all();
            self.rescan();
        }
        fits
    }
}

impl<const D: usize, S: Kernel<D>> Simulation<D, S> {
    /// One step, not beyond time `until`; returns dt.
    ///
    /// # Errors
    /// [`Failure`]: where it is [`Failure::NotFinite`] the state is that after the failed step, else nothing has been done.
    pub fn advance(&mut self, until: f64) -> Result<f64, Failure> {
        let wanted = self.wanted_step();
        let left = until - self.time;
        // A rest of the way that only rounding left over is part of the last step.
        let rounding = if self.is_adaptive() { 0.0 } else { 1e-9 };
        let last = wanted * (1.0 + rounding) >= left;
        let (dt, time) = if last { (left, until) } else { (wanted, self.time + wanted) };
        let advances = time > self.time && dt.is_finite();
        if !advances {
            return Err(Failure::Collapsed { step: self.step, time: self.time, dt });
        }
        let max = self.scheme.max_courant();
        if S::REFUSES_LONG_STEPS && dt * self.rate() > max * (1.0 + 1e-9) {
            let courant = wanted * self.rate();
            return Err(Failure::TooLong { step: self.step, time: self.time, dt: wanted, courant, max });
        }
        self.wake();
        let mut out = [0.0; 5];
        for (stage, &rk_weight) in self.stages.iter().enumerate() {
            let last = stage + 1 == self.stages.len();
            boundary::fill(&mut self.now, &self.grid, &self.layout, |axis, s| self.scheme.mirror(axis, &s));
            let sweep = Sweep {
                simd: self.simd,
                tiles: &self.tiles,
                awake: &self.awake,
                runs: &self.runs,
                layout: self.layout,
                size: [self.grid.size[0], self.grid.size[D - 1]],
                grounds: &self.grounds,
                from: &self.now,
                reach: GHOSTS * self.stages.len(),
                dt,
                rk_weight,
                last,
                time,
                outlets: &self.outlets,
            };
            let maps = if last { self.maps.as_mut() } else { None };
            self.scheme.sweep(&sweep, &mut self.next, maps, &mut self.found);
            std::mem::swap(&mut self.now, &mut self.next);
            out = out.map(|o| o * (1.0 - rk_weight));
            for (&number, found) in self.awake.iter().zip(&self.found) {
                let tally = &mut self.tallies[number as usize];
                let activity = if stage == 0 { found.activity } else { found.activity.or(tally.activity) };
                *tally = TileStats { activity, ..*found };
            }
            // In the order of the tiles, whatever runs they were computed in.
            for &number in &self.with_outlets {
                for (sum, part) in out.iter_mut().zip(self.tallies[number as usize].out) {
                    *sum += (1.0 - rk_weight) * part;
                }
            }
        }
        self.time = time;
        self.step += 1;
        self.last_dt = dt;
        self.poured.add(dt * self.supply);
        for (sum, part) in self.out.iter_mut().zip(out) {
            sum.add(part);
        }
        let mut finite = true;
        self.active.clear();
        for &number in &self.awake {
            let tile = &self.tiles[number as usize];
            let cells = (tile.columns[1] - tile.columns[0]) * (tile.rows[1] - tile.rows[0]);
            self.updates += (cells * self.stages.len()) as u64;
            let tally = &self.tallies[number as usize];
            finite &= tally.rate < f64::INFINITY;
            self.row_max[number as usize / self.across].stale = true;
            self.unsummed[number as usize] = true;
            if tally.activity.anywhere {
                self.active.push(number);
            }
        }
        self.find_rate();
        if finite { Ok(dt) } else { Err(Failure::NotFinite { step: self.step, time: self.time }) }
    }
}

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Give back what only steps need, for there will be none, or none before [`Simulation::restore`].
    pub fn release_buffers(&mut self) {
        self.next = Field::default();
    }
    /// The summary maps by name, x fastest, each copied when all else and those before it are given back.
    pub fn into_maps(self) -> Vec<(&'static str, Vec<f64>)> {
        let Simulation { maps, layout, now, next, grounds, .. } = self;
        drop((now, next, grounds));
        let named = maps.into_iter().flat_map(Maps::into_named);
        named.map(|(name, map)| (name, layout.unpadded(&map))).collect()
    }
}

/// The grid cut into tiles, row by row; how many lie side by side.
fn cut(layout: &Layout) -> (Vec<Tile>, usize) {
    let ends = |count: usize, size: usize| {
        let tiles = count.div_ceil(size);
        (0..tiles).map(move |k| [k * count / tiles, (k + 1) * count / tiles])
    };
    let [width, height] = tile_size(if layout.margin > 0 { 2 } else { 1 });
    let across = ends(layout.columns, width).count();
    let mut tiles = Vec::new();
    for rows in ends(layout.rows, height) {
        for columns in ends(layout.columns, width) {
            tiles.push(Tile { columns, rows, outlets: 0..0, uniform: false });
        }
    }
    (tiles, across)
}
