//! A scheme is a few pointwise functions; arrays, axes, threads and files live elsewhere.

use crate::real::{Real, for_axis, per_axis, repeated};
use crate::time::Stages;

/// A value of a cell that is stored as a few numbers, one array each (struct of arrays).
///
/// `load` asks for, and `store` hands out, parts below `COUNT`; the engine panics at others.
pub trait Components<R: Real>: Copy + Send + Sync + 'static {
    /// How many numbers.
    const COUNT: usize;
    /// The parts that a grid keeps in single precision, a bit each.
    const F32_MASK: u32 = 0;
    /// The parts that are the same in all cells of a grid, a bit each: they are kept once.
    const UNIFORM_MASK: u32 = 0;
    /// Gather the value from its numbers.
    fn load(part: impl Fn(usize) -> R) -> Self;
    /// Hand the numbers out.
    fn store(self, put: impl FnMut(usize, R));
}

/// The most numbers that the state, the ground or the forcing of a scheme may have. (Face states and fluxes may have any number.)
pub const MAX_COMPONENTS: usize = 16;

/// The numbers of a value of at most [`MAX_COMPONENTS`], and zeros behind them.
///
/// # Panics
/// If it has more.
#[inline(always)]
pub fn numbers<R: Real, P: Components<R>>(value: P) -> [R; MAX_COMPONENTS] {
    let zero = R::zero();
    // One by one: `[zero; 16]` would be a loop for the compiler ([`crate::real::repeated`]).
    let mut numbers =
        [zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero];
    value.store(
        #[inline(always)]
        |k, number| numbers[k] = number,
    );
    numbers
}

impl<R: Real> Components<R> for () {
    const COUNT: usize = 0;
    #[inline(always)]
    fn load(_part: impl Fn(usize) -> R) -> Self {}
    #[inline(always)]
    fn store(self, _put: impl FnMut(usize, R)) {}
}

impl<R: Real> Components<R> for R {
    const COUNT: usize = 1;
    #[inline(always)]
    fn load(part: impl Fn(usize) -> R) -> Self {
        part(0)
    }
    #[inline(always)]
    fn store(self, mut put: impl FnMut(usize, R)) {
        put(0, self);
    }
}

impl<R: Real, P: Components<R>, const N: usize> Components<R> for [P; N] {
    const COUNT: usize = N * P::COUNT;
    #[inline(always)]
    fn load(part: impl Fn(usize) -> R) -> Self {
        per_axis!(item => P::load(
            #[inline(always)]
            |k| part(item * P::COUNT + k),
        ))
    }
    #[inline(always)]
    fn store(self, mut put: impl FnMut(usize, R)) {
        for_axis!(item in N => {
            self[item].store(
                #[inline(always)]
                |k, value| put(item * P::COUNT + k, value),
            );
        });
    }
}

