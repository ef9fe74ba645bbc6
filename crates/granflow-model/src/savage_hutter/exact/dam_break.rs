//! Dam break on a slope that friction does not hold.

use super::values::{ExactError, Flow1, angle, positive};

/// Dam break on a slope that friction does not hold (`d <= z`), exact (Mangeney, Heinrich & Roche 2000, Pure Appl.
/// Geophys. 157; Faccanoni & Mangeney 2013), SI units.
///
/// The reservoir of depth h0 fills x < 0 and is at rest at t = 0. With `beta = G k cos z`, `c0 = sqrt(beta h0)`,
/// `m = G cos z (tan z - tan d)`:
///
/// ```text
/// x < x_A = m t^2/2 - c0 t        h = h0, u = m t      (the slab slides)
/// x_A <= x <= x_B                 h = (2 c0 - x/t + m t/2)^2 / (9 beta),   u = (2/3) (c0 + x/t + m t)
/// x > x_B = m t^2/2 + 2 c0 t      dry
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlopeDamBreak {
    h0: f64,
    beta: f64,
    drive: f64,
}

impl SlopeDamBreak {
    /// Gravity (m/s2), depth h0 (m), slope and friction angle (rad) and earth pressure coefficient.
    ///
    /// # Errors
    /// [`ExactError::OutOfRange`] for a value without meaning, [`ExactError::NotValid`] for `d > z`: the formula
    /// then lets the reservoir climb.
    pub fn new(
        gravity: f64,
        h0: f64,
        slope: f64,
        friction: f64,
        earth_pressure: f64,
    ) -> Result<Self, ExactError> {
        positive("gravity", gravity)?;
        positive("h0", h0)?;
        angle("slope", slope)?;
        angle("friction", friction)?;
        positive("earth pressure", earth_pressure)?;
        if friction > slope {
            return Err(ExactError::NotValid {
                solution: "the dam break on a slope",
                requirement: "friction angle <= slope angle",
                left: friction,
                right: slope,
            });
        }
        Ok(Self {
            h0,
            beta: gravity * earth_pressure * slope.cos(),
            drive: gravity * slope.cos() * (slope.tan() - friction.tan()),
        })
    }

    /// (x_A, x_B): where the fan begins and where the front is at time `t >= 0`, m.
    pub fn fronts(&self, t: f64) -> (f64, f64) {
        let (c0, moved) = ((self.beta * self.h0).sqrt(), self.drive * t * t / 2.0);
        (moved - c0 * t, moved + 2.0 * c0 * t)
    }

    /// The flow at `x` and time `t >= 0`.
    pub fn flow(&self, x: f64, t: f64) -> Flow1 {
        let (tail, front) = self.fronts(t);
        if x <= tail {
            Flow1 { h: self.h0, u: self.drive * t }
        } else if x < front {
            let c0 = (self.beta * self.h0).sqrt();
            let c = (2.0 * c0 - x / t + self.drive * t / 2.0) / 3.0;
            Flow1 { h: c * c / self.beta, u: 2.0 / 3.0 * (c0 + x / t + self.drive * t) }
        } else {
            Flow1::DRY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::residual;
    use super::*;
    use std::prelude::v1::*;

    #[test]
    fn slope_numbers_at_five_seconds() {
        let (z, d) = (22f64.to_radians(), 21f64.to_radians());
        let dam = SlopeDamBreak::new(9.81, 1.0, z, d, 1.0).unwrap();
        let (a, b) = dam.fronts(5.0);
        assert!((a + 12.787158).abs() < 5e-7 && (b - 32.451393).abs() < 5e-7, "{a} {b}");
        assert!((dam.flow(a - 1.0, 5.0).u - 0.916944).abs() < 5e-7);
        let middle = 9.81 * z.cos() * (z.tan() - d.tan()) * 12.5;
        assert!((dam.flow(middle, 5.0).h - 4.0 / 9.0).abs() < 1e-14);
        assert_eq!((dam.flow(b, 5.0), dam.flow(0.1, 0.0)), (Flow1::DRY, Flow1::DRY));
        assert_eq!(dam.flow(-0.1, 0.0), Flow1 { h: 1.0, u: 0.0 });
    }

    #[test]
    fn slope_solves_the_equations() {
        let (z, d): (f64, f64) = (0.4, 0.3);
        let dam = SlopeDamBreak::new(9.81, 1.3, z, d, 1.4).unwrap();
        let source = 9.81 * (z.sin() - z.cos() * d.tan());
        for share in [-0.3, 0.1, 0.5, 0.9] {
            let (a, b) = dam.fronts(2.0);
            let x = a + share * (b - a);
            let (m, q) = residual(|x, t| dam.flow(x, t), 9.81 * 1.4 * z.cos(), source, x, 2.0, 1e-3);
            assert!(m.abs() < 1e-8 && q.abs() < 1e-7, "{share}: {m} {q}");
        }
        let (a, _) = dam.fronts(2.0);
        let (l, r) = (dam.flow(a - 1e-9, 2.0), dam.flow(a + 1e-9, 2.0));
        assert!((l.h - r.h).abs() < 1e-8 && (l.u - r.u).abs() < 1e-8);
    }

    #[test]
    fn slope_is_refused_where_friction_holds() {
        assert!(matches!(SlopeDamBreak::new(9.81, 1.0, 0.3, 0.31, 1.0), Err(ExactError::NotValid { .. })));
        assert!(SlopeDamBreak::new(9.81, 1.0, 0.3, 0.3, 1.0).is_ok());
    }
}
