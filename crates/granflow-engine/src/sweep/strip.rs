//! The inner loop: a block of tiles, some rows at a time, vector by vector.
//!
//! ```text
//!              a block: tiles that are awake side by side and above each other, 126 columns at most
//!
//!              lowest.columns[0]                 highest.columns[1]
//!      row       |   tile    |   tile    |   tile    |
//!     end ---- g +-----------+-----------+-----------+ g     g: a neighbour at each end: its face states are computed,
//!              g |           |           |           | g        its state is not
//!              g |           |           |           | g
//!              g +-----------+-----------+-----------+ g
//!      number  g | ========= | ========= | ========= | g  <- face states of this row are found;
//!     number-1 g | ========= | ========= | ========= | g  <- this one is updated from them and from its own: the strip,
//!              g |           |           |           | g     g included, STRIP cells at most; each of three passes
//!     first -- g +-----------+-----------+-----------+ g     does its part of this for some rows
//!              g   g   g   g   g   g   g   g   g   g   g  <- the ghost row below: where the grid ends boundary::fill set it,
//!                                                            elsewhere it is a row of the tiles below
//!
//!     column of the scratch rows    0   1   2 ...              cells g, first cell of the strip, ...
//!     vectors                      [0 .. W)[W .. 2 W) ...      the last one may reach beyond the strip: computed, not written
//! ```
//!
//! The padded arrays have [`crate::grid::GHOSTS`] cells around the grid: a face needs the face states of two cells, and these a
//! stencil of [`REACH`] cells to each side.

mod outflow;
mod rows;
mod update;

use super::plan::Sweep;
use super::reducer::TileReducer;
use super::scratch::Scratch;
use crate::disjoint::DisjointSlice;
use crate::field::has;
use crate::grid::Layout;
use crate::lanes::{SimdContext, SimdVector, prefetch};
use crate::observe::Marks;
use crate::tiles::{OutletFace, Tile, TileStats};
use granflow_model::real::{for_axis, per_axis};
use granflow_model::scheme::{Cell, Components, MAX_COMPONENTS, REACH, Scheme, Spacing, Stencil, numbers};

/// Where the inner loops write.
pub(super) struct Targets<'a> {
    /// The arrays of the state, [`Layout::len`] numbers each; as many as it has components.
    pub to: [Option<DisjointSlice<'a>>; MAX_COMPONENTS],
    /// The summary maps.
    pub maps: Option<Marks<'a>>,
}

/// Tiles under way, on ground and under a forcing that are everywhere the same (`UNIFORM`) or not. All by value: a number
/// behind a reference would have to be read again after every number that the inner loop writes.
#[derive(Clone, Copy)]
struct Strip<'a, const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> {
    layout: Layout,
    scheme: T,
    /// Where the arrays of the states, the grounds and the forcings begin.
    from: [*const u8; MAX_COMPONENTS],
    grounds: [*const u8; MAX_COMPONENTS],
    forcings: [*const u8; MAX_COMPONENTS],
    /// Ground and forcing where they are uniform, else of one of the cells.
    uniform: (T::Ground, T::Forcing),
    to: [*mut f64; MAX_COMPONENTS],
    maps: Option<&'a Marks<'a>>,
    outlets: &'a [OutletFace],
    spacing: Spacing<D, L>,
    reach: usize,
    dt: L,
    rk_weight: f64,
    last: bool,
    time: f64,
}

/// The cells around one and around those that share its vector.
struct Around<'a, const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> {
    strip: &'a Strip<'a, D, UNIFORM, L, T>,
    place: usize,
}

impl<const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>>
    Stencil<D, L, T::State, T::Ground, T::Forcing> for Around<'_, D, UNIFORM, L, T>
{
    #[inline(always)]
    fn at(&self, offset: [isize; D]) -> Cell<T::State, T::Ground, T::Forcing> {
        for_axis!(axis in D => {
            assert!(offset[axis].unsigned_abs() <= REACH, "a cell beyond the reach of a stencil");
        });
        self.strip.cell(self.strip.layout.moved(self.place, offset))
    }
    #[inline(always)]
    fn spacing(&self) -> &Spacing<D, L> {
        &self.strip.spacing
    }
}

