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
pub struct Edges<const D: usize, R> {
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
    ) -> Edges<D, R>
    where
        R: Real,
    {
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
    #[inline(always)]
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
    /// sum of |G| + h |rate of v|, h the smallest cell size.
    #[inline(always)]
    fn residual<const D: usize, R: Real>(&self, window: &impl Window<D, R, Pile<R>, Ground<D, R>>) -> R {
        let Spacing { size, per } = window.spacing();
        let low = if D > 1 { -1 } else { 0 };
        // around[y][x], from the neighbour with smaller coordinates.
        let around: [[Edges<D, R>; 3]; 3] = std::array::from_fn(|y| {
            std::array::from_fn(|x| {
                let mut offset = [0; D];
                offset[0] = x as isize - 1;
                if D > 1 {
                    offset[D - 1] = y as isize - 1;
                }
                Self::constant(window, offset)
            })
        });
        let row = |y: isize| &around[(y + 1) as usize];
        let corner = |x: usize, y: isize| {
            let (below, above) = (row(y + low), row(y));
            self.corner([[&below[x], &below[x + 1]], [&above[x], &above[x + 1]]])
        };
        let corners: [[R; 2]; 2] = if D > 1 {
            std::array::from_fn(|y| std::array::from_fn(|x| corner(x, y as isize)))
        } else {
            [[corner(0, 0), corner(1, 0)]; 2]
        };
        let mid = row(0);
        let mut faces = [Faces { lo: R::zero(), hi: R::zero() }; D];
        faces[0] = Faces { lo: self.flux(0, &mid[0], &mid[1]), hi: self.flux(0, &mid[1], &mid[2]) };
        if D > 1 {
            let (below, above) = (&row(-1)[1], &row(1)[1]);
            faces[D - 1] =
                Faces { lo: self.flux(D - 1, below, &mid[1]), hi: self.flux(D - 1, &mid[1], above) };
        }
        let ground = window.at([0; D]).ground;
        let change = rate_of_v(&ground, &faces, &corners, *per);
        let mut h = size[0];
        for axis in 1..D {
            h = h.min(size[axis]);
        }
        let [[a, b], [c, d]] = corners.map(|row| row.map(R::abs));
        let sum = if D > 1 { (a + d) + (b + c) } else { a + b };
        sum + change.abs() * h
    }

    /// Theta(E) = E^2/(E^2 + h^m) (eq. 36).
    #[inline(always)]
    fn theta<const D: usize, R: Real>(
        &self,
        exponent: f64,
        window: &impl Window<D, R, Pile<R>, Ground<D, R>>,
    ) -> R {
        let residual = self.residual(window);
        let square = residual * residual;
        let mut scale = window.spacing().size[0];
        for axis in 1..D {
            scale = scale.min(window.spacing().size[axis]);
        }
        let scale = (R::of(exponent) * scale.ln()).exp();
        square / (square + scale)
    }
}
