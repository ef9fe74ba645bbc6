//! Water without friction over a curved bed.

use super::values::{ExactError, Flow2, finite, positive};

/// Depth of a lake at rest with level `surface` over a bed of height `bed` (both in m): `max(surface - bed, 0)`, u = 0.
///
/// It solves the frictionless equations over any bed, islands included.
pub fn lake_depth(surface: f64, bed: f64) -> f64 {
    (surface - bed).max(0.0)
}

/// Water with a plane surface that circles in the paraboloid `z = -h0 (1 - r^2/a^2)` (Thacker 1981, J. Fluid
/// Mech. 107), SI units, no friction:
///
/// ```text
/// h = h0 (1 - |(x, y) - sigma (cos wt, sin wt)|^2 / a^2),   w = sqrt(2 G h0)/a
/// u = -sigma w sin wt,   v = sigma w cos wt
/// ```
///
/// It solves Saint-Venant's equations with gravity along the vertical, not a terrain model that measures depth along the normal of the bed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThackerParaboloid {
    gravity: f64,
    a: f64,
    sigma: f64,
    h0: f64,
}

impl ThackerParaboloid {
    /// Gravity (m/s2), radius `a` of the still lake (m), radius `sigma` of the circle run by its centre (m) and
    /// depth `h0` of the still lake (m).
    ///
    /// # Errors
    /// [`ExactError::OutOfRange`] for values that are not positive (`sigma` may be of either sign).
    pub fn new(gravity: f64, a: f64, sigma: f64, h0: f64) -> Result<Self, ExactError> {
        Ok(Self {
            gravity: positive("gravity", gravity)?,
            a: positive("a", a)?,
            sigma: finite("sigma", sigma)?,
            h0: positive("h0", h0)?,
        })
    }

    /// Angular speed w, rad/s.
    pub fn omega(&self) -> f64 {
        (2.0 * self.gravity * self.h0).sqrt() / self.a
    }

    /// Time of one turn, s.
    pub fn period(&self) -> f64 {
        2.0 * core::f64::consts::PI / self.omega()
    }

    /// Height of the bed at `(x, y)`, m; 0 on the shore of the still lake.
    pub fn bed(&self, x: f64, y: f64) -> f64 {
        self.h0 * ((x * x + y * y) / (self.a * self.a) - 1.0)
    }

    /// The flow at `(x, y)` and time `t`.
    pub fn flow(&self, x: f64, y: f64, t: f64) -> Flow2 {
        let (sin, cos) = (self.omega() * t).sin_cos();
        let (dx, dy) = (x - self.sigma * cos, y - self.sigma * sin);
        let h = self.h0 * (1.0 - (dx * dx + dy * dy) / (self.a * self.a));
        if h > 0.0 {
            let speed = self.sigma * self.omega();
            Flow2 { h, u: -speed * sin, v: speed * cos }
        } else {
            Flow2::DRY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::prelude::v1::*;

    #[test]
    fn solves_saint_venant() {
        let s = ThackerParaboloid::new(9.81, 1.0, 0.5, 0.1).unwrap();
        assert!((s.omega() - (2.0f64 * 9.81 * 0.1).sqrt()).abs() < 1e-15);
        let d = |f: &dyn Fn(f64) -> f64| (f(1e-4) - f(-1e-4)) / 2e-4;
        for (x, y, t) in [(0.2, 0.3, 0.4), (-0.1, 0.1, 1.7), (0.0, -0.6, 3.9)] {
            let f = |dx: f64, dy: f64, dt: f64| s.flow(x + dx, y + dy, t + dt);
            let here = f(0.0, 0.0, 0.0);
            assert!(here.h > 0.0);
            let mass = d(&|e| f(0.0, 0.0, e).h)
                + d(&|e| f(e, 0.0, 0.0).h * f(e, 0.0, 0.0).u)
                + d(&|e| f(0.0, e, 0.0).h * f(0.0, e, 0.0).v);
            // uniform velocity: u_t = -G (h + z)_x
            let level = |dx: f64, dy: f64| f(dx, dy, 0.0).h + s.bed(x + dx, y + dy);
            let mx = d(&|e| f(0.0, 0.0, e).u) + 9.81 * d(&|e| level(e, 0.0));
            let my = d(&|e| f(0.0, 0.0, e).v) + 9.81 * d(&|e| level(0.0, e));
            assert!(mass.abs() < 1e-8 && mx.abs() < 1e-8 && my.abs() < 1e-8, "{mass} {mx} {my}");
        }
        let (a, b) = (s.flow(0.3, 0.1, 0.2), s.flow(0.3, 0.1, 0.2 + s.period()));
        assert!((a.h - b.h).abs() < 1e-14 && (a.u - b.u).abs() < 1e-14);
        assert_eq!(s.flow(-0.9, 0.0, 0.0), Flow2::DRY);
    }

    #[test]
    fn lake_leaves_the_island_dry() {
        assert_eq!((lake_depth(1.0, 0.25), lake_depth(1.0, 1.5)), (0.75, 0.0));
    }
}
