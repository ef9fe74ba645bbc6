//! The half moments of the kinetic density: one function holds all eight printed integrals.
//!
//! M(h, xi - u) = (2/pi) h/c sqrt(1 - ((xi - u)/c)^2)_+, c = sqrt(2 beta h) (report eq. 12). What crosses a face
//! to the right is carried by xi >= 0, to the left by xi < 0.

use crate::real::{Real, per_axis};
use crate::scheme::components;
use core::f64::consts::{FRAC_2_PI, FRAC_PI_4, PI};

/// One half of the kinetic density, as fluxes along one axis.
#[derive(Clone, Copy, Debug)]
pub struct Half<R> {
    /// Integral of xi M: mass per time; >= 0 to the right, <= 0 to the left.
    pub mass: R,
    /// Integral of xi (xi - u) M: the momentum beyond mass * u (pressure); >= 0 when the halves are summed.
    pub push: R,
}

components!([R: Real] Half<R> { mass: R, push: R });

impl<R: Real> Half<R> {
    /// Nothing.
    #[inline(always)]
    pub fn none() -> Self {
        Half { mass: R::zero(), push: R::zero() }
    }
    /// From (2/pi) h, u, c and the moments m0, m1, m2.
    #[inline(always)]
    fn of([scale, u, c]: [R; 3], m0: R, m1: R, m2: R) -> Self {
        Half { mass: scale * u.mul_add(m0, c * m1), push: (scale * c) * c.mul_add(m2, u * m1) }
    }
    /// Integral of xi^2 M = mass * u + push.
    #[inline(always)]
    pub fn momentum(&self, u: R) -> R {
        self.mass * u + self.push
    }
    /// What the share that is not carried gives back at a wall, with the push of the share that is carried:
    /// 2 (1 - share) (mass u + push) + share push.
    #[inline(always)]
    pub fn reflected(&self, u: R, share: R) -> R {
        self.momentum(u) * (R::splat(2.0) - (share + share)) + self.push * share
    }
    /// This share of it.
    #[inline(always)]
    pub fn share(self, share: R) -> Self {
        Half { mass: self.mass * share, push: self.push * share }
    }
    /// The half where `mask` holds, nothing elsewhere.
    #[inline(always)]
    pub fn only(self, mask: R::Mask) -> Self {
        Half { mass: R::select(mask, self.mass, R::zero()), push: R::select(mask, self.push, R::zero()) }
    }
}

/// The density of a cell's mass along one axis: what of it takes roots and divisions.
#[derive(Clone, Copy, Debug)]
pub struct Density<R> {
    /// Mean velocity.
    pub u: R,
    /// Half width c = sqrt(2 beta h) of the support.
    c: R,
    /// a = clamp(-u/c): the place of xi = 0 in it.
    a: R,
}

impl<R: Real> Density<R> {
    /// Of depth `h` and momentum `q` along the axis, pressure coefficient `beta`: u = q/h and a by one division,
    /// 1/(h c), 1/h without pressure. A depth so small that h c is no normal number has no velocity.
    #[inline(always)]
    pub fn new(h: R, q: R, beta: R) -> Self {
        let (zero, one) = (R::zero(), R::splat(1.0));
        let c = ((beta + beta) * h).sqrt();
        let wide = R::select(c.equals(zero), one, c);
        let volume = h * wide;
        let wet = R::splat(f64::MIN_POSITIVE).le(volume);
        let share = q * R::select(wet, one / R::select(wet, volume, one), zero);
        Density { u: R::select(wet, share * wide, zero), c, a: (-share).max(-one).min(one) }
    }

    /// Of mean velocity `u`, where nothing else is asked.
    #[inline(always)]
    pub fn mean(u: R) -> Self {
        Density { u, c: R::zero(), a: R::zero() }
    }

    /// At the two ends of a cell, depths `h`, velocities `u`.
    #[inline(always)]
    pub fn ends(h: [R; 2], u: [R; 2], beta: R) -> [Self; 2] {
        let (zero, one) = (R::zero(), R::splat(1.0));
        let c: [R; 2] = per_axis!(end => ((beta + beta) * h[end]).sqrt());
        let wide: [R; 2] = per_axis!(end => R::select(c[end].le(zero), one, c[end]));
        let per = one / (wide[0] * wide[1]);
        per_axis!(end => Density { u: u[end], c: c[end], a: (-u[end] * (wide[1 - end] * per)).max(-one).min(one) })
    }

