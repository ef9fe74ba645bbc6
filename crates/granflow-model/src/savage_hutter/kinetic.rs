//! The five published kinetic schemes as five constants, the [`Variant`]s of one [`Kinetic`].
//!
//! Kaland & Struckmeier 2007 (report, Schemes 1-3) and Kaland 2007 (thesis, Verfahren 1-5), errata corrected; in
//! two dimensions on a plane by applying the fluxes along each axis, the (1, 2, 1)/4 depth per axis and static
//! friction as the projection onto a disc.

use super::flux::{Density, Half};
use super::friction::{Coulomb, Friction};
use super::ground::{Bed, Chute, Towards};
use super::{Flow, normal};
use crate::real::{Real, dot, for_axis, per_axis, repeated};
use crate::scheme::{
    Cell, Diagnostics, Faces, Forecasts, Neighbours, Scheme, SchemeVisitor, Side, Spacing, Stencil,
    components,
};
use crate::time::{EULER, Stages};

/// The depth that enters the half moments at a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceDepth {
    /// Each cell's own depth: the flux F.
    Own,
    /// (h_i + h_{i+1})/2 on both sides: the flux F~.
    Mean,
}

/// When a cell takes the static source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestTest {
    /// q = 0.
    Still,
    /// |q| < dt |g(q)| h^{n+1}, or q = 0.
    Slow,
}

/// The depth in the static source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StaticDepth {
    /// h_i^{n+1}.
    New,
    /// (h_{i-1} + 2 h_i + h_{i+1})/4 per axis (report eq. 27).
    Smoothed,
}

/// The five choices that tell the published schemes apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Face depth of a moving cell.
    pub moving: FaceDepth,
    /// Face depth of a resting cell.
    pub resting: FaceDepth,
    /// When a cell counts as resting.
    pub rest: RestTest,
    /// Depth in the static source.
    pub static_depth: StaticDepth,
    /// Blend by mu = -q/(dt g(q) h^{n+1}).
    pub blend: bool,
}

impl Variant {
    /// The scheme with this friction.
    pub const fn with(self, friction: Coulomb) -> Kinetic {
        Kinetic { variant: self, friction }
    }
}

/// Verfahren 1 = Scheme 1.
pub const VERFAHREN_1: Variant = Variant {
    moving: FaceDepth::Own,
    resting: FaceDepth::Own,
    rest: RestTest::Still,
    static_depth: StaticDepth::New,
    blend: false,
};
/// Verfahren 2.
pub const VERFAHREN_2: Variant = Variant {
    moving: FaceDepth::Mean,
    resting: FaceDepth::Mean,
    static_depth: StaticDepth::Smoothed,
    ..VERFAHREN_1
};
/// Verfahren 3.
pub const VERFAHREN_3: Variant = Variant { rest: RestTest::Slow, ..VERFAHREN_2 };
/// Verfahren 4 = Scheme 2.
pub const VERFAHREN_4: Variant = Variant { blend: true, ..VERFAHREN_3 };
/// Verfahren 5 = Scheme 3.
pub const VERFAHREN_5: Variant = Variant { moving: FaceDepth::Own, ..VERFAHREN_4 };

/// A published scheme on a plane chute with Coulomb friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinetic {
    /// Which one.
    pub variant: Variant,
    /// mu = tan(delta).
    pub friction: Coulomb,
}

/// What a cell offers to its faces.
#[derive(Clone, Copy, Debug)]
pub struct FaceStates<const D: usize, R> {
    h: R,
    u: [R; D],
    /// The halves at the cell's own depth, where the moving flux takes them, along each axis.
    halves: [[Half<R>; 2]; D],
    beta: R,
}

components!([const D: usize, R: Real] FaceStates<D, R> { h: R, u: [R; D], halves: [[Half<R>; 2]; D], beta: R });