/// Implements [`Components`] for a struct, field by field in the order of the list, whatever their order in the struct:
/// `components!([const D: usize, R: Real] Flow<D, R> { h: R, q: [R; D] });`, or of single numbers
/// `components!(Coulomb { mu: f64 });`
#[macro_export]
macro_rules! components {
    ($name:ident { $($field:ident: $kind:ty),* $(,)? }) => {
        const _: () = {
            type R = f64;
            $crate::components!([] $name { $($field: $kind),* });
        };
    };
    ([$($generics:tt)*] $name:ty { $($field:ident: $kind:ty),* $(,)? }) => {
        impl<$($generics)*> $crate::scheme::Components<R> for $name {
            const COUNT: usize = 0 $(+ <$kind as $crate::scheme::Components<R>>::COUNT)*;
            #[inline(always)]
            #[allow(unused_assignments, unused_mut, unused_variables, reason = "the last field moves on as the others do")]
            fn load(part: impl Fn(usize) -> R) -> Self {
                let mut next = 0;
                $(
                    let from = next;
                    next += <$kind as $crate::scheme::Components<R>>::COUNT;
                    let $field = <$kind as $crate::scheme::Components<R>>::load(#[inline(always)] |k| part(from + k));
                )*
                Self { $($field),* }
            }
            #[inline(always)]
            #[allow(unused_assignments, unused_mut, unused_variables, reason = "the last field moves on as the others do")]
            fn store(self, mut put: impl FnMut(usize, R)) {
                let mut next = 0;
                $(
                    let from = next;
                    next += <$kind as $crate::scheme::Components<R>>::COUNT;
                    <$kind as $crate::scheme::Components<R>>::store(self.$field, #[inline(always)] |k, value| put(from + k, value));
                )*
            }
        }
    };
}
pub use components;

/// A cell's state, its ground, and what acts on it.
#[derive(Clone, Copy, Debug)]
pub struct Cell<S, G, F = ()> {
    /// The unknowns.
    pub state: S,
    /// Slope, bed, coefficients: nothing of it changes in time.
    pub ground: G,
    /// Sources and whatever else comes from outside and may change between two steps.
    pub forcing: F,
}

/// The distance of cell centres along each axis, and its reciprocal.
#[derive(Clone, Copy, Debug)]
pub struct Spacing<const D: usize, R> {
    /// dx, dy in the units of the case.
    pub size: [R; D],
    /// 1/dx, 1/dy.
    pub inv: [R; D],
    /// The smallest of dx, dy.
    pub smallest: f64,
}

impl<const D: usize, R: Real> Spacing<D, R> {
    /// From the cell sizes.
    #[inline(always)]
    pub fn new(size: [f64; D]) -> Self {
        Spacing {
            size: per_axis!(k => R::splat(size[k])),
            inv: per_axis!(k => R::splat(1.0 / size[k])),
            smallest: size.into_iter().fold(f64::INFINITY, f64::min),
        }
    }
}

/// A cell and its neighbours along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Neighbours<const D: usize, R, S, G, F = ()> {
    /// The cell itself.
    pub here: Cell<S, G, F>,
    /// The neighbour towards smaller coordinates, per axis.
    pub lo: [Cell<S, G, F>; D],
    /// The neighbour towards larger coordinates, per axis.
    pub hi: [Cell<S, G, F>; D],
    /// Cell sizes.
    pub spacing: Spacing<D, R>,
}

/// The neighbourhood of a cell, read where a scheme asks.
pub trait Stencil<const D: usize, R: Real, S: Copy, G: Copy, F: Copy = ()> {
    /// The cell `offset` cells away along each axis, at most [`REACH`].
    fn at(&self, offset: [isize; D]) -> Cell<S, G, F>;
    /// Cell sizes.
    fn spacing(&self) -> &Spacing<D, R>;

    /// The cell with its neighbours along each axis.
    #[inline(always)]
    fn star(&self) -> Neighbours<D, R, S, G, F> {
        let here = self.at([0; D]);
        let (mut lo, mut hi) = (repeated(here), repeated(here));
        for_axis!(axis in D => {
            let mut step = [0; D];
            step[axis] = 1;
            hi[axis] = self.at(step);
            step[axis] = -1;
            lo[axis] = self.at(step);
        });
        Neighbours { here, lo, hi, spacing: *self.spacing() }
    }
}

/// What was forecast of a cell and of its neighbours along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Forecasts<const D: usize, P> {
    /// Of the cell itself.
    pub here: P,
    /// Of the neighbour towards smaller coordinates, per axis.
    pub lo: [P; D],
    /// Of the neighbour towards larger coordinates, per axis.
    pub hi: [P; D],
}

/// How far along each axis [`Scheme::reconstruct`] sees, and with what it sees of the forecasts' neighbours.
pub const REACH: usize = 2;

/// What passes a cell's two faces of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Faces<F> {
    /// Through the face towards smaller coordinates.
    pub lo: F,
    /// Through the face towards larger coordinates.
    pub hi: F,
}

/// The side of a face on which a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The cell with the smaller coordinate.
    Left,
    /// The cell with the larger coordinate.
    Right,
}

