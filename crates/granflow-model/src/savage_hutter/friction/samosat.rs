//! The law of samosAT.

use super::{Friction, Resistance};
use crate::real::Real;
use crate::scheme::components;

/// samosAT, the default law of AvaFrame's com1DFA (Sampl & Granig 2009; AvaFrame documentation).
///
/// \[tau0 + mu sigma (1 + Rs0/(Rs0 + Rs)) + rho |V|^2/(ln(h/R)/kappa + B)^2\]/(rho h), sigma = rho N+ h,
/// Rs = rho |V|^2/sigma; h/R is taken as at least 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamosAt {
    /// mu.
    pub mu: f64,
    /// tau0/rho \[m^2/s^2\].
    pub bond: f64,
    /// Rs0.
    pub rs0: f64,
    /// kappa.
    pub kappa: f64,
    /// R \[m\].
    pub r: f64,
    /// B.
    pub b: f64,
}

components!(SamosAt { mu: f64, bond: f64, rs0: f64, kappa: f64, r: f64, b: f64 });

impl Friction for SamosAt {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let (mu, rs0, one) = (R::splat(self.mu), R::splat(self.rs0), R::splat(1.0));
        let bond = R::splat(self.bond) / thickness;
        // Rs0/(Rs0 + Rs) with Rs = |V|^2/(N h), multiplied through by N h: no division by a vanishing load.
        let pressure = rs0 * load * thickness;
        let sum = pressure + speed_squared;
        let share = R::select(sum.le(R::zero()), one, pressure / R::select(sum.le(R::zero()), one, sum));
        let wall = (thickness * R::splat(1.0 / self.r)).max(one).ln() * R::splat(1.0 / self.kappa)
            + R::splat(self.b);
        Resistance {
            dry: bond + mu * load * (one + share),
            viscous: R::zero(),
            drag: one / (wall * wall * thickness),
            holding: bond + mu * (weight + weight),
        }
    }
}
