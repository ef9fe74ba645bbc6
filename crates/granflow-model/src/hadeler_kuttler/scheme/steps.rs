//! The pointwise functions of the scheme.

use super::cell::{FaceStates, SlopeStorage};
use super::rates::{corner, flux, rate_of_v};
use super::reconstruct::{constant, linear};
use super::variant::{HadelerKuttler, Slopes};
use crate::hadeler_kuttler::{Ground, Pile, Source};
use crate::limiter::Limited;
use crate::real::{Real, for_axis};
use crate::scheme::{Cell, Diagnostics, Faces, Forecasts, Scheme, SchemeVisitor, Side, Spacing, Stencil};
use crate::time::{EULER, SSP_RK2, Stages};

impl<const D: usize, R: Real, const LIMITED: bool> Scheme<D, R> for HadelerKuttler<LIMITED>
where
    Limited<LIMITED>: SlopeStorage,
{
    type State = Pile<R>;
    type Ground = Ground<D, R>;
    type Forcing = Source<D, R>;
    type Primitives = ();
    type Forecast = ();
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
    fn forecast(&self, _stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>, _dt: R) {}
    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Pile<R>, Ground<D, R>, Source<D, R>>,
        _: &(),
        _forecasts: &Forecasts<D, ()>,
        _dt: R,
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
    fn flux(&self, axis: usize, left: &Self::FaceStates, right: &Self::FaceStates, _lambda: R) -> R {
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
    fn outflow(&self, flux: &R, _side: Side, lambda: R) -> R {
        -(lambda * *flux)
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