/// What happens at the end of an axis of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    /// Transmissive: the ghost cells copy the edge cell.
    Open,
    /// Reflecting: the ghost cells are the mirror image, nothing passes.
    Wall,
    /// The two ends of the axis are joined.
    Periodic,
    /// Nothing is beyond: what leaves is added to the outflow, nothing comes back. The edge of a raster.
    Absorbing,
}

/// A finite-volume scheme: U -> E_dt(U), written for one cell, one face and one corner.
/// `forecast` sees a cell and its neighbours, `reconstruct` these and their forecasts, `flux` the face states of two cells, `corner` those of the cells around a
/// corner, `update` a cell with what its faces and corners found. A Runge-Kutta method is a convex combination of such
/// maps ([`crate::time`]).
pub trait Scheme<const D: usize, R: Real>: Copy + Send + Sync {
    /// The unknowns of a cell.
    type State: Components<R>;
    /// The static data of a cell.
    type Ground: Components<R>;
    /// What acts on a cell from outside and may change between two steps: sources; `()` where there is none.
    type Forcing: Components<R>;
    /// What follows from a cell alone.
    type Primitives: Copy;
    /// What neighbours must know of a cell beside its state before any of them offers something; `()` where a scheme needs none.
    type Forecast: Components<R>;
    /// What a cell offers to its faces and remembers for its update.
    type FaceStates: Components<R>;
    /// What passes a face, seen from both sides.
    type Flux: Components<R>;
    /// What is found at a corner of cells; `()` where a scheme needs none.
    type Corner: Components<R>;

    /// Runs end when the state changes slowly enough: the largest change of a step is kept.
    const TRACKS_CHANGE: bool = false;
    /// A fixed step whose Courant number exceeds [`Scheme::max_courant`] is refused. The published schemes of Savage and Hutter's
    /// model take it, as their papers do.
    const REFUSES_LONG_STEPS: bool = false;

    /// What acts on a cell of which nothing else is said.
    fn usual_forcing(&self) -> Self::Forcing {
        Components::load(|_| R::zero())
    }
    /// The Runge-Kutta method that the scheme is stepped by.
    fn stages(&self) -> Stages;
    /// The largest Courant number dt * [`Scheme::rate`] at which the scheme is known to be stable.
    fn max_courant(&self) -> f64;
    /// The Courant number to take where nobody asks for another one.
    fn suggested_courant(&self) -> f64 {
        0.9 * self.max_courant()
    }

    /// Let `visitor` have the same scheme on another scalar: states, grounds and forcings of the same
    /// components in the same order.
    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output;

