//! Coulomb's law, and with a bond.

use super::{Friction, Resistance};
use crate::real::Real;
use crate::scheme::components;

/// mu N+ (Coulomb 1776; report eq. 1, R = cos zeta tan delta).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb {
    /// mu = tan(delta).
    pub mu: f64,
}

components!(Coulomb { mu: f64 });

impl Friction for Coulomb {
    #[inline(always)]
    fn resistance<R: Real>(&self, _thickness: R, _speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let mu = R::splat(self.mu);
        Resistance { dry: mu * load, viscous: R::zero(), drag: R::zero(), holding: mu * weight }
    }
}

/// mu N+ + tau0/(rho h): Coulomb with a cohesive bond to the bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cohesion {
    /// mu = tan(delta).
    pub mu: f64,
    /// Cohesion over density, tau0/rho \[m^2/s^2\].
    pub bond: f64,
}

components!(Cohesion { mu: f64, bond: f64 });

impl Friction for Cohesion {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let coulomb = Coulomb { mu: self.mu }.resistance(thickness, speed_squared, load, weight);
        let bond = R::splat(self.bond) / thickness;
        Resistance { dry: coulomb.dry + bond, holding: coulomb.holding + bond, ..coulomb }
    }
}
