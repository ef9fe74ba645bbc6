//! A scheme is three pointwise functions; arrays, axes, threads and files live elsewhere.

use crate::real::Real;

/// A value of a cell that is stored as a few numbers, one array each (struct of arrays).
///
/// # Safety
/// `gather` asks for, and `scatter` hands out, only parts below `COUNT`: the inner loop reads them unchecked.
pub unsafe trait Parts<R: Real>: Copy + Send + Sync + 'static {
    /// How many numbers.
    const COUNT: usize;
    /// Gather the value from its numbers.
    fn gather(part: impl Fn(usize) -> R) -> Self;
    /// Hand the numbers out.
    fn scatter(self, put: impl FnMut(usize, R));
}

/// A cell's state and what is fixed there.
#[derive(Clone, Copy, Debug)]
pub struct Cell<S, G> {
    /// The unknowns.
    pub state: S,
    /// What does not change in time: slope, bed, coefficients.
    pub ground: G,
}

/// The distance of cell centres along each axis, and its reciprocal.
#[derive(Clone, Copy, Debug)]
pub struct Spacing<const D: usize, R> {
    /// dx, dy in the units of the case.
    pub size: [R; D],
    /// 1/dx, 1/dy.
    pub per: [R; D],
}

impl<const D: usize, R: Real> Spacing<D, R> {
    /// From the cell sizes.
    pub fn new(size: [f64; D]) -> Self {
        Spacing { size: size.map(R::of), per: size.map(|s| R::of(1.0 / s)) }
    }
}

/// A cell and its neighbours along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Near<const D: usize, R, S, G> {
    /// The cell itself.
    pub here: Cell<S, G>,
    /// The neighbour towards smaller coordinates, per axis.
    pub lo: [Cell<S, G>; D],
    /// The neighbour towards larger coordinates, per axis.
    pub hi: [Cell<S, G>; D],
    /// Cell sizes.
    pub spacing: Spacing<D, R>,
}

/// What passes a cell's two faces of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Faces<F> {
    /// Through the face towards smaller coordinates.
    pub lo: F,
    /// Through the face towards larger coordinates.
    pub hi: F,
}

/// The side of a face on which a cell lies.
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
    /// Nothing lies beyond: what leaves is booked and gone, nothing comes back. The edge of a raster.
    Nothing,
}

/// A finite-volume scheme: U -> E_dt(U), written for one cell and one face.
/// `reconstruct` sees a cell and its cross of neighbours, `flux` the edges of two cells, `update` a cell with
/// what passes its faces. A Runge-Kutta method is a convex combination of such maps ([`crate::time`]).
pub trait Scheme<const D: usize, R: Real>: Send + Sync {
    /// The unknowns of a cell.
    type State: Parts<R>;
    /// The static data of a cell.
    type Ground: Parts<R>;
    /// What a cell offers to its faces and remembers for its update.
    type Edges: Copy + Send + Sync;
    /// What passes a face, seen from both sides.
    type Flux: Copy + Send + Sync;

    /// What cell `near.here` offers to its faces.
    fn reconstruct(&self, near: &Near<D, R, Self::State, Self::Ground>) -> Self::Edges;
    /// What passes the face between `left` and `right` along `axis`.
    fn flux(&self, axis: usize, left: &Self::Edges, right: &Self::Edges) -> Self::Flux;
    /// The state after `dt`.
    fn update(
        &self,
        here: &Cell<Self::State, Self::Ground>,
        edges: &Self::Edges,
        faces: &[Faces<Self::Flux>; D],
        spacing: &Spacing<D, R>,
        dt: R,
    ) -> Self::State;

    /// The mirror image of a state across a wall normal to `axis`.
    fn mirror(&self, axis: usize, state: &Self::State) -> Self::State;
    /// The mirror image of a ground across a wall normal to `axis`.
    fn mirror_ground(&self, axis: usize, ground: &Self::Ground) -> Self::Ground;
    /// sum over axes of (fastest signal)/dx: the Courant condition is dt times this <= courant. \[1/time\]
    fn rate(&self, here: &Cell<Self::State, Self::Ground>, spacing: &Spacing<D, R>) -> R;
    /// keep * old + (1 - keep) * new, without undoing an exact stop of `new`.
    fn average(&self, keep: R, old: &Self::State, new: &Self::State) -> Self::State;
    /// The cell rests by a proof of the scheme (or is dry): with neighbours at rest nothing will change here.
    fn rests(&self, edges: &Self::Edges) -> R::Mask;
    /// The cell lies outside the data: what enters it has left.
    fn outside(&self, ground: &Self::Ground) -> R::Mask;
    /// Volume per time and face length that the cell on `side` books as leaving it to the other side.
    fn booked(&self, flux: &Self::Flux, side: Side) -> R;
    /// Pull of the mass if it were at rest, as a share of the static bound: up to 1 it stays; 0 where dry and where
    /// nothing holds.
    fn margin(&self, near: &Near<D, R, Self::State, Self::Ground>) -> R;
    /// What the run keeps watch of in a cell.
    fn watch(&self, here: &Cell<Self::State, Self::Ground>) -> Watch<R>;
}

/// What a run watches in every cell.
#[derive(Clone, Copy, Debug)]
pub struct Watch<R> {
    /// Conserved volume per area.
    pub volume: R,
    /// Speed along the bed.
    pub speed: R,
    /// Kinetic energy per density and area, volume * speed^2 / 2.
    pub energy: R,
    /// Thickness normal to the bed.
    pub thickness: R,
    /// 1 where the cell is a film (thinner than the scheme moves), else 0.
    pub film: R,
}