    /// What follows from a cell alone: the place for divisions and roots, which are computed ahead of what waits for them.
    fn primitives(&self, here: &Cell<Self::State, Self::Ground, Self::Forcing>) -> Self::Primitives;
    /// What neighbours must know of the cell in the middle of the stencil in a step of `dt`; it sees the next cells along each axis.
    fn forecast(
        &self,
        stencil: &impl Stencil<D, R, Self::State, Self::Ground, Self::Forcing>,
        dt: R,
    ) -> Self::Forecast;
    /// What the cell in the middle of the stencil offers to its faces and corners in a step of `dt`.
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Self::State, Self::Ground, Self::Forcing>,
        primitives: &Self::Primitives,
        forecasts: &Forecasts<D, Self::Forecast>,
        dt: R,
    ) -> Self::FaceStates;
    /// What passes the face between `left` and `right` along `axis`; `lambda` is dt/dx along it. Beside a block of cells it is asked
    /// about numbers that are of no cell, or were another scheme's; what comes of them is thrown away, so it must only not panic.
    fn flux(&self, axis: usize, left: &Self::FaceStates, right: &Self::FaceStates, lambda: R) -> Self::Flux;
    /// What is found at a corner: `around[y][x]` are the cells below and above it, left and right of it; in one dimension
    /// the corner is the face, and both rows are the same. Of numbers of no cell the same is true as for [`Scheme::flux`].
    fn corner(&self, around: [[&Self::FaceStates; 2]; 2]) -> Self::Corner;
    /// The state after `dt` of the cell in the middle of the stencil; `corners[y][x]` are the cell's lower and upper ones,
    /// left and right.
    fn update(
        &self,
        stencil: &impl Stencil<D, R, Self::State, Self::Ground, Self::Forcing>,
        face_states: &Self::FaceStates,
        faces: &[Faces<Self::Flux>; D],
        corners: &[[Self::Corner; 2]; 2],
        dt: R,
    ) -> Self::State;

    /// The mirror image of a state across a wall normal to `axis`.
    fn mirror(&self, axis: usize, state: &Self::State) -> Self::State;
    /// The mirror image of a ground across a wall normal to `axis`.
    fn mirror_ground(&self, axis: usize, ground: &Self::Ground) -> Self::Ground;
    /// The mirror image of a forcing across a wall normal to `axis`.
    fn mirror_forcing(&self, _axis: usize, forcing: &Self::Forcing) -> Self::Forcing {
        *forcing
    }
    /// sum over axes of (fastest signal)/dx: the Courant condition is dt times this <= courant; finite in every finite state, for
    /// a run ends where it is not. It must not depend on the forcing: a changed one is not asked for its rate before the next
    /// step. \[1/time\]
    fn rate(&self, here: &Cell<Self::State, Self::Ground, Self::Forcing>, spacing: &Spacing<D, R>) -> R;
    /// keep * old + (1 - keep) * new: how several stages are put together. A scheme that stops exactly must not undo a stop of `new`.
    #[inline(always)]
    fn rk_combine(&self, keep: R, old: &Self::State, new: &Self::State) -> Self::State {
        let give = R::splat(1.0) - keep;
        let (old, new) = (numbers(*old), numbers(*new));
        Components::load(
            #[inline(always)]
            |k| keep * old[k] + give * new[k],
        )
    }
    /// The cell rests by a proof of the scheme (or is dry): with neighbours at rest nothing will change here.
    fn is_static(&self, here: &Cell<Self::State, Self::Ground, Self::Forcing>) -> R::Mask;
    /// The cell is outside the data, and nothing is computed there.
    fn is_nodata(&self, ground: &Self::Ground) -> R::Mask;
    /// The outlet, of the five of the ledger, by which what passes from `here` to `there` leaves, `way` being the one on that side;
    /// none where it stays in the domain.
    fn outlet(&self, _here: &Self::Ground, there: &Self::Ground, _way: usize) -> Option<usize> {
        R::any(self.is_nodata(there)).then_some(4)
    }
    /// Volume per time and area that is poured on a cell.
    fn source_rate(&self, _forcing: &Self::Forcing) -> R {
        R::zero()
    }
    /// Volume per cell area that leaves the cell on `side` towards the other side in a step, dt/dx along the axis being `lambda`.
    fn outflow(&self, flux: &Self::Flux, side: Side, lambda: R) -> R;
    /// Pull of the mass if it were at rest, as a share of the static bound: up to 1 it stays; 0 where dry and where
    /// nothing holds.
    fn yield_ratio(&self, stencil: &impl Stencil<D, R, Self::State, Self::Ground, Self::Forcing>) -> R;
    /// What the run keeps watch of in a cell.
    fn diagnostics(&self, here: &Cell<Self::State, Self::Ground, Self::Forcing>) -> Diagnostics<R>;
}

/// Work that is done with a scheme.
pub trait SchemeVisitor<const D: usize, R: Real> {
    /// What it gives.
    type Output;
    /// Do it.
    fn visit<S: Scheme<D, R>>(self, scheme: &S) -> Self::Output;
}

/// What a run watches in every cell.
#[derive(Clone, Copy, Debug)]
pub struct Diagnostics<R> {
    /// Conserved volume per area.
    pub volume: R,
    /// Squared speed along the bed.
    pub speed_squared: R,
    /// Kinetic energy per density and area, volume * speed^2 / 2.
    pub energy: R,
    /// Thickness normal to the bed.
    pub thickness: R,
    /// 1 where the cell is a film (thinner than the scheme moves), else 0.
    pub film: R,
}
