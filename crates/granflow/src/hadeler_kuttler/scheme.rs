//! The well-balanced finite-volume scheme of first order, of second order, and the adaptive one between them.
//!
//! The transport flux v grad u is taken together with the source, -f = div B (Aggarwal, Veerappa Gowda & Sudarshan Kumar
//! 2023, eqs. 7, 42). B itself is an integral over the table; only its differences enter, so that the flux is written
//! here as H less the value of B at the face: sand poured within half a cell of a face passes it with the rest, and the
//! sum over a cell of what is left is its own source.

use super::{Ground, Pile};
use crate::limiter::minmod;
use crate::real::Real;
use crate::scheme::{Cell, Faces, Scheme, Side, Spacing, Watch, Window};

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

/// The scheme: what tells its variants apart are the slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HadelerKuttler {
    /// The slopes.
    pub slopes: Slopes,
}

/// First order (eqs. 8-10), to be stepped by [`crate::time::EULER`].
pub const FIRST_ORDER: HadelerKuttler = HadelerKuttler { slopes: Slopes::None };
/// Second order (eqs. 16-23), to be stepped by [`crate::time::SSP_RK2`]; not well-balanced in v.
pub const SECOND_ORDER: HadelerKuttler = HadelerKuttler { slopes: Slopes::Minmod };
/// Second order away from steady states, first order and well-balanced at them (eqs. 36-40), with exponent 2; to be
/// stepped by [`crate::time::SSP_RK2`].
pub const ADAPTIVE: HadelerKuttler = HadelerKuttler { slopes: Slopes::Adaptive { exponent: 2.0 } };

/// Two slopes that sum to less are level: their sign is rounding.
const LEVEL: f64 = 1e-12;

/// A value and its limited difference across the cell.
#[derive(Clone, Copy, Debug)]
struct Linear<R> {
    mid: R,
    across: R,
}

impl<R: Real> Linear<R> {
    #[inline(always)]
    fn flat(mid: R) -> Self {
        Linear { mid, across: R::zero() }
    }
    #[inline(always)]
    fn lo(&self) -> R {
        self.mid - self.across * R::of(0.5)
    }
    #[inline(always)]
    fn hi(&self) -> R {
        self.mid + self.across * R::of(0.5)
    }
}

/// What a cell offers to its faces and corners.
#[derive(Clone, Copy, Debug)]
pub struct Edges<const D: usize, R: Real> {
    /// Rolling layer, along each axis.
    v: [Linear<R>; D],
    /// Slope of the surface in the cell, along each axis.
    slope: [Linear<R>; D],
    /// Slope along the cell's lower edge of each axis, not yet adapted.
    edge: [Linear<R>; D],
    /// B at the face less B at the cell's end, (h f - difference of B)/2: what is poured on the half cell.
    poured: [R; D],
    /// Theta of the cell, 1 beside the table.
    theta: R,
    inside: R::Mask,
    /// The lower left node is free to rise.
    free: R::Mask,
    wall: [R::Mask; D],
}

impl HadelerKuttler {
    /// The cell at `offset` with constant values.
    #[inline(always)]
    fn constant<const D: usize, R: Real>(
        window: &impl Window<D, R, Pile<R>, Ground<D, R>>,
        offset: [isize; D],
    ) -> Edges<D, R> {
        let Cell { state, ground } = window.at(offset);
        let Spacing { size, per } = window.spacing();
        let surface = |step: [isize; D]| {
            let cell = window.at(std::array::from_fn(|k| offset[k] + step[k]));
            cell.state.u + cell.ground.bed
        };
        let half = R::of(0.5);
        let edge: [R; D] = std::array::from_fn(|k| (surface(unit(k)) - surface([0; D])) * per[k]);
        let slope = std::array::from_fn(|k| {
            if D == 1 {
                return Linear::flat(edge[k]);
            }
            let other = unit(1 - k);
            let far = (surface([1; D]) - surface(other)) * per[k];
            Linear::flat((edge[k] + far) * half)
        });
        Edges {
            v: [Linear::flat(state.v); D],
            slope,
            edge: edge.map(Linear::flat),
            poured: std::array::from_fn(|k| ground.source[k] * size[k] * half),
            theta: R::of(1.0),
            inside: R::zero().lt(ground.inside),
            free: R::zero().lt(ground.weight),
            wall: ground.wall.map(|wall| R::zero().lt(wall)),
        }
    }