/// Checks that `with_scalar` gave a scheme whose values are stored as those of the scheme that it came from.
pub(super) const fn same<L: SimdVector, S: Components<f64>, T: Components<L>>() {
    assert!(
        S::COUNT == T::COUNT && S::F32_MASK == T::F32_MASK && S::UNIFORM_MASK == T::UNIFORM_MASK,
        "`with_scalar` gives a scheme whose values have other components"
    );
}

/// Compute a rectangle of tiles, `across` side by side, row by row; leave what was found in each, and its changes.
pub(super) fn run<'a, 't, const D: usize, L: SimdVector, T: Scheme<D, L>, S: Scheme<D, f64>>(
    (sweep, targets, context): (&Sweep<'a>, &'a Targets<'a>, impl SimdContext),
    scheme: &T,
    tiles: impl Iterator<Item = &'t Tile> + Clone,
    across: usize,
    found: (&mut [TileStats], &mut [f64]),
    memory: (&mut Scratch<D, L, T>, &mut TileReducer),
) {
    // Mountains, which are kept in single precision, are seldom uniform, the grounds of a line stay in the nearest cache, one cell
    // at a time is slow anyway, and a page is to be small: no loops are compiled for these.
    if const {
        D > 1
            && S::Ground::F32_MASK | S::Forcing::F32_MASK == 0
            && L::WIDTH > 1
            && !cfg!(target_arch = "wasm32")
    } && tiles.clone().all(|tile| tile.uniform)
    {
        let strip = Strip::<D, true, L, T>::new::<S>(sweep, scheme, tiles.clone(), targets);
        strip.sweep(context, tiles, across, found, memory);
    } else {
        let strip = Strip::<D, false, L, T>::new::<S>(sweep, scheme, tiles.clone(), targets);
        strip.sweep(context, tiles, across, found, memory);
    }
}

impl<'a, const D: usize, const UNIFORM: bool, L: SimdVector, T: Scheme<D, L>> Strip<'a, D, UNIFORM, L, T> {
    fn new<'t, S: Scheme<D, f64>>(
        sweep: &Sweep<'a>,
        scheme: &T,
        mut tiles: impl Iterator<Item = &'t Tile>,
        targets: &'a Targets<'a>,
    ) -> Self {
        let corner = tiles.next().map_or([0; 2], |tile| [tile.columns[0], tile.rows[0]]);
        let place = sweep.layout.place(corner[0] as isize, corner[1] as isize);
        let mut to = [std::ptr::null_mut(); MAX_COMPONENTS];
        for (start, array) in to.iter_mut().zip(targets.to.iter().flatten()) {
            *start = array.start();
        }
        Strip {
            layout: sweep.layout,
            scheme: *scheme,
            from: sweep.from.starts::<S::State>(),
            grounds: sweep.grounds.starts::<S::Ground>(),
            forcings: sweep.forcings.starts::<S::Forcing>(),
            uniform: (
                everywhere::<L, S::Ground, _>(sweep.grounds.get(place)),
                everywhere::<L, S::Forcing, _>(sweep.forcings.get(place)),
            ),
            to,
            maps: targets.maps.as_ref(),
            outlets: sweep.outlets,
            spacing: Spacing::new(per_axis!(k => sweep.size[k])),
            reach: sweep.reach,
            dt: L::splat(sweep.dt),
            rk_weight: sweep.rk_weight,
            last: sweep.last,
            time: sweep.time,
        }
    }

    /// dt/dx along an axis.
    #[inline(always)]
    fn lambda(&self, axis: usize) -> L {
        self.dt * self.spacing.inv[axis]
    }
    /// The cells from `place` on.
    #[inline(always)]
    fn cell(&self, place: usize) -> Cell<T::State, T::Ground, T::Forcing> {
        // SAFETY: `Sweep::run` found as many arrays of the length of the layout; the tiles and their ghosts are inside the
        // layout, which ends with room for a vector.
        let state = unsafe { load::<L, T::State>(&self.from, place) };
        Cell { state, ground: self.ground(place), forcing: self.forcing(place) }
    }
    /// Their ground.
    #[inline(always)]
    fn ground(&self, place: usize) -> T::Ground {
        // SAFETY: as in `cell`.
        if UNIFORM { self.uniform.0 } else { unsafe { load::<L, T::Ground>(&self.grounds, place) } }
    }
    /// What acts on them.
    #[inline(always)]
    fn forcing(&self, place: usize) -> T::Forcing {
        // SAFETY: as in `cell`.
        if UNIFORM { self.uniform.1 } else { unsafe { load::<L, T::Forcing>(&self.forcings, place) } }
    }

    /// Ask for the numbers that will be read a row above `place` and written at it: the rows of a strip are too short for the
    /// processor to foresee where the next one begins.
    #[inline(always)]
    fn prefetch_rows(&self, place: usize) {
        /// Numbers in a line of the cache.
        const LINE: usize = 8;
        let above = place + self.layout.stride;
        for m in (0..L::WIDTH).step_by(LINE) {
            for k in 0..T::State::COUNT {
                prefetch(self.from[k].cast::<f64>().wrapping_add(above + m).cast());
                prefetch(self.to[k].wrapping_add(place + m).cast());
            }
            if !UNIFORM {
                prefetch_components::<L, T::Ground>(&self.grounds, above + m);
                prefetch_components::<L, T::Forcing>(&self.forcings, above + m);
            }
        }
    }

    /// Cells of a row that are computed: those of the strip with a neighbour at both ends, filled up to whole vectors.
    #[inline(always)]
    fn end(columns: [usize; 2]) -> usize {
        (columns[1] - columns[0] + 2).next_multiple_of(L::WIDTH)
    }
    /// The first cell of each vector of a row.
    #[inline(always)]
    fn vectors(columns: [usize; 2]) -> impl Iterator<Item = usize> {
        let count = Self::end(columns) / L::WIDTH;
        (0..count).map(|k| k * L::WIDTH)
    }
    /// Place of cell 0 of the scratch, the one left of the strip.
    #[inline(always)]
    fn start(&self, columns: [usize; 2], j: isize) -> usize {
        self.layout.place(columns[0] as isize - 1, j)
    }
}

