//! The well-balanced finite-volume scheme of first order, of second order, and the adaptive one between them.
//!
//! The transport flux v grad u is taken together with the source, -f = div B (Aggarwal, Veerappa Gowda & Sudarshan Kumar
//! 2023, eqs. 7, 42). B itself is an integral over the table; only its differences enter, so that the flux is written
//! here as H less the value of B at the face: sand poured within half a cell of a face passes it with the rest, and the
//! sum over a cell of what is left is its own source.

use super::{Ground, Pile, Source};
use crate::limiter::{Limited, minmod};
use crate::real::{Real, for_axis, per_axis, power};
use crate::scheme::{
    Cell, Components, Diagnostics, Faces, Scheme, SchemeVisitor, Side, Spacing, Stencil, components,
};
use crate::time::{EULER, SSP_RK2, Stages};

/// How a cell's values vary across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slopes {
    /// Not at all: first order.
    None,
    /// By the smaller of the two differences, minmod (eqs. 16-18, theta = 1/2): second order.
    Minmod,
    /// By Theta(E) times that, Theta = E^2/(E^2 + h^exponent) (eqs. 36-39), E the first-order residual of the cell: 0 at a
    /// steady state.
    Adaptive {
        /// m of h^m.
        exponent: f64,
    },
}

/// The scheme: what tells its variants apart are the slopes. Where it is known that there are none, `LIMITED` is false.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HadelerKuttler<const LIMITED: bool = true> {
    /// The slopes.
    pub slopes: Slopes,
}

/// First order (eqs. 8-10).
pub const FIRST_ORDER: HadelerKuttler = HadelerKuttler { slopes: Slopes::None };
/// Second order (eqs. 16-23); not well-balanced in v.
pub const SECOND_ORDER: HadelerKuttler = HadelerKuttler { slopes: Slopes::Minmod };
/// Second order away from steady states, first order and well-balanced at them (eqs. 36-40), with exponent 2.
pub const ADAPTIVE: HadelerKuttler = HadelerKuttler { slopes: Slopes::Adaptive { exponent: 2.0 } };

/// Cells along each axis at a corner.
const TWO: usize = 2;

/// Two slopes that sum to less are level: their sign is rounding.
const LEVEL: f64 = 1e-12;

/// How the values of a cell vary across it.
pub trait CellSlopes<const D: usize, R: Real>: Components<R> {
    /// Not at all.
    fn none() -> Self;
    /// By limited differences, where it can.
    fn by(halves: Halves<D, R>) -> Self;
    /// By what, if it does.
    fn halves(&self) -> Option<&Halves<D, R>>;
}

impl<const D: usize, R: Real> CellSlopes<D, R> for () {
    #[inline(always)]
    fn none() {}
    #[inline(always)]
    fn by(_: Halves<D, R>) {}
    #[inline(always)]
    fn halves(&self) -> Option<&Halves<D, R>> {
        None
    }
}

/// Half the limited differences across a cell: what a value rises from its middle to its upper end, along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Halves<const D: usize, R> {
    v: [R; D],
    slope: [R; D],
    /// Not yet adapted.
    edge: [R; D],
    /// Theta of the cell, 1 beside the table.
    theta: R,
}
components!([const D: usize, R: Real] Halves<D, R> { v: [R; D], slope: [R; D], edge: [R; D], theta: R });

impl<const D: usize, R: Real> CellSlopes<D, R> for Halves<D, R> {
    #[inline(always)]
    fn none() -> Self {
        let none = [R::zero(); D];
        Halves { v: none, slope: none, edge: none, theta: R::splat(1.0) }
    }
    #[inline(always)]
    fn by(halves: Halves<D, R>) -> Self {
        halves
    }
    #[inline(always)]
    fn halves(&self) -> Option<&Halves<D, R>> {
        Some(self)
    }
}

/// How values vary across the cells of a scheme.
pub trait SlopeStorage: Copy + Send + Sync + 'static {
    /// In a cell.
    type CellSlopes<const D: usize, R: Real>: CellSlopes<D, R>;
}
impl SlopeStorage for Limited<false> {
    type CellSlopes<const D: usize, R: Real> = ();
}
impl SlopeStorage for Limited<true> {
    type CellSlopes<const D: usize, R: Real> = Halves<D, R>;
}