    /// Limited differences of everything that varies (eqs. 16-18, 43), 0 beside the edge of the table.
    #[inline(never)]
    fn linear<const D: usize, R: Real>(
        window: &impl Window<D, R, Pile<R>, Ground<D, R>>,
        here: &Edges<D, R>,
    ) -> Edges<D, R> {
        let zero = R::zero();
        let inside = |offset: [isize; D]| zero.lt(window.at(offset).ground.inside);
        let mut edges = *here;
        for axis in 0..D {
            let step = unit::<D>(axis);
            let back = step.map(|k| -k);
            let (a, b) = (Self::constant(window, back), Self::constant(window, step));
            let across = |pick: fn(&Edges<D, R>, usize) -> R| {
                let mid = pick(here, axis);
                minmod(mid - pick(&a, axis), pick(&b, axis) - mid)
            };
            let smooth = a.inside & b.inside & here.inside;
            let within = |across: R| R::select(smooth, across, zero);
            edges.v[axis].across = within(across(|edges, k| edges.v[k].mid));
            edges.slope[axis].across = within(across(|edges, k| edges.slope[k].mid));
            // B rises by half of each cell's source between two centres.
            let (lo, mid, hi) = (a.poured[axis], here.poured[axis], b.poured[axis]);
            edges.poured[axis] = mid - within(minmod(lo + mid, mid + hi)) * R::of(0.5);
            // An edge belongs to the table if one of the two cells along it does.
            let mut exist = smooth;
            if D > 1 {
                let below = |along: isize| {
                    let mut offset = [0; D];
                    offset[axis] = along;
                    let cell = inside(offset);
                    offset[1 - axis] = -1;
                    cell | inside(offset)
                };
                exist = below(-1) & below(0) & below(1);
            }
            edges.edge[axis].across = R::select(exist, across(|edges, k| edges.edge[k].mid), zero);
        }
        edges
    }

    /// E of a cell (eq. 37): what the first-order scheme would change in it and at its corners,
    /// sum of |G| + h |v_t|, h the smallest cell size; in two dimensions half the sum, which is the line's where nothing
    /// varies across.
    #[inline(always)]
    fn residual<const D: usize, R: Real>(
        &self,
        window: &impl Window<D, R, Pile<R>, Ground<D, R>>,
        smallest: R,
    ) -> R {
        // around[y][x], from the neighbour with smaller coordinates; in one dimension the rows are the same.
        let around: [[Edges<D, R>; 3]; 3] = std::array::from_fn(|y| {
            std::array::from_fn(|x| {
                let at = [x as isize - 1, y as isize - 1];
                Self::constant(window, std::array::from_fn(|k| at[k]))
            })
        });
        let corner = |x: usize, y: usize| {
            corner([[&around[y][x], &around[y][x + 1]], [&around[y + 1][x], &around[y + 1][x + 1]]])
        };
        let corners: [[R; 2]; 2] = std::array::from_fn(|y| std::array::from_fn(|x| corner(x, y)));
        let faces: [Faces<R>; D] = std::array::from_fn(|axis| {
            let (lo, hi) =
                if axis == 0 { (&around[1][0], &around[1][2]) } else { (&around[0][1], &around[2][1]) };
            Faces { lo: flux(axis, lo, &around[1][1]), hi: flux(axis, &around[1][1], hi) }
        });
        let ground = window.at([0; D]).ground;
        let rate = rate_of_v(&ground, &faces, &corners, window.spacing());
        let [[a, b], [c, d]] = corners.map(|row| row.map(R::abs));
        let corners = if D > 1 { ((a + d) + (b + c)) * R::of(0.5) } else { a + b };
        corners + rate.abs() * smallest
    }

    /// Theta(E) = E^2/(E^2 + h^m) (eq. 36).
    #[inline(never)]
    fn theta<const D: usize, R: Real>(
        &self,
        exponent: f64,
        window: &impl Window<D, R, Pile<R>, Ground<D, R>>,
    ) -> R {
        let mut smallest = window.spacing().size[0];
        for axis in 1..D {
            smallest = smallest.min(window.spacing().size[axis]);
        }
        let residual = self.residual(window, smallest);
        let square = residual * residual;
        square / (square + smallest.powf(exponent))
    }
}

/// The offset of the next cell along `axis`.
#[inline(always)]
fn unit<const D: usize>(axis: usize) -> [isize; D] {
    std::array::from_fn(|k| isize::from(k == axis))
}