    /// The two halves (xi < 0, xi >= 0) under the depth `h`.
    ///
    /// With x = asin a, r = sqrt(1 - a^2):
    /// m0 = pi/4 -+ (x + a r)/2, m1 = +- r^3/3, m2 = pi/16 -+ (x/8 - a r (1 - 2 a^2)/8), upper sign xi >= 0;
    /// mass = (2/pi) h (u m0 + c m1), push = (2/pi) h (u c m1 + c^2 m2).
    /// Report I_1 ... I_4 with the errata of I_3 and I_4. Each half is exactly 0 in supercritical flow against it,
    /// and one is bit for bit the mirror image of the other.
    #[inline(always)]
    pub fn halves(self, h: R) -> [Half<R>; 2] {
        let Density { u, c, a } = self;
        let (one, half, eighth) = (R::splat(1.0), R::splat(0.5), R::splat(0.125));
        let square = one - a * a;
        let [x, r] = a.asin_and_cos();
        let (ar, third) = (a * r, (square * r) * R::splat(1.0 / 3.0));
        let (area, fourth) = (x + ar, ar.mul_add((a + a).mul_add(a, -one), x));
        let (m0, m2) = (R::splat(FRAC_PI_4), R::splat(PI / 16.0));
        let scale = [R::splat(FRAC_2_PI) * h, u, c];
        [
            Half::of(scale, area.mul_add(half, m0), -third, fourth.mul_add(eighth, m2)),
            Half::of(scale, area.mul_add(-half, m0), third, fourth.mul_add(-eighth, m2)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::prelude::v1::*;

    fn halves(h: f64, u: f64, beta: f64) -> [Half<f64>; 2] {
        Density::new(h, h * u, beta).halves(h)
    }

    fn by_quadrature(h: f64, u: f64, beta: f64, right: bool) -> (f64, f64) {
        // xi = u + c sin t removes the root's end points; midpoint rule on the half, cut at xi = 0.
        let c = (2.0 * beta * h).sqrt();
        let cut = (-u / c).clamp(-1.0, 1.0).asin();
        let (from, to) =
            if right { (cut, core::f64::consts::FRAC_PI_2) } else { (-core::f64::consts::FRAC_PI_2, cut) };
        let n = 20_000;
        let dt = (to - from) / f64::from(n);
        let (mut mass, mut momentum) = (0.0, 0.0);
        for k in 0..n {
            let t = from + (f64::from(k) + 0.5) * dt;
            let xi = u + c * t.sin();
            let weight = FRAC_2_PI * h * t.cos().powi(2) * dt;
            mass += xi * weight;
            momentum += xi * xi * weight;
        }
        (mass, momentum)
    }

    #[test]
    fn halves_are_the_integrals() {
        for (h, u, beta) in
            [(0.7, 0.3, 0.4), (1.3, -0.9, 0.4), (0.2, 2.0, 0.4), (2.3, 0.0, 0.5), (1.0, -3.0, 0.1)]
        {
            let [left, right] = halves(h, u, beta);
            for (half, is_right) in [(left, false), (right, true)] {
                let (mass, momentum) = by_quadrature(h, u, beta, is_right);
                assert!((half.mass - mass).abs() < 1e-8, "{h} {u} {beta}");
                assert!((half.momentum(u) - momentum).abs() < 1e-8, "{h} {u} {beta}");
            }
        }
        // The erratum of I_3: the integral is 0.153, the printed form gave 0.055.
        assert!((halves(0.7, 0.3, 0.4)[1].momentum(0.3) - 0.153).abs() < 5e-4);
    }

    #[test]
    fn halves_mirror_bit_for_bit_and_vanish_upstream() {
        for k in 0..1000 {
            let (h, u) = (0.01 + f64::from(k) * 0.003, f64::from(k % 37) * 0.11 - 2.0);
            let [left, right] = halves(h, u, 0.4);
            let [mirrored_left, mirrored_right] = halves(h, -u, 0.4);
            assert_eq!(left.mass, -mirrored_right.mass);
            assert_eq!(left.push, mirrored_right.push);
            assert_eq!(right.mass, -mirrored_left.mass);
        }
        let [left, right] = halves(0.5, 3.0, 0.4);
        assert_eq!((left.mass, left.push), (0.0, 0.0));
        assert!((right.mass - 1.5).abs() < 1e-15);
        let [left, right] = halves(0.0, 0.0, 0.4);
        assert_eq!((left.mass, left.push, right.mass, right.push), (0.0, 0.0, 0.0, 0.0));
    }

    #[test]
    fn depths_down_to_none_and_below_have_a_velocity() {
        let mut h = 1.0;
        while h > 0.0 {
            for u in [0.0, 1.0, -3.0] {
                let density = Density::new(h, h * u, 0.4);
                assert!(
                    density.halves(h).iter().all(|half| (half.mass + half.push).is_finite()),
                    "{h:e} {u}"
                );
                assert!(h < 1e-200 || (density.u - u).abs() <= 1e-15 * u.abs(), "{h:e} {u}");
            }
            h *= 0.1;
        }
        // Without pressure; below 0, where the published schemes of the mean depth may come.
        assert_eq!(Density::new(2.0, 3.0, 0.0).u, 1.5);
        assert_eq!(Density::new(-1e-3, 1e-3, 0.4).u, 0.0);
    }
}