/// Where a cell and its lower left node lie. A number, so that a few can be asked at once: 0 is on the table, the node free
/// to rise.
#[derive(Clone, Copy, Debug)]
struct CellClass<R> {
    code: R,
}

components!([R: Real] CellClass<R> { code: R });

impl<R: Real> CellClass<R> {
    #[inline(always)]
    fn new(code: R) -> Self {
        CellClass { code }
    }
    const PINNED: f64 = 1.0;
    const OUTSIDE: f64 = 2.0;

    #[inline(always)]
    fn of<const D: usize>(ground: &Ground<D, R>) -> Self {
        let zero = R::zero();
        let outside = R::select(zero.lt(ground.inside), zero, R::splat(Self::OUTSIDE));
        CellClass::new(outside + R::select(zero.lt(ground.weight), zero, R::splat(Self::PINNED)))
    }
    #[inline(always)]
    fn inside(self) -> R::Mask {
        self.code.lt(R::splat(Self::OUTSIDE))
    }
    /// The lower left node is free to rise.
    #[inline(always)]
    fn free(self) -> R::Mask {
        self.code.equals(R::zero()) | self.code.equals(R::splat(Self::OUTSIDE))
    }
}

/// What a cell offers to its faces and corners.
#[derive(Clone, Copy, Debug)]
pub struct FaceStates<const D: usize, R: Real, S = Halves<D, R>> {
    /// Rolling layer.
    v: R,
    /// Slope of the surface in the cell, along each axis.
    slope: [R; D],
    /// Slope along the cell's lower edge of each axis.
    edge: [R; D],
    /// B at the face less B at the cell's end, (h f - difference of B)/2: what is poured on the half cell.
    poured: [R; D],
    /// 1 where the face at the lower end of an axis is a wall.
    wall: [R; D],
    place: CellClass<R>,
    slopes: S,
}
components!([const D: usize, R: Real, S: CellSlopes<D, R>] FaceStates<D, R, S> {
    v: R, slope: [R; D], edge: [R; D], poured: [R; D], wall: [R; D], place: CellClass<R>, slopes: S
});

/// The two ends of a cell along an axis.
#[derive(Clone, Copy)]
enum End {
    Lo,
    Hi,
}

/// A value at one end, which rises by `half` from the middle to the upper one.
#[inline(always)]
fn at_end<R: Real>(end: End, mid: R, half: R) -> R {
    match end {
        End::Lo => mid - half,
        End::Hi => mid + half,
    }
}

impl<const D: usize, R: Real, S: CellSlopes<D, R>> FaceStates<D, R, S> {
    #[inline(always)]
    fn v_at(&self, axis: usize, end: End) -> R {
        self.slopes.halves().map_or(self.v, |halves| at_end(end, self.v, halves.v[axis]))
    }
    #[inline(always)]
    fn slope_at(&self, axis: usize, end: End) -> R {
        let mid = self.slope[axis];
        self.slopes.halves().map_or(mid, |halves| at_end(end, mid, halves.slope[axis]))
    }
    /// Along the lower edge, by the smaller Theta of the two cells along it.
    #[inline(always)]
    fn edge_at(&self, axis: usize, end: End, beside: &Self) -> R {
        let mid = self.edge[axis];
        match (self.slopes.halves(), beside.slopes.halves()) {
            (Some(here), Some(there)) => at_end(end, mid, here.edge[axis] * here.theta.min(there.theta)),
            _ => mid,
        }
    }
    /// Rolling layer at a corner, by its end of each axis.
    #[inline(always)]
    fn v_at_corner(&self, ends: [End; TWO]) -> R {
        let Some(Halves { v, .. }) = self.slopes.halves() else { return self.v };
        // The axes are added first: they may be swapped without changing a bit.
        let mut across = at_end(ends[0], R::zero(), v[0]);
        if D > 1 {
            across = across + at_end(ends[1], R::zero(), v[D - 1]);
        }
        self.v + across
    }
}

/// Height of the surface at the lower left node of the cell at `offset`.
#[inline(always)]
fn surface<const D: usize, R: Real>(
    stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    offset: [isize; D],
) -> R {
    let cell = stencil.at(offset);
    cell.state.u + cell.ground.bed
}