/// H of a face less the value of B there (eqs. 10, 45): what flows towards smaller coordinates.
#[inline(always)]
fn flux<const D: usize, R: Real>(axis: usize, left: &Edges<D, R>, right: &Edges<D, R>) -> R {
    let zero = R::zero();
    let (a, b) = (left.slope[axis].hi(), right.slope[axis].lo());
    let (v_a, v_b) = (left.v[axis].hi(), right.v[axis].lo());
    let (poured_a, poured_b) = (left.poured[axis], right.poured[axis]);
    let size = a.abs() + b.abs();
    let level = size.lt(R::of(LEVEL));
    let lean = R::select(level, zero, (a + b) / R::select(level, R::of(1.0), size));
    let poured = ((poured_b - poured_a) + lean * (poured_b + poured_a)) * R::of(0.5);
    let within = (b.positive() * v_b + a.min(zero) * v_a) + poured;
    // An open edge takes what comes and gives nothing; level ground leads over it.
    let over_left = b.positive() * v_b + R::select(b.lt(zero), zero, poured_b);
    let over_right = a.min(zero) * v_a - R::select(zero.lt(a), zero, poured_a);
    let over = R::select(left.inside, over_right, over_left);
    let passes = (left.inside | right.inside) & !right.wall[axis];
    R::select(left.inside & right.inside, within, R::select(passes, over, zero))
}

/// G at a node (eq. 9; in two dimensions the largest over the cells around it, which keeps v >= 0 and is eq. 9 where
/// nothing varies along one axis): what the standing layer loses, v (|grad u| - 1).
#[inline(always)]
fn corner<const D: usize, R: Real>(around: [[&Edges<D, R>; 2]; 2]) -> R {
    let (zero, one) = (R::zero(), R::of(1.0));
    let [[_, below_right], [above_left, above_right]] = around;
    let mut squares = [[zero; 2]; 2];
    for axis in 0..D {
        // The edges that end and that begin at the node, each with the smaller Theta of the cells along it.
        let (ends, begins) = (if axis == 0 { above_left } else { below_right }, above_right);
        let beside = |edge: &Edges<D, R>, other: &Edges<D, R>| {
            edge.edge[axis].across * edge.theta.min(other.theta) * R::of(0.5)
        };
        let [ends_beside, begins_beside] =
            if axis == 0 { [around[0][0], around[0][1]] } else { [around[0][0], around[1][0]] };
        let falls = (ends.edge[axis].mid + beside(ends, ends_beside)).positive();
        let rises = (-(begins.edge[axis].mid - beside(begins, begins_beside))).positive();
        squares[axis] = [falls * falls, rises * rises];
    }
    let mut most = R::of(f64::NEG_INFINITY);
    for (y, row) in around.iter().enumerate() {
        for (x, cell) in row.iter().enumerate() {
            let mut square = squares[0][x];
            let towards = |axis: usize, k: usize| {
                let across = cell.v[axis].across * R::of(0.5);
                if k == 0 { across } else { -across }
            };
            // The axes are added first: they may be swapped without changing a bit.
            let mut across = towards(0, x);
            if D > 1 {
                square = square + squares[1][y];
                across = across + towards(D - 1, y);
            }
            let v = cell.v[0].mid + across;
            let loss = v * (square.sqrt() - one);
            most = R::select(cell.inside, most.max(loss), most);
        }
    }
    R::select(above_right.free, most, zero)
}

/// v_t of a cell: sum over axes of (H_hi - H_lo)/h + f + S, S the mean of G at the cell's nodes (eqs. 8, 44).
#[inline(always)]
fn rate_of_v<const D: usize, R: Real>(
    ground: &Ground<D, R>,
    faces: &[Faces<R>; D],
    corners: &[[R; 2]; 2],
    spacing: &Spacing<D, R>,
) -> R {
    let (mut flow, mut poured) = (R::zero(), R::zero());
    for axis in 0..D {
        flow = flow + (faces[axis].hi - faces[axis].lo) * spacing.per[axis];
        poured = poured + ground.source[axis];
    }
    let [[a, b], [c, d]] = *corners;
    let mean = if D > 1 { ((a + d) + (b + c)) * R::of(0.25) } else { (a + b) * R::of(0.5) };
    R::select(R::zero().lt(ground.inside), flow + (poured + mean), R::zero())
}

impl<const D: usize, R: Real> Scheme<D, R> for HadelerKuttler {
    type State = Pile<R>;
    type Ground = Ground<D, R>;
    type Edges = Edges<D, R>;
    type Flux = R;
    type Corner = R;