impl Kinetic {
    /// What a cell offers to its faces under a face depth.
    #[inline(always)]
    fn face_states<const D: usize, R: Real>(
        depth: FaceDepth,
        Cell { state, ground, .. }: &Cell<Flow<D, R>, Chute<D, R>>,
        primitives: &[Density<R>; D],
    ) -> FaceStates<D, R> {
        let own = depth == FaceDepth::Own;
        FaceStates {
            h: state.h,
            u: per_axis!(k => primitives[k].u),
            halves: per_axis!(k => if own { primitives[k].halves(state.h) } else { [Half::none(), Half::none()] }),
            beta: ground.beta,
        }
    }

    /// F or F~ through the face between `left` and `right`.
    #[inline(always)]
    fn through<const D: usize, R: Real>(
        depth: FaceDepth,
        axis: usize,
        left: &FaceStates<D, R>,
        right: &FaceStates<D, R>,
    ) -> Flow<D, R> {
        let halves = match depth {
            FaceDepth::Own => [left.halves[axis][1], right.halves[axis][0]],
            FaceDepth::Mean => {
                let mean = (left.h + right.h) * R::splat(0.5);
                let momenta = [mean * left.u[axis], mean * right.u[axis]];
                Self::halves_at([mean, mean], momenta, [left.beta, right.beta])
            }
        };
        Self::sum(axis, halves, [left.u, right.u])
    }

    /// The two halves that meet at a face, at these depths and momenta.
    #[inline(always)]
    fn halves_at<R: Real>(h: [R; 2], q: [R; 2], beta: [R; 2]) -> [Half<R>; 2] {
        let out = Density::new(h[0], q[0], beta[0]);
        let back = Density::new(h[1], q[1], beta[1]);
        [out.halves(h[0])[1], back.halves(h[1])[0]]
    }

    /// The flux of two halves, which carry the velocities of their cells.
    #[inline(always)]
    fn sum<const D: usize, R: Real>(axis: usize, [out, back]: [Half<R>; 2], u: [[R; D]; 2]) -> Flow<D, R> {
        let mut q: [R; D] = per_axis!(k => out.mass * u[0][k] + back.mass * u[1][k]);
        q[axis] = q[axis] + (out.push + back.push);
        Flow { h: out.mass + back.mass, q }
    }

    /// What passes the faces of a cell with the face depth of a resting one.
    #[inline(always)]
    fn resting_faces<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, Chute<D, R>>,
    ) -> [Faces<Flow<D, R>>; D] {
        per_axis!(axis => Faces {
            lo: self.resting_face(axis, [&near.lo[axis], &near.here]),
            hi: self.resting_face(axis, [&near.here, &near.hi[axis]]),
        })
    }

    /// What passes one face so. The depths are chosen before the one formula: it is long.
    #[inline(always)]
    fn resting_face<const D: usize, R: Real>(
        &self,
        axis: usize,
        cells: [&Cell<Flow<D, R>, Chute<D, R>>; 2],
    ) -> Flow<D, R> {
        let u: [[R; D]; 2] = per_axis!(side => {
            let primitives: [Density<R>; D] = self.primitives(cells[side]);
            per_axis!(k => primitives[k].u)
        });
        let mean = (cells[0].state.h + cells[1].state.h) * R::splat(0.5);
        let own = self.variant.resting == FaceDepth::Own;
        let h = per_axis!(side => if own { cells[side].state.h } else { mean });
        let q = per_axis!(side => if own { cells[side].state.q[axis] } else { mean * u[side][axis] });
        Self::sum(axis, Self::halves_at(h, q, per_axis!(side => cells[side].ground.beta)), u)
    }

    /// g~: the static force per mass, tilt plus the excess cut to the disc of radius R.
    #[inline(always)]
    fn static_force<const D: usize, R: Real>(
        near: &Neighbours<D, R, Flow<D, R>, Chute<D, R>>,
        bound: R,
    ) -> [R; D] {
        let by_neighbours = Self::excess(near);
        let excess = dot(by_neighbours, by_neighbours).sqrt();
        let over = bound.lt(excess);
        let one = R::splat(1.0);
        let cut = R::select(over, bound / R::select(over, excess, one), one);
        per_axis!(k => near.here.ground.tilt[k] + by_neighbours[k] * cut)
    }

    /// The depth along each axis that the static force pulls at.
    #[inline(always)]
    fn static_depth<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, Chute<D, R>>,
        resting_h: R,
    ) -> [R; D] {
        let h = near.here.state.h;
        match self.variant.static_depth {
            StaticDepth::New => repeated(resting_h),
            StaticDepth::Smoothed => per_axis!(k => {
                ((near.lo[k].state.h + near.hi[k].state.h) + (h + h)) * R::splat(0.25)
            }),
        }
    }

    /// beta D h - tilt per axis: the pull that friction must hold, as an acceleration.
    #[inline(always)]
    fn excess<const D: usize, R: Real>(near: &Neighbours<D, R, Flow<D, R>, Chute<D, R>>) -> [R; D] {
        let Cell { state, ground, .. } = near.here;
        let (size, lo, hi) = (near.spacing.size, &near.lo, &near.hi);
        let rise_lo: [R; D] = per_axis!(k => ground.potential_jump(k, Towards::Lo, &lo[k].ground, state.h, lo[k].state.h, size[k]));
        let rise_hi: [R; D] = per_axis!(k => ground.potential_jump(k, Towards::Hi, &hi[k].ground, state.h, hi[k].state.h, size[k]));
        let pull = ground.driving_force(rise_lo, rise_hi, near.spacing.inv);
        per_axis!(k => -pull[k])
    }
}