/// The cell at `offset` with constant values.
#[inline(always)]
fn constant<const D: usize, R: Real, S: CellSlopes<D, R>>(
    stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    offset: [isize; D],
) -> FaceStates<D, R, S> {
    let Cell { state, ground, forcing } = stencil.at(offset);
    let Spacing { size, inv: per, .. } = stencil.spacing();
    let half = R::splat(0.5);
    let (mut edge, mut slope) = ([R::zero(); D], [R::zero(); D]);
    let here = surface(stencil, offset);
    for_axis!(k in D => {
        edge[k] = (surface(stencil, sum(offset, unit(k))) - here) * per[k];
        slope[k] = edge[k];
        if D > 1 {
            let far = surface(stencil, sum(offset, [1; D])) - surface(stencil, sum(offset, unit(1 - k)));
            slope[k] = (edge[k] + far * per[k]) * half;
        }
    });
    FaceStates {
        v: state.v,
        slope,
        edge,
        poured: per_axis!(k => forcing.split[k] * size[k] * half),
        wall: ground.wall,
        place: CellClass::of(&ground),
        slopes: S::none(),
    }
}

/// The limited difference over three cells, of which all must be on the table.
#[inline(always)]
fn limited<R: Real>(smooth: R::Mask, lo: R, mid: R, hi: R) -> R {
    R::select(smooth, minmod(mid - lo, hi - mid), R::zero())
}

/// Does one of the two cells along the lower edge of the cell at `along` the axis belong to the table?
#[inline(always)]
fn has_edge<const D: usize, R: Real>(
    stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    axis: usize,
    along: isize,
) -> R::Mask {
    let mut offset = [0; D];
    offset[axis] = along;
    let cell = R::zero().lt(stencil.at(offset).ground.inside);
    offset[1 - axis] = -1;
    cell | R::zero().lt(stencil.at(offset).ground.inside)
}

/// Limited differences of everything that varies (eqs. 16-18, 43), 0 beside the edge of the table.
#[inline(always)]
fn linear<const D: usize, R: Real, S: CellSlopes<D, R>>(
    stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    here: &FaceStates<D, R, S>,
    theta: R,
) -> FaceStates<D, R, S> {
    let half = R::splat(0.5);
    let mut edges = *here;
    let none = [R::zero(); D];
    let mut halves = Halves { v: none, slope: none, edge: none, theta };
    for_axis!(axis in D => {
        let step = unit::<D>(axis);
        let a: FaceStates<D, R, ()> = constant(stencil, per_axis!(k => -step[k]));
        let b: FaceStates<D, R, ()> = constant(stencil, step);
        let smooth = a.place.inside() & b.place.inside() & here.place.inside();
        halves.v[axis] = theta * limited(smooth, a.v, here.v, b.v) * half;
        halves.slope[axis] = theta * limited(smooth, a.slope[axis], here.slope[axis], b.slope[axis]) * half;
        // B rises by half of each cell's source between two centres.
        let (lo, mid, hi) = (a.poured[axis], here.poured[axis], b.poured[axis]);
        let rise = R::select(smooth, minmod(lo + mid, mid + hi), R::zero());
        edges.poured[axis] = mid - theta * (mid - (mid - rise * half));
        // An edge belongs to the table if one of the two cells along it does.
        let mut exist = smooth;
        if D > 1 {
            exist = has_edge(stencil, axis, -1) & has_edge(stencil, axis, 0) & has_edge(stencil, axis, 1);
        }
        halves.edge[axis] = limited(exist, a.edge[axis], here.edge[axis], b.edge[axis]) * half;
    });
    edges.slopes = S::by(halves);
    edges
}

impl<const LIMITED: bool> HadelerKuttler<LIMITED> {
    /// E of a cell (eq. 37): what the first-order scheme would change in it and at its corners,
    /// sum of |G| + h |v_t|, h the smallest cell size; in two dimensions half the sum, which is the line's where nothing
    /// varies across.
    #[inline(always)]
    fn residual<const D: usize, R: Real>(
        &self,
        stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
        smallest: R,
    ) -> R {
        // around[y][x], from the neighbour with smaller coordinates; in one dimension the rows are the same.
        let around: [[FaceStates<D, R, ()>; 3]; 3] = per_axis!(y => {
            per_axis!(x => {
                let at = [x as isize - 1, y as isize - 1];
                constant(stencil, per_axis!(k => at[k]))
            })
        });
        let corners: [[R; 2]; 2] = per_axis!(y => per_axis!(x => {
            corner([[&around[y][x], &around[y][x + 1]], [&around[y + 1][x], &around[y + 1][x + 1]]])
        }));
        let faces: [Faces<R>; D] = per_axis!(axis => {
            let (lo, hi) =
                if axis == 0 { (&around[1][0], &around[1][2]) } else { (&around[0][1], &around[2][1]) };
            Faces { lo: flux(axis, lo, &around[1][1]), hi: flux(axis, &around[1][1], hi) }
        });
        let Cell { ground, forcing, .. } = stencil.at([0; D]);
        let rate = rate_of_v(&ground, &forcing, &faces, &corners, stencil.spacing());
        let [[a, b], [c, d]]: [[R; 2]; 2] = per_axis!(y => per_axis!(x => corners[y][x].abs()));
        let corners = if D > 1 { ((a + d) + (b + c)) * R::splat(0.5) } else { a + b };
        corners + rate.abs() * smallest
    }

