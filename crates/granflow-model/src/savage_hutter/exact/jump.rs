//! The granular jump, a shock that travels with one speed.

use super::values::{ExactError, Flow1, not_negative, positive};

/// A jump between two uniform flows where friction just carries the slope (`tan d = tan z`), so that both sides
/// keep their speed:
///
/// ```text
/// (u- - u+)^2 = (beta/2) (h+ - h-)^2 (h+ + h-) / (h+ h-),    V = (h- u- - h+ u+) / (h- - h+)
/// ```
///
/// with `beta = G k cos z` (m/s2) in SI units or `eps k cos z` scaled (Tai, Noelle, Gray & Hutter 2002, J. Comput. Phys.
/// 175: jump conditions of the Savage-Hutter equations). `-` is the side of smaller x, and the jump compresses: `u- > u+`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GranularJump {
    minus: Flow1,
    plus: Flow1,
    speed: f64,
}

impl GranularJump {
    /// The jump from the depth `minus.h` and speed `minus.u` to the depth `h_plus`.
    ///
    /// # Errors
    /// [`ExactError::OutOfRange`] for a value without meaning; [`ExactError::NotValid`] for equal depths, or where
    /// `u+ < 0` would follow, since friction then no longer carries the slope.
    pub fn new(beta: f64, minus: Flow1, h_plus: f64) -> Result<Self, ExactError> {
        positive("beta", beta)?;
        let h_minus = positive("h-", minus.h)?;
        not_negative("u-", minus.u)?;
        positive("h+", h_plus)?;
        let not_valid = |requirement, left, right| {
            Err(ExactError::NotValid { solution: "the granular jump", requirement, left, right })
        };
        if h_minus == h_plus {
            return not_valid("h- different from h+", h_minus, h_plus);
        }
        let drop = (h_plus - h_minus).abs() * (beta / 2.0 * (h_plus + h_minus) / (h_plus * h_minus)).sqrt();
        let plus = Flow1 { h: h_plus, u: minus.u - drop };
        if plus.u < 0.0 {
            return not_valid("u- >= u- - u+ (both sides flow downhill or rest)", minus.u, drop);
        }
        Ok(Self { minus, plus, speed: (minus.q() - plus.q()) / (h_minus - h_plus) })
    }

    /// State behind x = V t.
    pub fn minus(&self) -> Flow1 {
        self.minus
    }

    /// State ahead of x = V t.
    pub fn plus(&self) -> Flow1 {
        self.plus
    }

    /// Speed V of the jump.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// The flow at `x` and time `t`; the jump starts at x = 0.
    pub fn flow(&self, x: f64, t: f64) -> Flow1 {
        if x <= self.speed * t { self.minus } else { self.plus }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Riemann, Wave};
    use super::*;
    use std::prelude::v1::*;

    #[test]
    fn balances_mass_and_momentum_and_is_the_riemann_shock() {
        let beta = 4.2;
        for (h_minus, h_plus) in [(0.3, 1.1), (1.1, 0.3)] {
            let minus = Flow1 { h: h_minus, u: 4.0 };
            let j = GranularJump::new(beta, minus, h_plus).unwrap();
            let (a, b, v) = (j.minus(), j.plus(), j.speed());
            let force = |f: Flow1| f.q() * f.u + beta * f.h * f.h / 2.0;
            assert!((v * (b.h - a.h) - (b.q() - a.q())).abs() < 1e-14);
            assert!((v * (b.q() - a.q()) - (force(b) - force(a))).abs() < 1e-13);
            assert!(a.u > b.u);
            // The Riemann problem of the two sides is this one shock.
            let r = Riemann::new(beta, a, b).unwrap();
            let waves = [r.left_wave(), r.right_wave()];
            let shock = waves
                .into_iter()
                .flatten()
                .find(|w| matches!(w, Wave::Shock { speed } if (speed - v).abs() < 1e-7));
            assert!(shock.is_some(), "{r:?}");
            assert_eq!((j.flow(2.0 * v - 1e-9, 2.0), j.flow(2.0 * v + 1e-9, 2.0)), (a, b));
        }
    }

    #[test]
    fn refused_where_the_far_side_would_flow_uphill() {
        assert!(matches!(
            GranularJump::new(4.2, Flow1 { h: 0.1, u: 1.0 }, 2.0),
            Err(ExactError::NotValid { .. })
        ));
        assert!(GranularJump::new(4.2, Flow1 { h: 1.0, u: 1.0 }, 1.0).is_err());
    }
}