/// The same value in all lanes.
#[inline(always)]
fn everywhere<L: SimdVector, S: Components<f64>, T: Components<L>>(value: S) -> T {
    let components = numbers(value);
    T::load(
        #[inline(always)]
        |k| L::splat(components[k]),
    )
}

/// The values of the cells from `place` on.
///
/// # Safety
/// `starts` are the arrays of a field of such values, which has the places of a vector from `place` on.
#[inline(always)]
unsafe fn load<L: SimdVector, P: Components<L>>(starts: &[*const u8; MAX_COMPONENTS], place: usize) -> P {
    P::load(
        #[inline(always)]
        |k| {
            assert!(k < P::COUNT);
            let start = starts[k];
            // SAFETY: as the caller promises, in the precision of the component.
            unsafe {
                if has(P::UNIFORM_MASK, k) {
                    L::splat(*start.cast())
                } else if has(P::F32_MASK, k) {
                    L::load_single(start.cast::<f32>().add(place))
                } else {
                    L::load(start.cast::<f64>().add(place))
                }
            }
        },
    )
}

/// Ask for the values of the cells from `place` on.
#[inline(always)]
fn prefetch_components<L: SimdVector, P: Components<L>>(starts: &[*const u8; MAX_COMPONENTS], place: usize) {
    for k in 0..P::COUNT {
        if has(P::F32_MASK, k) {
            prefetch(starts[k].cast::<f32>().wrapping_add(place).cast());
        } else if !has(P::UNIFORM_MASK, k) {
            prefetch(starts[k].cast::<f64>().wrapping_add(place).cast());
        }
    }
}