    /// Theta(E) = E^2/(E^2 + h^m) (eq. 36).
    #[inline(always)]
    fn theta<const D: usize, R: Real>(
        &self,
        exponent: f64,
        stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
    ) -> R {
        let smallest = stencil.spacing().smallest;
        let residual = self.residual(stencil, R::splat(smallest));
        let square = residual * residual;
        square / (square + R::splat(power(smallest, exponent)))
    }
}

/// The offset of the next cell along `axis`.
#[inline(always)]
fn unit<const D: usize>(axis: usize) -> [isize; D] {
    per_axis!(k => isize::from(k == axis))
}

#[inline(always)]
fn sum<const D: usize>(a: [isize; D], b: [isize; D]) -> [isize; D] {
    per_axis!(k => a[k] + b[k])
}

/// H of a face less the value of B there (eqs. 10, 45): what flows towards smaller coordinates.
#[inline(always)]
fn flux<const D: usize, R: Real, S: CellSlopes<D, R>>(
    axis: usize,
    left: &FaceStates<D, R, S>,
    right: &FaceStates<D, R, S>,
) -> R {
    let (zero, one) = (R::zero(), R::splat(1.0));
    let (a, b) = (left.slope_at(axis, End::Hi), right.slope_at(axis, End::Lo));
    let (v_a, v_b) = (left.v_at(axis, End::Hi), right.v_at(axis, End::Lo));
    let (poured_a, poured_b) = (left.poured[axis], right.poured[axis]);
    // (a + b)/(|a| + |b|): a sign, where the two slopes do not point against each other.
    let (sum, size) = (a + b, a.abs() + b.abs());
    let mut lean = R::select(sum.lt(zero), -one, one);
    let against = (a * b).lt(zero);
    if R::any(against) {
        lean = R::select(against, sum / R::select(against, size, one), lean);
    }
    lean = R::select(size.lt(R::splat(LEVEL)), zero, lean);
    let poured = ((poured_b - poured_a) + lean * (poured_b + poured_a)) * R::splat(0.5);
    let within = (b.positive_part() * v_b + a.min(zero) * v_a) + poured;
    let rim = (left.place.code + right.place.code) + right.wall[axis];
    if !R::any(!rim.equals(zero)) {
        return within;
    }
    // An open edge takes what comes and gives nothing; level ground leads over it.
    let over_left = b.positive_part() * v_b + R::select(b.lt(zero), zero, poured_b);
    let over_right = a.min(zero) * v_a - R::select(zero.lt(a), zero, poured_a);
    let (in_left, in_right) = (left.place.inside(), right.place.inside());
    let over = R::select(in_left, over_right, over_left);
    let passes = (in_left | in_right) & !zero.lt(right.wall[axis]);
    R::select(in_left & in_right, within, R::select(passes, over, zero))
}

/// sqrt(x^2 + y^2) of two numbers >= 0; where one of them is 0 it is the other, without a root.
#[inline(always)]
fn length<R: Real>(x: R, y: R) -> R {
    let both = R::zero().lt(x) & R::zero().lt(y);
    let sum = x + y;
    if R::any(both) { R::select(both, (x * x + y * y).sqrt(), sum) } else { sum }
}