    #[inline(always)]
    fn reconstruct(&self, window: &impl Window<D, R, Pile<R>, Ground<D, R>>) -> Edges<D, R> {
        let constant = Self::constant(window, [0; D]);
        let theta = match self.slopes {
            Slopes::None => return constant,
            Slopes::Minmod => R::of(1.0),
            Slopes::Adaptive { exponent } => self.theta(exponent, window),
        };
        let theta = R::select(constant.inside, theta, R::of(1.0));
        let mut edges = Self::linear(window, &constant);
        edges.theta = theta;
        for axis in 0..D {
            edges.v[axis].across = theta * edges.v[axis].across;
            edges.slope[axis].across = theta * edges.slope[axis].across;
            let whole = constant.poured[axis];
            edges.poured[axis] = whole - theta * (whole - edges.poured[axis]);
        }
        edges
    }
    #[inline(always)]
    fn flux(&self, axis: usize, left: &Edges<D, R>, right: &Edges<D, R>) -> R {
        flux(axis, left, right)
    }
    #[inline(always)]
    fn corner(&self, around: [[&Edges<D, R>; 2]; 2]) -> R {
        corner(around)
    }
    #[inline(always)]
    fn update(
        &self,
        here: &Cell<Pile<R>, Ground<D, R>>,
        _edges: &Edges<D, R>,
        faces: &[Faces<R>; D],
        corners: &[[R; 2]; 2],
        spacing: &Spacing<D, R>,
        dt: R,
    ) -> Pile<R> {
        Pile {
            u: here.state.u - dt * corners[0][0],
            v: here.state.v + dt * rate_of_v(&here.ground, faces, corners, spacing),
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
    fn rate(&self, here: &Cell<Pile<R>, Ground<D, R>>, spacing: &Spacing<D, R>) -> R {
        let fastest = R::of(1.0).max(here.state.v);
        let mut sum = R::of(1.0);
        for axis in 0..D {
            sum = sum + fastest * spacing.per[axis];
        }
        sum
    }
    fn most_courant(&self) -> f64 {
        if self.slopes == Slopes::None { 1.0 } else { 0.5 }
    }
    #[inline(always)]
    fn average(&self, keep: R, old: &Pile<R>, new: &Pile<R>) -> Pile<R> {
        let give = R::of(1.0) - keep;
        Pile { u: keep * old.u + give * new.u, v: keep * old.v + give * new.v }
    }
    /// No sand rolls here and none is poured.
    #[inline(always)]
    fn rests(&self, edges: &Edges<D, R>) -> R::Mask {
        let mut sum = edges.v[0].mid.abs();
        for axis in 0..D {
            sum = sum + edges.poured[axis].abs();
        }
        sum.same(R::zero())
    }
    #[inline(always)]
    fn outside(&self, ground: &Ground<D, R>) -> R::Mask {
        (ground.inside + ground.weight).same(R::zero())
    }
    #[inline(always)]
    fn exit(&self, here: &Ground<D, R>, there: &Ground<D, R>, way: usize) -> Option<usize> {
        let zero = R::zero();
        let leaves = zero.lt(here.inside) & !zero.lt(there.inside);
        let way = if R::any(zero.lt(there.hole)) { 4 } else { way };
        R::any(leaves).then_some(way)
    }
    #[inline(always)]
    fn supply(&self, ground: &Ground<D, R>) -> R {
        let mut sum = R::zero();
        for axis in 0..D {
            sum = sum + ground.source[axis];
        }
        sum
    }
    #[inline(always)]
    fn booked(&self, flux: &R, _side: Side) -> R {
        -*flux
    }
    /// |grad(u + b)| in the cell: 1 is the steepest slope.
    fn margin(&self, window: &impl Window<D, R, Pile<R>, Ground<D, R>>) -> R {
        let edges = Self::constant(window, [0; D]);
        let mut square = R::zero();
        for axis in 0..D {
            square = square + edges.slope[axis].mid * edges.slope[axis].mid;
        }
        R::select(edges.inside, square.sqrt(), R::zero())
    }
    /// Thickness of the pile; in place of a speed the rolling layer, which is what moves.
    #[inline(always)]
    fn watch(&self, here: &Cell<Pile<R>, Ground<D, R>>) -> Watch<R> {
        let Cell { state, ground } = here;
        Watch {
            volume: ground.weight * state.u + state.v,
            speed: state.v,
            energy: R::zero(),
            thickness: state.u,
            film: R::zero(),
        }
    }
}
