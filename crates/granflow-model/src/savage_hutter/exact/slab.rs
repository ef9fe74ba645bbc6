//! A uniform slab that friction brings to rest.

use super::values::{ExactError, angle, not_negative, positive};

/// A slab of any uniform depth that slides down a plane with `tan d > tan z` from the speed `u0`:
/// `u = max(0, u0 - G cos z (tan d - tan z) t)` and then exactly 0 (SI units).
///
/// It is the Savage-Hutter model without gradients (Kaland & Struckmeier 2007, eq. 1 with h_x = u_x = 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlidingSlab {
    u0: f64,
    braking: f64,
}

impl SlidingSlab {
    /// Gravity (m/s2), slope and friction angle (rad) and initial speed (m/s, down the slope).
    ///
    /// # Errors
    /// [`ExactError::OutOfRange`] for a value without meaning, [`ExactError::NotValid`] unless `d > z`, since
    /// the slab would never stop.
    pub fn new(gravity: f64, slope: f64, friction: f64, u0: f64) -> Result<Self, ExactError> {
        positive("gravity", gravity)?;
        angle("slope", slope)?;
        angle("friction", friction)?;
        not_negative("u0", u0)?;
        if friction <= slope {
            return Err(ExactError::NotValid {
                solution: "the stopping slab",
                requirement: "friction angle > slope angle",
                left: friction,
                right: slope,
            });
        }
        Ok(Self { u0, braking: gravity * slope.cos() * (friction.tan() - slope.tan()) })
    }

    /// Speed at time `t >= 0`, m/s.
    pub fn velocity(&self, t: f64) -> f64 {
        (self.u0 - self.braking * t).max(0.0)
    }

    /// Time at which it comes to rest, s: `u0 / (G cos z (tan d - tan z))`.
    pub fn stopping_time(&self) -> f64 {
        self.u0 / self.braking
    }

    /// Way travelled by time `t >= 0`, m.
    pub fn displacement(&self, t: f64) -> f64 {
        let t = t.min(self.stopping_time());
        self.u0 * t - self.braking * t * t / 2.0
    }

    /// Way travelled until it rests, m: `u0^2 / (2 G cos z (tan d - tan z))`.
    pub fn stopping_distance(&self) -> f64 {
        self.u0 * self.u0 / (2.0 * self.braking)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::prelude::v1::*;

    #[test]
    fn brakes_evenly_and_stays() {
        let (z, d) = (20f64.to_radians(), 30f64.to_radians());
        let s = SlidingSlab::new(9.81, z, d, 3.0).unwrap();
        let (t, e) = (s.stopping_time(), 1e-6);
        // the equation of motion: u' = G (sin z - cos z tan d)
        let slope = (s.velocity(0.5 * t + e) - s.velocity(0.5 * t - e)) / (2.0 * e);
        assert!((slope - 9.81 * (z.sin() - z.cos() * d.tan())).abs() < 1e-8);
        assert!(s.velocity(t * (1.0 - 1e-9)) > 0.0);
        assert_eq!((s.velocity(t + e), s.velocity(10.0 * t)), (0.0, 0.0));
        assert!((s.displacement(2.0 * t) - s.stopping_distance()).abs() < 1e-14);
        // the way is the integral of the speed (trapezoids are exact for a straight line)
        assert!((s.displacement(0.5 * t) - (3.0 + 1.5) / 2.0 * 0.5 * t).abs() < 1e-14);
    }

    #[test]
    fn refused_where_it_would_not_stop() {
        assert!(matches!(SlidingSlab::new(9.81, 0.3, 0.3, 1.0), Err(ExactError::NotValid { .. })));
        assert!(SlidingSlab::new(9.81, 0.3, 0.4, -1.0).is_err());
    }
}