/// sum over axes of lambda (F_hi - F_lo).
#[inline(always)]
fn divergence<const D: usize, R: Real>(faces: &[Faces<Flow<D, R>>; D], lambda: [R; D]) -> Flow<D, R> {
    let mut sum = Flow::still(R::zero());
    for_axis!(axis in D => {
        let Faces { lo, hi } = &faces[axis];
        sum.h = sum.h + lambda[axis] * (hi.h - lo.h);
        for_axis!(k in D => {
            sum.q[k] = sum.q[k] + lambda[axis] * (hi.q[k] - lo.q[k]);
        });
    });
    sum
}

impl<const D: usize, R: Real> Scheme<D, R> for Kinetic {
    type State = Flow<D, R>;
    type Ground = Chute<D, R>;
    type Forcing = ();
    type Primitives = [Density<R>; D];
    type Forecast = ();
    type FaceStates = FaceStates<D, R>;
    /// Mass and momentum, with the face depth of a moving cell.
    type Flux = Flow<D, R>;
    type Corner = ();

    fn stages(&self) -> Stages {
        EULER
    }
    /// The bound of Verfahren 1 (report eq. 28), under which its depth stays positive; none is proven for the others.
    fn max_courant(&self) -> f64 {
        1.0
    }

    #[inline(always)]
    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output {
        visitor.visit(self)
    }

    #[inline(always)]
    fn primitives(&self, Cell { state, ground, .. }: &Cell<Flow<D, R>, Chute<D, R>>) -> [Density<R>; D] {
        per_axis!(axis => Density::new(state.h, state.q[axis], ground.beta))
    }