/// G at a node (eq. 9; in two dimensions the largest over the cells around it, which keeps v >= 0 and is eq. 9 where
/// nothing varies along one axis): what the standing layer loses, v (|grad u| - 1).
#[inline(always)]
fn corner<const D: usize, R: Real, S: CellSlopes<D, R>>(around: [[&FaceStates<D, R, S>; 2]; 2]) -> R {
    let (zero, one) = (R::zero(), R::splat(1.0));
    let [[_, below_right], [above_left, above_right]] = around;
    let mut steep = [[zero; 2]; 2];
    for_axis!(axis in D => {
        // The edges that end and that begin at the node, each with the cells along it.
        let (ends, begins) = (if axis == 0 { above_left } else { below_right }, above_right);
        let [ends_beside, begins_beside] =
            if axis == 0 { [around[0][0], around[0][1]] } else { [around[0][0], around[1][0]] };
        let over = ends.edge_at(axis, End::Hi, ends_beside);
        let under = begins.edge_at(axis, End::Lo, begins_beside);
        steep[axis] = [over.positive_part(), (-under).positive_part()];
    });
    let mut rim = above_right.place.code;
    for_axis!(x in TWO => {
        rim = rim + (around[0][x].place.code + around[1][x].place.code);
    });
    let plain = !R::any(!rim.equals(zero));
    let mut most = R::splat(f64::NEG_INFINITY);
    for_axis!(y in TWO => {
        for_axis!(x in TWO => {
            let cell = around[y][x];
            let slope = if D > 1 { length(steep[0][x], steep[1][y]) } else { steep[0][x] };
            let end = |place: usize| if place == 0 { End::Hi } else { End::Lo };
            let loss = cell.v_at_corner([end(x), end(y)]) * (slope - one);
            let larger = most.max(loss);
            most = if plain { larger } else { R::select(cell.place.inside(), larger, most) };
        });
    });
    if plain { most } else { R::select(above_right.place.free(), most, zero) }
}

/// v_t of a cell: sum over axes of (H_hi - H_lo)/h + f + S, S the mean of G at the cell's nodes (eqs. 8, 44).
#[inline(always)]
fn rate_of_v<const D: usize, R: Real>(
    ground: &Ground<D, R>,
    source: &Source<D, R>,
    faces: &[Faces<R>; D],
    corners: &[[R; 2]; 2],
    spacing: &Spacing<D, R>,
) -> R {
    let (mut flow, poured) = (R::zero(), source.rate());
    for_axis!(axis in D => {
        flow = flow + (faces[axis].hi - faces[axis].lo) * spacing.inv[axis];
    });
    let [[a, b], [c, d]] = *corners;
    let mean = if D > 1 { ((a + d) + (b + c)) * R::splat(0.25) } else { (a + b) * R::splat(0.5) };
    R::select(R::zero().lt(ground.inside), flow + (poured + mean), R::zero())
}

