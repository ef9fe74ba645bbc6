//! The papers' chute.

use super::bed::{Bed, Towards, straight};
use crate::real::{Real, dot, per_axis, repeated};
use crate::scheme::components;

/// The papers' chute (report eqs. 1 and 13), in their scaling; also a tilted plane in two dimensions.
///
/// A cell outside the grid has cos = 0. psi = beta h per cell pair with P = beta h^2/2: a variable beta enters as h (beta_hi - beta_lo)/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chute<const D: usize, R> {
    /// g sin(zeta), as a vector down the slope; g = 1 in the papers' scaling.
    pub tilt: [R; D],
    /// g epsilon k cos(zeta).
    pub beta: R,
    /// g cos(zeta).
    pub cos: R,
    /// eta kappa: curvature of the chute times L/R; N = cos(zeta) + eta kappa u^2.
    pub curvature: R,
}

components!([const D: usize, R: Real] Chute<D, R> { tilt: [R; D], beta: R, cos: R, curvature: R });

/// The free surface over a chute.
#[derive(Clone, Copy, Debug)]
pub struct Layer<const D: usize, R> {
    h: R,
    beta: R,
    /// What the chute falls within half a cell.
    fall: [R; D],
}
components!([const D: usize, R: Real] Layer<D, R> { h: R, beta: R, fall: [R; D] });

impl<const D: usize, R: Real> Bed<D, R> for Chute<D, R> {
    type On<L: Real> = Chute<D, L>;
    type Plane = ();
    type Surface = Layer<D, R>;
    #[inline(always)]
    fn surface(&self, h: R, size: [R; D]) -> Layer<D, R> {
        Layer { h, beta: self.beta, fall: per_axis!(k => self.tilt[k] * size[k] * R::splat(0.5)) }
    }
    /// beta (h_b - h_a) + h (beta_b - beta_a)/2 with the means of beta and h, less the fall of the chute: the pressure is
    /// beta h^2/2.
    #[inline(always)]
    fn rise(axis: usize, [a, b]: [&Layer<D, R>; 2]) -> R {
        let by_depth = (a.beta + b.beta) * R::splat(0.5) * (b.h - a.h);
        let by_beta = (b.beta - a.beta) * (a.h + b.h) * R::splat(0.25);
        (by_depth + by_beta) - (a.fall[axis] + b.fall[axis])
    }
    #[inline(always)]
    fn potential(_surface: &Layer<D, R>) -> R {
        R::zero()
    }
    #[inline(always)]
    fn head(&self) -> R {
        self.beta
    }
    #[inline(always)]
    fn per_head(&self) -> R {
        let none = self.beta.le(R::zero());
        R::select(none, R::zero(), R::splat(1.0) / R::select(none, R::splat(1.0), self.beta))
    }
    #[inline(always)]
    fn stretch_in(_plane: &(), _axis: usize) -> R {
        R::splat(1.0)
    }
    #[inline(always)]
    fn metric(_plane: &(), v: [R; D]) -> [R; D] {
        v
    }
    #[inline(always)]
    fn square_in(_plane: &(), v: [R; D]) -> R {
        dot(v, v)
    }
    #[inline(always)]
    fn gravity(&self) -> R {
        (self.cos * self.cos + dot(self.tilt, self.tilt)).sqrt()
    }
    #[inline(always)]
    fn exact(self) -> Self {
        self
    }
    #[inline(always)]
    fn plane(&self) {}
    #[inline(always)]
    fn beta(&self, _axis: usize) -> R {
        self.beta
    }
    #[inline(always)]
    fn bed_jump(&self, axis: usize, towards: Towards, _there: &Self, dx: R) -> R {
        let fall = self.tilt[axis] * dx;
        match towards {
            Towards::Hi => -fall,
            Towards::Lo => fall,
        }
    }
    #[inline(always)]
    fn pressure_jump(&self, there: &Self, h: R, h_there: R) -> R {
        self.beta * (h_there - h) + (there.beta - self.beta) * h * R::splat(0.5)
    }
    #[inline(always)]
    fn driving_force(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D] {
        straight(lo, hi, per)
    }
    #[inline(always)]
    fn uniform_driving_force(&self) -> Option<[R; D]> {
        Some(self.tilt)
    }
    #[inline(always)]
    fn cross_force(&self, _lo: [R; D], _hi: [R; D], _per: [R; D]) -> [R; D] {
        repeated(R::zero())
    }
    #[inline(always)]
    fn curvature_force(&self, _axis: usize, _lo: &Self, _hi: &Self, _per: R) -> R {
        R::zero()
    }
    #[inline(always)]
    fn normal_load(&self, w: [R; D]) -> R {
        (self.cos + self.curvature * dot(w, w)).positive_part()
    }
    #[inline(always)]
    fn weight_at_rest(&self) -> R {
        self.cos
    }
    #[inline(always)]
    fn square(&self, v: [R; D]) -> R {
        dot(v, v)
    }
    #[inline(always)]
    fn parallel_transport(w: [[R; D]; 2], _planes: [&(); 2]) -> [[R; D]; 2] {
        w
    }
    #[inline(always)]
    fn thickness(&self, h: R) -> R {
        h
    }
    #[inline(always)]
    fn rounding(&self, h: R, per: R) -> R {
        R::splat(1e-14) * (self.beta * h * per + self.cos)
    }
    #[inline(always)]
    fn elevation(&self) -> R {
        R::splat(f64::NAN)
    }
    #[inline(always)]
    fn is_nodata(&self) -> R::Mask {
        self.cos.le(R::zero())
    }
    fn mirror(mut self, axis: usize) -> Self {
        self.tilt[axis] = -self.tilt[axis];
        self
    }
}