    #[inline(always)]
    fn forecast(&self, _stencil: &impl Stencil<D, R, Flow<D, R>, Chute<D, R>>, _dt: R) {}
    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, Chute<D, R>>,
        primitives: &[Density<R>; D],
        _forecasts: &Forecasts<D, ()>,
        _dt: R,
    ) -> FaceStates<D, R> {
        Self::face_states(self.variant.moving, &stencil.at([0; D]), primitives)
    }

    #[inline(always)]
    fn flux(&self, axis: usize, left: &FaceStates<D, R>, right: &FaceStates<D, R>, _lambda: R) -> Flow<D, R> {
        Self::through(self.variant.moving, axis, left, right)
    }

    #[inline(always)]
    fn corner(&self, _around: [[&FaceStates<D, R>; 2]; 2]) {}
    #[inline(always)]
    fn update(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, Chute<D, R>>,
        _face_states: &FaceStates<D, R>,
        faces: &[Faces<Flow<D, R>>; D],
        _corners: &[[(); 2]; 2],
        dt: R,
    ) -> Flow<D, R> {
        let near = stencil.star();
        let Cell { state: Flow { h, q }, ground, .. } = near.here;
        let lambda: [R; D] = per_axis!(k => dt * near.spacing.inv[k]);
        let (zero, one) = (R::zero(), R::splat(1.0));
        let moving = divergence(faces, lambda);
        let moving_h = normal(h - moving.h);

        // g(q) = tilt - R q/|q|
        let bound = self.friction.resistance(h, zero, ground.cos, ground.cos).holding;
        // A momentum whose square underflows has no direction: it counts as none.
        let size = dot(q, q).sqrt();
        let still = size.equals(zero);
        let per = one / R::select(still, one, size);
        let g: [R; D] = per_axis!(k => ground.tilt[k] - bound * (q[k] * per));
        let square = dot(g, g);
        let rests = match self.variant.rest {
            RestTest::Still => still,
            // |q| < dt |g| h
            RestTest::Slow => {
                let limit = dt * moving_h;
                still | (zero.lt(limit) & (size * size).lt(square * (limit * limit)))
            }
        };
        let moved = Flow { h: moving_h, q: per_axis!(k => q[k] - moving.q[k] + dt * g[k] * moving_h) };
        if !R::any(rests) {
            return moved;
        }

        let resting = if self.variant.resting == self.variant.moving {
            moving
        } else {
            divergence(&self.resting_faces(&near), lambda)
        };
        let resting_h = normal(h - resting.h);
        let held = Self::static_force(&near, bound);
        // 1 - mu with mu = -q.g/(dt |g|^2 h^{n+1}); q = 0 is rest in words
        let weight = dt * square * moving_h;
        let no_weight = weight.equals(zero) | still;
        let blend = one + R::select(no_weight, zero, dot(q, g) / R::select(no_weight, one, weight));
        let static_depth = self.static_depth(&near, resting_h);
        Flow {
            h: R::select(rests, resting_h, moving_h),
            q: per_axis!(k => {
                let source = dt * held[k] * static_depth[k];
                let rest = if self.variant.blend { blend * source } else { q[k] + source };
                R::select(rests, rest - resting.q[k], moved.q[k])
            }),
        }
    }

    fn mirror(&self, axis: usize, state: &Flow<D, R>) -> Flow<D, R> {
        state.mirror(axis)
    }
    fn mirror_ground(&self, axis: usize, ground: &Chute<D, R>) -> Chute<D, R> {
        ground.mirror(axis)
    }
    #[inline(always)]
    fn rate(&self, here: &Cell<Flow<D, R>, Chute<D, R>>, spacing: &Spacing<D, R>) -> R {
        here.state.rate(&here.ground, spacing.inv)
    }
    /// The published schemes prove no rest; a dry cell counts.
    #[inline(always)]
    fn is_static(&self, here: &Cell<Flow<D, R>, Chute<D, R>>) -> R::Mask {
        here.state.h.equals(R::zero())
    }
    #[inline(always)]
    fn is_nodata(&self, ground: &Chute<D, R>) -> R::Mask {
        ground.is_nodata()
    }
    /// The flux of the moving depth; a resting edge cell of Verfahren 5 loses the other one (erratum 5).
    #[inline(always)]
    fn outflow(&self, flux: &Flow<D, R>, _side: Side, lambda: R) -> R {
        lambda * flux.h
    }
    fn yield_ratio(&self, stencil: &impl Stencil<D, R, Flow<D, R>, Chute<D, R>>) -> R {
        let near = stencil.star();
        let Cell { state, ground, .. } = near.here;
        let excess = Self::excess(&near);
        let bound = self.friction.resistance(state.h, R::zero(), ground.cos, ground.cos).holding;
        let none = state.h.le(R::zero()) | bound.le(R::zero());
        R::select(none, R::zero(), dot(excess, excess).sqrt() / R::select(none, R::splat(1.0), bound))
    }
    #[inline(always)]
    fn diagnostics(&self, here: &Cell<Flow<D, R>, Chute<D, R>>) -> Diagnostics<R> {
        here.state.diagnostics(&here.ground, R::zero())
    }
}