impl<const D: usize, R: Real, const LIMITED: bool> Scheme<D, R> for HadelerKuttler<LIMITED>
where
    Limited<LIMITED>: SlopeStorage,
{
    type State = Pile<R>;
    type Ground = Ground<D, R>;
    type Forcing = Source<D, R>;
    type Primitives = ();
    type FaceStates = FaceStates<D, R, <Limited<LIMITED> as SlopeStorage>::CellSlopes<D, R>>;
    type Flux = R;
    type Corner = R;
    const TRACKS_CHANGE: bool = true;
    const REFUSES_LONG_STEPS: bool = true;

    /// Euler's method without slopes, else [`SSP_RK2`] (eqs. 8, 21-23).
    fn stages(&self) -> Stages {
        if self.slopes == Slopes::None { EULER } else { SSP_RK2 }
    }
    /// 1 without slopes, else 1/2 (eqs. 26, 27).
    fn max_courant(&self) -> f64 {
        if self.slopes == Slopes::None { 1.0 } else { 0.5 }
    }
    /// Half of what is usual elsewhere, as in the paper.
    fn suggested_courant(&self) -> f64 {
        0.45 * Scheme::<D, R>::max_courant(self)
    }

    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output {
        match self.slopes {
            Slopes::None => visitor.visit(&HadelerKuttler::<false> { slopes: Slopes::None }),
            slopes => visitor.visit(&HadelerKuttler::<true> { slopes }),
        }
    }
    #[inline(always)]
    fn primitives(&self, _here: &Cell<Pile<R>, Ground<D, R>, Source<D, R>>) {}
    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
        _: &(),
    ) -> Self::FaceStates {
        let constant: Self::FaceStates = constant(stencil, [0; D]);
        let theta = match self.slopes {
            Slopes::None => return constant,
            Slopes::Minmod => R::splat(1.0),
            Slopes::Adaptive { exponent } => self.theta(exponent, stencil),
        };
        linear(stencil, &constant, R::select(constant.place.inside(), theta, R::splat(1.0)))
    }
    #[inline(always)]
    fn flux(&self, axis: usize, left: &Self::FaceStates, right: &Self::FaceStates) -> R {
        flux(axis, left, right)
    }
    #[inline(always)]
    fn corner(&self, around: [[&Self::FaceStates; 2]; 2]) -> R {
        corner(around)
    }
    #[inline(always)]
    fn update(
        &self,
        stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
        _edges: &Self::FaceStates,
        faces: &[Faces<R>; D],
        corners: &[[R; 2]; 2],
        dt: R,
    ) -> Pile<R> {
        let here = stencil.at([0; D]);
        Pile {
            u: here.state.u - dt * corners[0][0],
            v: here.state.v + dt * rate_of_v(&here.ground, &here.forcing, faces, corners, stencil.spacing()),
        }
    }

    /// No boundary of the grid is a wall: walls are edges of the table.
    fn mirror(&self, _axis: usize, state: &Pile<R>) -> Pile<R> {
        *state
    }
    fn mirror_ground(&self, _axis: usize, ground: &Ground<D, R>) -> Ground<D, R> {
        *ground
    }
    /// sum over axes of max(1, v)/h, + 1: the bound of eqs. 26, 27 with slopes up to 1 is dt times this <= 1, or 1/2 with
    /// slopes.
    #[inline(always)]
    fn rate(&self, here: &Cell<Pile<R>, Ground<D, R>, Source<D, R>>, spacing: &Spacing<D, R>) -> R {
        let fastest = R::splat(1.0).max(here.state.v);
        let mut sum = R::splat(1.0);
        for_axis!(axis in D => {
            sum = sum + fastest * spacing.inv[axis];
        });
        sum
    }
    #[inline(always)]
    fn rk_combine(&self, keep: R, old: &Pile<R>, new: &Pile<R>) -> Pile<R> {
        let give = R::splat(1.0) - keep;
        Pile { u: keep * old.u + give * new.u, v: keep * old.v + give * new.v }
    }
    /// No sand rolls here and none is poured.
    #[inline(always)]
    fn is_static(&self, here: &Cell<Pile<R>, Ground<D, R>, Source<D, R>>) -> R::Mask {
        let mut sum = here.state.v.abs();
        for_axis!(axis in D => {
            sum = sum + here.forcing.split[axis].abs();
        });
        sum.equals(R::zero())
    }
    #[inline(always)]
    fn is_nodata(&self, ground: &Ground<D, R>) -> R::Mask {
        (ground.inside + ground.weight).equals(R::zero())
    }
    #[inline(always)]
    fn outlet(&self, here: &Ground<D, R>, there: &Ground<D, R>, way: usize) -> Option<usize> {
        let zero = R::zero();
        let leaves = zero.lt(here.inside) & !zero.lt(there.inside);
        let way = if R::any(zero.lt(there.hole)) { 4 } else { way };
        R::any(leaves).then_some(way)
    }
    #[inline(always)]
    fn source_rate(&self, source: &Source<D, R>) -> R {
        source.rate()
    }
    #[inline(always)]
    fn outflow(&self, flux: &R, _side: Side) -> R {
        -*flux
    }
    /// |grad(u + b)| in the cell: 1 is the steepest slope.
    fn yield_ratio(&self, stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>) -> R {
        let edges: FaceStates<D, R, ()> = constant(stencil, [0; D]);
        let mut square = R::zero();
        for_axis!(axis in D => {
            square = square + edges.slope[axis] * edges.slope[axis];
        });
        R::select(edges.place.inside(), square.sqrt(), R::zero())
    }
    /// Thickness of the pile; in place of a speed the rolling layer, which is what moves.
    #[inline(always)]
    fn diagnostics(&self, here: &Cell<Pile<R>, Ground<D, R>, Source<D, R>>) -> Diagnostics<R> {
        let Cell { state, ground, .. } = here;
        Diagnostics {
            volume: ground.weight * state.u + state.v,
            speed_squared: state.v * state.v,
            energy: R::zero(),
            thickness: state.u,
            film: R::zero(),
        }
    }
}
